/*
 * trendid in MATLAB and GNU Octave, on the C interface: an identifier of any structure over whole records.
 *
 *   [theta, std, model, errors] = trendid_mex(t_sample, bandwidth, structure, u, y, options)
 *
 * trendid_identify.m is the function for users; this one only passes arrays on. `structure` is [order, integrators?, ..] as
 * trendid_identify.m builds it: order, inputs, output terms, terms of both inputs, constant, initial state. `options` is
 * input ranges (2), output range, noise, memory, settling, significance, delays (2), holds (2), whether changes are followed.
 *
 * No state between calls: the object lives on the stack of the call.
 */
#include "mex.h"

#include <string.h>

#include "trendid.h"

/* Ends the call with an error of MATLAB that names what was refused. */
static void refuse(trendid_error error, const trendid_detail *detail)
{
    if (detail != NULL && detail->setting[0] != '\0') {
        mexErrMsgIdAndTxt("trendid:setting", "%s = %g: %s (%g to %g)", detail->setting, (double)detail->value,
                          trendid_error_text(error), (double)detail->low, (double)detail->high);
    }
    mexErrMsgIdAndTxt("trendid:error", "%s", trendid_error_text(error));
}

static const double *reals(const mxArray *array, size_t count, const char *name)
{
    if (!mxIsDouble(array) || mxIsComplex(array) || mxGetNumberOfElements(array) != count) {
        mexErrMsgIdAndTxt("trendid:argument", "%s must be %u real numbers of class double", name, (unsigned)count);
    }
    return mxGetPr(array);
}

/* A whole number within a byte. */
static uint8_t byte_of(double value, const char *name)
{
    if (!(value >= 0.0 && value <= 255.0) || value != (double)(uint8_t)value) {
        mexErrMsgIdAndTxt("trendid:argument", "%s = %g is not a whole number from 0 to 255", name, value);
    }
    return (uint8_t)value;
}

static mxArray *row(const float *values, size_t count)
{
    mxArray *made = mxCreateDoubleMatrix(1, (mwSize)count, mxREAL);
    for (size_t i = 0; i < count; i++) {
        mxGetPr(made)[i] = (double)values[i];
    }
    return made;
}

static void field(mxArray *to, const char *name, mxArray *value)
{
    mxAddField(to, name);
    mxSetField(to, 0, name, value);
}

static mxArray *number(bool exists, float value)
{
    return mxCreateDoubleScalar(exists ? (double)value : mxGetNaN());
}

static mxArray *model_of(const trendid_estimate *found)
{
    mxArray *model = mxCreateStructMatrix(1, 1, 0, NULL);
    const size_t order = found->order;
    mxArray *b = mxCreateDoubleMatrix((mwSize)found->inputs, (mwSize)order, mxREAL);
    for (size_t input = 0; input < found->inputs; input++) {
        for (size_t power = 0; power < order; power++) {
            mxGetPr(b)[input + power * found->inputs] = (double)found->b[input][power];
        }
    }
    field(model, "a", row(found->a, order));
    field(model, "b", b);
    field(model, "constant", number(true, found->constant));
    field(model, "gain", number(found->has_gain, found->gain));
    field(model, "omega0", number(found->has_pair, found->omega0));
    field(model, "damping", number(found->has_pair, found->damping));
    field(model, "gain_std", number(found->has_physical_std, found->gain_std));
    field(model, "omega0_std", number(found->has_physical_std, found->omega0_std));
    field(model, "damping_std", number(found->has_physical_std, found->damping_std));
    field(model, "stable", mxCreateLogicalScalar(found->stable));
    return model;
}

