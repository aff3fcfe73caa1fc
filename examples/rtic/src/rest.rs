//! The last thing a run does: the valve comes to rest, and the watchdog restarts the chip.

use cortex_m_semihosting::debug;
use trendid::hardware::Valve;

use trendid_example_support::drive::SimulatedValve;

use crate::logger::FRAMES;

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    cortex_m::interrupt::disable();
    // On a machine: by the registers of the output, whose driver is in the hands of the task that
    // panicked.
    let _ = SimulatedValve.safe();
    defmt::error!("{}", defmt::Display2Format(&info.message()));
    if FRAMES.are_over_semihosting() {
        debug::exit(debug::EXIT_FAILURE);
    }
    loop {
        cortex_m::asm::nop();
    }
}
