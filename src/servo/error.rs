//! Errors of the settings and requests of a servo loop.

use core::fmt;

use crate::error::{ConfigError, check_positive, check_range};
use crate::servo::supervision::state::Reason;

/// A configuration of the servo loop that cannot work, with the setting, its value and the expected
/// values; or a request that cannot be carried out.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
#[doc(alias = "ServoError")]
pub enum Error {
    /// A setting of the loop.
    Setting(ConfigError),
    /// Bandwidth squared times travel is beyond a limit: the unit of y is too small for the
    /// accelerations of this axis.
    Unit {
        /// Bandwidth squared times travel, in units of y per s^2.
        acceleration: f32,
        /// The largest that is accepted, in the same units.
        limit: f32,
    },
    /// The model to install may not control, for this reason.
    Model(Reason),
    /// The settings of the identifier.
    Identifier(ConfigError),
    /// A motion was requested while the controller does not have the axis, or has not seen it yet.
    NotControlling,
}

impl Error {
    /// An error unless `value` is a finite number above zero.
    pub(crate) fn unless_positive(setting: &'static str, value: f32) -> Result<(), Self> {
        check_positive(setting, value).map_err(Self::Setting)
    }

    /// An error unless `value` is within `min..=max`.
    pub(crate) fn unless_within(
        setting: &'static str,
        value: f32,
        min: f32,
        max: f32,
    ) -> Result<(), Self> {
        check_range(setting, value, [min, max]).map_err(Self::Setting)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Setting(error) => write!(f, "{error}"),
            Self::Unit { acceleration, limit } => write!(
                f,
                "bandwidth squared times travel is {acceleration} units of y per s^2, more than {limit:e}: give y in a larger unit, mm and not um"
            ),
            Self::Model(reason) => write!(f, "the model may not control: {reason}"),
            Self::Identifier(error) => write!(f, "identifier: {error}"),
            Self::NotControlling => f.write_str(
                "the axis is not under control: commission it, or install or resume a model, and wait for the next sample",
            ),
        }
    }
}

impl core::error::Error for Error {}

impl From<ConfigError> for Error {
    fn from(error: ConfigError) -> Self {
        Self::Identifier(error)
    }
}
