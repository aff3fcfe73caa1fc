//! Which setting was refused.

use core::ffi::c_char;

use trendid::ConfigError;
use trendid::error::Setting;
use trendid::servo::Error as LoopError;
use trendid::servo::store::Refused;

use crate::error::Error;

/// Which setting was refused, and what was expected.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detail {
    /// The error, again.
    pub error: Error,
    /// Position in a list of values, -1 for a single value.
    pub index: i32,
    /// The value.
    pub value: f32,
    /// The smallest value; an infinite limit allows every finite value.
    pub low: f32,
    /// The largest value.
    pub high: f32,
    /// Why a model may not control, a `trendid_reason`; 0 otherwise.
    pub reason: u8,
    /// Name of the setting, ends with 0; empty where it is none.
    pub setting: [c_char; 35],
}

impl Detail {
    pub(crate) const fn of(error: Error) -> Self {
        Self {
            error,
            index: -1,
            value: 0.0,
            low: f32::NEG_INFINITY,
            high: f32::INFINITY,
            reason: 0,
            setting: [0; 35],
        }
    }

    fn named(mut self, setting: Setting) -> Self {
        // The last place stays 0.
        let letters = self
            .setting
            .split_last_mut()
            .map_or(&mut [][..], |(_, letters)| letters);
        for (place, letter) in letters.iter_mut().zip(setting.name.bytes()) {
            *place = letter as c_char;
        }
        self.index = setting.index.map_or(-1, |index| index as i32);
        self
    }

    /// A setting of the interface itself that is not above zero.
    pub(crate) fn not_positive(setting: impl Into<Setting>, value: f32) -> Self {
        Self::from(ConfigError::NotPositive {
            setting: setting.into(),
            value,
        })
    }

    /// A setting of the interface itself outside its limits.
    pub(crate) fn out_of_range(setting: impl Into<Setting>, value: f32, limits: [f32; 2]) -> Self {
        Self::from(ConfigError::OutOfRange {
            setting: setting.into(),
            value,
            limits,
        })
    }
}

impl From<Error> for Detail {
    fn from(error: Error) -> Self {
        Self::of(error)
    }
}

impl From<ConfigError> for Detail {
    fn from(error: ConfigError) -> Self {
        match error {
            ConfigError::NotFinite { setting, value } => Self {
                value,
                ..Self::of(Error::NotFinite)
            }
            .named(setting),
            ConfigError::NotPositive { setting, value } => Self {
                value,
                low: 0.0,
                ..Self::of(Error::NotPositive)
            }
            .named(setting),
            ConfigError::OutOfRange {
                setting,
                value,
                limits: [low, high],
            } => Self {
                value,
                low,
                high,
                ..Self::of(Error::OutOfRange)
            }
            .named(setting),
            ConfigError::Unstable { setting } => Self::of(Error::Unstable).named(setting),
            ConfigError::TooFast { setting, limit } => Self {
                high: limit,
                ..Self::of(Error::TooFast)
            }
            .named(setting),
            ConfigError::ParameterCount { found, expected } => Self {
                value: found as f32,
                high: expected as f32,
                ..Self::of(Error::ParameterCount)
            },
            ConfigError::Term { power, order } => Self {
                value: power as f32,
                high: order as f32,
                ..Self::of(Error::Term)
            },
            ConfigError::NoInput => Self::of(Error::NoInput),
            _ => Self::of(Error::Other),
        }
    }
}

impl From<LoopError> for Detail {
    fn from(error: LoopError) -> Self {
        match error {
            LoopError::Setting(error) | LoopError::Identifier(error) => error.into(),
            LoopError::Unit {
                acceleration,
                limit,
            } => Self {
                value: acceleration,
                high: limit,
                ..Self::of(Error::Unit)
            },
            LoopError::Model(reason) => Self {
                reason: crate::servo::reason_code(Some(reason)),
                ..Self::of(Error::ModelRefused)
            },
            LoopError::NotControlling => Self::of(Error::NotControlling),
            _ => Self::of(Error::Other),
        }
    }
}

impl From<Refused> for Detail {
    fn from(refused: Refused) -> Self {
        Self::of(match refused {
            Refused::Empty => Error::RecordEmpty,
            Refused::Damaged { .. } => Error::RecordDamaged,
            Refused::Version { .. } => Error::RecordVersion,
            Refused::Plant { .. } => Error::RecordPlant,
            Refused::Settings { .. } => Error::RecordSettings,
            _ => Error::Other,
        })
    }
}

#[cfg(test)]
mod tests {
    use core::ffi::CStr;

    use super::*;

    #[test]
    fn a_detail_names_the_setting() {
        let error = ConfigError::OutOfRange {
            setting: ("input_range", 1).into(),
            value: 2.0,
            limits: [3.0, 4.0],
        };
        let detail = Detail::from(error);
        assert_eq!((detail.error, detail.index), (Error::OutOfRange, 1));
        assert_eq!((detail.value, detail.low, detail.high), (2.0, 3.0, 4.0));
        let name: std::vec::Vec<u8> = detail.setting.iter().map(|letter| *letter as u8).collect();
        assert_eq!(CStr::from_bytes_until_nul(&name), Ok(c"input_range"));
    }
}
