// The identifier and the loop by the C++ wrapper: the lines `servo3` and `loop` of the example in C must come out again.
#include "trendid.hpp"

#include "board.h"
#include "drive.h"
#include "hash.h"
#include "record.h"

namespace {

trendid::servo3 servo;
trendid::loop axis;

void take(hash &all, const trendid_outcome &outcome)
{
    hash_bits(&all, outcome.kind);
    hash_bits(&all, outcome.remaining);
    hash_number(&all, outcome.innovation);
}

bool identify()
{
    const auto settings = trendid::defaults(RECORD_SAMPLE_TIME, 20.0f, 1.0f, 50.0f);
    trendid_detail why;
    if (servo.init(settings, &why) != TRENDID_ERROR_OK) {
        board_line(why.setting);
        return false;
    }
    hash all = hash_new();
    for (std::uint32_t k = 0; k < RECORD_SAMPLES; k++) {
        const sample now = record_sample(k);
        const auto outcome = servo.update(now.u, now.y);
        const auto theta = servo.theta();
        if (!outcome || !theta) {
            return false;
        }
        take(all, outcome.value);
        hash_numbers(&all, theta.value.data(), theta.value.size());
        if (k % 10 == 9) {
            const auto found = servo.estimate();
            hash_numbers(&all, found.value.std, found.value.parameters);
            hash_number(&all, found.value.gain);
            hash_number(&all, found.value.omega0);
            hash_number(&all, found.value.damping);
            hash_number(&all, found.value.omega0_std);
        }
    }
    const auto status = servo.status();
    hash_number(&all, status.value.prediction);
    hash_number(&all, status.value.noise_std);
    hash_number(&all, status.value.ise);
    hash_number(&all, status.value.iae);
    hash_bits(&all, status.value.samples);
    hash_bits(&all, status.value.replaced);
    hash_bits(&all, status.value.changes);
    hash_number(&all, status.value.dead_zone);
    hash_bits(&all, status.value.way);
    hash_number(&all, status.value.blocks);
    for (const trendid_pole &pole : servo.poles().value) {
        hash_number(&all, pole.re);
        hash_number(&all, pole.im);
    }
    hash_line("servo3", &all);
    // A copy is an identifier of its own.
    const trendid::servo3 copy = servo;
    const bool reset = servo.reset() == TRENDID_ERROR_OK;
    return reset && copy.theta().value[0] != servo.theta().value[0];
}

bool control()
{
    auto settings = trendid::defaults(0.001f, 0.0f, 400.0f, DRIVE_MM_PER_COUNT, DRIVE_ORIGIN);
    settings.bandwidth = 20.0f;
    if (axis.init(settings) != TRENDID_ERROR_OK || axis.commission() != TRENDID_ERROR_OK) {
        return false;
    }
    drive machine = drive_new();
    hash all = hash_new();
    float command = 0.0f;
    for (std::uint32_t k = 0; k < 12000; k++) {
        const std::int32_t code = drive_move(&machine, command);
        const auto report = k % 997 == 996 ? axis.update_blind() : axis.update(code);
        if (!report) {
            return false;
        }
        command = report.value.command;
        trendid::error asked = TRENDID_ERROR_OK;
        if (k == 5000) {
            asked = axis.move_to(300.0f);
        } else if (k == 7000) {
            asked = axis.move_to(150.0f);
        } else if (k == 9000) {
            asked = axis.oscillate(20.0f, 0.5f);
        }
        if (asked != TRENDID_ERROR_OK) {
            board_line(trendid::text(asked));
            return false;
        }
        hash_bits(&all, report.value.state);
        hash_bits(&all, report.value.reason);
        hash_bits(&all, report.value.retuned);
        hash_number(&all, report.value.command);
        hash_number(&all, report.value.position);
        hash_number(&all, report.value.reference);
        hash_number(&all, report.value.innovation);
    }
    hash_line("loop", &all);
    const auto quality = axis.quality();
    return axis.model() && quality && quality.value.has_margins && quality.value.accepted > 0;
}

}  // namespace

int main()
{
    return identify() && control() ? 0 : 1;
}
