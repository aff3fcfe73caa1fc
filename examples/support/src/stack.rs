//! Peak stack of a call: the free stack is painted before and looked at after.

/// Bytes that are painted, where the stack has as many left; a call that needs more is reported
/// with this number.
pub const PAINTED: usize = 16 * 1024;

const PAINT: u32 = 0xA5C3_96E1;

/// Stack in bytes that `work` takes below the frame of its caller, at most [`PAINTED`].
///
/// No interrupt may run meanwhile, or its frame is counted too.
#[inline(never)]
pub fn peak<R>(work: impl FnOnce() -> R) -> usize {
    peak_within(PAINTED, work)
}

/// As [`peak`], with another number of bytes painted at most.
#[inline(never)]
pub fn peak_within<R>(painted: usize, work: impl FnOnce() -> R) -> usize {
    unsafe extern "C" {
        /// The end of the stack (memory.x): below it a small machine has no memory.
        static _stack_end: u8;
    }
    // The painted part begins below everything this function and the paint loop need themselves.
    let top = cortex_m::register::msp::read() as *mut u32;
    let left = (top as usize).saturating_sub(&raw const _stack_end as usize);
    let words = painted.min(left) / 4;
    for depth in 1..=words {
        // SAFETY: memory between the end of the stack and its pointer is free, and the loop calls
        // nothing.
        unsafe { top.sub(depth).write_volatile(PAINT) };
    }
    let _ = core::hint::black_box(outlined(work));
    let untouched = (1..=words)
        .rev()
        // SAFETY: as above; only reads what was painted.
        .take_while(|&depth| unsafe { top.sub(depth).read_volatile() } == PAINT)
        .count();
    (words - untouched) * 4
}

/// The call in a frame of its own: inlined, its variables would lie above what was painted.
#[inline(never)]
fn outlined<R>(work: impl FnOnce() -> R) -> R {
    work()
}
