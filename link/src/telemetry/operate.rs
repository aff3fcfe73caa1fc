//! Requests carried out on a loop.

use trendid::ConfigError;
use trendid::hardware::{PositionSensor, Valve};
use trendid::servo::{Error, Model, ServoLoop};

use crate::telemetry::request::{Outcome, Refusal, Request};
use crate::telemetry::text::text;

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

/// Carries out what the loop itself can; everything else is [`Refusal::Unsupported`], for the
/// machine around it.
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
        Request::Move(target) => servo.move_to(target).map_err(Refusal::from),
        Request::Oscillate {
            amplitude,
            frequency,
        } => servo.oscillate(amplitude, frequency).map_err(Refusal::from),
        Request::Install(_) if state.is_commissioning() || state.is_controlling() => {
            Err(Refusal::Moving)
        }
        Request::Install(fields) => servo
            .install(Model::from_fields(fields))
            .map_err(Refusal::from),
        _ => Err(Refusal::Unsupported),
    }
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        match error {
            Error::Setting(error) | Error::Identifier(error) => error.into(),
            Error::Model(reason) => Self::Model(reason as u8),
            Error::NotControlling => Self::NotControlling,
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
