//! The estimator: recursive least squares on the factors U D U' of the covariance.

mod again;
mod memory;

use crate::estimation::factors::{Factors, Row};
use crate::estimation::inflation::Inflation;
use crate::estimation::mean_square::{MeanSquare, flush};
use crate::estimation::two_words::TwoWords;

/// Recursive least squares with exponential forgetting in U D U' form (Bierman).
///
/// With the regressor phi, the left-hand side psi and the forgetting factor lambda:
///
/// ```text
/// e     = psi - phi' theta                    innovation
/// f     = U' phi,   v_j = D_j f_j
/// alpha_0 = lambda, alpha_j = alpha_{j-1} + f_j v_j
/// D_j  <- D_j alpha_{j-1} / (alpha_j lambda)
/// U_ij <- U_ij - (f_j / alpha_{j-1}) k_i,     k_i <- k_i + U_ij v_j     (i < j)
/// theta <- theta + k e / alpha_n              P = U D U'
/// ```
///
/// D stays positive by construction, in f32, which the textbook form of P does not. Theta is kept
/// in two words: a correction below half the last digit of theta is carried over to the next
/// sample, not lost. Under forgetting alone P grows without bound where nothing excites the
/// parameters: see [`StabilisedForgetting`](crate::estimation::StabilisedForgetting). A parameter
/// whose prior standard deviation is 0 is known: it never moves, and every other number is the same
/// as if it were not in the model.
///
/// | symbol | argument | shape |
/// |---|---|---|
/// | theta | `theta` | N |
/// | sigma_0 | `std`, relative to the noise of psi | N, >= 0 |
/// | lambda | `forgetting` | (0, 1] |
///
/// All quantities are normalised; [`Identifier`](crate::Identifier) does the units.
///
/// # Examples
/// ```
/// use trendid::estimation::Estimator;
/// let mut estimator = Estimator::<1>::new([0.0], [1000.0], 1.0);
/// for k in 1..100 {
///     let x = k as f32;
///     let _ = estimator.update(&[x], 3.0 * x);
/// }
/// assert!((estimator.theta()[0] - 3.0).abs() < 1e-4);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Estimator<const N: usize> {
    theta: TwoWords<N>,
    factors: Factors<N>,
    forgetting: f32,
    /// What the next row is forgotten for: lambda or 1, and one over it.
    next: [f32; 2],
    /// Weighted sum of squares of the innovations with the weight of the samples in it.
    residual: MeanSquare,
    /// Weight of the samples in P.
    samples: f32,
    observation: Observation<N>,
    inflation: Inflation<N>,
}

/// An observation of one parameter whose last columns are not yet in P, and theta not yet moved.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Observation<const N: usize> {
    /// The parameter; N for none.
    index: usize,
    value: f32,
    row: Row<N>,
}

impl<const N: usize> Observation<N> {
    const NONE: Self = Self {
        index: N,
        value: 0.0,
        row: Row::new(1.0, 1.0),
    };
}

/// A weight of samples below this counts for nothing.
const NEGLIGIBLE: f32 = 1e-18;

impl<const N: usize> Estimator<N> {
    /// Starts at `theta` with the standard deviations `std`, in units of the noise of psi.
    ///
    /// `forgetting` is lambda; 1 forgets nothing.
    pub const fn new(theta: [f32; N], std: [f32; N], forgetting: f32) -> Self {
        Self {
            theta: TwoWords::new(theta),
            factors: Factors::independent(&std),
            forgetting,
            next: [forgetting, 1.0 / forgetting],
            residual: MeanSquare::new(forgetting),
            samples: 0.0,
            observation: Observation::NONE,
            inflation: Inflation::NONE,
        }
    }

    /// The normalised parameters.
    pub const fn theta(&self) -> &[f32; N] {
        self.theta.high()
    }

    /// Takes one row and returns the innovation e before the step.
    ///
    /// Guarantees: no division by zero, D_j >= 0. Cost: see the table of instruction counts.
    #[inline]
    pub fn update(&mut self, phi: &[f32; N], psi: f32) -> f32 {
        self.finish_observation();
        let innovation = self.innovation(phi, psi);
        let _ = self.fold(phi, innovation);
        innovation
    }

    /// The innovation e of a row, without a step.
    #[inline(always)]
    pub fn innovation(&self, phi: &[f32; N], psi: f32) -> f32 {
        let theta = self.theta();
        let mut innovation = psi;
        for j in 0..N {
            innovation -= phi[j] * theta[j];
        }
        innovation
    }

    /// Variance that P leaves of the innovation of the row `phi`, relative to the noise: phi' P
    /// phi; while P is being inflated at least that.
    #[inline(always)]
    pub(crate) fn spread(&self, phi: [f32; N]) -> f32 {
        self.inflation.growth * self.factors.spread(phi)
    }

    /// Corrects the estimate by `innovation` along the direction `z`.
    ///
    /// With `z = phi` this is least squares.
    #[inline(always)]
    pub fn correct(&mut self, z: &[f32; N], innovation: f32) {
        self.finish_observation();
        let _ = self.fold(z, innovation);
    }

