//! Where the frames of defmt go: over RTT on a board, over semihosting in the emulator, from the same image.
//!
//! A frame goes out with interrupts off, which on a board takes the time of a copy; in the emulator no time passes
//! meanwhile. Nobody waits for the reader: a frame that finds no room is dropped whole, whatever mode the debugger asks for.
//! The image of `examples/rtic` has this file too.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use cortex_m::{interrupt, register::primask};
use cortex_m_semihosting::hio;
use trendid_example_support::ring::{self, Ring};

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
            *FRAME.place.get() = RING.begin(&RTT.write);
            (*FRAME.encoder.get()).start_frame(put);
        }
    }

    unsafe fn flush() {}

    unsafe fn release() {
        // SAFETY: interrupts are off since acquire; they were on before unless masked says otherwise.
        unsafe {
            (*FRAME.encoder.get()).end_frame(put);
            RING.end(*FRAME.place.get(), &RTT.write);
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
        .for_each(|&byte| RING.put(place, byte, &RTT.read));
}

/// Frames that found no room.
#[allow(dead_code, reason = "not every image of this file asks")]
pub(crate) fn lost() -> u32 {
    RING.lost()
}

const SIZE: usize = 1024;

/// Control block of SEGGER's real-time transfer with one channel up; the debugger finds it by its symbol and its first
/// bytes and reads the ring behind the back of the processor.
#[repr(C)]
struct Rtt {
    id: [u8; 16],
    channels_up: u32,
    channels_down: u32,
    name: Pointer,
    ring: Pointer,
    size: u32,
    write: AtomicU32,
    read: AtomicU32,
    /// How the debugger wants a full ring to be met; it is left as it is, without waiting.
    mode: AtomicU32,
}

/// An address in a static.
#[repr(transparent)]
struct Pointer(*const u8);

// SAFETY: the addresses are constant, and what they point to is read by the debugger only.
unsafe impl Sync for Pointer {}

static RING: Ring<SIZE> = Ring::new();

// SAFETY: the name that debuggers look for; nothing else has it.
#[unsafe(export_name = "_SEGGER_RTT")]
static RTT: Rtt = Rtt {
    id: *b"SEGGER RTT\0\0\0\0\0\0",
    channels_up: 1,
    channels_down: 0,
    // The name tells probe-rs that the bytes are frames of defmt.
    name: Pointer(c"defmt".as_ptr().cast()),
    ring: Pointer(RING.as_ptr()),
    size: SIZE as u32,
    write: AtomicU32::new(0),
    read: AtomicU32::new(0),
    mode: AtomicU32::new(0),
};
