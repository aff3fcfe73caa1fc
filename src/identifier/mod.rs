//! The facade: one call per sample from (u, y) to the current model.

pub(crate) mod config;
pub(crate) mod delay_bank;
pub(crate) mod inputs;
pub(crate) mod outcome;

use crate::error::{ConfigError, positive};
use crate::estimation::noise_level::NoiseLevel;
use crate::estimation::regressor::Regressor;
use crate::estimation::rls::Estimator;
use crate::estimation::structure::{Column, Structure, place};
use crate::identifier::config::{Config, REACH, check_std};
use crate::identifier::outcome::{Outcome, Refusal};
use crate::math::sqrt;
use crate::model::evaluation::Quality;
use crate::model::physical::{Physical, second_order_std};
use crate::model::transfer_function::TransferFunction;
use crate::readout::s_plane::{continuous, continuous_readout, sampled};
use crate::readout::{Evidence, Readout, estimate, in_band, read_out};
use crate::trends::delay_line::{DelayLine, acceptable};
use crate::trends::{Hold, NoiseGain, TrendOperator};

/// Where a covariance without a floor stops, relative to the noise variance.
const WIND_UP: f32 = 1e12;

/// What a filter worth replacing has told is less certain than it says: its covariance counts this many times.
const DISCOUNT: f32 = 5.0;

/// A prior standard deviation of more than this many times the noise says no more than this one: its square must fit.
const UNKNOWN: f32 = 1e8;

/// Prior standard deviation of a normalised parameter whose size by design is 1.
const PRIOR: f32 = 10.0;

/// The same of the constant of a drive that integrates: valves rest within some percent of their command.
const OFFSET: f32 = 0.03;

/// Recursive identifier of a continuous-time model of order `M` with `N` parameters.
///
/// ```text
/// (u, y) -> trends T -> regressor -> estimator -> theta -> transfer function -> physical reading
///                                        `-> innovation, IQ, IV
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
/// use trendid::{Config, FilteredTrends, Identifier, Scheme, Structure};
/// let trends = FilteredTrends::try_new(Scheme::Tustin, 0.001, [25.0; 2])?;
/// let config = Config::new(Structure::<2, 2, 1>::integrating(), 25.0, [1.0], 1.0);
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
/// let model = identifier.transfer_function();
/// assert!((model.a[1] - 10.0).abs() < 0.01);
/// assert!((model.b[0][0] - 50.0).abs() < 0.05);
/// # Ok::<(), trendid::ConfigError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Identifier<
    T: TrendOperator<M>,
    const M: usize,
    const N: usize,
    const I: usize = 1,
    const D: usize = 0,
> {
    trends: T,
    structure: Structure<M, N, I>,
    regressor: Regressor<M, N>,
    estimator: Estimator<N>,
    start: Estimator<N>,
    holds: [Hold; I],
    delays: [usize; I],
    rest: [f32; I],
    input_limit: [f32; I],
    output_limit: f32,
    prior_noise: f32,
    bandwidth: f32,
    noise_gain: NoiseGain<M>,
    noise: NoiseLevel,
    decay: f32,
    start_trend: f32,
    forgets: bool,
    /// 1/pull, and the share per sample of the way back to the trusted estimate, over the ceiling.
    ceiling: f32,
    fall_back: f32,
    doubt: f32,
    trusted: [f32; N],
    has_trusted: bool,
    turn: usize,
    output: T::Memory,
    inputs: [T::Memory; I],
    constant: T::Memory,
    lines: [DelayLine<D>; I],
    reference: f32,
    before: f32,
    prediction: f32,
    quality: Quality,
    warm_up: u32,
    remaining: u32,
    begun: bool,
    adapting: bool,
}

