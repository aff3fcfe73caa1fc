/* The position loop on the simulated drive: commissioning, moves, a sine, a record of the model, and control from it. */
#include "board.h"
#include "drive.h"
#include "hash.h"
#include "parts.h"

enum { SAMPLES = 12000, PLANT = 4711 };

static trendid_loop loop;
static trendid_loop again;

static void take(struct hash *hash, const trendid_report *report)
{
    hash_bits(hash, report->state);
    hash_bits(hash, report->reason);
    hash_bits(hash, report->retuned);
    hash_number(hash, report->command);
    hash_number(hash, report->position);
    hash_number(hash, report->reference);
    hash_number(hash, report->innovation);
}

static bool is_controlling(const trendid_report *report)
{
    return report->state >= TRENDID_LOOP_STATE_VERIFIED && report->state <= TRENDID_LOOP_STATE_REJECTED;
}

/* What a person asks of the axis at sample k. */
static bool request(uint32_t k)
{
    switch (k) {
    case 5000:
        return done("move_to", trendid_loop_move_to(&loop, 300.0f, NULL));
    case 7000:
        return done("move_to", trendid_loop_move_to(&loop, 150.0f, NULL));
    case 9000:
        return done("oscillate", trendid_loop_oscillate(&loop, 20.0f, 0.5f, NULL));
    default:
        return true;
    }
}

/* Control of a second loop from the record of the first. */
static bool resume(struct drive *drive, const trendid_loop_settings *settings, const uint8_t *record)
{
    struct hash hash = hash_new();
    uint32_t sequence = 0;
    if (!done("init", trendid_loop_init(&again, settings, NULL)) ||
        !done("load", trendid_loop_load(&again, PLANT, record, TRENDID_RECORD_BYTES, &sequence, NULL)) || sequence != 9u) {
        return false;
    }
    trendid_report report = {0};
    for (uint32_t k = 0; k < 2000; k++) {
        const int32_t code = drive_move(drive, report.command);
        if (!done("update", trendid_loop_update(&again, code, &report))) {
            return false;
        }
        take(&hash, &report);
    }
    hash_line("resumed", &hash);
    return is_controlling(&report);
}

bool control_all(void)
{
    trendid_loop_settings settings;
    if (!done("settings", trendid_loop_settings_init(&settings, 0.001f, 0.0f, 400.0f, DRIVE_MM_PER_COUNT, DRIVE_ORIGIN))) {
        return false;
    }
    settings.bandwidth = 20.0f;
    if (!done("init", trendid_loop_init(&loop, &settings, NULL)) || !done("commission", trendid_loop_commission(&loop))) {
        return false;
    }
    struct drive drive = drive_new();
    struct hash hash = hash_new();
    trendid_report report = {0};
    for (uint32_t k = 0; k < SAMPLES; k++) {
        const int32_t code = drive_move(&drive, report.command);
        /* Every 997th reading fails. */
        const trendid_error error =
            k % 997u == 996u ? trendid_loop_update_blind(&loop, &report) : trendid_loop_update(&loop, code, &report);
        if (!done("update", error) || !request(k)) {
            return false;
        }
        take(&hash, &report);
    }
    hash_line("loop", &hash);
    if (!is_controlling(&report)) {
        board_line(trendid_reason_text(report.reason));
        return false;
    }

    uint8_t record[TRENDID_RECORD_BYTES];
    if (!done("store", trendid_loop_store(&loop, PLANT, 9, record, sizeof record))) {
        return false;
    }
    struct hash stored = hash_new();
    for (size_t i = 0; i < sizeof record; i++) {
        hash_bits(&stored, record[i]);
    }
    hash_line("record", &stored);
    return resume(&drive, &settings, record);
}
