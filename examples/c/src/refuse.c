/* What is refused, and that nothing breaks by it. */
#include <math.h>
#include <string.h>

#include "board.h"
#include "parts.h"

static trendid_servo3 memory;
static trendid_servo3 other;
static trendid_loop loop;

static bool expect(const char *what, trendid_error found, trendid_error wanted)
{
    if (found != wanted) {
        board_line(what);
        board_line(trendid_error_text(found));
    }
    return found == wanted;
}

static bool pointers(trendid_identifier *identifier)
{
    trendid_identifier *fresh = NULL;
    float theta[5];
    bool good = expect("NULL", trendid_identifier_update(NULL, 0.0f, 0.0f, NULL), TRENDID_ERROR_NULL);
    good = expect("NULL settings", trendid_servo3_init(&other, NULL, &fresh, NULL), TRENDID_ERROR_NULL) && good;
    good = expect("never initialised", trendid_identifier_theta((trendid_identifier *)(void *)&other, theta, 5),
                  TRENDID_ERROR_NOT_INITIALISED) && good;
    /* Through bytes: the address is wrong on purpose. */
    char *bytes = (char *)identifier + 1;
    good = expect("misaligned", trendid_identifier_theta((trendid_identifier *)(void *)bytes, theta, 5),
                  TRENDID_ERROR_MISALIGNED) && good;
    /* What is optional, too. */
    static union {
        trendid_outcome outcome;
        trendid_detail detail;
        char bytes[sizeof(trendid_detail) + 1];
    } place;
    void *odd = place.bytes + 1;
    good = expect("outcome", trendid_identifier_update(identifier, 0.0f, 1.0f, (trendid_outcome *)odd),
                  TRENDID_ERROR_MISALIGNED) && good;
    good = expect("detail", trendid_identifier_retune(identifier, 25.0f, (trendid_detail *)odd),
                  TRENDID_ERROR_MISALIGNED) && good;
    good = expect("detail of a loop", trendid_loop_init(&loop, NULL, (trendid_detail *)odd),
                  TRENDID_ERROR_MISALIGNED) && good;
    good = expect("handle", trendid_servo3_init(&other, NULL, (trendid_identifier **)odd, NULL),
                  TRENDID_ERROR_MISALIGNED) && good;
    good = expect("length", trendid_identifier_theta(identifier, theta, 4), TRENDID_ERROR_LENGTH) && good;
    good = expect("two inputs", trendid_identifier_update_inputs(identifier, theta, 2, 0.0f, NULL),
                  TRENDID_ERROR_LENGTH) && good;
    good = expect("loop", trendid_loop_commission(&loop), TRENDID_ERROR_NOT_INITIALISED) && good;
    return good;
}

static bool values(trendid_identifier *identifier)
{
    trendid_outcome outcome;
    bool good = expect("NaN", trendid_identifier_update(identifier, 0.1f, NAN, &outcome), TRENDID_ERROR_OK);
    good = outcome.kind == TRENDID_SAMPLE_KIND_OUTPUT_REFUSED && good;
    good = expect("infinity", trendid_identifier_update(identifier, INFINITY, 0.0f, &outcome), TRENDID_ERROR_OK) && good;
    good = outcome.kind == TRENDID_SAMPLE_KIND_INPUT_REFUSED && good;

    trendid_settings settings;
    trendid_detail detail;
    good = done("settings", trendid_settings_init(&settings, 0.001f, 20.0f, 1.0f, 50.0f)) && good;
    settings.bandwidth = 5000.0f;
    good = expect("bandwidth", trendid_servo3_init(&other, &settings, NULL, &detail), TRENDID_ERROR_OUT_OF_RANGE) && good;
    good = strcmp(detail.setting, "bandwidth") == 0 && detail.error == TRENDID_ERROR_OUT_OF_RANGE && good;
    settings.bandwidth = 20.0f;
    settings.delay[0] = TRENDID_DELAY_MAX + 0.5f;
    good = expect("delay", trendid_servo3_init(&other, &settings, NULL, &detail), TRENDID_ERROR_OUT_OF_RANGE) && good;
    good = strcmp(detail.setting, "delay") == 0 && detail.index == 0 && good;
    /* A refusal leaves no object: nothing where there was none, and not the one that was there. */
    const trendid_servo3 untouched = {{0}};
    good = memcmp(&other, &untouched, sizeof other) == 0 && good;
    trendid_identifier *replaced = NULL;
    settings.delay[0] = 0.0f;
    good = expect("init", trendid_servo3_init(&other, &settings, &replaced, NULL), TRENDID_ERROR_OK) && good;
    settings.delay[0] = TRENDID_DELAY_MAX + 0.5f;
    good = expect("again", trendid_servo3_init(&other, &settings, NULL, NULL), TRENDID_ERROR_OUT_OF_RANGE) && good;
    return expect("no object", trendid_identifier_update(replaced, 0.0f, 0.0f, NULL),
                  TRENDID_ERROR_NOT_INITIALISED) && good;
}

static bool records(void)
{
    trendid_loop_settings settings;
    uint8_t record[TRENDID_RECORD_BYTES];
    bool good = done("settings", trendid_loop_settings_init(&settings, 0.001f, 0.0f, 400.0f, 0.005f, 0));
    good = done("init", trendid_loop_init(&loop, &settings, NULL)) && good;
    good = expect("no model", trendid_loop_store(&loop, 1, 0, record, sizeof record), TRENDID_ERROR_NOT_YET) && good;
    const trendid_model model = {.a1 = 400.0f, .a2 = 20.0f, .b0 = 1e6f, .dead_zone = 0.03f};
    good = done("install", trendid_loop_install(&loop, &model, NULL)) && good;
    good = done("store", trendid_loop_store(&loop, 1, 0, record, sizeof record)) && good;
    good = expect("other machine", trendid_loop_load(&loop, 2, record, sizeof record, NULL, NULL),
                  TRENDID_ERROR_RECORD_PLANT) && good;
    record[30] ^= 4u;
    good = expect("one bit", trendid_loop_load(&loop, 1, record, sizeof record, NULL, NULL),
                  TRENDID_ERROR_RECORD_DAMAGED) && good;
    memset(record, 0xFF, sizeof record);
    good = expect("erased", trendid_loop_load(&loop, 1, record, sizeof record, NULL, NULL),
                  TRENDID_ERROR_RECORD_EMPTY) && good;
    const trendid_model unstable = {.a1 = -400.0f, .a2 = 20.0f, .b0 = 1e6f};
    trendid_detail detail;
    good = expect("unstable", trendid_loop_install(&loop, &unstable, &detail), TRENDID_ERROR_MODEL_REFUSED) && good;
    return detail.reason != TRENDID_REASON_NONE && good;
}

bool refuse_all(void)
{
    trendid_settings settings;
    trendid_identifier *identifier;
    if (!done("settings", trendid_settings_init(&settings, 0.001f, 20.0f, 1.0f, 50.0f)) ||
        !done("init", trendid_servo3_init(&memory, &settings, &identifier, NULL))) {
        return false;
    }
    bool good = pointers(identifier);
    good = values(identifier) && good;
    good = records() && good;
    board_line(good ? "refusals ok" : "refusals FAILED");
    return good;
}
