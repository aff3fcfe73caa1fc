/* Every kind of identifier on the record. */
#include "hash.h"
#include "parts.h"
#include "record.h"

/* Half width of the dead zone that the record does not have, and the memory with which one is looked for, in s. */
#define DEAD_ZONE_MAX 0.1f
#define MEMORY 0.7f

/* Velocity within which the axis is at rest, in mm/s. */
#define REST 50.0f

/* Standard deviations are read this often. */
enum { EVERY = 10 };

/* The objects live in static memory: no heap, and nothing large on the stack. */
static trendid_servo2 servo2;
static trendid_servo3 servo3;
static trendid_valve2 valve2;
static trendid_valve3 valve3;
static trendid_coulomb2 coulomb2;
static trendid_coulomb3 coulomb3;
static trendid_valve_coulomb2 valve_coulomb2;
static trendid_valve_coulomb3 valve_coulomb3;
static trendid_instrumented2 instrumented2;
static trendid_instrumented3 instrumented3;
static trendid_friction friction;
#if !defined(WITHOUT_ANY)
static trendid_any any;
#endif
static trendid_delay_bank bank;

static void take_outcome(struct hash *hash, const trendid_outcome *outcome)
{
    hash_bits(hash, outcome->kind);
    hash_bits(hash, outcome->remaining);
    hash_number(hash, outcome->innovation);
}

static bool take_estimate(struct hash *hash, const trendid_identifier *identifier)
{
    trendid_estimate found;
    if (!done("estimate", trendid_identifier_estimate(identifier, &found))) {
        return false;
    }
    hash_numbers(hash, found.std, found.parameters);
    hash_number(hash, found.gain);
    hash_number(hash, found.omega0);
    hash_number(hash, found.damping);
    hash_number(hash, found.omega0_std);
    return true;
}

/* Poles may not be found; then nothing enters. */
static bool take_poles(struct hash *hash, const trendid_identifier *identifier)
{
    trendid_estimate found;
    trendid_pole poles[TRENDID_ORDER_MAX];
    if (!done("estimate", trendid_identifier_estimate(identifier, &found))) {
        return false;
    }
    const trendid_error error = trendid_identifier_poles(identifier, poles, found.order);
    if (error == TRENDID_ERROR_OK) {
        for (size_t i = 0; i < found.order; i++) {
            hash_number(hash, poles[i].re);
            hash_number(hash, poles[i].im);
        }
    }
    return error == TRENDID_ERROR_NOT_YET || done("poles", error);
}

static bool take_status(struct hash *hash, const trendid_identifier *identifier)
{
    trendid_status status;
    if (!done("status", trendid_identifier_status(identifier, &status))) {
        return false;
    }
    hash_number(hash, status.prediction);
    hash_number(hash, status.noise_std);
    hash_number(hash, status.ise);
    hash_number(hash, status.iae);
    hash_bits(hash, status.samples);
    hash_bits(hash, status.replaced);
    hash_bits(hash, status.changes);
    hash_number(hash, status.dead_zone);
    hash_bits(hash, status.way);
    hash_number(hash, status.blocks);
    return true;
}

/* The sign of the velocity, or its mean since the sample before. */
static bool sign_of(float velocity, bool mean, float *sign)
{
    if (mean) {
        return done("friction", trendid_friction_update(&friction, velocity, sign));
    }
    *sign = trendid_sign_of_velocity(velocity, REST);
    return true;
}

/*
 * The record through one identifier of `parameters` parameters; the second input is the sign of the velocity, its mean where
 * `mean` is true.
 */
static bool run_with(const char *name, trendid_identifier *identifier, size_t parameters, size_t inputs, bool mean)
{
    struct hash hash = hash_new();
    float theta[TRENDID_PARAMETERS_MAX];
    float last = 0.0f;
    for (uint32_t k = 0; k < RECORD_SAMPLES; k++) {
        const struct sample sample = record_sample(k);
        const float velocity = (sample.y - last) / RECORD_SAMPLE_TIME;
        last = sample.y;
        trendid_outcome outcome;
        trendid_error error;
        if (inputs == 1u) {
            error = trendid_identifier_update(identifier, sample.u, sample.y, &outcome);
        } else {
            float u[2] = {sample.u, 0.0f};
            if (!sign_of(velocity, mean, &u[1])) {
                return false;
            }
            error = trendid_identifier_update_inputs(identifier, u, inputs, sample.y, &outcome);
        }
        if (!done(name, error) || !done(name, trendid_identifier_theta(identifier, theta, parameters))) {
            return false;
        }
        take_outcome(&hash, &outcome);
        hash_numbers(&hash, theta, parameters);
        if (k % EVERY == EVERY - 1 && !take_estimate(&hash, identifier)) {
            return false;
        }
    }
    if (!take_status(&hash, identifier) || !take_poles(&hash, identifier)) {
        return false;
    }
    hash_line(name, &hash);
    return true;
}

static bool run(const char *name, trendid_identifier *identifier, size_t parameters, size_t inputs)
{
    return run_with(name, identifier, parameters, inputs, false);
}

