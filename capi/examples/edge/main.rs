//! What the C edge costs: instructions of a call in Rust and through the C interface, in one image,
//! on one record.
//!
//! `cargo xtask capi --edge` runs it in the emulator. The image writes one line
//! `name;rust;worst;c;worst` per call. What is counted is the function from its first instruction
//! to its return, as a caller has it. Both programs read theta and the whole estimate, so that both
//! have the code of the read-out once. Behind them lines `name;bytes`, the stack of a call of C.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod c_calls;
#[cfg(target_os = "none")]
mod count;
#[cfg(target_os = "none")]
mod identifiers;
#[cfg(target_os = "none")]
mod position_loop;
#[cfg(target_os = "none")]
mod stacks;

#[cfg(target_os = "none")]
mod target {
    use core::hint::black_box;

    use cortex_m_rt::entry;
    use trendid_example_support::board::{exit, line};
    use trendid_example_support::clock::Clock;
    use trendid_example_support::record;

    use crate::count::{Count, nothing};
    use crate::{identifiers, position_loop, stacks};

    // For memory.x: the objects lie on the stack.
    core::arch::global_asm!(".global __trendid_deep_stack", "__trendid_deep_stack = 1");

    #[panic_handler]
    fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
        line(format_args!("{info}"));
        exit(false)
    }

    #[entry]
    fn main() -> ! {
        let Some(mut core) = cortex_m::Peripherals::take() else {
            exit(false)
        };
        let [clock, _] = Clock::start(&mut core);
        line(format_args!("# {clock}"));
        let mut idle = Count::default();
        for (u, _) in record::samples() {
            idle.take(clock.ticks(|| nothing(black_box(u))));
        }
        let idle = idle.mean();
        let done =
            identifiers::count(&clock, idle).is_ok() && position_loop::count(&clock, idle).is_ok();
        stacks::measure();
        exit(done)
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("`cargo xtask capi --edge` counts instructions on the emulated target");
}
