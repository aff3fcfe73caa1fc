//! The control block of SEGGER's real-time transfer: a debugger finds it in memory by its first
//! bytes, and reads and writes its rings behind the back of the processor.
//!
//! The layout is that of SEGGER's `SEGGER_RTT_CB` (J-Link manual UM08001, chapter RTT). The crate
//! rtt-target has it too, but waits for the reader in the mode that a debugger writes into the
//! block, and probe-rs writes that one; here the mode is left as it is, and nobody waits.

use core::ffi::CStr;
use core::ptr::null;
use core::sync::atomic::AtomicU32;

use crate::ring::Ring;

/// A control block with `UP` channels to the debugger and `DOWN` from it; a `static` of the name
/// `_SEGGER_RTT`.
///
/// It must be `#[used]`: what only a debugger writes is a constant to the compiler otherwise.
#[repr(C)]
#[derive(Debug)]
pub struct Block<const UP: usize, const DOWN: usize> {
    id: [u8; 16],
    channels_up: u32,
    channels_down: u32,
    /// To the debugger.
    pub up: [Channel; UP],
    /// From the debugger.
    pub down: [Channel; DOWN],
}

impl<const UP: usize, const DOWN: usize> Block<UP, DOWN> {
    /// The block of these channels.
    #[must_use]
    pub const fn new(up: [Channel; UP], down: [Channel; DOWN]) -> Self {
        const { assert!(UP <= 16 && DOWN <= 16) };
        Self {
            id: *b"SEGGER RTT\0\0\0\0\0\0",
            channels_up: UP as u32,
            channels_down: DOWN as u32,
            up,
            down,
        }
    }
}

/// A ring and how far its two ends are.
#[repr(C)]
#[derive(Debug)]
pub struct Channel {
    name: Pointer,
    bytes: Pointer,
    size: u32,
    /// Place behind the last byte that was written.
    pub written: AtomicU32,
    /// Place of the next byte to be read.
    pub read: AtomicU32,
    /// How the debugger wants a full ring to be met.
    mode: AtomicU32,
}

impl Channel {
    /// The channel over a ring. Debuggers take `defmt` for frames of defmt.
    #[must_use]
    pub const fn new<const N: usize>(name: &'static CStr, ring: &'static Ring<N>) -> Self {
        Self {
            name: Pointer(name.as_ptr().cast()),
            bytes: Pointer(ring.as_ptr()),
            size: N as u32,
            written: AtomicU32::new(0),
            read: AtomicU32::new(0),
            mode: AtomicU32::new(0),
        }
    }

    /// A number that is not used.
    #[must_use]
    pub const fn absent() -> Self {
        Self {
            name: Pointer(null()),
            bytes: Pointer(null()),
            size: 0,
            written: AtomicU32::new(0),
            read: AtomicU32::new(0),
            mode: AtomicU32::new(0),
        }
    }
}

/// An address in a static.
#[repr(transparent)]
#[derive(Debug)]
struct Pointer(*const u8);

// SAFETY: the addresses are constant, and only the debugger follows them.
unsafe impl Sync for Pointer {}

#[cfg(target_pointer_width = "32")]
const _: () = assert!(size_of::<Channel>() == 24 && size_of::<Block<2, 2>>() == 24 + 4 * 24);
