//! Processor in the loop: the adaptive position loop on the target, the axis simulated on the host,
//! one frame each way per sample.
//!
//! USART1 (PA9 transmit, PA10 receive), 115 200 baud, 8N1; frames, lockstep and loop are in `link`.
//! The other end is `trendid pil` in the emulator and `trendid pil --port PORT` with a board, which
//! was not tried on hardware.
//!
//! What is asked of the loop (to commission, to move) comes with a frame and is carried out before
//! the update, while time stands still on both sides: a move is planned outside of the 1 ms path.
//!
//! The processor waits for each byte. The data register of the USART is read in a loop of a few
//! instructions, so at 87 us per byte none is lost while it waits; what comes in during an update
//! is at most one byte, which the USART holds.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target {
    use cortex_m_rt::entry;
    use stm32f4xx_hal::{nb, pac, prelude::*, rcc};
    use trendid_example_support::board;
    use trendid_link::{Controller, Incoming, Reply, Responder};

    #[panic_handler]
    fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
        board::line(format_args!("{info}"));
        board::exit(false)
    }

    /// What a byte from the line sets off; found in the image by its name.
    #[inline(never)]
    // SAFETY: the name is used once in this image.
    #[unsafe(no_mangle)]
    fn link_push(responder: &mut Responder, byte: u8) -> Option<Incoming> {
        responder.push(byte)
    }

    /// The frame of a reply; found in the image by its name.
    #[inline(never)]
    // SAFETY: the name is used once in this image.
    #[unsafe(no_mangle)]
    fn link_answer(responder: &mut Responder, reply: Reply) -> &[u8] {
        responder.answer(reply)
    }

    #[entry]
    fn main() -> ! {
        let Some(chip) = pac::Peripherals::take() else {
            board::exit(false)
        };
        // The internal 16 MHz oscillator: there on every board and in the emulator.
        let mut rcc = chip.RCC.freeze(rcc::Config::hsi());
        let pins = chip.GPIOA.split(&mut rcc);
        let Ok(serial) = chip
            .USART1
            .serial((pins.pa9, pins.pa10), 115_200.bps(), &mut rcc)
        else {
            board::exit(false)
        };
        let (mut transmit, mut receive) = serial.split();
        let mut controller = Controller::new();
        let mut responder = Responder::new();
        // An empty frame says that the line is heard from now on. Cannot fail: an empty register
        // takes a byte.
        let _ = nb::block!(transmit.write(0));
        loop {
            // A receive error (noise, framing, overrun) is a wrong byte to the check sum.
            let byte = nb::block!(receive.read()).unwrap_or(0xFF);
            let answer = match link_push(&mut responder, byte) {
                Some(Incoming::New(sample)) => {
                    let reply = controller.update(&sample);
                    link_answer(&mut responder, reply)
                }
                Some(Incoming::Repeated) => responder.cached(),
                Some(Incoming::Stale) | None => &[],
            };
            for &byte in answer {
                let _ = nb::block!(transmit.write(byte));
            }
        }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("the target's end of `trendid pil`; on the host run `cargo xtask pil`");
}
