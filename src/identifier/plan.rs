//! The plan of an identifier: everything that follows from its configuration and its trends.
//!
//! No sample changes it. A change of the filter does, and a reset undoes that.

use crate::error::ConfigError;
use crate::estimation::regressor::Regressor;
use crate::estimation::structure::Structure;
use crate::estimation::terms::Parameter;
use crate::identifier::change::Shares;
use crate::identifier::config::{Config, REACH};
use crate::identifier::times::{Times, kicked};
use crate::trends::{Form, Hold, TrendOperator};

/// The drive moves where the trends of y exceed this many standard deviations of their noise.
const MOVES: f32 = 5.0;

/// Least variance of the noise over the expected one.
const LEAST_NOISE: f32 = 0.02 * 0.02;

/// Largest bandwidth times sample time with an innovation gate: beyond, the third difference of the
/// motion itself is as large as a spike, and the predictions of a rough model would replace good
/// samples.
const FINE: f32 = 0.1;

/// Mean and standard deviation of the parameters before the first sample, normalised.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Prior<const N: usize> {
    pub(crate) theta: [f32; N],
    /// Relative to the noise of psi.
    pub(crate) std: [f32; N],
}

/// How each input comes in.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct InputPlan<const I: usize> {
    pub(crate) holds: [Hold; I],
    /// Whole samples, and the part of one beside them.
    pub(crate) delays: [usize; I],
    pub(crate) delay_parts: [f32; I],
    /// Its value in equilibrium before the first sample.
    pub(crate) initial: [f32; I],
    /// Beyond it a sample is refused.
    pub(crate) limit: [f32; I],
}

