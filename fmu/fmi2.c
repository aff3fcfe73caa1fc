/*
 * The functions of FMI 2.0 for co-simulation around a model of trendid (model.h).
 *
 * A communication step is a whole number of sample times. Inputs are in force for all its samples.
 */
#include "fmi2.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "model.h"

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

/* Up to here each sample has a number of its own. */
#define SAMPLES_MAX 9007199254740992.0

enum state { INSTANTIATED, INITIALISING, STEPPING, TERMINATED, FAILED };

struct unit {
    const fmi2CallbackFunctions *callbacks;
    enum state state;
    bool logging;
    /* Samples since the begin, the time of the begin in s, and the sample time that the object has. */
    double samples;
    double begin;
    double sample_time;
    struct values values;
    /* The object of trendid follows, aligned for every type. */
    max_align_t object[];
};

static size_t bytes_of_unit(void)
{
    return sizeof(struct unit) + object_bytes;
}

static fmi2Status told(struct unit *unit, fmi2Status status, const char *text)
{
    if (unit->callbacks->logger != NULL && (unit->logging || status >= fmi2Error)) {
        unit->callbacks->logger(unit->callbacks->componentEnvironment, "trendid", status,
                                status >= fmi2Error ? "logStatusError" : "logStatusWarning", "%s", text);
    }
    return status;
}

static fmi2Status refused(struct unit *unit, trendid_error error, const char *setting)
{
    unit->state = FAILED;
    if (setting[0] != '\0') {
        (void)told(unit, fmi2Error, setting);
    }
    return told(unit, fmi2Error, trendid_error_text(error));
}

EXPORT const char *fmi2GetTypesPlatform(void)
{
    return "default";
}

EXPORT const char *fmi2GetVersion(void)
{
    return "2.0";
}

EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                     const fmi2CallbackFunctions *callbacks, fmi2Boolean visible, fmi2Boolean logging)
{
    (void)resources;
    (void)visible;
    if (callbacks == NULL || callbacks->allocateMemory == NULL || callbacks->freeMemory == NULL || name == NULL ||
        guid == NULL || type != fmi2CoSimulation || strcmp(guid, description.guid) != 0) {
        return NULL;
    }
    struct unit *unit = callbacks->allocateMemory(1, bytes_of_unit());
    if (unit == NULL) {
        return NULL;
    }
    memset(unit, 0, bytes_of_unit());
    unit->callbacks = callbacks;
    unit->logging = logging != fmi2False;
    model_defaults(&unit->values);
    return unit;
}

EXPORT void fmi2FreeInstance(fmi2Component component)
{
    struct unit *unit = component;
    if (unit != NULL) {
        unit->callbacks->freeMemory(unit);
    }
}

EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean logging, size_t count, const fmi2String names[])
{
    (void)count;
    (void)names;
    ((struct unit *)component)->logging = logging != fmi2False;
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real begin,
                                      fmi2Boolean has_end, fmi2Real end)
{
    (void)has_tolerance;
    (void)tolerance;
    (void)has_end;
    (void)end;
    struct unit *unit = component;
    if (unit->state != INSTANTIATED) {
        return told(unit, fmi2Error, "the experiment is set up before the initialisation");
    }
    if (!isfinite(begin)) {
        return told(unit, fmi2Error, "the begin is not a finite time");
    }
    unit->begin = begin;
    return fmi2OK;
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component component)
{
    struct unit *unit = component;
    if (unit->state != INSTANTIATED) {
        return told(unit, fmi2Error, "initialisation twice");
    }
    unit->state = INITIALISING;
    return fmi2OK;
}

EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component component)
{
    struct unit *unit = component;
    if (unit->state != INITIALISING) {
        return told(unit, fmi2Error, "not in initialisation");
    }
    trendid_detail detail;
    memset(&detail, 0, sizeof detail);
    const trendid_error error = model_begin(unit->object, &unit->values, &detail);
    if (error != TRENDID_ERROR_OK) {
        return refused(unit, error, detail.setting);
    }
    unit->samples = 0.0;
    unit->sample_time = model_sample_time(&unit->values);
    unit->state = STEPPING;
    return fmi2OK;
}

