//! What can be wrong with the settings of a servo loop.

use core::fmt;

use crate::error::ConfigError;

/// A setting of the servo loop that cannot work; names the setting and the value.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ServoError {
    /// The sample time is not a positive finite number of seconds.
    SampleTime(f32),
    /// A limit of velocity, acceleration or jerk is not positive and finite.
    MotionLimit(f32),
    /// The wanted bandwidth is not positive, or above a fifth of the sample rate (rad/s).
    Bandwidth(f32),
    /// The wanted damping is not positive and finite.
    Damping(f32),
    /// The observer's rate is not positive, or above 0.3 per sample (rad/s).
    ObserverRate(f32),
    /// The range of the command is not within 0..=1.
    CommandRange(f32),
    /// The rate limit of the command is not positive and finite (per s).
    CommandRate(f32),
    /// The window in which the valve rests is negative or not finite.
    RestWindow(f32),
    /// The end of the travel is not beyond its begin, or not finite.
    Travel {
        /// Begin of the travel.
        begin: f32,
        /// End of the travel.
        end: f32,
    },
    /// Bandwidth squared times travel is beyond 1e7: the unit of y is too small for the accelerations of this axis.
    Unit(f32),
    /// The amplitude of the excitation is not within 0..=1.
    Amplitude(f32),
    /// A time is not positive, or longer than 2^31 samples (s).
    Time(f32),
    /// A bound of the supervisor is not positive and finite.
    Bound(f32),
    /// The model given at the start is not finite or not stable.
    Model,
    /// The settings of the identifier.
    Identifier(ConfigError),
}

impl fmt::Display for ServoError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::SampleTime(v) => write!(f, "sample time {v} s is not positive"),
            Self::MotionLimit(v) => write!(f, "motion limit {v} is not positive"),
            Self::Bandwidth(v) => write!(
                f,
                "bandwidth {v} rad/s is not positive or too fast for the sample time"
            ),
            Self::Damping(v) => write!(f, "damping {v} is not positive"),
            Self::ObserverRate(v) => write!(
                f,
                "observer rate {v} rad/s is not positive or too fast for the sample time"
            ),
            Self::CommandRange(v) => write!(f, "command range {v} is not within 0..=1"),
            Self::CommandRate(v) => write!(f, "command rate {v} per s is not positive"),
            Self::RestWindow(v) => write!(f, "rest window {v} is not a finite number >= 0"),
            Self::Travel { begin, end } => write!(f, "travel from {begin} to {end} is empty"),
            Self::Unit(v) => write!(
                f,
                "bandwidth squared times travel is {v} units of y per s^2, more than 1e7: give y in a larger unit, mm and not um"
            ),
            Self::Amplitude(v) => write!(f, "excitation amplitude {v} is not within 0..=1"),
            Self::Time(v) => write!(f, "time {v} s is not positive or too long"),
            Self::Bound(v) => write!(f, "bound {v} of the supervisor is not positive"),
            Self::Model => write!(f, "the model to start with is not finite or not stable"),
            Self::Identifier(error) => write!(f, "identifier: {error}"),
        }
    }
}

impl core::error::Error for ServoError {}

impl From<ConfigError> for ServoError {
    fn from(error: ConfigError) -> Self {
        Self::Identifier(error)
    }
}
