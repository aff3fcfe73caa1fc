//! What the core refuses, by the names and the numbers that the caller gave.

use trendid::ConfigError;
use trendid::servo::Error as LoopError;

use super::settings::LoopSettings;
use crate::detail::Detail;

/// Settings of the core that have another name here.
const NAMES: [(&str, &str); 7] = [
    ("travel.min", "travel_min"),
    ("motion.velocity", "velocity"),
    ("motion.acceleration", "acceleration"),
    ("motion.jerk", "jerk"),
    ("excitation.amplitude", "excitation"),
    ("input_range", "excitation"),
    ("supervision.time_limit", "time_limit"),
];

impl LoopSettings {
    /// What was refused where a loop is made of these settings.
    pub(super) fn refused(&self, error: LoopError) -> Detail {
        let (LoopError::Setting(error) | LoopError::Identifier(error)) = error else {
            return error.into();
        };
        let mut error = error;
        if let ConfigError::OutOfRange {
            setting,
            value,
            limits,
        } = &error
            && let Some(detail) = self.derived(setting.name, *value, *limits)
        {
            return detail;
        }
        if let ConfigError::NotFinite { setting, .. }
        | ConfigError::NotPositive { setting, .. }
        | ConfigError::OutOfRange { setting, .. } = &mut error
            && let Some((_, name)) = NAMES.iter().find(|(of_core, _)| *of_core == setting.name)
        {
            *setting = (*name).into();
        }
        error.into()
    }

    /// A quantity that follows from a setting and is refused: the setting, with its own limits.
    fn derived(&self, name: &str, value: f32, [low, high]: [f32; 2]) -> Option<Detail> {
        let (setting, own, limits) = match name {
            // In proportion to 1/bandwidth, which is in proportion to the sample time itself where
            // nothing is said.
            "supervision.validation_time" if self.bandwidth != 0.0 => {
                let least = self.bandwidth * (value / high);
                ("bandwidth", self.bandwidth, [least, f32::MAX])
            }
            "supervision.validation_time" => {
                let most = self.sample_time * (high / value);
                ("sample_time", self.sample_time, [0.0, most])
            }
            // In proportion to the travel.
            "output_range" => {
                let length = self.travel_max - self.travel_min;
                let end = |limit: f32| self.travel_min + length * (limit / value);
                ("travel_max", self.travel_max, [end(low), end(high)])
            }
            _ => return None,
        };
        Some(Detail::out_of_range(setting, own, limits))
    }
}