EXPORT fmi2Status fmi2Terminate(fmi2Component component)
{
    ((struct unit *)component)->state = TERMINATED;
    return fmi2OK;
}

EXPORT fmi2Status fmi2Reset(fmi2Component component)
{
    struct unit *unit = component;
    model_defaults(&unit->values);
    memset(unit->object, 0, object_bytes);
    unit->samples = 0.0;
    unit->state = INSTANTIATED;
    return fmi2OK;
}

EXPORT fmi2Status fmi2DoStep(fmi2Component component, fmi2Real now, fmi2Real step, fmi2Boolean no_return)
{
    (void)no_return;
    struct unit *unit = component;
    if (unit->state != STEPPING) {
        return told(unit, fmi2Error, "a step before the end of the initialisation");
    }
    const double before = (now - unit->begin) / unit->sample_time;
    if (!(fabs(before - unit->samples) < 1e-3)) {
        return told(unit, fmi2Error, "a communication step must begin where the one before has ended");
    }
    const double wanted = (now + step - unit->begin) / unit->sample_time;
    const double whole = floor(wanted + 0.5);
    if (!(step > 0.0) || !(fabs(wanted - whole) < 1e-3) || !(whole > unit->samples) || !(whole < SAMPLES_MAX)) {
        return told(unit, fmi2Error, "a communication step must be a whole number of sample times");
    }
    for (; unit->samples < whole; unit->samples += 1.0) {
        trendid_detail detail;
        memset(&detail, 0, sizeof detail);
        const trendid_error error = model_sample(unit->object, &unit->values, &detail);
        if (error != TRENDID_ERROR_OK) {
            return refused(unit, error, detail.setting);
        }
    }
    return fmi2OK;
}

EXPORT fmi2Status fmi2CancelStep(fmi2Component component)
{
    return told(component, fmi2Error, "a step ends before it returns");
}

/* Reading and writing the variables: a parameter until the initialisation, an input at any time, an output never. */

static const char *unwritable(const struct unit *unit, const struct kind *kind, fmi2ValueReference which)
{
    if (which >= kind->all) {
        return "no variable of this reference";
    }
    if (which < kind->parameters) {
        return unit->state < STEPPING ? NULL : "a parameter is fixed by the initialisation";
    }
    return which < kind->parameters + kind->inputs ? NULL : "an output cannot be set";
}

#define GET_AND_SET(Name, Type, list)                                                                                          \
    EXPORT fmi2Status fmi2Get##Name(fmi2Component component, const fmi2ValueReference which[], size_t count, Type to[])         \
    {                                                                                                                          \
        struct unit *unit = component;                                                                                         \
        for (size_t i = 0; i < count; i++) {                                                                                   \
            if (which[i] >= description.list.all) {                                                                            \
                return told(unit, fmi2Error, "no variable of this reference");                                                 \
            }                                                                                                                  \
            to[i] = unit->values.list[which[i]];                                                                               \
        }                                                                                                                      \
        return fmi2OK;                                                                                                         \
    }                                                                                                                          \
    EXPORT fmi2Status fmi2Set##Name(fmi2Component component, const fmi2ValueReference which[], size_t count,                   \
                                    const Type from[])                                                                         \
    {                                                                                                                          \
        struct unit *unit = component;                                                                                         \
        for (size_t i = 0; i < count; i++) {                                                                                   \
            const char *why = unwritable(unit, &description.list, which[i]);                                                   \
            if (why != NULL) {                                                                                                 \
                return told(unit, fmi2Error, why);                                                                             \
            }                                                                                                                  \
            unit->values.list[which[i]] = from[i];                                                                             \
        }                                                                                                                      \
        return fmi2OK;                                                                                                         \
    }