void mexFunction(int nlhs, mxArray *plhs[], int nrhs, const mxArray *prhs[])
{
    if (nrhs != 6 || nlhs > 5) {
        mexErrMsgIdAndTxt("trendid:argument", "six arguments, up to five results; use trendid_identify");
    }
    const double sample_time = reals(prhs[0], 1, "sample time")[0];
    const double bandwidth = reals(prhs[1], 1, "bandwidth")[0];
    const double *shape = reals(prhs[2], 7, "structure");
    const size_t samples = mxGetNumberOfElements(prhs[4]);
    const double *y = reals(prhs[4], samples, "y");
    const double *option = reals(prhs[5], 12, "options");
    const trendid_structure structure = {
        .order = byte_of(shape[0], "order"),
        .inputs = byte_of(shape[1], "inputs"),
        .output_terms = byte_of(shape[2], "output terms"),
        .input_terms = {byte_of(shape[3], "input terms"), byte_of(shape[4], "input terms")},
        .constant = byte_of(shape[5], "constant"),
        .initial_state = byte_of(shape[6], "initial state"),
    };
    const double *u = reals(prhs[3], samples * structure.inputs, "u");

    trendid_settings settings;
    trendid_any memory;
    trendid_identifier *identifier = NULL;
    trendid_detail detail;
    memset(&detail, 0, sizeof detail);
    trendid_error error =
        trendid_settings_init(&settings, (float)sample_time, (float)bandwidth, (float)option[0], (float)option[2]);
    settings.input_range[1] = (float)option[1];
    settings.output_noise = (float)option[3];
    settings.memory = (float)option[4];
    settings.settling = (float)option[5];
    settings.offset_significance = (float)option[6];
    settings.delay[0] = (float)option[7];
    settings.delay[1] = (float)option[8];
    settings.hold[0] = byte_of(option[9], "hold");
    settings.hold[1] = byte_of(option[10], "hold");
    settings.follow_changes = byte_of(option[11], "follow_changes");
    if (error == TRENDID_ERROR_OK) {
        error = trendid_any_init(&memory, &settings, &structure, &identifier, &detail);
    }
    if (error != TRENDID_ERROR_OK) {
        refuse(error, &detail);
    }

    mxArray *innovations = mxCreateDoubleMatrix((mwSize)samples, 1, mxREAL);
    for (size_t k = 0; k < samples; k++) {
        float inputs[TRENDID_INPUTS_MAX] = {0.0f};
        for (size_t input = 0; input < structure.inputs; input++) {
            inputs[input] = (float)u[k + input * samples];
        }
        trendid_outcome outcome;
        error = trendid_identifier_update_inputs(identifier, inputs, structure.inputs, (float)y[k], &outcome);
        if (error != TRENDID_ERROR_OK) {
            refuse(error, NULL);
        }
        const bool predicted = outcome.kind >= TRENDID_SAMPLE_KIND_REPLACED;
        mxGetPr(innovations)[k] = predicted ? (double)outcome.innovation : mxGetNaN();
    }

    trendid_estimate found;
    error = trendid_identifier_estimate(identifier, &found);
    if (error != TRENDID_ERROR_OK) {
        refuse(error, NULL);
    }
    plhs[0] = row(found.theta, found.parameters);
    if (nlhs > 1) {
        plhs[1] = row(found.std, found.parameters);
    }
    if (nlhs > 2) {
        plhs[2] = model_of(&found);
    }
    if (nlhs > 3) {
        plhs[3] = innovations;
    } else {
        mxDestroyArray(innovations);
    }
    if (nlhs > 4) {
        const size_t n = found.parameters;
        float covariance[TRENDID_PARAMETERS_MAX * TRENDID_PARAMETERS_MAX];
        error = trendid_identifier_covariance(identifier, covariance, n * n);
        if (error != TRENDID_ERROR_OK) {
            refuse(error, NULL);
        }
        /* Row by row here, column by column there: the matrix is symmetric. */
        plhs[4] = mxCreateDoubleMatrix((mwSize)n, (mwSize)n, mxREAL);
        for (size_t i = 0; i < n * n; i++) {
            mxGetPr(plhs[4])[i] = (double)covariance[i];
        }
    }
}
