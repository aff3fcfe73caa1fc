//! The identifier: one call per sample from (u, y) to the current model.

mod change;
pub(crate) mod config;
pub(crate) mod delay_bank;
mod exceptions;
mod gaps;
mod gate;
pub mod inputs;
mod nominal;
pub(crate) mod outcome;
mod plan;
mod prior;
mod replan;
mod retune;
mod row;
mod sample;
pub(crate) mod servo;
mod signals;
mod standstill;
mod start;
mod state;
mod stuck;
mod times;
pub(crate) mod witness;

pub use config::Config;
pub use delay_bank::DelayBank;
pub use outcome::{Outcome, Refusal};
pub use servo::{Servo, ValveServo};

use crate::error::{ConfigError, check_finite};
use crate::estimation::rls::Estimator;
use crate::estimation::structure::Structure;
use crate::identifier::plan::Plan;
use crate::identifier::state::State;
use crate::identifier::witness::Witness;
use crate::math::sqrt;
use crate::model::evaluation::PredictionError;
use crate::readout::ReadOut;
use crate::readout::estimate::Estimate;
use crate::trends::TrendOperator;

/// Recursive identifier of a continuous-time model of order `M` with `N` parameters.
///
/// ```text
/// (u, y) -> trends T -> regressor -> estimator -> theta -> transfer function -> physical reading
///                                        `-> innovation and its sums
/// ```
///
/// | symbol | const parameter | meaning |
/// |---|---|---|
/// | m | `M` | order, 1..=4 |
/// | n | `N` | number of parameters |
/// | - | `I` | number of inputs |
/// | d | `D` | longest delay in samples, 0 costs nothing |
///
/// Guarantees: `update` never panics, allocates, blocks or divides by zero, uses
/// only + - x /, and refuses what is not finite before it enters any buffer.
///
/// # Examples
/// ```
/// use trendid::{Config, Identifier, Structure};
/// use trendid::trends::{FilteredTrends, Scheme};
/// let trends = FilteredTrends::try_new(Scheme::Tustin, 0.001, [25.0; 2])?;
/// let config = Config::new(Structure::<2, 2, 1>::INTEGRATING, 25.0, [1.0], 1.0);
/// let mut identifier: Identifier<_, 2, 2> = Identifier::try_new(&config, trends)?;
/// // dv/dt = -10 v + 50 u, dy/dt = v: the simplest drive, u = +-1.
/// let (mut y, mut v) = (0.0_f32, 0.0_f32);
/// for k in 0..2000 {
///     let u = if (k / 100) % 2 == 0 { 1.0 } else { -1.0 };
///     let _ = identifier.update(u, y);
///     let decay = (-0.01_f32).exp();
///     let target = 5.0 * u;
///     y += 0.001 * target + (v - target) * (1.0 - decay) * 0.1;
///     v = target + (v - target) * decay;
/// }
/// let model = identifier.estimate().transfer_function();
/// assert!((model.a[1] - 10.0).abs() < 0.01);
/// assert!((model.b[0][0] - 50.0).abs() < 0.05);
/// # Ok::<(), trendid::ConfigError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Identifier<
    T: TrendOperator<M>,
    const M: usize,
    const N: usize,
    const I: usize = 1,
    const D: usize = 0,
> {
    plan: Plan<T, M, N, I>,
    state: State<T, M, N, I, D>,
}

