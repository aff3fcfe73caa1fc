//! Where the frames of defmt go: over RTT on a board, over semihosting in the emulator, from the
//! same image.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, Ordering};

use cortex_m::{interrupt, register::primask};
use cortex_m_semihosting::hio;

use crate::ring::{Frame, Ring};
use crate::rtt::Channel;

/// The frames of a log; what the `global_logger` of an image calls.
///
/// A frame goes out with interrupts off, which on a board takes the time of a copy; in the emulator
/// no time passes meanwhile. Nobody waits for the reader: a frame that finds no room is dropped
/// whole, whatever mode the debugger asks for.
pub struct Frames<const N: usize> {
    ring: &'static Ring<N>,
    channel: &'static Channel,
    over_semihosting: AtomicBool,
    /// Of the frame that is being written.
    encoder: UnsafeCell<defmt::Encoder>,
    masked: UnsafeCell<bool>,
    place: UnsafeCell<Frame>,
}

// SAFETY: the cells are used between acquire and release only, with interrupts off, on a single
// core.
unsafe impl<const N: usize> Sync for Frames<N> {}

impl<const N: usize> core::fmt::Debug for Frames<N> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Frames")
            .field("channel", &self.channel)
            .finish_non_exhaustive()
    }
}

impl<const N: usize> Frames<N> {
    /// Frames through a ring that the debugger knows as this channel.
    #[must_use]
    pub const fn new(ring: &'static Ring<N>, channel: &'static Channel) -> Self {
        Self {
            ring,
            channel,
            over_semihosting: AtomicBool::new(false),
            encoder: UnsafeCell::new(defmt::Encoder::new()),
            masked: UnsafeCell::new(false),
            place: UnsafeCell::new(Frame::NONE),
        }
    }

    /// Chooses semihosting for all frames from now on.
    pub fn go_over_semihosting(&self) {
        self.over_semihosting.store(true, Ordering::Relaxed);
    }

    /// Whether the frames go over semihosting.
    pub fn are_over_semihosting(&self) -> bool {
        self.over_semihosting.load(Ordering::Relaxed)
    }

    /// Frames that found no room.
    pub fn lost(&self) -> u32 {
        self.ring.lost()
    }

    /// Begins a frame, with interrupts off from now on.
    pub fn acquire(&self) {
        let masked = primask::read().is_inactive();
        interrupt::disable();
        // SAFETY: interrupts are off.
        unsafe {
            *self.masked.get() = masked;
            *self.place.get() = self.ring.begin(&self.channel.written);
            (*self.encoder.get()).start_frame(|bytes| self.put(bytes));
        }
    }

    /// Ends the frame.
    ///
    /// # Safety
    /// [`acquire`](Self::acquire) was called before, and this once behind it.
    pub unsafe fn release(&self) {
        // SAFETY: interrupts are off since acquire; they were on before unless `masked` says
        // otherwise.
        unsafe {
            (*self.encoder.get()).end_frame(|bytes| self.put(bytes));
            self.ring.end(*self.place.get(), &self.channel.written);
            if !*self.masked.get() {
                interrupt::enable();
            }
        }
    }

    /// Takes bytes of the frame.
    ///
    /// # Safety
    /// Called between [`acquire`](Self::acquire) and [`release`](Self::release).
    pub unsafe fn write(&self, bytes: &[u8]) {
        // SAFETY: interrupts are off since acquire.
        unsafe { (*self.encoder.get()).write(bytes, |bytes| self.put(bytes)) };
    }

    /// Sends encoded bytes.
    fn put(&self, bytes: &[u8]) {
        if self.are_over_semihosting() {
            if let Ok(mut out) = hio::hstdout() {
                // Without a debugger there is no receiver.
                let _ = out.write_all(bytes);
            }
            return;
        }
        // SAFETY: interrupts are off since acquire.
        let place = unsafe { &mut *self.place.get() };
        bytes
            .iter()
            .for_each(|&byte| self.ring.put(place, byte, &self.channel.read));
    }
}
