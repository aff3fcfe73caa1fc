//! The wire over USART1: two queues, an interrupt above that of the slot that takes a byte, and the
//! idle loop that sends.
//!
//! A byte that is lost, e.g. while the log writes with interrupts off, spoils its frame: the check
//! sum tells, and the order comes again.

use core::cell::RefCell;

use cortex_m::interrupt::{Mutex, free};
use cortex_m::peripheral::NVIC;
use heapless::spsc::{Consumer, Producer, Queue};
use stm32f4xx_hal::gpio::{PA9, PA10};
use stm32f4xx_hal::pac::{self, USART1, interrupt};
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{Event, Rx, Tx};
use stm32f4xx_hal::{nb, prelude::*};

use crate::wire::line::Line;

const BAUD: u32 = 921_600;

/// Bytes that wait in either direction; one place of a queue stays empty.
const RECEIVED: usize = 512;
const SENT: usize = 2048;

/// What the interrupt of the line owns.
type Receiving = (Rx<USART1>, Producer<'static, u8>);

static RECEIVING: Mutex<RefCell<Option<Receiving>>> = Mutex::new(RefCell::new(None));

#[interrupt]
fn USART1() {
    static mut OWN: Option<Receiving> = None;
    if OWN.is_none() {
        *OWN = free(|section| RECEIVING.borrow(section).take());
    }
    if let Some((line, queue)) = OWN {
        // An error of the line is a wrong byte to the check sum; so is a byte that finds no room.
        let byte = match line.read() {
            Ok(byte) => byte,
            Err(nb::Error::WouldBlock) => return,
            Err(nb::Error::Other(_)) => 0xFF,
        };
        let _ = queue.enqueue(byte);
    }
}

/// The end in the slot.
pub(crate) struct Usart {
    received: Consumer<'static, u8>,
    sends: Producer<'static, u8>,
}

/// The end in the idle loop.
pub(crate) struct Pump {
    line: Tx<USART1>,
    queue: Consumer<'static, u8>,
}

impl Pump {
    /// Sends what the line takes; whether more waits.
    pub(crate) fn run(&mut self) -> bool {
        while let Some(&byte) = self.queue.peek() {
            if self.line.write(byte).is_err() {
                return true;
            }
            let _ = self.queue.dequeue();
        }
        false
    }
}

/// Sets the line up. `None` when the clock has no such rate.
pub(crate) fn begin(line: USART1, pins: (PA9, PA10), rcc: &mut Rcc) -> Option<(Usart, Pump)> {
    let received = cortex_m::singleton!(: Queue<u8, RECEIVED> = Queue::new())?;
    let sent = cortex_m::singleton!(: Queue<u8, SENT> = Queue::new())?;
    let mut serial = line.serial::<u8>(pins, BAUD.bps(), rcc).ok()?;
    serial.listen(Event::RxNotEmpty);
    let (line, receives) = serial.split();
    let (fills, received) = received.split();
    let (sends, queue) = sent.split();
    free(|section| RECEIVING.borrow(section).replace(Some((receives, fills))));
    // SAFETY: everything the interrupt needs was handed over.
    unsafe { NVIC::unmask(pac::Interrupt::USART1) };
    Some((Usart { received, sends }, Pump { line, queue }))
}

impl Line for Usart {
    fn receive(&mut self) -> Option<u8> {
        self.received.dequeue()
    }

    fn send(&mut self, bytes: impl Iterator<Item = u8>) {
        let room = self.sends.capacity() - self.sends.len();
        for byte in bytes.take(room) {
            let _ = self.sends.enqueue(byte);
        }
    }
}
