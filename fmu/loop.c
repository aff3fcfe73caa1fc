/* The position loop as a unit: code of the sensor and requests in, command of the valve out. */
#include "model.h"

enum { SAMPLE_TIME, TRAVEL_MIN, TRAVEL_MAX, UNITS_PER_COUNT, BANDWIDTH, WANTED_BANDWIDTH, TARGET, COMMAND, POSITION, REFERENCE,
       REFERENCE_VELOCITY, INNOVATION, A1, A2, B0, DEAD_ZONE, OFFSET, FRICTION, REALS };
enum { REFERENCE_CODE, DIRECTION, CODE, STATE, REASON, INTEGERS };
enum { COMMISSION, ABORT, SENSOR_FAULT, RETUNED, BOOLEANS };

struct object {
    trendid_loop loop;
    /* What was asked for in the sample before: a request is a change. */
    double target;
    int commission;
    int abort;
};

const struct description description = {
    .guid = "{trendid-loop-1}",
    .reals = {TARGET, COMMAND - TARGET, REALS},
    .integers = {CODE, STATE - CODE, INTEGERS},
    .booleans = {0, RETUNED, BOOLEANS},
};
const size_t object_bytes = sizeof(struct object);

_Static_assert(REALS <= REALS_MAX && INTEGERS <= INTEGERS_MAX && BOOLEANS <= BOOLEANS_MAX,
               "more variables than there is room for");

void model_defaults(struct values *values)
{
    static const struct values defaults = {
        .reals = {[SAMPLE_TIME] = 0.001, [TRAVEL_MAX] = 400.0, [UNITS_PER_COUNT] = 0.005},
    };
    *values = defaults;
}

double model_sample_time(const struct values *values)
{
    return values->reals[SAMPLE_TIME];
}

trendid_error model_begin(void *memory, struct values *values, trendid_detail *detail)
{
    struct object *object = memory;
    trendid_loop_settings settings;
    const double *reals = values->reals;
    const trendid_error error =
        trendid_loop_settings_init(&settings, (float)reals[SAMPLE_TIME], (float)reals[TRAVEL_MIN], (float)reals[TRAVEL_MAX],
                                   (float)reals[UNITS_PER_COUNT], values->integers[REFERENCE_CODE]);
    settings.bandwidth = (float)reals[BANDWIDTH];
    settings.controller.bandwidth = (float)reals[WANTED_BANDWIDTH];
    settings.direction = values->integers[DIRECTION];
    object->target = reals[TARGET];
    object->commission = 0;
    object->abort = 0;
    return error != TRENDID_ERROR_OK ? error : trendid_loop_init(&object->loop, &settings, detail);
}

/* What changed since the sample before. */
static trendid_error requests(struct object *object, const struct values *values, trendid_detail *detail)
{
    trendid_error error = TRENDID_ERROR_OK;
    const int commission = values->booleans[COMMISSION];
    const int stop = values->booleans[ABORT];
    const double target = values->reals[TARGET];
    if (commission && !object->commission) {
        error = trendid_loop_commission(&object->loop);
    }
    if (error == TRENDID_ERROR_OK && stop && !object->abort) {
        error = trendid_loop_abort(&object->loop);
    }
    object->commission = commission;
    object->abort = stop;
    if (error == TRENDID_ERROR_OK && target != object->target) {
        error = trendid_loop_move_to(&object->loop, (float)target, detail);
        if (error == TRENDID_ERROR_NOT_CONTROLLING) {
            /* It stays a new value, and is a move where control begins. */
            return TRENDID_ERROR_OK;
        }
        object->target = target;
    }
    return error;
}

trendid_error model_sample(void *memory, struct values *values, trendid_detail *detail)
{
    struct object *object = memory;
    trendid_report report;
    trendid_error error = requests(object, values, detail);
    if (error == TRENDID_ERROR_OK) {
        error = values->booleans[SENSOR_FAULT] ? trendid_loop_update_blind(&object->loop, &report)
                                               : trendid_loop_update(&object->loop, values->integers[CODE], &report);
    }
    if (error != TRENDID_ERROR_OK) {
        return error;
    }
    double *reals = values->reals;
    reals[COMMAND] = (double)report.command;
    reals[POSITION] = (double)report.position;
    reals[REFERENCE] = (double)report.reference;
    reals[REFERENCE_VELOCITY] = (double)report.reference_velocity;
    reals[INNOVATION] = (double)report.innovation;
    values->integers[STATE] = report.state;
    values->integers[REASON] = report.reason;
    values->booleans[RETUNED] = report.retuned;
    trendid_model model;
    if (trendid_loop_model(&object->loop, &model) == TRENDID_ERROR_OK) {
        reals[A1] = (double)model.a1;
        reals[A2] = (double)model.a2;
        reals[B0] = (double)model.b0;
        reals[DEAD_ZONE] = (double)model.dead_zone;
        reals[OFFSET] = (double)model.offset;
        reals[FRICTION] = (double)model.friction;
    }
    return TRENDID_ERROR_OK;
}