    /// As [`correct`](Self::correct), where no observation waits for its rest. Gives phi' P phi
    /// before it.
    #[inline(always)]
    pub(crate) fn fold(&mut self, z: &[f32; N], innovation: f32) -> f32 {
        let [forgetting, growth] = self.next;
        let row = self.factors.fold(z, forgetting, growth);
        let step = innovation / row.alpha;
        self.theta.add(&row.gain, step);
        self.residual.update(forgetting * (innovation * step));
        self.samples = forgetting * self.samples + 1.0;
        row.alpha - forgetting
    }

    /// Takes `value` as an observation of parameter `index` alone, with `variance` relative to the
    /// noise of psi.
    ///
    /// Nothing is forgotten, and no sample counted. Nothing happens where P_ii is below `least`,
    /// for an index that does not exist and for a known parameter. Gives P_ii before the step.
    /// `variance` should be a power of two: then D and U of the parameters before this one keep
    /// their bits.
    #[inline(never)]
    pub fn observe_parameter(
        &mut self,
        index: usize,
        value: f32,
        variance: f32,
        least: f32,
    ) -> f32 {
        let before = self.begin_observation(index, value, || variance, least);
        self.finish_observation();
        before
    }

    /// All of [`observe_parameter`](Self::observe_parameter) but its last column and the step of
    /// theta.
    ///
    /// P is then that behind an observation of another row, z with U'z = (0.., f_i, ..,
    /// f_(N-2), 0). What changes the estimator next finishes the observation first.
    #[inline(always)]
    pub(crate) fn begin_observation(
        &mut self,
        index: usize,
        value: f32,
        variance: impl FnOnce() -> f32,
        least: f32,
    ) -> f32 {
        self.finish_observation();
        let (before, row) = self.factors.fold_unit(index, variance, least);
        if let Some(row) = row {
            self.observation = Observation { index, value, row };
        }
        before
    }

    /// The last column of an observation that was begun, and its step of theta.
    ///
    /// To be called before the innovation of the next row is computed.
    #[inline(always)]
    pub(crate) fn finish_observation(&mut self) {
        if self.observation.index < N {
            self.fold_rest();
        }
    }

    #[inline(never)]
    fn fold_rest(&mut self) {
        let Observation { index, value, row } = self.observation;
        self.observation.index = N;
        let row = self.factors.fold_unit_rest(index, row);
        let theta = self.theta().get(index).copied().unwrap_or(value);
        self.theta.add(&row.gain, (value - theta) / row.alpha);
    }

    /// Sets what is too small to matter to zero, before it becomes subnormal: row `index` of U and
    /// of theta's second word.
    ///
    /// One index per sample in turn is enough. Cost: 4 instructions for each parameter.
    #[inline(always)]
    pub fn flush(&mut self, index: usize) {
        self.factors.flush(index);
        self.theta.flush(index);
    }

    /// The same for the sums beside P.
    pub(crate) fn flush_sums(&mut self) {
        flush(&mut self.samples, NEGLIGIBLE);
        self.residual.flush();
    }

    /// Makes the last parameter uncertain again: adds `variance` to P_nn and leaves all other
    /// entries of P.
    ///
    /// Cost: about one `update`.
    #[doc(alias = "widen_last")]
    pub fn inflate_last(&mut self, variance: f32) {
        self.finish_observation();
        self.factors.inflate_last(variance);
    }

    /// Entry (i, j) of P = U D U', relative to the noise variance.
    pub fn covariance(&self, i: usize, j: usize) -> f32 {
        self.read(|factors| factors.covariance(i, j))
    }

    /// P, bit for bit the entries that [`covariance`](Self::covariance) gives, for less than half
    /// the instructions.
    pub(crate) fn covariances(&self) -> [[f32; N]; N] {
        self.read(|factors| factors.covariances())
    }

    /// The P_ii.
    pub(crate) fn variances(&self) -> [f32; N] {
        self.read(|factors| core::array::from_fn(|i| factors.covariance(i, i)))
    }

    /// U above the diagonal and D on it, column by column.
    pub(crate) fn factors(&self) -> [[f32; N]; N] {
        self.read(|factors| factors.packed())
    }

    /// The factors D_j: positive, or 0 for a known parameter.
    pub const fn diagonal(&self) -> &[f32; N] {
        self.factors.diagonal()
    }

    /// Variance of the noise of psi from the innovations, with a degree of freedom taken off for
    /// each parameter that is not known.
    ///
    /// `None` until there are more samples than such parameters.
    pub fn noise_variance(&self) -> Option<f32> {
        let freedom = self.residual.samples() - self.free();
        (freedom > 0.0).then(|| self.residual.squares() / freedom)
    }

    /// How many parameters are not known.
    pub(crate) fn free(&self) -> f32 {
        let mut free: u8 = 0;
        for variance in self.diagonal() {
            free += u8::from(*variance > 0.0);
        }
        f32::from(free)
    }

    /// What the next row is forgotten for: lambda or 1.
    pub(crate) const fn forgets_for(&self) -> f32 {
        let [forgetting, _] = self.next;
        forgetting
    }

    /// Weight of the samples in P: 1/(1-lambda) at most where every row is forgotten for.
    pub const fn samples(&self) -> f32 {
        self.samples
    }
}

#[cfg(test)]
mod tests;