static bool run_bank(const trendid_settings *settings)
{
    if (!done("delay_bank", trendid_delay_bank_init(&bank, settings, NULL))) {
        return false;
    }
    struct hash hash = hash_new();
    for (uint32_t k = 0; k < RECORD_SAMPLES; k++) {
        const struct sample sample = record_sample(k);
        trendid_outcome outcome;
        if (!done("delay_bank", trendid_delay_bank_update(&bank, sample.u, sample.y, &outcome))) {
            return false;
        }
        take_outcome(&hash, &outcome);
    }
    uint32_t delay;
    float margin;
    float errors[TRENDID_DELAY_CANDIDATES];
    float refined;
    trendid_identifier *chosen;
    float theta[5];
    if (!done("best", trendid_delay_bank_best(&bank, &delay, &margin)) ||
        !done("refined", trendid_delay_bank_refined(&bank, &refined)) ||
        !done("errors", trendid_delay_bank_errors(&bank, errors, TRENDID_DELAY_CANDIDATES)) ||
        !done("chosen", trendid_delay_bank_chosen(&bank, &servo3, &chosen)) ||
        !done("theta", trendid_identifier_theta(chosen, theta, 5))) {
        return false;
    }
    hash_bits(&hash, delay);
    hash_number(&hash, margin);
    hash_number(&hash, refined);
    hash_numbers(&hash, errors, TRENDID_DELAY_CANDIDATES);
    hash_numbers(&hash, theta, 5);
    hash_line("delay-bank", &hash);
    return true;
}

/* What else may be known of a drive. */
static bool run_known(trendid_settings settings)
{
    trendid_identifier *identifier;
    /* A measured command, which acts between two samples, and a damping that is known. */
    settings.hold[0] = TRENDID_HOLD_FIRST;
    settings.delay[0] = 1.5f;
    settings.known = 1u << 1;
    settings.initial[1] = 20.0f;
    bool good = done("known", trendid_servo3_init(&servo3, &settings, &identifier, NULL)) &&
                run("known", identifier, 5, 1);
    if (!done("settings", trendid_settings_init(&settings, RECORD_SAMPLE_TIME, 20.0f, 1.0f, 50.0f))) {
        return false;
    }
    settings.memory = MEMORY;
    settings.follow_changes = 1;
    good = done("changes", trendid_servo3_init(&servo3, &settings, &identifier, NULL)) &&
           run("changes", identifier, 5, 1) && good;
    /* An axis that may stick, by the mean sign of its velocity. */
    settings.follow_changes = 0;
    settings.friction_input = 1;
    settings.hold[1] = TRENDID_HOLD_MEAN;
    good = done("friction", trendid_friction_init(&friction, REST, NULL)) &&
           done("sticks", trendid_coulomb3_init(&coulomb3, &settings, &identifier, NULL)) &&
           run_with("sticks", identifier, 6, 2, true) && good;
    return good;
}

/* With instruments beside the recursion. */
static bool run_instruments(const trendid_settings *settings)
{
    trendid_identifier *identifier;
    const bool good = done("instrumented2", trendid_instrumented2_init(&instrumented2, settings, &identifier, NULL)) &&
                      run("instrumented2", identifier, 4, 1);
    return done("instrumented3", trendid_instrumented3_init(&instrumented3, settings, &identifier, NULL)) &&
           run("instrumented3", identifier, 5, 1) && good;
}

/* Behind a valve whose dead zone is found. */
static bool run_valves(trendid_settings settings)
{
    trendid_identifier *identifier;
    settings.memory = MEMORY;
    settings.dead_zone_max = DEAD_ZONE_MAX;
    bool good = done("valve2", trendid_valve2_init(&valve2, &settings, &identifier, NULL)) &&
                run("valve2", identifier, 5, 1);
    good = done("valve3", trendid_valve3_init(&valve3, &settings, &identifier, NULL)) &&
           run("valve3", identifier, 6, 1) && good;
    good = done("valve_coulomb2", trendid_valve_coulomb2_init(&valve_coulomb2, &settings, &identifier, NULL)) &&
           run("valve-coulomb2", identifier, 6, 2) && good;
    return done("valve_coulomb3", trendid_valve_coulomb3_init(&valve_coulomb3, &settings, &identifier, NULL)) &&
           run("valve-coulomb3", identifier, 7, 2) && good;
}

bool identify_all(void)
{
    trendid_settings settings;
    trendid_identifier *identifier;
    /* 1 ms, about 20 rad/s, commands of 1, strokes of 50 mm. */
    if (!done("settings", trendid_settings_init(&settings, RECORD_SAMPLE_TIME, 20.0f, 1.0f, 50.0f))) {
        return false;
    }
    bool good = run_valves(settings);
    good = run_known(settings) && good;
    good = run_instruments(&settings) && good;
    settings.memory = MEMORY;
    good = done("servo2", trendid_servo2_init(&servo2, &settings, &identifier, NULL)) &&
           run("servo2", identifier, 4, 1) && good;
    good = done("coulomb2", trendid_coulomb2_init(&coulomb2, &settings, &identifier, NULL)) &&
           run("coulomb2", identifier, 5, 2) && good;
    good = done("coulomb3", trendid_coulomb3_init(&coulomb3, &settings, &identifier, NULL)) &&
           run("coulomb3", identifier, 6, 2) && good;

    settings.memory = 0.0f;
    good = done("servo3", trendid_servo3_init(&servo3, &settings, &identifier, NULL)) &&
           run("servo3", identifier, 5, 1) && good;
    settings.delay[0] = 2.0f;
    good = done("late", trendid_servo3_init(&servo3, &settings, &identifier, NULL)) &&
           run("late", identifier, 5, 1) && good;
    settings.delay[0] = 0.0f;
    good = run_bank(&settings) && good;

#if !defined(WITHOUT_ANY)
    /* Every a_i and b_i of order 3. */
    const trendid_structure full = {
        .order = 3, .inputs = 1, .output_terms = 0x7, .input_terms = {0x7, 0}, .constant = 0, .initial_state = 0};
    good = done("any", trendid_any_init(&any, &settings, &full, &identifier, NULL)) &&
           run("any-full3", identifier, 6, 1) && good;
#endif
    return good;
}