impl<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize, const D: usize>
    Identifier<T, M, N, I, D>
{
    /// An identifier at rest, with the trends of `trends`.
    ///
    /// # Errors
    /// The first value of `config` that cannot work, as a [`ConfigError`] that names it.
    pub fn try_new(config: &Config<M, N, I>, trends: T) -> Result<Self, ConfigError> {
        let plan = Plan::new(config, trends, D)?;
        let state = State::new(&plan);
        Ok(Self { plan, state })
    }

    /// Begins anew with other settings and other trends, in the place of this identifier: as
    /// [`Identifier::try_new`], with less stack. Not for the 1 ms path.
    ///
    /// # Errors
    /// As of [`Identifier::try_new`]; nothing is changed then.
    pub fn reconfigure(&mut self, config: &Config<M, N, I>, trends: T) -> Result<(), ConfigError> {
        self.plan = Plan::new(config, trends, D)?;
        self.reset();
        Ok(())
    }

    /// Takes all inputs u(k), in force from now until the next sample, and the output y(k).
    ///
    /// Cost: see the table of instruction counts.
    #[inline]
    pub fn update_inputs(&mut self, u: [f32; I], y: f32) -> Outcome {
        self.state.update(&self.plan, u, y, &mut ())
    }

    /// As [`Identifier::update_inputs`], with somebody who sees its trends and its row.
    #[inline(always)]
    pub(crate) fn update_seen(
        &mut self,
        u: [f32; I],
        y: f32,
        witness: &mut impl Witness<M, N, I>,
    ) -> Outcome {
        self.state.update(&self.plan, u, y, witness)
    }

    /// Back to the identifier as constructed, in every field: the filter, prior, estimate and
    /// signals, and it adapts.
    pub fn reset(&mut self) {
        self.plan.restore();
        self.state = State::new(&self.plan);
    }

    /// Lets `samples` sample times pass without a measurement, under the newest inputs.
    ///
    /// The model bridges a short gap, up to 5 over the bandwidth once it is known; after a longer
    /// one the trends begin anew with the next sample, as by [`Identifier::restart_trends`].
    pub fn skip(&mut self, samples: u32) {
        self.skip_seen(samples, &mut ());
    }

    /// As [`Identifier::skip`], with somebody who sees the trends.
    pub(crate) fn skip_seen(&mut self, samples: u32, witness: &mut impl Witness<M, N, I>) {
        self.state.skip_all(&self.plan, samples, witness);
    }

    /// How many samples of y were replaced by their prediction: implausible, refused, skipped.
    pub const fn replaced(&self) -> u32 {
        self.state.replaced
    }

    /// How many changes of the drive were found and followed: see [`Config::follow_changes`].
    pub const fn changes(&self) -> u32 {
        self.state.changes
    }

    /// Forgets the signals, after a long gap, and holds the estimate until the filter did so, too.
    pub fn restart_trends(&mut self) {
        self.state.restart(&self.plan);
    }

    /// Begins again from an estimate with its standard deviations, both in the user's units.
    ///
    /// # Errors
    /// [`ConfigError::NotFinite`], [`ConfigError::OutOfRange`]; nothing is changed then.
    pub fn warm_start(&mut self, theta: [f32; N], std: [f32; N]) -> Result<(), ConfigError> {
        for (index, value) in theta.iter().copied().enumerate() {
            check_finite(("initial", index), value)?;
        }
        let prior = self.plan.prior_of(&theta, &std)?;
        self.state.warm_start(&self.plan, prior);
        Ok(())
    }

    /// Adapts (`true`, as constructed) or holds the estimate; predictions go on.
    pub fn adapt(&mut self, on: bool) {
        self.state.adapt(on);
    }

    /// The model found, with its uncertainty: noise bias taken out, an insignificant constant
    /// withdrawn.
    ///
    /// Cost: see the table of instruction counts; for the loop that reports, not for every sample.
    pub fn estimate(&self) -> Estimate<M, N, I> {
        self.read_out().estimate()
    }

    /// The parameters of [`Identifier::estimate`] alone, at about a sixth of its cost: see the
    /// table of instruction counts.
    pub fn theta(&self) -> [f32; N] {
        self.read_out().theta()
    }

    /// The recursion without the correction of the noise bias, in the user's units.
    ///
    /// Its covariance is that of a white residual.
    pub fn recursion(&self) -> Estimate<M, N, I> {
        self.read_out().recursion()
    }

    pub(crate) fn read_out(&self) -> ReadOut<'_, M, N, I> {
        let Plan {
            structure,
            trends,
            regressor,
            bandwidth,
            noise,
            ..
        } = &self.plan;
        ReadOut {
            structure,
            design: trends.design(),
            regressor,
            bandwidth: *bandwidth,
            prior_noise: noise.prior,
            significance: self.plan.offset_significance,
            estimator: &self.state.estimator,
            forgetting: &self.state.forgetting,
            turns: self.plan.turns(),
            delay_parts: &self.plan.inputs.delay_parts,
            former: self.state.change.former(self.plan.forgetting),
            position: self.state.position(),
            noise: &self.state.noise,
            beginning: &self.state.beginning,
            start_error: &self.state.start_error,
        }
    }

    /// Standard deviation of the innovation in the unit of y, `None` until there are more samples
    /// than parameters.
    pub fn noise_std(&self) -> Option<f32> {
        let regressor = &self.plan.regressor;
        let beta = regressor.feedthrough(self.state.estimator.theta());
        let variance = self.state.estimator.noise_variance()?;
        Some(sqrt(variance) / beta)
    }

    /// Prediction of the newest y from the samples before it, in the unit of y.
    pub const fn prediction(&self) -> f32 {
        self.state.prediction
    }

    /// Sums of the squared and absolute innovations so far (11).
    pub const fn prediction_error(&self) -> PredictionError {
        self.state.errors
    }

    /// The estimator, in normalised quantities.
    pub const fn estimator(&self) -> &Estimator<N> {
        &self.state.estimator
    }

    /// lambda.
    pub(crate) const fn forgetting(&self) -> f32 {
        self.plan.forgetting
    }

    /// The structure of the model.
    pub const fn structure(&self) -> &Structure<M, N, I> {
        &self.plan.structure
    }

    /// The trend operator.
    pub const fn trends(&self) -> &T {
        &self.plan.trends
    }
}

impl<T: TrendOperator<M>, const M: usize, const N: usize, const D: usize>
    Identifier<T, M, N, 1, D>
{
    /// Takes u(k), in force from now until the next sample, and y(k).
    #[inline]
    pub fn update(&mut self, u: f32, y: f32) -> Outcome {
        self.update_inputs([u], y)
    }
}

#[cfg(test)]
mod tests;
