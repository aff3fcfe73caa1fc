//! Faults that are provoked on purpose.

use core::arch::asm;
use core::hint::black_box;

/// Reads where no memory is.
pub(super) fn read_nothing() {
    // SAFETY: none; the fault is the purpose.
    black_box(unsafe { (0x6000_0000 as *const u32).read_volatile() });
}

/// Ends the stack.
pub(super) fn overflow() {
    black_box(endless(0));
}

/// Calls itself until the stack ends.
#[inline(never)]
#[allow(unconditional_recursion, reason = "the overflow is the purpose")]
fn endless(depth: u32) -> u32 {
    let frame = black_box([depth; 16]);
    endless(depth.wrapping_add(1)).wrapping_add(frame[depth as usize % 16])
}

/// Pushes above the RAM, where no memory is either, as after a pointer to the stack that was
/// overwritten.
pub(super) fn lose_stack() -> ! {
    // SAFETY: none; the fault is the purpose.
    unsafe {
        asm!(
            "msr msp, {place}",
            "push {{r0}}",
            "udf #0",
            place = in(reg) 0x3000_0000_u32,
            options(noreturn)
        )
    }
}
