//! Telemetry and requests over USART1 or RTT, for `trendid-monitor`.
//!
//! ```text
//! line --> slot: Station --> line            a line: wire/usart.rs, wire/rtt.rs
//! ```
//!
//! The slot empties one end of the line and fills the other, and never waits: what finds no room
//! stays in the outbox of the station, which drops samples and counts them, and keeps events and
//! answers.

mod line;
mod rtt;
mod usart;

use core::iter::from_fn;

use stm32f4xx_hal::gpio::{PA9, PA10};
use stm32f4xx_hal::pac::USART1;
use stm32f4xx_hal::rcc::Rcc;
use trendid::hardware::{PositionSensor, Valve};
use trendid::servo::{Config, Report, ServoLoop};
use trendid_example_support::survivor::Survivor;
use trendid_link::telemetry::{
    Event, Health, Identity, Learned, Outcome, Request, Sample, SettingValue, Station, text,
};

use line::Line;
use rtt::Rtt;
pub(crate) use usart::Pump;
use usart::Usart;

/// Bytes that a slot takes at most: more than the line brings in one.
const PER_SLOT: usize = 128;

/// What the wire runs over.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Over {
    Usart,
    Rtt,
}

/// The line of this image.
enum Chosen {
    Usart(Usart),
    Rtt(Rtt),
}

impl Line for Chosen {
    fn receive(&mut self) -> Option<u8> {
        match self {
            Self::Usart(line) => line.receive(),
            Self::Rtt(line) => line.receive(),
        }
    }

    fn send(&mut self, bytes: impl Iterator<Item = u8>) {
        match self {
            Self::Usart(line) => line.send(bytes),
            Self::Rtt(line) => line.send(bytes),
        }
    }
}

/// The end in the slot.
pub(crate) struct Wire {
    station: Station,
    line: Chosen,
    last: Sample,
    health: Health,
}

/// Sets the line up, and what the idle loop has to do for it; no wire when the clock has no such
/// rate.
pub(crate) fn begin(
    over: Over,
    usart: USART1,
    pins: (PA9, PA10),
    rcc: &mut Rcc,
    identity: Identity,
    (survivor, cause): (&Survivor, &str),
) -> (Option<Wire>, Option<Pump>) {
    let (line, pump) = match over {
        Over::Usart => usart::begin(usart, pins, rcc).unzip(),
        Over::Rtt => (None, None),
    };
    let line = match over {
        Over::Usart => line.map(Chosen::Usart),
        Over::Rtt => Some(Chosen::Rtt(Rtt)),
    };
    let mut station = Station::new(identity, survivor.number(), 0);
    station.event(Event::Start {
        cause: text(cause),
        starts: survivor.starts(),
    });
    let wire = line.map(|line| Wire {
        station,
        line,
        last: Sample::default(),
        health: Health::default(),
    });
    (wire, pump)
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
            if let Some(request) = self.station.push(self.line.receive()?) {
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
        self.health = Health::of(tick, report);
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
                    ..self.health
                });
            }
        }
        self.send();
        wanted.stop
    }

    /// Tells a slot of a machine that is stopped.
    pub(crate) fn rests(&mut self, tick: u32, position: f32, [overruns, longest_us]: [u32; 2]) {
        self.last = Sample::stopped(tick, position, &self.last);
        // Its output is safe already: nothing to stop.
        if self.station.sample(self.last).slow {
            self.station.health(Health {
                tick,
                overruns,
                longest_us,
                ..self.health
            });
        }
        self.send();
    }

    /// Gives the line what it has room for.
    fn send(&mut self) {
        let station = &mut self.station;
        self.line.send(from_fn(|| station.next_byte()));
    }
}
