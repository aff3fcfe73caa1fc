//! The plan of an identifier: everything that follows from its configuration and its trends.
//!
//! No sample changes it. A change of the filter does, and a reset undoes that.

use crate::error::ConfigError;
use crate::estimation::regressor::Regressor;
use crate::estimation::structure::Structure;
use crate::estimation::terms::Parameter;
use crate::identifier::change::Shares;
use crate::identifier::config::{Config, REACH, check_std};
use crate::readout::s_plane::theta_in_trend_plane;
use crate::trends::delay_line::acceptable;
use crate::trends::filter::settling_time;
use crate::trends::{Form, Hold, NoiseGain, TrendOperator};

/// The drive moves where the trends of y exceed this many standard deviations of their noise.
const MOVES: f32 = 5.0;

/// Least variance of the noise over the expected one.
const LEAST_NOISE: f32 = 0.02 * 0.02;

/// Upper limit of the relative prior standard deviation; its square must fit f32.
const UNKNOWN: f32 = 1e8;

/// Largest bandwidth times sample time with an innovation gate: beyond, the third difference of the motion itself is as
/// large as a spike, and the predictions of a rough model would replace good samples.
const FINE: f32 = 0.1;

/// Prior standard deviation of a normalised parameter whose size by design is 1.
const PRIOR: f32 = 10.0;

/// The same of the constant of a drive that integrates: valves rest within some percent of their command.
const OFFSET: f32 = 0.03;

/// Mean and standard deviation of the parameters before the first sample, normalised.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Prior<const N: usize> {
    pub(crate) theta: [f32; N],
    /// Relative to the noise of psi.
    pub(crate) std: [f32; N],
}

/// Everything that a sample uses and does not change.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Plan<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize> {
    /// The trends in use.
    pub(crate) trends: T,
    /// The trends of the construction while others are in use.
    configured: Option<T>,
    pub(crate) structure: Structure<M, N, I>,
    pub(crate) regressor: Regressor<M, N>,
    /// How the output enters its trends.
    pub(crate) output_form: Form,
    pub(crate) prior: Prior<N>,
    /// lambda.
    pub(crate) forgetting: f32,
    pub(crate) holds: [Hold; I],
    pub(crate) delays: [usize; I],
    pub(crate) delay_parts: [f32; I],
    pub(crate) initial_inputs: [f32; I],
    pub(crate) input_limit: [f32; I],
    pub(crate) output_limit: f32,
    /// Standard deviation of psi from the noise expected on the output.
    pub(crate) prior_noise: f32,
    pub(crate) bandwidth: f32,
    pub(crate) forgets: bool,
    /// 1 / variance of each entry of phi under white noise of variance 1 on y; 0 where there is none.
    noise_weights: [f32; N],
    pub(crate) offset_significance: f32,
    /// Whether implausible samples of y are replaced.
    pub(crate) has_gate: bool,
    /// A variance of y that is always allowed for: that of a fiftieth of the expected noise.
    pub(crate) least_noise: f32,
    /// For how many samples the innovation gate stays open after a start, and after a lasting change.
    pub(crate) gate_open: u32,
    pub(crate) gate_pause: u32,
    /// Whether standstill can contradict the model: behind an integrator every input moves the drive.
    pub(crate) can_stand: bool,
    /// Samples after which a standstill is certain, those after which the trends have settled behind one, and those for which
    /// they carry a step of y.
    pub(crate) certain: u32,
    pub(crate) settled: u32,
    pub(crate) after_step: u32,
    /// Samples without y that the model bridges; after more the trends begin anew.
    pub(crate) longest_gap: u32,
    /// Samples between the first one and the first estimate.
    pub(crate) warm_up: u32,
    /// Whether a change of the drive is looked for, and how: shares of a sample, samples for which rows are left out behind
    /// one, samples without a look at the start and behind one.
    pub(crate) follows_changes: bool,
    pub(crate) change_shares: Shares,
    pub(crate) change_settling: u32,
    pub(crate) change_blind: u32,
    /// The input that is the sign of the velocity.
    friction_input: Option<usize>,
}

impl<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize> Plan<T, M, N, I> {
    /// The plan for `config` with `trends`; `capacity` is the length D of the delay lines.
    pub(crate) fn new(
        config: &Config<M, N, I>,
        trends: T,
        capacity: usize,
    ) -> Result<Self, ConfigError> {
        let design = trends.design();
        let sample_time = design.sample_time;
        config.check(sample_time, capacity)?;
        let regressor = Regressor::new(
            &config.structure,
            design,
            config.bandwidth,
            &config.input_range,
            config.output_range,
        );
        let prior_noise = regressor.noise(config.output_noise);
        let angle = config.bandwidth * sample_time;
        let mut plan = Self {
            configured: None,
            structure: config.structure,
            regressor,
            noise_weights: noise_weights(&regressor, &design.noise_gain),
            output_form: output_form(&config.structure),
            prior: Prior {
                theta: [0.0; N],
                std: [0.0; N],
            },
            forgetting: config
                .memory
                .map_or(1.0, |memory| 1.0 - sample_time / memory),
            holds: config.holds,
            delays: config.delays,
            delay_parts: config.delay_parts,
            initial_inputs: config.initial_input,
            input_limit: config.input_range.map(|range| REACH * range),
            output_limit: REACH * config.output_range,
            prior_noise,
            bandwidth: config.bandwidth,
            forgets: config.memory.is_some(),
            offset_significance: config.offset_significance,
            has_gate: config.memory.is_some()
                && angle <= FINE
                && design.filter.is_some()
                && smooth(&config.structure),
            least_noise: LEAST_NOISE * config.output_noise * config.output_noise,
            gate_open: (10.0 / angle) as u32,
            gate_pause: (0.5 / angle) as u32,
            can_stand: config.structure.integrators() > 0,
            certain: (1.0 / angle) as u32 + 10,
            settled: match config.structure.initial_state() {
                true => (12.0 / angle) as u32,
                false => (3.0 / (1.0 - design.slow_mode)).max(12.0 / angle) as u32,
            },
            after_step: (2.0 / angle) as u32,
            longest_gap: (5.0 / angle) as u32,
            warm_up: design.warm_up.max((config.settling / sample_time) as u32),
            follows_changes: config.follow_changes && config.memory.is_some(),
            change_shares: Shares::new(angle, LEAST_NOISE * prior_noise * prior_noise),
            change_settling: (settling_time(config.bandwidth) / sample_time) as u32 + N as u32,
            change_blind: (10.0 / angle) as u32,
            friction_input: config.friction_input,
            // Last: the design above is theirs.
            trends,
        };
        plan.prior = plan.first_prior(config)?;
        Ok(plan)
    }

