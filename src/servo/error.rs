//! What can be wrong with the settings of a servo loop.

use core::fmt;

use crate::error::{ConfigError, positive};
use crate::servo::supervision::state::Reason;

/// A setting of the servo loop that cannot work: its name, and the value that it has or that follows.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
#[doc(alias = "ServoError")]
pub enum Error {
    /// The value is not a finite number above zero.
    NotPositive {
        /// Name of the setting.
        setting: &'static str,
        /// The value given.
        value: f32,
    },
    /// The value is not within `min..=max`.
    OutOfRange {
        /// Name of the setting.
        setting: &'static str,
        /// The value given.
        value: f32,
        /// Least value.
        min: f32,
        /// Largest value.
        max: f32,
    },
    /// Bandwidth squared times travel is beyond 1e7: the unit of y is too small for the accelerations of this axis.
    Unit {
        /// Bandwidth squared times travel, in units of y per s^2.
        acceleration: f32,
    },
    /// The model to install may not control, for this reason.
    Model(Reason),
    /// The settings of the identifier.
    Identifier(ConfigError),
}

impl Error {
    /// Refuses what is not a finite number above zero.
    pub(crate) const fn unless_positive(setting: &'static str, value: f32) -> Result<(), Self> {
        if positive(value) {
            Ok(())
        } else {
            Err(Self::NotPositive { setting, value })
        }
    }

    /// Refuses what is not within `min..=max`, NaN included.
    pub(crate) fn unless_within(
        setting: &'static str,
        value: f32,
        min: f32,
        max: f32,
    ) -> Result<(), Self> {
        if value >= min && value <= max {
            Ok(())
        } else {
            Err(Self::OutOfRange {
                setting,
                value,
                min,
                max,
            })
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotPositive { setting, value } => {
                write!(f, "{setting} = {value} is not a finite number above zero")
            }
            Self::OutOfRange {
                setting,
                value,
                min,
                max,
            } => write!(f, "{setting} = {value} is not within {min} to {max}"),
            Self::Unit { acceleration } => write!(
                f,
                "bandwidth squared times travel is {acceleration} units of y per s^2, more than 1e7: give y in a larger unit, mm and not um"
            ),
            Self::Model(reason) => write!(f, "the model may not control: {reason}"),
            Self::Identifier(error) => write!(f, "identifier: {error}"),
        }
    }
}

impl core::error::Error for Error {}

impl From<ConfigError> for Error {
    fn from(error: ConfigError) -> Self {
        Self::Identifier(error)
    }
}
