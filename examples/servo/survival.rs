//! Where the pure code of the record meets the chip: memory that the start does not clear, and the
//! handlers of the last resort.

use core::arch::global_asm;
use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use cortex_m::interrupt::free;
use cortex_m::peripheral::SCB;
use cortex_m_rt::exception;
use trendid_example_support::reset::Causes;
use trendid_example_support::survivor::{Fault, Survivor, Text, WORDS};

use crate::wiring;

/// Memory that survives a reset, but no loss of power.
#[repr(transparent)]
struct Memory(UnsafeCell<MaybeUninit<[u32; WORDS]>>);

// SAFETY: accessed with interrupts off only, or by handlers that do not return.
unsafe impl Sync for Memory {}

// SAFETY: cortex-m-rt neither clears nor fills this section, and nothing else is placed by its
// name.
#[unsafe(link_section = ".uninit.survivor")]
static MEMORY: Memory = Memory(UnsafeCell::new(MaybeUninit::uninit()));

/// The words of the memory.
fn read() -> [u32; WORDS] {
    free(|_| {
        // SAFETY: interrupts are off; memory that came up by chance is a number too, and the check
        // tells it from a record.
        unsafe { MEMORY.0.get().cast::<[u32; WORDS]>().read_volatile() }
    })
}

fn write(survivor: &Survivor) {
    let words = survivor.words();
    free(|_| {
        // SAFETY: interrupts are off, so that nobody else reads or writes.
        unsafe { MEMORY.0.get().cast::<[u32; WORDS]>().write_volatile(words) };
    });
}

/// The record at the start.
pub(crate) fn begin(causes: Causes) -> Survivor {
    let survivor = Survivor::at_start(&read(), causes);
    write(&survivor);
    survivor
}

/// The record; an empty one where the memory holds none.
pub(crate) fn load() -> Survivor {
    Survivor::from_words(&read()).unwrap_or_default()
}

/// Changes the record.
pub(crate) fn update(change: impl FnOnce(&mut Survivor)) {
    let mut survivor = load();
    change(&mut survivor);
    write(&survivor);
}

/// Restarts the chip.
pub(crate) fn restart() -> ! {
    wiring::centre();
    SCB::sys_reset()
}

/// The last thing a run does: the valve first, then the record, then a restart that reports it.
fn end(fault: Fault) -> ! {
    cortex_m::interrupt::disable();
    wiring::centre();
    update(|survivor| survivor.latch(fault));
    SCB::sys_reset()
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    let (line, file) = info
        .location()
        .map_or((0, ""), |place| (place.line(), place.file()));
    end(Fault::Panic {
        line,
        file: Text::end_of(file),
    })
}

// The entry of the hard fault. The stack may be what failed, so it begins anew before anything is
// pushed; what it held is needed no more, but for the two addresses that the processor has pushed,
// if it could. They are read where the whole frame of 32 bytes lies in the stack only: a fault in
// here would stop the processor for good.
global_asm!(
    ".section .HardFault.user,\"ax\",%progbits",
    ".global HardFault",
    ".type HardFault,%function",
    ".thumb_func",
    "HardFault:",
    "mrs r2, msp",
    "ldr r3, =_stack_start",
    "movs r0, #0",
    "movs r1, #0",
    "ldr r4, =_stack_end",
    "cmp r2, r4",
    "blo 1f",
    "subs r5, r3, #32",
    "cmp r2, r5",
    "bhi 1f",
    "ldr r0, [r2, #24]", // program counter
    "ldr r1, [r2, #20]", // return address
    "1:",
    "msr msp, r3",
    "b {handler}",
    handler = sym hard_fault,
);

/// Ends the run; `sp` is where the stack pointer was, the addresses are zero where it had left the
/// stack at either end.
unsafe extern "C" fn hard_fault(pc: u32, lr: u32, sp: u32) -> ! {
    unsafe extern "C" {
        static _stack_end: u8;
    }
    // A symbol of the linker, of which only the address is taken.
    let floor = &raw const _stack_end as u32;
    end(if sp < floor {
        Fault::StackOverflow { sp }
    } else {
        Fault::HardFault { pc, lr }
    })
}

// SAFETY: the handler does not return, so what it interrupted never sees what it changed.
#[exception]
unsafe fn DefaultHandler(number: i16) -> ! {
    end(Fault::Exception {
        number: number.into(),
    })
}
