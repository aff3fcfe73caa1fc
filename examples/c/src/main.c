/*
 * Identification and control by trendid, every number into a hash. `cargo xtask capi` compares the lines with those of the
 * same runs in Rust: host and target, C and Rust must agree to the last bit.
 */
#include "board.h"
#include "parts.h"

bool done(const char *call, trendid_error error)
{
    if (error == TRENDID_ERROR_OK) {
        return true;
    }
    board_line(call);
    board_line(trendid_error_text(error));
    return false;
}

/* Header and library must be of one version. */
static bool matches(void)
{
    return trendid_abi_version() == TRENDID_ABI_VERSION &&
           trendid_object_size(TRENDID_OBJECT_KIND_SERVO3) == sizeof(trendid_servo3) &&
           trendid_object_size(TRENDID_OBJECT_KIND_LOOP) == sizeof(trendid_loop) &&
           trendid_object_used(TRENDID_OBJECT_KIND_LOOP) <= sizeof(trendid_loop);
}

int main(void)
{
    if (!matches()) {
        board_line("header and library differ");
        return 1;
    }
    /* No short circuit: every part shows what it does. */
    const bool identified = identify_all();
    const bool controlled = control_all();
    const bool refused = refuse_all();
    return identified && controlled && refused ? 0 : 1;
}
