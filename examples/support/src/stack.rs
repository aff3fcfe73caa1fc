//! Peak stack of a call: the free stack is painted before and looked at after.

/// Bytes that are painted; a call that needs more is reported with this number.
pub const PAINTED: usize = 16 * 1024;

const PAINT: u32 = 0xA5C3_96E1;

/// Stack in bytes that `work` takes below the frame of its caller, at most [`PAINTED`].
///
/// No interrupt may run meanwhile, or its frame is counted too.
#[inline(never)]
pub fn peak<R>(work: impl FnOnce() -> R) -> usize {
    peak_within(PAINTED, work)
}

/// As [`peak`], with another number of bytes painted, which the stack must have left.
#[inline(never)]
pub fn peak_within<R>(painted: usize, work: impl FnOnce() -> R) -> usize {
    let words = painted / 4;
    // The painted part begins below everything this function and the paint loop need themselves.
    let top = cortex_m::register::msp::read() as *mut u32;
    for depth in 1..=words {
        // SAFETY: memory below the stack pointer is free, and the loop calls nothing.
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
