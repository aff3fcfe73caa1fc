//! The target's end.

use crate::telemetry::outbox::Outbox;
use crate::telemetry::{
    Answer, Content, Event, Health, Identity, Learned, Order, Outcome, Refusal, Request, Sample,
    SettingValue,
};
use crate::{Receiver, code};

/// Age in ms beyond which a sample that the sender saw is too old for an order that moves the axis.
pub const STALE_MS: u32 = 2000;

/// Period in ms of what is told slowly, and of events that are not acknowledged.
const SLOW_MS: u32 = 100;
const AGAIN_MS: u32 = 500;

/// What the station wants after a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// [`Station::learned`] and [`Station::health`]: a tenth of a second is over.
    pub slow: bool,
    /// Stop the machine: the watchdog of the line.
    pub stop: bool,
}

/// The target's end: takes orders, sends notices, never waits.
///
/// Per sample: [`push`](Self::push) what the line received, carry out the request that comes of it
/// and [`answer`](Self::answer); [`sample`](Self::sample) after the loop; give the line what
/// [`next_byte`](Self::next_byte) has.
///
/// ```
/// use trendid_link::telemetry::{Client, Content, Identity, Outcome, Request, Sample, Station};
///
/// let mut station = Station::new(Identity::default(), 1, 1);
/// let mut client = Client::new(7);
/// client.ask(Request::Stream(1));
/// while let Some(byte) = client.next_byte(0) {
///     assert_eq!(station.push(byte), None); // the station answers this one itself
/// }
/// let _ = station.sample(Sample { tick: 1, position: 2.5, ..Sample::default() });
/// let mut heard = Vec::new();
/// while let Some(byte) = station.next_byte() {
///     heard.extend(client.push(byte));
/// }
/// assert!(heard.iter().any(|c| matches!(c, Content::Answer(a) if a.outcome == Outcome::Done)));
/// assert!(heard.iter().any(|c| matches!(c, Content::Sample(s) if s.position == 2.5)));
/// ```
#[derive(Clone, Debug, Default)]
pub struct Station {
    receiver: Receiver<Order>,
    outbox: Outbox,
    identity: Identity,
    /// Samples per ms.
    per_ms: f32,
    tick: u32,
    every: u16,
    since: u16,
    /// Samples since the last slow notice, the last repetition of events and the last order.
    slow: u32,
    again: u32,
    silent: u32,
    watchdog: u32,
    /// Whether a fault was latched in this start.
    latched: bool,
    /// Whether somebody waits for the identity, which found no room.
    introduces: bool,
    /// The last order, and what came of it; `None` while the machine has it.
    last: Option<(u32, Option<Outcome>)>,
    /// An answer that found no room.
    owed: Option<Answer>,
    told: (u8, u8),
    refused: u32,
}

impl Station {
    /// A station that sends a sample every `every` samples; 0 for none before it is asked for.
    ///
    /// `start` should differ from start to start, over a loss of power too: it tells events of this
    /// start from those of another, which a client takes for the same ones otherwise.
    #[must_use]
    pub fn new(identity: Identity, start: u16, every: u16) -> Self {
        let per_ms = 1e-3 / identity.sample_time;
        Self {
            per_ms: if per_ms > 0.0 && per_ms < 1e3 {
                per_ms
            } else {
                1.0
            },
            identity,
            every,
            told: (code::NO_LOOP, code::NO_REASON),
            outbox: Outbox::new(start),
            ..Self::default()
        }
    }

    /// Takes a byte of the line; gives a new request that the machine must carry out, and then
    /// [`answer`](Self::answer).
    pub fn push(&mut self, byte: u8) -> Option<Request> {
        let Order { id, seen, request } = self.receiver.push(byte)?;
        self.silent = 0;
        if let Some((last, outcome)) = &self.last
            && *last == id
        {
            if let Some(outcome) = outcome.clone() {
                self.send(Answer { id, outcome });
            }
            return None;
        }
        self.last = Some((id, None));
        let age = self.tick.wrapping_sub(seen).cast_signed();
        let recent = (0..=self.samples(STALE_MS).cast_signed()).contains(&age);
        // Who saw a later sample than there was yet saw an earlier start of the target.
        let earlier = age < 0;
        let of_a_fault_before = earlier && self.latched && request == Request::Acknowledge;
        if request.moves() && !recent || of_a_fault_before {
            self.answer(Outcome::Refused(Refusal::Stale));
            return None;
        }
        match request {
            Request::Hello => {
                self.introduces = true;
                self.introduce();
                self.outbox.again();
            }
            Request::Alive => {}
            Request::Stream(every) => {
                self.every = every;
                self.since = 0;
            }
            Request::Watchdog(0) => self.watchdog = 0,
            // Less than a sample is one, and not never.
            Request::Watchdog(ms) => self.watchdog = self.samples(u32::from(ms)).max(1),
            // The numbers of an earlier start are none of this one.
            Request::Heard(_) if earlier => {}
            Request::Heard(number) => self.outbox.heard(number),
            request => return Some(request),
        }
        self.answer(Outcome::Done);
        None
    }

