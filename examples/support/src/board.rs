//! Output through the debugger and the end of an image.

use core::fmt::{self, Write};

use cortex_m_semihosting::{debug, hio};
// The interrupt vectors of the chip; on the other cores there are none.
#[cfg(all(target_abi = "eabihf", feature = "vectors"))]
use stm32f4xx_hal as _;

/// Writes a line through the debugger or the emulator.
pub fn line(arguments: fmt::Arguments<'_>) {
    if let Ok(mut out) = hio::hstdout() {
        // Without a debugger there is no receiver.
        let _ = out.write_fmt(arguments);
        let _ = out.write_str("\n");
    }
}

/// Ends the image: the emulator exits with 0 or 1, a board stops.
pub fn exit(success: bool) -> ! {
    debug::exit(if success {
        debug::EXIT_SUCCESS
    } else {
        debug::EXIT_FAILURE
    });
    loop {
        cortex_m::asm::wfi();
    }
}