/// What is compared with the noise of y.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NoisePlan<const N: usize> {
    /// Standard deviation of psi from the noise expected on the output.
    pub(crate) prior: f32,
    /// A variance of y that is always allowed for: that of a fiftieth of the expected noise.
    pub(crate) least: f32,
    /// Where half a digit of y in f32 is as large as the expected noise.
    pub(crate) coarse: f32,
    /// A variance of y below which no sample is implausible.
    pub(crate) gate: f32,
    /// 1 / 25 times the variance of each entry of phi under white noise of variance 1 on y; 0 where
    /// there is none.
    weights: [f32; N],
    /// Whether there is none in any.
    always_moves: bool,
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
    pub(crate) inputs: InputPlan<I>,
    pub(crate) output_limit: f32,
    pub(crate) noise: NoisePlan<N>,
    pub(crate) bandwidth: f32,
    pub(crate) forgets: bool,
    pub(crate) offset_significance: f32,
    /// Whether implausible samples of y are replaced.
    pub(crate) has_gate: bool,
    /// Whether standstill can contradict the model: behind an integrator every input moves the
    /// drive.
    pub(crate) can_stand: bool,
    /// How long things last.
    pub(crate) times: Times,
    /// Samples between the first one and the first estimate.
    pub(crate) warm_up: u32,
    /// Whether a change of the drive is looked for, and with which shares of a sample.
    pub(crate) follows_changes: bool,
    pub(crate) change_shares: Shares,
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
        let mut plan = Self::unweighed(config, trends, capacity)?;
        plan.expect_noise(config)?;
        Ok(plan)
    }

    /// The same without [`Plan::expect_noise`], which must follow.
    pub(crate) fn unweighed(
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
        let angle = config.bandwidth * sample_time;
        let settling = (config.settling / sample_time) as u32;
        let warm_up = (design.warm_up.max(settling)).max(kicked(config, angle));
        let mut times = Times::new(config, design, smooth(config));
        times.begin_anew(design, warm_up);
        Ok(Self {
            configured: None,
            structure: config.structure,
            regressor,
            output_form: output_form(&config.structure),
            prior: Prior {
                theta: [0.0; N],
                std: [0.0; N],
            },
            forgetting: config
                .memory
                .map_or(1.0, |memory| 1.0 - sample_time / memory),
            inputs: InputPlan {
                holds: config.holds,
                delays: config.delays,
                delay_parts: config.delay_parts,
                initial: config.initial_input,
                limit: config.input_range.map(|range| REACH * range),
            },
            output_limit: REACH * config.output_range,
            noise: NoisePlan {
                prior: 0.0,
                least: LEAST_NOISE * config.output_noise * config.output_noise,
                coarse: config.output_noise * (2.0 / f32::EPSILON),
                gate: match config.memory {
                    Some(_) => 0.0,
                    None => config.output_noise * config.output_noise,
                },
                weights: [0.0; N],
                always_moves: true,
            },
            bandwidth: config.bandwidth,
            forgets: config.memory.is_some(),
            offset_significance: config.offset_significance,
            has_gate: angle <= FINE && design.filter.is_some() && smooth(config),
            can_stand: config.structure.integrators() > 0,
            times,
            warm_up,
            follows_changes: config.follow_changes && config.memory.is_some(),
            change_shares: Shares::NONE,
            friction_input: config.friction_input,
            // Last: the design above is theirs.
            trends,
        })
    }

    /// What follows from the noise that is expected: the prior and what is compared with noise.
    ///
    /// # Errors
    /// [`ConfigError::OutOfRange`], naming `initial` or `prior_std`.
    pub(crate) fn expect_noise(&mut self, config: &Config<M, N, I>) -> Result<(), ConfigError> {
        self.noise.prior = self.regressor.noise(config.output_noise);
        let angle = config.bandwidth * self.trends.design().sample_time;
        let least = LEAST_NOISE * self.noise.prior * self.noise.prior;
        self.change_shares = Shares::new(angle, least);
        self.weigh_noise();
        self.prior = self.first_prior(config)?;
        Ok(())
    }

    /// Whether the trends of y exceed their noise; where they do not, a row holds no information on
    /// the drive.
    ///
    /// ```text
    /// moves  <=>  sum over the columns of y: phi_j^2 / M_jj > 25 sigma_y^2        sigma_y^2 = S / (20 n)
    /// ```
    ///
    /// `noise` is sigma_y^2, -1 as long as it is not known. True then, and for trends without a
    /// known noise gain. Cost: 10 instructions.
    #[inline(always)]
    pub(crate) fn moves(&self, phi: &[f32; N], noise: f32) -> bool {
        // Those of y are the first parameters, at most M.
        let mut power = 0.0;
        for (x, weight) in phi.iter().zip(&self.noise.weights).take(M) {
            power += x * x * weight;
        }
        power > noise || self.noise.always_moves
    }

    /// Whether friction may hold the axis: its input is 0.
    #[inline(always)]
    pub(crate) fn sticks(&self, u: &[f32; I]) -> bool {
        let velocity = self.friction_input.and_then(|input| u.get(input));
        self.can_stand && velocity.is_some_and(|sign| *sign == 0.0)
    }

    /// The input that is the sign of the velocity.
    pub(crate) const fn friction_input(&self) -> Option<usize> {
        self.friction_input
    }

    /// Whether an input is the sign of the velocity.
    pub(crate) const fn turns(&self) -> bool {
        self.friction_input.is_some()
    }

    /// Whether `trends` differ from those in use in their numerators only: every signal then is
    /// already what it would be.
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
        let design = trends.design();
        self.regressor.set_feedthrough(&design.feedthrough);
        self.times.begin_anew(design, self.warm_up);
        self.trends = trends;
        self.weigh_noise();
    }

    /// By what the trends of y are compared with its noise.
    fn weigh_noise(&mut self) {
        let (moments, ..) = (self.regressor).noise_moments::<0>(&self.trends.design().noise_gain);
        self.noise.weights = core::array::from_fn(|j| {
            let moment = moments.get(j).and_then(|row| row.get(j));
            let variance = MOVES * MOVES * moment.copied().unwrap_or(0.0);
            if variance > 0.0 { 1.0 / variance } else { 0.0 }
        });
        self.noise.always_moves = self.noise.weights.iter().all(|weight| *weight == 0.0);
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

/// Whether every input acts at least two integrations behind, its b_(m-1) known to be 0, also by
/// its standard deviation, if there is one: then the velocity has no steps, and a step of y is no
/// motion.
fn smooth<const M: usize, const N: usize, const I: usize>(config: &Config<M, N, I>) -> bool {
    let absent = |j: usize| {
        let known = config.known[j] || config.prior_std.is_some_and(|std| std[j] == 0.0);
        known && config.initial[j] == 0.0
    };
    let parameters = config.structure.parameters();
    (parameters.iter().enumerate()).all(|(j, parameter)| {
        !matches!(parameter, Parameter::Input { power, .. } if power + 1 == M) || absent(j)
    })
}

#[cfg(test)]
mod tests;