    /// Answers the last order that [`push`](Self::push) gave; nothing where that is answered, as
    /// for a machine that took its time for one before.
    pub fn answer(&mut self, outcome: Outcome) {
        if let Some((id, answered @ None)) = &mut self.last {
            *answered = Some(outcome.clone());
            let id = *id;
            self.send(Answer { id, outcome });
        }
    }

    fn send(&mut self, answer: Answer) {
        if !self.outbox.urge(Content::Answer(answer.clone())) {
            self.owed = Some(answer);
        }
    }

    /// Takes a sample; its changes of state and model become events.
    pub fn sample(&mut self, sample: Sample) -> Wanted {
        self.tick = sample.tick;
        if self.told != (sample.state, sample.reason) {
            self.told = (sample.state, sample.reason);
            let (state, reason) = self.told;
            self.event(Event::State { state, reason });
        }
        if let Some(answer) = self.owed.take() {
            self.send(answer);
        }
        self.introduce();
        self.again += 1;
        if self.again >= self.samples(AGAIN_MS) {
            self.again = 0;
            self.outbox.again();
        }
        self.outbox.post();
        if self.every > 0 {
            self.since += 1;
            if self.since >= self.every {
                self.since = 0;
                self.outbox.offer(Content::Sample(sample));
            }
        }
        self.silent = self.silent.saturating_add(1);
        // Once: it watches again from the next order on.
        let stop = self.watchdog > 0 && self.silent == self.watchdog.saturating_add(1);
        if stop {
            self.event(Event::LineLost);
        }
        self.slow += 1;
        let slow = self.slow >= self.samples(SLOW_MS);
        if slow {
            self.slow = 0;
        }
        Wanted { slow, stop }
    }

    /// Tells what was learned; a refusal that is new becomes an event.
    pub fn learned(&mut self, learned: Learned) {
        if learned.counts[1] != self.refused {
            self.refused = learned.counts[1];
            self.event(Event::Refused(learned.refusal));
        }
        self.outbox.offer(Content::Learned(learned));
    }

    /// Tells the counters; those of the line are filled in here.
    pub fn health(&mut self, health: Health) {
        let health = Health {
            dropped: self.outbox.dropped,
            events_lost: self.outbox.events_lost,
            corrupt: self.receiver.corrupt(),
            ..health
        };
        self.outbox.offer(Content::Health(health));
    }

    /// Tells a value of the table of settings, before samples: somebody has asked for it.
    pub fn setting(&mut self, value: SettingValue) {
        let value = Content::Setting(value);
        if !self.outbox.urge(value.clone()) {
            self.outbox.offer(value);
        }
    }

    /// Keeps an event until it is acknowledged.
    pub fn event(&mut self, event: Event) {
        self.latched |= matches!(event, Event::Fault(_));
        self.outbox.keep(self.tick, event);
        self.outbox.post();
    }

    /// The next byte for the line.
    pub fn next_byte(&mut self) -> Option<u8> {
        self.outbox.next_byte()
    }

    /// Whether nothing waits for the line.
    #[must_use]
    pub fn is_quiet(&self) -> bool {
        self.outbox.is_empty()
    }

    /// Says who is there, as soon as there is room for it.
    fn introduce(&mut self) {
        if self.introduces {
            let identity = Content::Identity(self.identity.clone());
            self.introduces = !self.outbox.fits(identity);
        }
    }

    fn samples(&self, ms: u32) -> u32 {
        (ms as f32 * self.per_ms) as u32
    }
}