GET_AND_SET(Real, fmi2Real, reals)
GET_AND_SET(Integer, fmi2Integer, integers)
GET_AND_SET(Boolean, fmi2Boolean, booleans)

EXPORT fmi2Status fmi2GetString(fmi2Component component, const fmi2ValueReference which[], size_t count, fmi2String to[])
{
    (void)which;
    (void)to;
    return count == 0 ? fmi2OK : told(component, fmi2Error, "there are no strings");
}

EXPORT fmi2Status fmi2SetString(fmi2Component component, const fmi2ValueReference which[], size_t count,
                                const fmi2String from[])
{
    (void)which;
    (void)from;
    return count == 0 ? fmi2OK : told(component, fmi2Error, "there are no strings");
}

/* A state is a copy of the unit: objects of trendid may be copied. */

EXPORT fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *state)
{
    struct unit *unit = component;
    if (*state == NULL) {
        *state = unit->callbacks->allocateMemory(1, bytes_of_unit());
    }
    if (*state == NULL) {
        return told(unit, fmi2Error, "no memory for the state");
    }
    memcpy(*state, unit, bytes_of_unit());
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state)
{
    if (state == NULL) {
        return told(component, fmi2Error, "no state");
    }
    /* Of another unit that has gone, the callbacks may have gone, too. */
    struct unit *unit = component;
    const fmi2CallbackFunctions *callbacks = unit->callbacks;
    memcpy(unit, state, bytes_of_unit());
    unit->callbacks = callbacks;
    return fmi2OK;
}

EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *state)
{
    if (state != NULL && *state != NULL) {
        ((struct unit *)component)->callbacks->freeMemory(*state);
        *state = NULL;
    }
    return fmi2OK;
}

EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t *size)
{
    (void)state;
    (void)size;
    return told(component, fmi2Error, "a state cannot leave the process");
}

EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    (void)state;
    (void)bytes;
    (void)size;
    return told(component, fmi2Error, "a state cannot leave the process");
}

EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    (void)bytes;
    (void)size;
    (void)state;
    return told(component, fmi2Error, "a state cannot leave the process");
}

/* What modelDescription.xml says is not there. */

EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component component, const fmi2ValueReference unknown[], size_t unknowns,
                                               const fmi2ValueReference known[], size_t knowns, const fmi2Real seed[],
                                               fmi2Real to[])
{
    (void)unknown;
    (void)unknowns;
    (void)known;
    (void)knowns;
    (void)seed;
    (void)to;
    return told(component, fmi2Error, "no directional derivatives");
}

EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component component, const fmi2ValueReference which[], size_t count,
                                              const fmi2Integer order[], const fmi2Real from[])
{
    (void)which;
    (void)count;
    (void)order;
    (void)from;
    return told(component, fmi2Error, "inputs are held");
}

EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component component, const fmi2ValueReference which[], size_t count,
                                               const fmi2Integer order[], fmi2Real to[])
{
    (void)which;
    (void)count;
    (void)order;
    (void)to;
    return told(component, fmi2Error, "no derivatives of outputs");
}

EXPORT fmi2Status fmi2GetStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Status *to)
{
    (void)kind;
    (void)to;
    return told(component, fmi2Discard, "no step is pending");
}

EXPORT fmi2Status fmi2GetRealStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Real *to)
{
    struct unit *unit = component;
    if (kind != fmi2LastSuccessfulTime) {
        return told(unit, fmi2Discard, "no such status");
    }
    *to = unit->begin + unit->samples * unit->sample_time;
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Integer *to)
{
    (void)kind;
    (void)to;
    return told(component, fmi2Discard, "no such status");
}

EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean *to)
{
    struct unit *unit = component;
    if (kind != fmi2Terminated) {
        return told(unit, fmi2Discard, "no such status");
    }
    *to = unit->state == TERMINATED;
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetStringStatus(fmi2Component component, const fmi2StatusKind kind, fmi2String *to)
{
    (void)kind;
    (void)to;
    return told(component, fmi2Discard, "no such status");
}
