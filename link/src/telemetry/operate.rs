//! Requests carried out on a loop.

use trendid::ConfigError;
use trendid::hardware::{PositionSensor, Valve};
use trendid::servo::{Error, Model, Reason, ServoLoop, State};

use crate::telemetry::{Outcome, Refusal, Request, Text};

/// A machine that carries out requests.
pub trait Machine {
    /// Carries out a request outside of the path of a sample.
    ///
    /// # Errors
    /// Why not; nothing has changed then.
    fn operate(&mut self, request: &Request) -> Result<(), Refusal>;
}

/// The answer to what a machine did.
impl From<Result<(), Refusal>> for Outcome {
    fn from(done: Result<(), Refusal>) -> Self {
        match done {
            Ok(()) => Self::Done,
            Err(refusal) => Self::Refused(refusal),
        }
    }
}

/// Carries out what the loop itself can; everything else is [`Refusal::Unsupported`], for the machine around it.
///
/// # Errors
/// Why not; the loop is as before.
pub fn operate<S: PositionSensor, V: Valve>(
    servo: &mut ServoLoop<S, V>,
    request: &Request,
) -> Result<(), Refusal> {
    let state = servo.supervisor().state();
    match *request {
        Request::Commission if state.is_commissioning() => Err(Refusal::Moving),
        Request::Commission => {
            servo.commission();
            Ok(())
        }
        Request::Stop => {
            servo.abort();
            Ok(())
        }
        Request::Move(_) | Request::Oscillate { .. } if !state.is_controlling() => {
            Err(Refusal::NotControlling)
        }
        Request::Move(target) => servo.move_to(target).map_err(Refusal::from),
        Request::Oscillate {
            amplitude,
            frequency,
        } => servo.oscillate(amplitude, frequency).map_err(Refusal::from),
        Request::Install(_) if state.is_commissioning() || state.is_controlling() => {
            Err(Refusal::Moving)
        }
        Request::Install([a1, a2, b0, dead_zone, offset, friction]) => {
            let model = Model {
                dead_zone,
                offset,
                friction,
                ..Model::linear(a1, a2, b0)
            };
            servo.install(model).map_err(Refusal::from)
        }
        _ => Err(Refusal::Unsupported),
    }
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        match error {
            Error::Setting(error) | Error::Identifier(error) => error.into(),
            Error::Model(reason) => Self::Model(reason as u8),
            _ => Self::Setting(text("unit of the position")),
        }
    }
}

impl From<ConfigError> for Refusal {
    fn from(error: ConfigError) -> Self {
        let (setting, value, limits) = match error {
            ConfigError::NotFinite { setting, value } => (setting, value, [f32::MIN, f32::MAX]),
            ConfigError::NotPositive { setting, value } => {
                (setting, value, [f32::MIN_POSITIVE, f32::MAX])
            }
            ConfigError::OutOfRange {
                setting,
                value,
                limits,
            } => (setting, value, limits),
            ConfigError::Unstable { setting } | ConfigError::TooFast { setting, .. } => {
                return Self::Setting(text(setting.name));
            }
            _ => return Self::Setting(text("the structure")),
        };
        Self::Value {
            name: text(setting.name),
            value,
            limits,
        }
    }
}

/// As much of a text as fits.
pub(crate) fn text(words: &str) -> Text {
    let mut text = Text::new();
    for letter in words.chars() {
        if text.push(letter).is_err() {
            break;
        }
    }
    text
}

/// The reasons in the order of their numbers on the wire.
const REASONS: [Reason; 17] = [
    Reason::NotFinite,
    Reason::WrongSign,
    Reason::OutOfRange,
    Reason::Unstable,
    Reason::Uncertain,
    Reason::PoorFit,
    Reason::NotBetter,
    Reason::Blocked,
    Reason::ValveStuck,
    Reason::SensorStuck,
    Reason::SensorFault,
    Reason::ValveFault,
    Reason::TravelEnd,
    Reason::Aborted,
    Reason::Implausible,
    Reason::FollowingError,
    Reason::Saturated,
];

// A reason that is not in its place would be told under another name.
const _: () = {
    let mut place = 0;
    while place < REASONS.len() {
        assert!(REASONS[place] as usize == place);
        place += 1;
    }
};

/// The reason with a number; `None` for one of a newer version.
#[must_use]
pub fn reason_of(number: u8) -> Option<Reason> {
    REASONS.get(usize::from(number)).copied()
}

/// The state with a number and the number of its reason.
#[must_use]
pub fn state_of(number: u8, reason: u8) -> Option<State> {
    Some(match number {
        0 => State::Idle,
        1 => State::Exciting,
        2 => State::Identifying,
        3 => State::Verified,
        4 => State::Adapting,
        5 => State::Frozen,
        6 => State::Rejected(reason_of(reason)?),
        7 => State::Failed(reason_of(reason)?),
        _ => return None,
    })
}
