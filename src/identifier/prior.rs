//! The prior of the settings, and as the recursion has it.

use crate::error::ConfigError;
use crate::estimation::terms::Parameter;
use crate::identifier::config::{Config, REACH, check_std};
use crate::identifier::plan::{Plan, Prior};
use crate::readout::s_plane::theta_in_trend_plane;
use crate::trends::TrendOperator;
use crate::trends::delay_line::acceptable;

/// Upper limit of the relative prior standard deviation; its square must fit f32.
const UNKNOWN: f32 = 1e8;

/// Prior standard deviation of a normalised parameter whose size by design is 1.
const PRIOR: f32 = 10.0;

/// The same of the constant of a drive that integrates: valves rest within a tenth of the range of
/// their command, and a drive may be three times as strong as its design size.
const OFFSET: f32 = 0.3;

impl<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize> Plan<T, M, N, I> {
    /// The prior of the settings.
    pub(super) fn first_prior(&self, config: &Config<M, N, I>) -> Result<Prior<N>, ConfigError> {
        let mut prior = match config.prior_std {
            Some(std) => self.prior_of(&config.initial, &std)?,
            None => Prior {
                theta: self.normalised(&config.initial, &config.known)?,
                std: self.default_std(),
            },
        };
        for (std, known) in prior.std.iter_mut().zip(&config.known) {
            if *known {
                *std = 0.0;
            }
        }
        Ok(prior)
    }

    /// The prior with this mean and these standard deviations, both in the user's units.
    ///
    /// # Errors
    /// [`ConfigError::OutOfRange`], naming `initial` or `prior_std`.
    pub(crate) fn prior_of(
        &self,
        theta: &[f32; N],
        std: &[f32; N],
    ) -> Result<Prior<N>, ConfigError> {
        check_std(std)?;
        let theta = self.normalised(theta, &std.map(|std| std == 0.0))?;
        let units = self.regressor.units();
        let std = core::array::from_fn(|j| bounded(std[j] / (units[j] * self.noise.prior)));
        Ok(Prior { theta, std })
    }

    /// Parameters of the s plane in the user's units as the recursion has them.
    fn normalised(&self, theta: &[f32; N], known: &[bool; N]) -> Result<[f32; N], ConfigError> {
        // No parameters are none in every plane.
        if *theta == [0.0; N] {
            return Ok(*theta);
        }
        let design = self.trends.design();
        let given = theta_in_trend_plane(theta, &self.structure, design, known);
        let units = self.regressor.units();
        let theta: [f32; N] = core::array::from_fn(|j| given[j] / units[j]);
        match theta.iter().position(|value| !acceptable(*value, REACH)) {
            None => Ok(theta),
            Some(index) => Err(ConfigError::OutOfRange {
                setting: ("initial", index).into(),
                value: given[index],
                limits: [-REACH * units[index], REACH * units[index]],
            }),
        }
    }

    /// Relative prior standard deviations where the configuration names none.
    fn default_std(&self) -> [f32; N] {
        let integrates = self.structure.integrators() > 0;
        self.structure.parameters().map(|column| {
            let std = match column {
                Parameter::Constant if integrates => OFFSET,
                _ => PRIOR,
            };
            bounded(std / self.noise.prior)
        })
    }
}

/// A relative standard deviation within its limit.
fn bounded(std: f32) -> f32 {
    if std < UNKNOWN { std } else { UNKNOWN }
}
