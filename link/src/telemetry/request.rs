//! What may be asked, and what came of it.
//!
//! The order of variants and fields is part of the protocol; a change is another
//! [`VERSION`](crate::VERSION).

use core::fmt;

use serde::{Deserialize, Serialize};

use crate::Message;
use crate::telemetry::reasons::reason_of;
use crate::telemetry::text::Text;

/// Host to target: one request.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Order {
    /// Number of the order; one that comes again is not carried out again.
    pub id: u32,
    /// Tick of the newest sample that the sender has seen.
    pub seen: u32,
    /// What is asked.
    pub request: Request,
}

impl Message for Order {
    const TAG: u8 = b'O';
}

/// What may be asked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Request {
    /// Who is there; answered by an [`Identity`](super::Identity) besides.
    Hello,
    /// Nothing: the line lives.
    Alive,
    /// A [`Sample`](super::Sample) every so many samples; 0 for none.
    Stream(u16),
    /// Stop whenever no order came for so many ms; 0 for never.
    Watchdog(u16),
    /// Events of this start up to this number have arrived.
    Heard(u32),
    /// Commission the axis.
    Commission,
    /// Move to this position.
    Move(f32),
    /// Oscillate about the present reference.
    Oscillate {
        /// Amplitude in the unit of the position.
        amplitude: f32,
        /// Frequency in Hz.
        frequency: f32,
    },
    /// Stop commissioning or control.
    Stop,
    /// Limits of moves.
    Limits {
        /// Largest velocity.
        velocity: f32,
        /// Largest acceleration.
        acceleration: f32,
        /// Largest jerk.
        jerk: f32,
    },
    /// Set a value of [`settings::SETTINGS`](super::settings::SETTINGS); `None` lets it follow from
    /// the others.
    Set {
        /// Its place in the table.
        setting: u8,
        /// The value.
        value: Option<f32>,
    },
    /// Tell a value of the table; answered by a [`SettingValue`] besides.
    Get(u8),
    /// Control with this model: a1, a2, b0, dead zone, offset, friction.
    Install([f32; 6]),
    /// Keep the verified model where it survives a loss of power.
    Store,
    /// Acknowledge a latched fault, but none of a later start.
    Acknowledge,
    /// Do this to a simulated machine; a real one refuses.
    Play(Trick),
}

impl Request {
    /// Whether the axis may move by it.
    #[must_use]
    pub const fn moves(&self) -> bool {
        matches!(
            self,
            Self::Commission
                | Self::Move(_)
                | Self::Oscillate { .. }
                | Self::Install(_)
                | Self::Play(_)
        )
    }
}

/// What can be done to a simulated machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Trick {
    /// As it was built.
    Heal,
    /// The code of the sensor stays.
    FreezeSensor,
    /// No reading succeeds.
    LoseReadings,
    /// The valve stays closed.
    CloseValve,
    /// Three times the moving mass.
    TripleMass,
}

/// A value of the table of settings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SettingValue {
    /// Its place in the table.
    pub setting: u8,
    /// The value; `None` when it follows from the others.
    pub value: Option<f32>,
}

/// The answer to an order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    /// Number of the order.
    pub id: u32,
    /// What came of it.
    pub outcome: Outcome,
}

/// What came of an order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Outcome {
    /// It was done.
    Done,
    /// It was refused and changed nothing.
    Refused(Refusal),
}

/// Why an order was refused.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Refusal {
    /// A value is not within its limits.
    Value {
        /// Its name.
        name: Text,
        /// The value.
        value: f32,
        /// The limits; an infinite one allows every finite value.
        limits: [f32; 2],
    },
    /// The settings contradict each other: this one has no place beside the others.
    Setting(Text),
    /// The model may not control, for this reason in the order of [`trendid::servo::Reason`].
    Model(u8),
    /// The loop does not control the axis.
    NotControlling,
    /// The axis moves: stop it first.
    Moving,
    /// No model was verified.
    NoModel,
    /// A fault is latched: acknowledge it first.
    Latched,
    /// The sender has not seen a recent sample.
    Stale,
    /// This machine cannot do that.
    Unsupported,
    /// Somebody else is in control.
    NotYours,
    /// The memory for the model failed.
    Storage,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Value {
                name,
                value,
                limits: [low, high],
            } => return write!(f, "{name} = {value} is not within {low}..={high}"),
            Self::Setting(name) => return write!(f, "{name} contradicts the other settings"),
            Self::Model(reason) => match reason_of(*reason) {
                Some(reason) => return write!(f, "the model may not control: {reason}"),
                None => "the model may not control",
            },
            Self::NotControlling => "the loop does not control the axis: commission it first",
            Self::Moving => "the axis moves: stop it first",
            Self::NoModel => "no model was verified yet",
            Self::Latched => "a fault is latched: acknowledge it first",
            Self::Stale => "the line stood still meanwhile: look at the axis and ask again",
            Self::Unsupported => "this machine cannot do that",
            Self::NotYours => "another page is in control",
            Self::Storage => "the memory for the model failed",
        })
    }
}