    /// The prior of the settings.
    fn first_prior(&self, config: &Config<M, N, I>) -> Result<Prior<N>, ConfigError> {
        match config.prior_std {
            Some(std) => self.prior_of(&config.initial, &std),
            None => Ok(Prior {
                theta: self.normalised(&config.initial)?,
                std: self.default_std(),
            }),
        }
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
        let theta = self.normalised(theta)?;
        let units = self.regressor.units();
        let std = core::array::from_fn(|j| bounded(std[j] / (units[j] * self.prior_noise)));
        Ok(Prior { theta, std })
    }

    /// Parameters of the s plane in the user's units as the recursion has them.
    fn normalised(&self, theta: &[f32; N]) -> Result<[f32; N], ConfigError> {
        // No parameters are none in every plane.
        if *theta == [0.0; N] {
            return Ok(*theta);
        }
        let given = theta_in_trend_plane(theta, &self.structure, self.trends.design());
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
            bounded(std / self.prior_noise)
        })
    }

    /// Whether the trends of y exceed their noise; where they do not, a row holds no information on the drive.
    ///
    /// ```text
    /// moves  <=>  sum over the columns of y: phi_j^2 / M_jj > 25 sigma_y^2        sigma_y^2 = S / (20 n)
    /// ```
    ///
    /// `noise` is sigma_y^2, -1 as long as it is not known. True then, and for trends without a known noise gain.
    /// Cost: 20 instructions.
    #[inline(always)]
    pub(crate) fn moves(&self, phi: &[f32; N], noise: f32) -> bool {
        let mut power = 0.0;
        let mut known = 0.0;
        for (x, weight) in phi.iter().zip(&self.noise_weights) {
            power += x * x * weight;
            known += weight;
        }
        power > MOVES * MOVES * noise || known == 0.0
    }

    /// Whether friction may hold the axis: its input is 0.
    #[inline(always)]
    pub(crate) fn sticks(&self, u: &[f32; I]) -> bool {
        let velocity = self.friction_input.and_then(|input| u.get(input));
        self.can_stand && velocity.is_some_and(|sign| *sign == 0.0)
    }

    /// Whether `trends` differ from those in use in their numerators only: every signal then is already what it would be.
    pub(crate) fn same_filter(&self, trends: &T) -> bool {
        let (old, new) = (self.trends.design(), trends.design());
        new.filter.is_some() && new.filter == old.filter && new.feedthrough == old.feedthrough
    }

    /// Goes on with other trends; those of the construction are kept.
    pub(crate) fn retune(&mut self, trends: T) {
        if self.configured.is_none() {
            self.configured = Some(self.trends.clone());
        }
        self.set_trends(trends);
    }

    /// Back to the plan as constructed.
    pub(crate) fn restore(&mut self) {
        if let Some(trends) = self.configured.take() {
            self.set_trends(trends);
        }
    }

    fn set_trends(&mut self, trends: T) {
        self.regressor.set_feedthrough(&trends.design().feedthrough);
        self.noise_weights = noise_weights(&self.regressor, &trends.design().noise_gain);
        self.trends = trends;
    }
}

/// Behind an integrator y enters its trends by increments.
fn output_form<const M: usize, const N: usize, const I: usize>(
    structure: &Structure<M, N, I>,
) -> Form {
    match structure.integrators() {
        0 => Form::Position,
        _ => Form::Increment,
    }
}

/// Whether every input acts at least two integrations behind: then the velocity has no steps, and a step of y is no motion.
fn smooth<const M: usize, const N: usize, const I: usize>(structure: &Structure<M, N, I>) -> bool {
    let inputs = structure.inputs();
    inputs.iter().all(|terms| !terms.contains(M - 1))
}

/// 1 / M_jj of the columns of y, 0 of the others.
fn noise_weights<const M: usize, const N: usize>(
    regressor: &Regressor<M, N>,
    gain: &NoiseGain<M>,
) -> [f32; N] {
    let (moments, ..) = regressor.noise_moments(gain);
    core::array::from_fn(|j| {
        let variance = moments[j][j];
        if variance > 0.0 { 1.0 / variance } else { 0.0 }
    })
}

/// A relative standard deviation within its limit.
fn bounded(std: f32) -> f32 {
    if std < UNKNOWN { std } else { UNKNOWN }
}
