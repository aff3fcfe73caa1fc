//! USART1 of the emulated chip behind the traits of the real one: bytes come by interrupt, and go
//! when there is room.

use core::convert::Infallible;

use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;
use embassy_time::Timer;
use embedded_io_async::{ErrorType, Read, Write};
use stm32f4xx_hal::pac::{USART1, interrupt};

/// Bytes that came and were not read; QEMU sends the next one when the last was taken.
static RECEIVED: Pipe<CriticalSectionRawMutex, 256> = Pipe::new();

/// The way in.
pub struct Receiver(());

/// The way out.
pub struct Sender(USART1);

/// Enables the line in both directions; QEMU knows no baud rate.
pub fn open(line: USART1) -> (Receiver, Sender) {
    line.cr1().write(|word| {
        word.ue().set_bit();
        word.te().set_bit();
        word.re().set_bit();
        word.rxneie().set_bit()
    });
    (Receiver(()), Sender(line))
}

#[interrupt]
fn USART1() {
    // SAFETY: the way out neither reads the data register nor writes the control registers.
    let line = unsafe { USART1::steal() };
    if line.sr().read().rxne().bit_is_set() {
        let byte = line.dr().read().bits() as u8;
        // A byte without room is lost, as on any line without a handshake.
        let _ = RECEIVED.try_write(&[byte]);
    }
}

impl ErrorType for Receiver {
    type Error = Infallible;
}

impl Read for Receiver {
    async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        Ok(RECEIVED.read(bytes).await)
    }
}

impl ErrorType for Sender {
    type Error = Infallible;
}

impl Write for Sender {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        let Some(byte) = bytes.first() else {
            return Ok(0);
        };
        // QEMU 7.2 raises no interrupt for an empty data register.
        while self.0.sr().read().txe().bit_is_clear() {
            Timer::after_millis(1).await;
        }
        self.0.dr().write(|word| word.dr().set(u16::from(*byte)));
        Ok(1)
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
