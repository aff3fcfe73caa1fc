/* The identifier of order 3 as a unit: command and position in, model with its uncertainty out. */
#include "model.h"

#include <math.h>

enum { SAMPLE_TIME, BANDWIDTH, U_RANGE, Y_RANGE, NOISE, MEMORY, U, Y, THETA, STD = THETA + 5, GAIN = STD + 5, OMEGA0, DAMPING,
       GAIN_STD, OMEGA0_STD, DAMPING_STD, INNOVATION, PREDICTION, REALS };
enum { DELAY, KIND, INTEGERS };

const struct description description = {
    .guid = "{trendid-identifier-1}",
    .reals = {U, THETA - U, REALS},
    .integers = {KIND, 0, INTEGERS},
    .booleans = {0, 0, 0},
};
const size_t object_bytes = sizeof(trendid_servo3);

_Static_assert(REALS <= REALS_MAX && INTEGERS <= INTEGERS_MAX, "more variables than there is room for");

void model_defaults(struct values *values)
{
    static const struct values defaults = {
        .reals = {[SAMPLE_TIME] = 0.001, [BANDWIDTH] = 20.0, [U_RANGE] = 1.0, [Y_RANGE] = 50.0},
    };
    *values = defaults;
}

double model_sample_time(const struct values *values)
{
    return values->reals[SAMPLE_TIME];
}

/* NaN in the place of what is not known: a zero would be a number. */
static double known(bool exists, float value)
{
    return exists ? (double)value : (double)NAN;
}

trendid_error model_begin(void *object, struct values *values, trendid_detail *detail)
{
    trendid_settings settings;
    const double *reals = values->reals;
    const trendid_error error = trendid_settings_init(&settings, (float)reals[SAMPLE_TIME], (float)reals[BANDWIDTH],
                                                      (float)reals[U_RANGE], (float)reals[Y_RANGE]);
    settings.output_noise = (float)reals[NOISE];
    settings.memory = (float)reals[MEMORY];
    settings.delay[0] = (float)values->integers[DELAY];
    for (int i = GAIN; i <= DAMPING_STD; i++) {
        values->reals[i] = known(false, 0.0F);
    }
    return error != TRENDID_ERROR_OK ? error : trendid_servo3_init(object, &settings, NULL, detail);
}

trendid_error model_sample(void *object, struct values *values, trendid_detail *detail)
{
    (void)detail;
    trendid_identifier *identifier = object;
    double *reals = values->reals;
    trendid_outcome outcome;
    trendid_estimate found;
    trendid_status status;
    trendid_error error = trendid_identifier_update(identifier, (float)reals[U], (float)reals[Y], &outcome);
    if (error == TRENDID_ERROR_OK) {
        error = trendid_identifier_estimate(identifier, &found);
    }
    if (error == TRENDID_ERROR_OK) {
        error = trendid_identifier_status(identifier, &status);
    }
    if (error != TRENDID_ERROR_OK) {
        return error;
    }
    for (int i = 0; i < 5; i++) {
        reals[THETA + i] = (double)found.theta[i];
        reals[STD + i] = (double)found.std[i];
    }
    reals[GAIN] = known(found.has_gain, found.gain);
    reals[OMEGA0] = known(found.has_pair, found.omega0);
    reals[DAMPING] = known(found.has_pair, found.damping);
    reals[GAIN_STD] = known(found.has_physical_std, found.gain_std);
    reals[OMEGA0_STD] = known(found.has_physical_std, found.omega0_std);
    reals[DAMPING_STD] = known(found.has_physical_std, found.damping_std);
    reals[INNOVATION] = (double)outcome.innovation;
    reals[PREDICTION] = (double)status.prediction;
    values->integers[KIND] = outcome.kind;
    return TRENDID_ERROR_OK;
}
