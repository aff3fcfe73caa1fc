//! The entry on a target: clocks, table, and whether the counters agree.

use cortex_m_rt::{ExceptionFrame, entry, exception};

use trendid_example_support::board::{exit, line};
use trendid_example_support::clock::{Clock, Unit};

use crate::all;
use crate::meter::Counter;

// For memory.x.
core::arch::global_asm!(".global __trendid_deep_stack", "__trendid_deep_stack = 1");

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    line(format_args!("{info}"));
    exit(false)
}

// SAFETY: it does not return. A fault ends the run at once: without a handler the image stands
// still until the task gives up.
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    line(format_args!("hard fault at {:#x}", frame.pc()));
    exit(false)
}

#[entry]
fn main() -> ! {
    let Some(mut core) = cortex_m::Peripherals::take() else {
        exit(false)
    };
    let clocks = Clock::start(&mut core);
    for clock in clocks {
        line(format_args!("# {clock}"));
    }
    if clocks[0].unit == Unit::Cycles {
        line(format_args!(
            "# a board: processor cycles, not instructions"
        ));
    }
    let mut counter = Counter::new(clocks);
    if let Err(error) = all(&mut counter) {
        if cfg!(target_has_atomic = "32") {
            line(format_args!("{error}"));
        } else {
            line(format_args!("a row is refused; larger machines say why")); // no room for its numbers
        }
        exit(false);
    }
    if counter.systick_off {
        line(format_args!("# SysTick and {} disagree", clocks[0].name));
    }
    exit(!counter.systick_off)
}
