//! What the target tells: who it is, numbers, events, answers.
//!
//! The order of variants and fields is part of the protocol; a change is another
//! [`VERSION`](crate::VERSION).

use serde::{Deserialize, Serialize};

use crate::Message;
use crate::telemetry::reading::{Health, Learned, Sample};
use crate::telemetry::request::{Answer, SettingValue};
use crate::telemetry::text::Text;

/// Target to host.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Notice {
    /// Number of the notice on the line, one more for each, wraps: a gap is a loss on the line.
    pub seq: u16,
    /// What is told.
    pub content: Content,
}

impl Message for Notice {
    const TAG: u8 = b'N';
}

/// What is told.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Content {
    /// Who is there.
    Identity(Identity),
    /// One sample of the loop.
    Sample(Sample),
    /// What the loop has learned.
    Learned(Learned),
    /// Counters.
    Health(Health),
    /// Something happened.
    Event(NumberedEvent),
    /// The answer to an order.
    Answer(Answer),
    /// A value of the table of settings.
    Setting(SettingValue),
}

/// Who is there.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    /// Name of the machine.
    pub name: Text,
    /// Unit of the position.
    pub unit: heapless::String<8>,
    /// Sample time in s.
    pub sample_time: f32,
    /// Begin and end of the travel.
    pub travel: [f32; 2],
    /// Whether the machine is simulated and takes [`Request::Play`](super::Request::Play).
    pub simulated: bool,
}

/// An event with its number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NumberedEvent {
    /// The start of the target that the number belongs to.
    pub start: u16,
    /// One more for each event since the start.
    pub number: u32,
    /// Number of the oldest event that still waits for its acknowledgement.
    pub oldest: u32,
    /// The sample in which it happened.
    pub tick: u32,
    /// What happened.
    pub event: Event,
}

/// What happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Event {
    /// The target started, for this cause, so many times since power came.
    Start {
        /// Cause of the reset.
        cause: Text,
        /// Starts since power came.
        starts: u32,
    },
    /// The supervisor went over to a state, for a reason or [`NO_REASON`](crate::code::NO_REASON).
    State {
        /// [`trendid::servo::State::code`].
        state: u8,
        /// The reason.
        reason: u8,
    },
    /// A model reached the controller: a1, a2, b0, dead zone, offset, friction.
    Model([f32; 6]),
    /// A candidate was refused.
    Refused(u8),
    /// A fault was latched.
    Fault(Text),
    /// No order came for as long as the watchdog of the line allows; the machine was asked to stop.
    LineLost,
    /// A slot was not done in time.
    Overrun,
}
