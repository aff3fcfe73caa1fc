//! The messages: orders to the target, notices from it.
//!
//! The order of variants and fields is part of the protocol; a change is another [`VERSION`](crate::VERSION).

use core::fmt;

use serde::{Deserialize, Serialize};
use trendid::hardware::{PositionSensor, Valve};
use trendid::servo::{Report, ServoLoop};

use crate::telemetry::reasons::reason_of;
use crate::{Message, code};

/// A short text: what does not fit is cut.
pub type Text = heapless::String<40>;

/// As much of a text as fits.
#[must_use]
pub fn text(words: &str) -> Text {
    let mut text = Text::new();
    for letter in words.chars() {
        if text.push(letter).is_err() {
            break;
        }
    }
    text
}

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
    /// Who is there; answered by an [`Identity`] besides.
    Hello,
    /// Nothing: the line lives.
    Alive,
    /// A [`Sample`] every so many samples; 0 for none.
    Stream(u16),
    /// Stop when no order came for so many ms; 0 for never.
    Watchdog(u16),
    /// Events up to this number have arrived.
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
    /// Set a value of [`settings::SETTINGS`](super::settings::SETTINGS); `None` lets it follow from the others.
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
    /// Acknowledge a latched fault.
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
    /// Whether the machine is simulated and takes [`Request::Play`].
    pub simulated: bool,
}

/// One sample of the loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Number of the sample since the start; wraps.
    pub tick: u32,
    /// [`trendid::servo::State::code`].
    pub state: u8,
    /// Reason of the state in the order of [`trendid::servo::Reason`], or [`code::NO_REASON`].
    pub reason: u8,
    /// Whether a model reached the controller in this sample.
    pub retuned: bool,
    /// Measured position.
    pub position: f32,
    /// Reference and its velocity.
    pub setpoint: [f32; 2],
    /// Observed velocity.
    pub velocity: f32,
    /// Command of the valve, -1 to 1.
    pub command: f32,
    /// Innovation of the identifier.
    pub innovation: Option<f32>,
}

impl Sample {
    /// What `servo` did in the sample of `report`.
    #[must_use]
    pub fn of<S: PositionSensor, V: Valve>(
        tick: u32,
        report: &Report,
        servo: &ServoLoop<S, V>,
    ) -> Self {
        Self {
            tick,
            state: report.state.code(),
            reason: report
                .state
                .reason()
                .map_or(code::NO_REASON, |reason| reason as u8),
            retuned: report.retuned,
            position: finite(report.position),
            setpoint: [
                finite(report.setpoint.position),
                finite(report.setpoint.velocity),
            ],
            velocity: finite(servo.controller().motion().velocity),
            command: finite(report.command),
            innovation: report.innovation.filter(|e| e.is_finite()),
        }
    }
}

/// What the loop has learned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Learned {
    /// Number of the sample.
    pub tick: u32,
    /// Estimated a1, a2, b0.
    pub theta: [f32; 3],
    /// Their covariance: 11, 22, 33, 12, 13, 23; `None` where nothing is known yet.
    pub covariance: Option<[f32; 6]>,
    /// The model in the controller: a1, a2, b0, dead zone, offset, friction.
    pub model: [f32; 6],
    /// Standard deviation that the identifier expects of its innovation.
    pub expected: Option<f32>,
    /// Models accepted and refused so far.
    pub counts: [u32; 2],
    /// Why the last one was refused, or [`code::NO_REASON`].
    pub refusal: u8,
    /// Sign of the valve.
    pub reversed: bool,
    /// Delay of the valve in s.
    pub delay: f32,
    /// Factor on the bandwidth.
    pub derating: f32,
    /// Gain margin, phase margin in degrees, delay margin in s, largest sensitivity; `None` where they were not computed.
    pub margins: Option<[f32; 4]>,
}

impl Learned {
    /// What `servo` knows after the sample of `report`. Cost: a reading of the covariance, some thousand instructions.
    #[must_use]
    pub fn of<S: PositionSensor, V: Valve>(
        tick: u32,
        report: &Report,
        servo: &ServoLoop<S, V>,
    ) -> Self {
        let found = servo.identifier().recursion();
        let ([a1, a2, b0, ..], p) = (found.theta(), found.covariance());
        let covariance = [p[0][0], p[1][1], p[2][2], p[0][1], p[0][2], p[1][2]];
        let model = servo.controller().model();
        let (accepted, refused) = servo.supervisor().counts();
        Self {
            tick,
            theta: [a1, a2, b0].map(finite),
            covariance: covariance
                .iter()
                .all(|p| p.is_finite())
                .then_some(covariance),
            model: [
                model.a1,
                model.a2,
                model.b0,
                model.dead_zone,
                model.offset,
                model.friction,
            ]
            .map(finite),
            expected: servo.identifier().noise_std().filter(|s| s.is_finite()),
            counts: [accepted, refused],
            refusal: servo
                .supervisor()
                .refusal()
                .map_or(code::NO_REASON, |reason| reason as u8),
            reversed: servo.sign() < 0.0,
            delay: finite(servo.delay()),
            derating: finite(report.faults.derating),
            margins: None,
        }
    }
}

/// Counters since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Health {
    /// Number of the sample.
    pub tick: u32,
    /// Readings that failed.
    pub failed_readings: u32,
    /// Readings that the axis cannot have reached.
    pub implausible_readings: u32,
    /// Samples at the full command.
    pub saturated_samples: u32,
    /// Oscillations at rest that were noticed.
    pub oscillations: u32,
    /// Faults that stopped the axis.
    pub stops: u32,
    /// Slots that were not done in time.
    pub overruns: u32,
    /// Longest slot in us.
    pub longest_us: u32,
    /// Samples that did not fit on the line.
    pub dropped: u32,
    /// Events that were lost because nobody acknowledged and [`EVENTS`](super::EVENTS) waited already.
    pub events_lost: u32,
    /// Damaged frames that the target received.
    pub corrupt: u32,
}

impl Health {
    /// The counters of the loop; what the slot and the line count is filled in by their owners.
    #[must_use]
    pub fn of(tick: u32, report: &Report) -> Self {
        let faults = report.faults;
        Self {
            tick,
            failed_readings: faults.failed_readings,
            implausible_readings: faults.implausible_readings,
            saturated_samples: faults.saturated_samples,
            oscillations: faults.oscillations,
            stops: faults.stops,
            ..Self::default()
        }
    }
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
    /// The supervisor went over to a state, for a reason or [`code::NO_REASON`].
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

/// A value of the table of settings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SettingValue {
    /// Its place in the table.
    pub setting: u8,
    /// The value; `None` when it follows from the others.
    pub value: Option<f32>,
}

/// A number for the line: zero in the place of what is not finite.
fn finite(value: f32) -> f32 {
    if value.is_finite() { value } else { 0.0 }
}
