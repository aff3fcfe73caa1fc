//! Telemetry of the firmware over RTT: requests and answers through the memory of the emulator.

use crate::process::{self, Done, M4F, cargo};
use crate::setup;

/// Builds the image and the monitor, and runs the tests that need both.
pub(crate) fn run() -> Done {
    setup::run()?;
    let image = M4F.build("servo", "firmware")?;
    let mut command = cargo(&["test", "-q", "-p", "trendid-monitor", "source::tests::rtt"]);
    // One emulator after another: they run in real time.
    command
        .args(["--", "--ignored", "--nocapture", "--test-threads", "1"])
        .env("IMAGE", image);
    process::run(command)
}
