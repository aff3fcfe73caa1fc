//! The log of this image, in frames of defmt.

use trendid_example_support::frames::Frames;

use crate::debugger::{LOG, RTT};

/// Its frames.
pub(crate) static FRAMES: Frames<1024> = Frames::new(&LOG, &RTT.up[0]);

#[defmt::global_logger]
struct Logger;

// SAFETY: acquire turns interrupts off and release restores them, so frames exclude each other.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        FRAMES.acquire();
    }

    unsafe fn flush() {}

    unsafe fn release() {
        // SAFETY: defmt calls it once behind acquire.
        unsafe { FRAMES.release() };
    }

    unsafe fn write(bytes: &[u8]) {
        // SAFETY: defmt calls it between acquire and release.
        unsafe { FRAMES.write(bytes) };
    }
}
