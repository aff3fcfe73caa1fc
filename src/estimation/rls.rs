//! The estimator: recursive least squares on the factors U D U' of the covariance.

use crate::estimation::factors::Factors;
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
/// D stays positive by construction, in f32, which the textbook form of P does not. Theta
/// is kept in two words: a correction below half the last digit of theta is carried over
/// to the next sample, not lost. Under forgetting alone P grows without bound where
/// nothing excites the parameters: see [`StabilisedForgetting`](crate::estimation::StabilisedForgetting).
/// A parameter whose prior standard deviation is 0 is known: it never moves, and
/// every other number is the same as if it were not in the model.
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
    inverse_forgetting: f32,
    /// Weighted sum of squares of the innovations with the weight of the samples in it.
    residual: MeanSquare,
    /// Weight of the samples in P.
    samples: f32,
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
            inverse_forgetting: 1.0 / forgetting,
            residual: MeanSquare::new(forgetting),
            samples: 0.0,
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
        let innovation = self.innovation(phi, psi);
        self.correct(phi, innovation);
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

    /// Variance that P leaves of the innovation of the row `phi`, relative to the noise: phi' P phi.
    pub(crate) fn spread(&self, phi: &[f32; N]) -> f32 {
        self.factors.spread(phi)
    }

    /// Corrects the estimate by `innovation` along the direction `z`.
    ///
    /// With `z = phi` this is least squares.
    #[inline(always)]
    pub fn correct(&mut self, z: &[f32; N], innovation: f32) {
        let row = self
            .factors
            .fold(z, self.forgetting, self.inverse_forgetting);
        let step = innovation / row.alpha;
        self.theta.add(&row.gain, step);
        self.residual.update(self.forgetting * (innovation * step));
        self.samples = self.forgetting * self.samples + 1.0;
    }

    /// Lets one sample time pass without a row: forgets, and leaves theta and the noise level.
    #[inline(always)]
    pub fn pass(&mut self) {
        self.factors.grow(self.inverse_forgetting);
        self.samples *= self.forgetting;
    }

    /// Takes `value` as an observation of parameter `index` alone, with `variance` relative to the noise of psi.
    ///
    /// Nothing is forgotten, and no sample counted. Nothing happens where P_ii is below
    /// `least`, for an index that does not exist and for a known parameter. Gives P_ii before the step.
    /// `variance` should be a power of two: then D and U of the parameters before this one keep their bits.
    #[inline(always)]
    pub fn observe_parameter(
        &mut self,
        index: usize,
        value: f32,
        variance: f32,
        least: f32,
    ) -> f32 {
        let (before, row) = self.factors.fold_unit(index, variance, least);
        if let Some(row) = row {
            let theta = self.theta().get(index).copied().unwrap_or(value);
            self.theta.add(&row.gain, (value - theta) / row.alpha);
        }
        before
    }

    /// Sets what is too small to matter to zero, before it becomes subnormal: row `index` of U and of theta's second word.
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

    /// Makes the last parameter uncertain again: adds `variance` to P_nn and leaves all other entries of P.
    ///
    /// Cost: about one `update`.
    pub fn widen_last(&mut self, variance: f32) {
        self.factors.widen_last(variance);
    }

    /// Entry (i, j) of P = U D U', relative to the noise variance.
    pub fn covariance(&self, i: usize, j: usize) -> f32 {
        self.factors.covariance(i, j)
    }

    /// P, bit for bit the entries that [`covariance`](Self::covariance) gives, for less than half the instructions.
    pub(crate) fn covariances(&self) -> [[f32; N]; N] {
        self.factors.covariances()
    }

    /// The factors D_j: positive, or 0 for a known parameter.
    pub const fn diagonal(&self) -> &[f32; N] {
        self.factors.diagonal()
    }

    /// Variance of the noise of psi from the innovations, with N degrees of freedom taken off.
    ///
    /// `None` until there are more samples than parameters.
    pub fn noise_variance(&self) -> Option<f32> {
        let freedom = self.residual.samples() - N as f32;
        (freedom > 0.0).then(|| self.residual.squares() / freedom)
    }

    /// Number of samples in the memory: 1/(1-lambda) at most.
    pub const fn samples(&self) -> f32 {
        self.samples
    }

    /// Goes on from `theta` with `scale` times the covariance, and counts samples and noise anew.
    ///
    /// No D_j grows beyond the one in `limit`, or beyond itself where it is larger already.
    pub fn resume(&mut self, theta: [f32; N], scale: f32, limit: &[f32; N]) {
        self.theta = TwoWords::new(theta);
        self.factors.grow_within(scale, limit);
        self.residual = MeanSquare::new(self.forgetting);
        self.samples = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows that excite three parameters: a deterministic mixture, then fitted without noise by theta = (2, -1, 0.5).
    fn row(k: usize) -> ([f32; 3], f32) {
        let wave = |period: usize| (k % period) as f32 / period as f32 - 0.5;
        let phi = [wave(7), wave(11), wave(5)];
        (phi, 2.0 * phi[0] - phi[1] + 0.5 * phi[2])
    }

    fn moved(forgetting: f32, rows: usize) -> Estimator<3> {
        let mut estimator = Estimator::new([0.0; 3], [100.0; 3], forgetting);
        for k in 0..rows {
            let (phi, psi) = row(k);
            let _ = estimator.update(&phi, psi);
        }
        estimator
    }

    #[test]
    fn rows_without_noise_give_their_parameters() {
        let estimator = moved(1.0, 200);
        for (found, truth) in estimator.theta().iter().zip([2.0, -1.0, 0.5]) {
            assert!((found - truth).abs() < 1e-4);
        }
    }

    #[test]
    fn noise_variance_of_a_known_residual() {
        // One parameter, psi = 3 phi +- 0.2 with phi = 1: the estimate is 3, the variance 0.04 n/(n - 1).
        let mut estimator = Estimator::<1>::new([0.0], [1e3], 1.0);
        assert_eq!(estimator.noise_variance(), None);
        for k in 0..1000 {
            let error = if k % 2 == 0 { 0.2 } else { -0.2 };
            let _ = estimator.update(&[1.0], 3.0 + error);
        }
        let variance = estimator.noise_variance().unwrap();
        assert!((variance / (0.04 * 1000.0 / 999.0) - 1.0).abs() < 1e-3);
        assert_eq!(estimator.samples(), 1000.0);
    }

    #[test]
    fn memory_is_that_of_the_forgetting() {
        let estimator = moved(0.99, 5000);
        assert!((estimator.samples() - 100.0).abs() < 0.1);
    }
}
