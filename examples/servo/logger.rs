//! Where the frames of defmt go: over RTT on a board, over semihosting in the emulator, from the same image.
//!
//! A frame goes out with interrupts off, which on a board takes the time of a copy; in the emulator no time passes
//! meanwhile. Nobody waits for the reader: a frame that finds no room is dropped whole, whatever mode the debugger asks for.
//! The image of `examples/rtic` has this file too. The ring and its channel are those of the image (`debugger.rs`).

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::{interrupt, register::primask};
use cortex_m_semihosting::hio;
use trendid_example_support::ring;

use crate::debugger::{LOG, RTT};

/// The choice.
static SEMIHOSTING: AtomicBool = AtomicBool::new(false);

/// Chooses semihosting for all frames from now on.
pub(crate) fn over_semihosting() {
    SEMIHOSTING.store(true, Ordering::Relaxed);
}

/// Whether the frames go over semihosting.
#[allow(dead_code, reason = "not every image of this file asks")]
pub(crate) fn is_over_semihosting() -> bool {
    SEMIHOSTING.load(Ordering::Relaxed)
}

#[defmt::global_logger]
struct Logger;

/// What belongs to the frame that is being written.
struct Frame {
    encoder: UnsafeCell<defmt::Encoder>,
    masked: UnsafeCell<bool>,
    place: UnsafeCell<ring::Frame>,
}

// SAFETY: used between acquire and release only, with interrupts off, on a single core.
unsafe impl Sync for Frame {}

static FRAME: Frame = Frame {
    encoder: UnsafeCell::new(defmt::Encoder::new()),
    masked: UnsafeCell::new(false),
    place: UnsafeCell::new(ring::Frame::NONE),
};

// SAFETY: acquire turns interrupts off and release restores them, so frames exclude each other.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        let masked = primask::read().is_inactive();
        interrupt::disable();
        // SAFETY: interrupts are off.
        unsafe {
            *FRAME.masked.get() = masked;
            *FRAME.place.get() = LOG.begin(&RTT.up[0].written);
            (*FRAME.encoder.get()).start_frame(put);
        }
    }

    unsafe fn flush() {}

    unsafe fn release() {
        // SAFETY: interrupts are off since acquire; they were on before unless masked says otherwise.
        unsafe {
            (*FRAME.encoder.get()).end_frame(put);
            LOG.end(*FRAME.place.get(), &RTT.up[0].written);
            if !*FRAME.masked.get() {
                interrupt::enable();
            }
        }
    }

    unsafe fn write(bytes: &[u8]) {
        // SAFETY: interrupts are off since acquire.
        unsafe { (*FRAME.encoder.get()).write(bytes, put) };
    }
}

/// Sends encoded bytes.
fn put(bytes: &[u8]) {
    if SEMIHOSTING.load(Ordering::Relaxed) {
        if let Ok(mut out) = hio::hstdout() {
            // Without a debugger there is no receiver.
            let _ = out.write_all(bytes);
        }
        return;
    }
    // SAFETY: interrupts are off since acquire.
    let place = unsafe { &mut *FRAME.place.get() };
    bytes
        .iter()
        .for_each(|&byte| LOG.put(place, byte, &RTT.up[0].read));
}

/// Frames that found no room.
#[allow(dead_code, reason = "not every image of this file asks")]
pub(crate) fn lost() -> u32 {
    LOG.lost()
}