impl<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize, const D: usize>
    Identifier<T, M, N, I, D>
{
    /// An identifier at rest, with the trends of `trends`.
    ///
    /// # Errors
    /// The first value of `config` that cannot work, as a [`ConfigError`] that names it.
    pub fn try_new(config: &Config<M, N, I>, trends: T) -> Result<Self, ConfigError> {
        let sample_time = trends.sample_time();
        config.check(sample_time, D)?;
        let regressor = Regressor::new(
            &config.structure,
            &trends,
            config.bandwidth,
            &config.input_range,
            config.output_range,
        );
        let prior_noise = regressor.noise(config.output_noise);
        let forgetting = match config.memory {
            Some(memory) => 1.0 - sample_time / memory,
            None => 1.0,
        };
        let initial = sampled(&config.initial, &config.structure, &trends);
        let (theta, std) = prior(
            &config.structure,
            &regressor,
            prior_noise,
            &initial,
            &config.prior_std,
        )?;
        let start = Estimator::new(theta, std, forgetting);
        let ceiling = if config.pull > 1.0 / WIND_UP {
            1.0 / config.pull
        } else {
            WIND_UP
        };
        let settling = (config.settling / sample_time) as u32;
        let warm_up = trends.warm_up().max(settling);
        Ok(Self {
            trends,
            structure: config.structure,
            regressor,
            estimator: start,
            start,
            holds: config.holds,
            delays: config.delays,
            rest: config.rest,
            input_limit: config.input_range.map(|range| REACH * range),
            output_limit: REACH * config.output_range,
            prior_noise,
            bandwidth: config.bandwidth,
            noise_gain: trends.noise_gain(),
            noise: NoiseLevel::new(forgetting),
            decay: trends.decay(),
            start_trend: 0.0,
            forgets: config.memory.is_some(),
            ceiling,
            fall_back: (1.0 - forgetting) * N as f32 / ceiling,
            doubt: config.doubt,
            has_trusted: false,
            trusted: theta,
            turn: 0,
            output: T::EMPTY,
            inputs: [T::EMPTY; I],
            constant: T::EMPTY,
            lines: [DelayLine::new(); I],
            reference: 0.0,
            before: 0.0,
            prediction: 0.0,
            quality: Quality::new(),
            warm_up,
            remaining: warm_up,
            begun: false,
            adapting: true,
        })
    }

    /// Takes all inputs u(k), in force from now until the next sample, and the output y(k).
    ///
    /// Cost: see the table of instruction counts.
    #[inline]
    pub fn update_inputs(&mut self, u: [f32; I], y: f32) -> Outcome {
        if !acceptable(y, self.output_limit) {
            return Outcome::Refused(Refusal::Output);
        }
        for (input, (u, limit)) in u.iter().zip(&self.input_limit).enumerate() {
            if !acceptable(*u, *limit) {
                return Outcome::Refused(Refusal::Input(input));
            }
        }
        if !self.begun {
            self.begin(y);
        }
        let y = y - self.reference;
        self.noise.update(y);
        let output = if self.structure.output().contains(0) {
            self.trends.output(&mut self.output, y)
        } else {
            self.trends.movement(&mut self.output, y, self.before)
        };
        self.before = y;
        let mut inputs = [[0.0; M]; I];
        for c in 0..I {
            let delayed = if D > 0 {
                self.lines[c].update(u[c], self.delays[c])
            } else {
                u[c]
            };
            inputs[c] = self
                .trends
                .input(&mut self.inputs[c], delayed, self.holds[c]);
        }
        let constant = if self.structure.constant() {
            let trends = self.trends.input(&mut self.constant, 1.0, Hold::Zero);
            trends[0]
        } else {
            0.0
        };
        let start = self.start_trend;
        if start > 0.0 {
            // Below a millionth it is nothing, and would end in subnormal numbers.
            let next = start * self.decay;
            self.start_trend = if next > 1e-6 { next } else { 0.0 };
        }
        if self.remaining > 0 {
            self.remaining -= 1;
            self.prediction = y + self.reference;
            return Outcome::WarmingUp {
                remaining: self.remaining,
            };
        }
        let (phi, psi) = self
            .regressor
            .assemble(&output, &inputs, &[constant, start]);
        let error = self.estimator.innovation(&phi, psi);
        // (10): y minus its evaluation is the equation error over the weight of y(k) in it.
        let beta = self.regressor.lead(self.estimator.theta());
        let innovation = error / beta;
        self.prediction = y - innovation + self.reference;
        self.quality.update(innovation);
        if !self.adapting {
            return Outcome::Held { innovation };
        }
        self.estimator.correct(&phi, error);
        if self.forgets {
            self.keep_bounded();
        }
        Outcome::Estimated { innovation }
    }

    /// One parameter per sample in turn: its covariance bounded, its value let fall back at rest.
    #[inline(always)]
    fn keep_bounded(&mut self) {
        let turn = if self.turn < N { self.turn } else { 0 };
        self.turn = turn + 1;
        let trusted = self.trusted.get(turn).copied().unwrap_or(0.0);
        let rate = if self.has_trusted {
            self.fall_back
        } else {
            0.0
        };
        self.estimator.relax(turn, trusted, self.ceiling, rate);
        if self.structure.constant() {
            self.estimator.loosen(turn, rate);
        }
    }

    /// The plant rested at y(0) with the inputs at their rest values until this sample.
    #[inline(never)]
    fn begin(&mut self, y: f32) {
        let integrates = self.structure.integrators() > 0;
        // Behind an integrator only movements count; small numbers keep their digits.
        self.reference = if integrates { y } else { 0.0 };
        self.before = y - self.reference;
        self.noise.settle(self.before);
        self.output = self.trends.settled(self.before);
        for c in 0..I {
            self.inputs[c] = self.trends.settled_input(self.rest[c], self.holds[c]);
        }
        self.constant = if integrates {
            T::EMPTY
        } else {
            self.trends.settled_input(1.0, Hold::Zero)
        };
        self.start_trend = if self.structure.start() { 1.0 } else { 0.0 };
        self.begun = true;
    }

    /// Back to the state after construction.
    pub fn reset(&mut self) {
        self.restart_trends();
        self.estimator = self.start;
        self.has_trusted = false;
        self.noise.reset();
        self.quality = Quality::new();
    }

    /// Forgets the signals, after a gap in the samples, and keeps the estimate.
    pub fn restart_trends(&mut self) {
        self.lines = [DelayLine::new(); I];
        self.remaining = self.warm_up;
        self.begun = false;
    }

    /// Goes on with other trends: a filter nearer to the plant, from the estimate.
    ///
    /// The estimate and what is known of it stay. The new chains start where the drive
    /// is; the estimate is held for `settling` seconds until they no longer show that
    /// (3 over the slowest pole but the one of the start leave 5 % of it, which no
    /// standard deviation tells), and the start becomes uncertain again. Nothing jumps:
    /// the estimate is the same before and after. Where the filter is the same and only
    /// the numerators are new, the chains go on and nothing is held.
    /// Cost: about 9000 instructions for order 3, once; not for every sample.
    ///
    /// # Errors
    /// [`ConfigError::SampleTime`] for another sample time, [`ConfigError::Settling`]; nothing is changed then.
    pub fn retune(&mut self, trends: T, settling: f32) -> Result<(), ConfigError> {
        if trends.sample_time() != self.trends.sample_time() {
            return Err(ConfigError::SampleTime(trends.sample_time()));
        }
        if !(settling >= 0.0 && settling.is_finite()) {
            return Err(ConfigError::Settling(settling));
        }
        // The bias that the old filter made is settled now; what follows has the new one's.
        let units = *self.regressor.units();
        let mut theta = self.found();
        // What was learnt weighs as much as the noise in band was smaller than it will be.
        let a = self.regressor.denominator(&theta);
        let scale = match (self.trends.filter_polynomial(), trends.filter_polynomial()) {
            (Some(old), Some(new)) => {
                in_band(&a, &old, self.bandwidth) / in_band(&a, &new, self.bandwidth)
            }
            _ => 1.0,
        };
        let scale = DISCOUNT * if positive(scale) { scale } else { 1.0 };
        theta = sampled(
            &continuous(&theta, &self.structure, &self.trends),
            &self.structure,
            &trends,
        );
        for (value, unit) in theta.iter_mut().zip(units) {
            *value /= unit;
        }
        self.estimator.resume(theta, scale);
        // Only the numerators are new: the chains hold what they would hold.
        let same_filter = trends.filter_polynomial().is_some()
            && trends.filter_polynomial() == self.trends.filter_polynomial()
            && trends.lead() == self.trends.lead();
        self.trends = trends;
        if same_filter {
            return Ok(());
        }
        self.regressor.set_lead(&trends.lead());
        self.noise_gain = trends.noise_gain();
        self.decay = trends.decay();
        if self.structure.start() {
            self.estimator
                .widen_last(self.start.covariance(N - 1, N - 1));
        }
        self.restart_trends();
        self.remaining = trends
            .warm_up()
            .max((settling / trends.sample_time()) as u32);
        Ok(())
    }

    /// Begins again from an estimate with its standard deviations, both in the user's units.
    ///
    /// # Errors
    /// [`ConfigError::Initial`], [`ConfigError::PriorStd`]; nothing is changed then.
    pub fn warm_start(&mut self, theta: [f32; N], std: [f32; N]) -> Result<(), ConfigError> {
        for (index, value) in theta.iter().copied().enumerate() {
            if !value.is_finite() {
                return Err(ConfigError::Initial { index, value });
            }
        }
        check_std(&std)?;
        let theta = sampled(&theta, &self.structure, &self.trends);
        let (theta, std) = prior(
            &self.structure,
            &self.regressor,
            self.prior_noise,
            &theta,
            &Some(std),
        )?;
        self.estimator = self.estimator.restarted(theta, std);
        self.trusted = theta;
        self.has_trusted = true;
        Ok(())
    }

    /// Makes the current estimate the one that a rest leads back to.
    pub fn trust(&mut self) {
        self.trusted = *self.estimator.theta();
        self.has_trusted = true;
    }

    /// Lets the estimate move (`true`, the start) or holds it; predictions go on.
    pub fn adapt(&mut self, on: bool) {
        self.adapting = on;
    }

    /// The parameters in the order of [`Structure`], in the user's units, with the noise bias taken out.
    ///
    /// Cost: some 100 N^2 instructions; for the loop that reports, not for every sample.
    pub fn theta(&self) -> [f32; N] {
        continuous(&self.found(), &self.structure, &self.trends)
    }

    /// The parameters as the trends have them, in the user's units.
    fn found(&self) -> [f32; N] {
        estimate(
            &self.evidence(),
            &self.noise_gain,
            &self.regressor,
            &self.trends,
            self.bandwidth,
        )
        .theta
    }

    /// Standard deviation of each parameter, in its unit, from the noise level found.
    pub fn std(&self) -> [f32; N] {
        let covariance = self.read_out().covariance;
        core::array::from_fn(|j| sqrt(covariance[j][j]))
    }

    /// Covariance of the parameters, in the products of their units.
    pub fn covariance(&self) -> [[f32; N]; N] {
        self.read_out().covariance
    }

    fn evidence(&self) -> Evidence<N> {
        Evidence {
            columns: self.structure.columns(),
            theta: *self.estimator.theta(),
            covariance: core::array::from_fn(|i| {
                core::array::from_fn(|j| self.estimator.covariance(i, j))
            }),
            samples: self.estimator.samples(),
            residual: self.estimator.noise_variance(),
            white: self.noise.variance(),
            prior: self.prior_noise * self.prior_noise,
            doubt: self.doubt,
        }
    }

    fn read_out(&self) -> Readout<N> {
        let found = read_out(
            &self.evidence(),
            &self.noise_gain,
            &self.regressor,
            &self.trends,
            self.bandwidth,
        );
        continuous_readout(found, &self.structure, &self.trends)
    }

    /// Standard deviation of the innovation in the unit of y, `None` until there are more samples than parameters.
    pub fn noise_std(&self) -> Option<f32> {
        let beta = self.regressor.lead(self.estimator.theta());
        let variance = self.estimator.noise_variance()?;
        Some(sqrt(variance) / beta)
    }

    /// The model that theta stands for.
    pub fn transfer_function(&self) -> TransferFunction<M, I> {
        let mut transfer = TransferFunction {
            a: [0.0; M],
            b: [[0.0; M]; I],
            constant: 0.0,
            integrators: self.structure.integrators(),
        };
        for (column, value) in self.structure.columns().into_iter().zip(self.theta()) {
            match column {
                Column::Output { power } => transfer.a[power] = value,
                Column::Input { input, power } => transfer.b[input][power] = value,
                Column::Constant => transfer.constant = value,
                Column::Start => {}
            }
        }
        transfer
    }

    /// The physical reading from the first input to y.
    pub fn physical(&self) -> Physical<M> {
        Physical::of(&self.transfer_function(), 0)
    }

    /// Standard deviations of gain, omega0 and damping of the first input, to first order.
    ///
    /// `None` unless two poles stand behind the integrators and b_0 is in the model.
    pub fn physical_std(&self) -> Option<[f32; 3]> {
        let nu = self.structure.integrators();
        if M != nu + 2 {
            return None;
        }
        let columns = self.structure.columns();
        let b0 = place(&columns, Column::Input { input: 0, power: 0 })?;
        let a_nu = place(&columns, Column::Output { power: nu })?;
        let a_next = place(&columns, Column::Output { power: nu + 1 })?;
        let Readout { theta, covariance } = self.read_out();
        second_order_std(
            theta[b0],
            theta[a_nu],
            theta[a_next],
            [b0, a_nu, a_next],
            |i, j| covariance[i][j],
        )
    }

    /// The evaluation of the newest y from the samples before it, in the unit of y.
    pub const fn prediction(&self) -> f32 {
        self.prediction
    }

    /// IQ and IV of the innovations so far (11).
    pub const fn quality(&self) -> Quality {
        self.quality
    }

    /// User's unit of each normalised parameter.
    pub(crate) fn units(&self) -> &[f32; N] {
        self.regressor.units()
    }

    /// The estimator, in normalised quantities.
    pub const fn estimator(&self) -> &Estimator<N> {
        &self.estimator
    }

    /// The structure of the model.
    pub const fn structure(&self) -> &Structure<M, N, I> {
        &self.structure
    }

    /// The trend operator.
    pub const fn trends(&self) -> &T {
        &self.trends
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

/// The prior in normalised units, its standard deviation relative to the noise of psi.
fn prior<const M: usize, const N: usize, const I: usize>(
    structure: &Structure<M, N, I>,
    regressor: &Regressor<M, N>,
    noise: f32,
    initial: &[f32; N],
    std: &Option<[f32; N]>,
) -> Result<([f32; N], [f32; N]), ConfigError> {
    let units = regressor.units();
    let mut theta = *initial;
    for (index, (value, unit)) in theta.iter_mut().zip(units).enumerate() {
        let given = *value;
        *value = given / unit;
        if !acceptable(*value, REACH) {
            return Err(ConfigError::Initial {
                index,
                value: given,
            });
        }
    }
    let mut relative = std.unwrap_or(structure.columns().map(|column| match column {
        Column::Constant if structure.integrators() > 0 => OFFSET,
        _ => PRIOR,
    }));
    for (value, unit) in relative.iter_mut().zip(units) {
        *value /= match std {
            Some(_) => unit * noise,
            None => noise,
        };
        if !(*value < UNKNOWN) {
            *value = UNKNOWN;
        }
    }
    Ok((theta, relative))
}
