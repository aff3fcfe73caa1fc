//! Errors of a configuration: each names the setting, its value and the values that were expected.

use core::fmt;

/// The name of a setting, and for a list of values the position in it.
///
/// # Examples
/// ```
/// use trendid::error::Setting;
/// assert_eq!(format!("{}", Setting::from("memory")), "memory");
/// assert_eq!(format!("{}", Setting::from(("input_range", 1))), "input_range[1]");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Setting {
    /// The field of the configuration, or the argument of the constructor.
    pub name: &'static str,
    /// The position in a list; `None` for a single value.
    pub index: Option<usize>,
}

impl From<&'static str> for Setting {
    fn from(name: &'static str) -> Self {
        Self { name, index: None }
    }
}

impl From<(&'static str, usize)> for Setting {
    fn from((name, index): (&'static str, usize)) -> Self {
        Self {
            name,
            index: Some(index),
        }
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.index {
            None => write!(f, "{}", self.name),
            Some(index) => write!(f, "{}[{index}]", self.name),
        }
    }
}

/// A configuration that cannot work, with the offending setting.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ConfigError {
    /// The value is NaN or infinite.
    NotFinite {
        /// The setting.
        setting: Setting,
        /// Its value.
        value: f32,
    },
    /// The value is not a finite number above zero.
    NotPositive {
        /// The setting.
        setting: Setting,
        /// Its value.
        value: f32,
    },
    /// The value is NaN or outside its limits.
    OutOfRange {
        /// The setting.
        setting: Setting,
        /// Its value.
        value: f32,
        /// The smallest and the largest value; an infinite limit allows every finite value.
        limits: [f32; 2],
    },
    /// The polynomial has a pole outside the left half plane.
    Unstable {
        /// The setting.
        setting: Setting,
    },
    /// The polynomial has a pole that is too fast for the sample time.
    TooFast {
        /// The setting.
        setting: Setting,
        /// Every pole must be below this rate in rad/s.
        limit: f32,
    },
    /// The terms of the structure add up to `found` parameters, its type has exactly `expected`.
    ParameterCount {
        /// Number of parameters the terms add up to.
        found: usize,
        /// The const parameter `N`.
        expected: usize,
    },
    /// The structure has a term a_i or b_i with `i >= m`.
    Term {
        /// The power of s of the term.
        power: usize,
        /// The order m of the model.
        order: usize,
    },
    /// No input has a numerator term.
    NoInput,
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotFinite { setting, value } => write!(f, "{setting} = {value} is not finite"),
            Self::NotPositive { setting, value } => {
                write!(f, "{setting} = {value} is not a finite number above 0")
            }
            Self::OutOfRange {
                setting,
                value,
                limits: [low, high],
            } if high == f32::INFINITY => {
                write!(f, "{setting} = {value} is not a finite number >= {low}")
            }
            Self::OutOfRange {
                setting,
                value,
                limits: [low, high],
            } => write!(f, "{setting} = {value} is not within {low}..={high}"),
            Self::Unstable { setting } => write!(f, "{setting} has a pole that is not stable"),
            Self::TooFast { setting, limit } => {
                write!(f, "{setting} has a pole that is not below {limit} rad/s")
            }
            Self::ParameterCount { found, expected } => write!(
                f,
                "the structure has {found} parameters, its type holds {expected}"
            ),
            Self::Term { power, order } => {
                write!(f, "a term of power {power} in a model of order {order}")
            }
            Self::NoInput => write!(f, "no input has a numerator term"),
        }
    }
}

impl core::error::Error for ConfigError {}

/// The orders that trends and structures are made for, checked at compile time.
pub(crate) const fn assert_order(order: usize) {
    assert!(1 <= order && order <= 4, "the order M is not in 1..=4");
}

/// Whether `value` is a finite number above zero.
pub(crate) const fn positive(value: f32) -> bool {
    value > 0.0 && value <= f32::MAX
}

/// An error unless `value` is finite.
pub(crate) fn check_finite(setting: impl Into<Setting>, value: f32) -> Result<(), ConfigError> {
    let setting = setting.into();
    match value.is_finite() {
        true => Ok(()),
        false => Err(ConfigError::NotFinite { setting, value }),
    }
}

/// An error unless `value` is a finite number above zero.
pub(crate) fn check_positive(setting: impl Into<Setting>, value: f32) -> Result<(), ConfigError> {
    let setting = setting.into();
    match positive(value) {
        true => Ok(()),
        false => Err(ConfigError::NotPositive { setting, value }),
    }
}

/// An error unless `value` is finite and within `limits`, which belong to the range.
pub(crate) fn check_range(
    setting: impl Into<Setting>,
    value: f32,
    limits: [f32; 2],
) -> Result<(), ConfigError> {
    let setting = setting.into();
    match value.is_finite() && value >= limits[0] && value <= limits[1] {
        true => Ok(()),
        false => Err(ConfigError::OutOfRange {
            setting,
            value,
            limits,
        }),
    }
}

/// An error unless `value` is a finite number of at least zero.
pub(crate) fn check_not_negative(
    setting: impl Into<Setting>,
    value: f32,
) -> Result<(), ConfigError> {
    check_range(setting, value, [0.0, f32::INFINITY])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nan_and_infinity_fail_every_check() {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert!(check_finite("x", value).is_err());
            assert!(check_positive("x", value).is_err());
            assert!(check_not_negative("x", value).is_err());
            assert!(check_range("x", value, [-1.0, 1.0]).is_err());
        }
        assert!(check_positive("x", 0.0).is_err() && check_not_negative("x", 0.0).is_ok());
        assert!(check_range("x", 1.0, [-1.0, 1.0]).is_ok());
    }
}
