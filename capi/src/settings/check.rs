//! What a kind takes of the settings: each value that it would not use is refused, and each that
//! the core cannot tell by its name.

use trendid::ConfigError;
use trendid::error::Setting;

use super::{Hold, INPUTS_MAX, Settings};
use crate::detail::Detail;
use crate::identifier::PARAMETERS_MAX;

/// What a kind takes of the settings.
pub(crate) struct Takes {
    /// Inputs that the caller gives.
    pub inputs: usize,
    /// The first of them that may be the sign of the velocity.
    pub sign: usize,
    /// Longest delay in samples.
    pub delay: usize,
    pub parameters: usize,
    pub constant: bool,
    pub dead_zone: bool,
}

/// Bandwidth times sample time, as the core takes it.
const ANGLE: [f32; 2] = [1e-4, 1.0];

/// The only value of a setting that means nothing.
const fn only(value: f32) -> [f32; 2] {
    [value, value]
}

/// An error unless the value is within its limits; NaN is not.
fn within(name: &'static str, value: f32, [low, high]: [f32; 2]) -> Result<(), Detail> {
    match value >= low && value <= high {
        true => Ok(()),
        false => Err(Detail::out_of_range(name, value, [low, high])),
    }
}

/// The same of a place in a list.
fn within_at(
    name: &'static str,
    index: usize,
    value: f32,
    [low, high]: [f32; 2],
) -> Result<(), Detail> {
    match value >= low && value <= high {
        true => Ok(()),
        false => Err(Detail::out_of_range((name, index), value, [low, high])),
    }
}

impl Settings {
    /// An error unless a kind takes every value, as far as the core does not tell.
    pub(crate) fn check(&self, takes: &Takes) -> Result<(), Detail> {
        for input in 0..INPUTS_MAX {
            self.check_input(input, takes)?;
        }
        let follows = if self.memory == 0.0 { 0.0 } else { 1.0 };
        within("follow_changes", self.follow_changes as f32, [0.0, follows])?;
        self.check_friction(takes)?;
        self.check_prior(takes)?;
        if !takes.constant {
            within("offset_significance", self.offset_significance, only(2.0))?;
        }
        self.check_dead_zone(takes)
    }

    fn check_input(&self, input: usize, takes: &Takes) -> Result<(), Detail> {
        let of = |list: &[f32; INPUTS_MAX]| list.get(input).copied().unwrap_or(0.0);
        let hold = self.hold.get(input).copied().unwrap_or(0);
        let (holds, delays) = match input < takes.inputs {
            true => (Hold::Mean as i32, takes.delay as f32),
            false => (0, 0.0),
        };
        // A whole number: as one in f32 it might be another.
        if !(0..=holds).contains(&hold) {
            let limits = [0.0, holds as f32];
            return Err(Detail::out_of_range(("hold", input), hold as f32, limits));
        }
        within_at("delay", input, of(&self.delay), [0.0, delays])?;
        if input >= takes.inputs {
            within_at("input_range", input, of(&self.input_range), only(1.0))?;
            within_at("initial_input", input, of(&self.initial_input), only(0.0))?;
        }
        Ok(())
    }

    /// The input that is the sign of the velocity, or none.
    fn check_friction(&self, takes: &Takes) -> Result<(), Detail> {
        let input = self.friction_input;
        let limits = match takes.inputs > takes.sign {
            true => [takes.sign as f32, takes.inputs as f32 - 1.0],
            false => only(-1.0),
        };
        match input {
            -1 => Ok(()),
            _ => within("friction_input", input as f32, limits),
        }
    }

    /// What is known of the parameters.
    fn check_prior(&self, takes: &Takes) -> Result<(), Detail> {
        let (own, others) = (0..takes.parameters, takes.parameters..PARAMETERS_MAX);
        let bits = u32::try_from(takes.parameters).unwrap_or(0);
        if self.known.checked_shr(bits).unwrap_or(0) != 0 {
            let most = ((1_u32 << (bits % u32::BITS)) - 1) as f32;
            return Err(Detail::out_of_range(
                "known",
                self.known as f32,
                [0.0, most],
            ));
        }
        let at = |list: &[f32; PARAMETERS_MAX], k: usize| list.get(k).copied().unwrap_or(0.0);
        for parameter in others {
            within_at(
                "initial",
                parameter,
                at(&self.initial, parameter),
                only(0.0),
            )?;
            within_at(
                "prior_std",
                parameter,
                at(&self.prior_std, parameter),
                only(0.0),
            )?;
        }
        if self.prior_std == [0.0; PARAMETERS_MAX] {
            return Ok(());
        }
        for parameter in own {
            let std = at(&self.prior_std, parameter);
            if !(std > 0.0 && std.is_finite() || std == 0.0 && self.is_known(parameter)) {
                return Err(Detail::not_positive(("prior_std", parameter), std));
            }
        }
        Ok(())
    }

    fn check_dead_zone(&self, takes: &Takes) -> Result<(), Detail> {
        if !takes.dead_zone {
            within("dead_zone", self.dead_zone, only(0.0))?;
            within("dead_zone_max", self.dead_zone_max, only(0.0))?;
            return within("dead_zone_block", self.dead_zone_block as f32, only(0.0));
        }
        let (largest, _) = self.dead_zone_limits();
        // A quarter of a range that is none is told by the core, which names the range.
        if self.dead_zone_max != 0.0 && !(largest > 0.0 && largest.is_finite()) {
            return Err(Detail::not_positive("dead_zone_max", largest));
        }
        let most = if largest > 0.0 { largest } else { 0.0 };
        within("dead_zone", self.dead_zone, [0.0, most])
    }

    /// What a filter that cannot be made means: a bandwidth beyond what this sample time allows.
    pub(super) fn no_filter(&self, error: ConfigError) -> Detail {
        let named = matches!(
            error,
            ConfigError::NotPositive { setting, .. } if setting.name != "filter"
        );
        let limits = ANGLE.map(|angle| angle / self.sample_time);
        match within("bandwidth", self.bandwidth, limits) {
            Err(refused) if !named => refused,
            _ => error.into(),
        }
    }
}

/// The error with the place of an input as the caller counts them.
pub(crate) fn of_caller(mut error: ConfigError, own: &[Option<usize>]) -> ConfigError {
    if let ConfigError::NotFinite { setting, .. }
    | ConfigError::NotPositive { setting, .. }
    | ConfigError::OutOfRange { setting, .. } = &mut error
        && let Setting {
            name: "input_range" | "initial_input",
            index: Some(index),
        } = setting
        && let Some(Some(input)) = own.get(*index)
    {
        *index = *input;
    }
    error
}

#[cfg(test)]
mod tests {
    use super::*;
    use trendid::trends::{FilteredTrends, Scheme};
    use trendid::{Config, Identifier, Structure as CoreStructure};

    #[test]
    fn the_bandwidths_of_a_sample_time_are_those_of_the_core() {
        let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, 20.0).unwrap();
        let config = Config::new(CoreStructure::<2, 2, 1>::INTEGRATING, 5000.0, [1.0], 50.0);
        let refused = Identifier::<_, 2, 2>::try_new(&config, trends);
        let Err(ConfigError::OutOfRange { limits, .. }) = refused else {
            panic!("{refused:?}");
        };
        for (limit, angle) in limits.into_iter().zip(ANGLE) {
            assert!((limit * 0.001 / angle - 1.0).abs() < 1e-6);
        }
    }
}
