//! Telemetry and requests over USART1, for `trendid-monitor --port` and `--emulator`.
//!
//! ```text
//! USART1 --interrupt--> queue --> slot: Station --> queue --idle loop--> USART1
//! ```
//!
//! The slot empties one queue and fills the other, and never waits: what finds no room stays in the outbox of the station,
//! which drops samples and counts them, and keeps events and answers. A byte that comes in is taken by an interrupt above
//! that of the slot. A byte that is lost all the same, e.g. while the log writes with interrupts off, spoils its frame: the
//! check sum tells, and the order comes again.

use core::cell::RefCell;

use cortex_m::interrupt::{Mutex, free};
use cortex_m::peripheral::NVIC;
use heapless::spsc::{Consumer, Producer, Queue};
use stm32f4xx_hal::gpio::{PA9, PA10};
use stm32f4xx_hal::pac::{self, USART1, interrupt};
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::{Event as Line, Rx, Tx};
use stm32f4xx_hal::{nb, prelude::*};
use trendid::hardware::{PositionSensor, Valve};
use trendid::servo::{Config, Report, ServoLoop};
use trendid_link::telemetry::{
    Event, Health, Identity, Learned, Outcome, Request, Sample, SettingValue, Station, text,
};

const BAUD: u32 = 921_600;

/// Bytes that wait in either direction; one place of a queue stays empty.
const RECEIVED: usize = 512;
const SENT: usize = 2048;

/// Bytes that a slot takes at most: more than the line brings in one.
const PER_SLOT: usize = 128;

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
pub(crate) struct Wire {
    station: Station,
    received: Consumer<'static, u8>,
    sends: Producer<'static, u8>,
    last: Sample,
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

/// Sets the line up; `start` is the number of the start, `cause` why it started. `None` when the clock has no such rate.
pub(crate) fn begin(
    line: USART1,
    pins: (PA9, PA10),
    rcc: &mut Rcc,
    identity: Identity,
    (start, cause): (u32, &str),
) -> Option<(Wire, Pump)> {
    let received = cortex_m::singleton!(: Queue<u8, RECEIVED> = Queue::new())?;
    let sent = cortex_m::singleton!(: Queue<u8, SENT> = Queue::new())?;
    let mut serial = line.serial::<u8>(pins, BAUD.bps(), rcc).ok()?;
    serial.listen(Line::RxNotEmpty);
    let (line, receives) = serial.split();
    let (fills, received) = received.split();
    let (sends, queue) = sent.split();
    free(|section| RECEIVING.borrow(section).replace(Some((receives, fills))));
    let mut station = Station::new(identity, start as u16, 0);
    station.event(Event::Start {
        cause: text(cause),
        starts: start,
    });
    // SAFETY: everything the interrupt needs was handed over.
    unsafe { NVIC::unmask(pac::Interrupt::USART1) };
    let wire = Wire {
        station,
        received,
        sends,
        last: Sample::default(),
    };
    Some((wire, Pump { line, queue }))
}

/// Who speaks.
pub(crate) fn identity(config: &Config, simulated: bool) -> Identity {
    Identity {
        name: text("servo example"),
        unit: "mm".try_into().unwrap_or_default(),
        sample_time: config.sample_time,
        travel: [config.travel.min, config.travel.max],
        simulated,
    }
}

impl Wire {
    /// The next request that the machine has to carry out and then to [`answer`](Self::answer).
    pub(crate) fn request(&mut self) -> Option<Request> {
        for _ in 0..PER_SLOT {
            if let Some(request) = self.station.push(self.received.dequeue()?) {
                return Some(request);
            }
        }
        None
    }

    /// Answers the last request.
    pub(crate) fn answer(&mut self, outcome: Outcome) {
        self.station.answer(outcome);
    }

    /// Tells the value of a setting.
    pub(crate) fn setting(&mut self, value: SettingValue) {
        self.station.setting(value);
    }

    /// Tells of something that is kept until it is acknowledged.
    pub(crate) fn event(&mut self, event: Event) {
        self.station.event(event);
    }

    /// Tells a sample of the loop; whether the watchdog of the line asks for a stop.
    pub(crate) fn sample<S: PositionSensor, V: Valve>(
        &mut self,
        tick: u32,
        report: &Report,
        servo: &ServoLoop<S, V>,
        [overruns, longest_us]: [u32; 2],
    ) -> bool {
        self.last = Sample::of(tick, report, servo);
        let wanted = self.station.sample(self.last);
        if report.retuned || wanted.slow {
            let learned = Learned::of(tick, report, servo);
            if report.retuned {
                self.station.event(Event::Model(learned.model));
            }
            if wanted.slow {
                self.station.learned(learned);
                self.station.health(Health {
                    overruns,
                    longest_us,
                    ..Health::of(tick, report)
                });
            }
        }
        self.send();
        wanted.stop
    }

    /// Tells a slot of a machine that is stopped.
    pub(crate) fn rests(&mut self, tick: u32, position: f32) {
        self.last = Sample {
            tick,
            position,
            setpoint: [position, 0.0],
            velocity: 0.0,
            command: 0.0,
            innovation: None,
            retuned: false,
            ..self.last
        };
        // Its output is safe already: nothing to stop.
        let _ = self.station.sample(self.last);
        self.send();
    }

    /// Gives the idle loop what it has room for.
    fn send(&mut self) {
        while self.sends.ready() {
            let Some(byte) = self.station.next_byte() else {
                return;
            };
            let _ = self.sends.enqueue(byte);
        }
    }
}
