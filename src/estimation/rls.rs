//! The estimator: recursive least squares on the factors U D U' of the covariance.

use crate::estimation::mean_square::MeanSquare;
use crate::estimation::mean_square::flush;

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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimator<const N: usize> {
    theta: [f32; N],
    /// What rounding left of each correction of theta.
    low: [f32; N],
    /// `factor[j][i]` is U_ij for i < j; the diagonal of U is 1 and is not stored.
    factor: [[f32; N]; N],
    diagonal: [f32; N],
    forgetting: f32,
    inverse_forgetting: f32,
    /// Weighted sum of squares of the innovations with the weight of the samples in it.
    residual: MeanSquare,
    /// Weight of the samples in P.
    samples: f32,
}

/// Entries of U and of theta's second word below this change no digit of any result.
const NEGLIGIBLE: f32 = 1e-18;

/// What travels from column to column while one row is folded in.
struct Row<const N: usize> {
    gain: [f32; N],
    alpha: f32,
    inverse: f32,
}

impl<const N: usize> Estimator<N> {
    /// Starts at `theta` with the standard deviations `std`, in units of the noise of psi.
    ///
    /// `forgetting` is lambda; 1 forgets nothing.
    pub const fn new(theta: [f32; N], std: [f32; N], forgetting: f32) -> Self {
        let mut diagonal = [0.0; N];
        let mut j = 0;
        while j < N {
            diagonal[j] = std[j] * std[j];
            j += 1;
        }
        Self {
            theta,
            low: [0.0; N],
            factor: [[0.0; N]; N],
            diagonal,
            forgetting,
            inverse_forgetting: 1.0 / forgetting,
            residual: MeanSquare::new(forgetting),
            samples: 0.0,
        }
    }

    /// The normalised parameters.
    pub const fn theta(&self) -> &[f32; N] {
        &self.theta
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
        let mut innovation = psi;
        for j in 0..N {
            innovation -= phi[j] * self.theta[j];
        }
        innovation
    }

    /// Corrects the estimate by `innovation` along the direction `z`.
    ///
    /// With `z = phi` this is least squares.
    #[inline(always)]
    pub fn correct(&mut self, z: &[f32; N], innovation: f32) {
        let mut f = *z;
        for j in 0..N {
            for i in 0..j {
                f[j] += self.factor[j][i] * z[i];
            }
        }
        let (gain, alpha) = self.fold(
            &f,
            self.forgetting,
            self.inverse_forgetting,
            self.inverse_forgetting,
        );
        let step = innovation / alpha;
        self.step(&gain, step);
        self.residual.update(self.forgetting * (innovation * step));
        self.samples = self.forgetting * self.samples + 1.0;
    }

    /// Lets one sample time pass without a row: forgets, and leaves theta and the noise level.
    #[inline(always)]
    pub fn pass(&mut self) {
        for d in &mut self.diagonal {
            *d *= self.inverse_forgetting;
        }
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
        // U' e_i: zero before the parameter, so that the columns before it stay as they are.
        let mut f = [0.0; N];
        let mut before = 0.0;
        for j in 0..N {
            if j >= index {
                let entry = self.factor[j].get(index).copied().unwrap_or(0.0);
                f[j] = if j == index { 1.0 } else { entry };
                before += f[j] * f[j] * self.diagonal[j];
            }
        }
        if before > least {
            let mut row = Row {
                gain: [0.0; N],
                alpha: variance,
                inverse: 1.0 / variance,
            };
            for j in 0..N {
                if j >= index {
                    self.fold_column(&mut row, j, f[j], 1.0);
                }
            }
            let theta = self.theta.get(index).copied().unwrap_or(value);
            self.step(&row.gain, (value - theta) / row.alpha);
        }
        before
    }

    /// theta <- theta + gain times `step`, in two words (Fast2Sum; Dekker 1971).
    #[inline(always)]
    fn step(&mut self, gain: &[f32; N], step: f32) {
        for j in 0..N {
            let change = gain[j] * step + self.low[j];
            let sum = self.theta[j] + change;
            self.low[j] = change - (sum - self.theta[j]);
            self.theta[j] = sum;
        }
    }

    /// Folds a row into U and D, given f = U' z, alpha_0 and its inverse; returns the unnormalised gain k and alpha_n.
    #[inline(always)]
    fn fold(&mut self, f: &[f32; N], alpha: f32, inverse: f32, growth: f32) -> ([f32; N], f32) {
        let mut row = Row {
            gain: [0.0; N],
            alpha,
            inverse,
        };
        for j in 0..N {
            self.fold_column(&mut row, j, f[j], growth);
        }
        (row.gain, row.alpha)
    }

    /// Column j of one row: D_j and the U_ij above it.
    #[inline(always)]
    fn fold_column(&mut self, row: &mut Row<N>, j: usize, f: f32, growth: f32) {
        let v = self.diagonal[j] * f;
        let share = f * row.inverse;
        let before = row.alpha;
        row.alpha += f * v;
        row.inverse = 1.0 / row.alpha;
        self.diagonal[j] *= before * row.inverse * growth;
        for i in 0..j {
            let u = self.factor[j][i];
            self.factor[j][i] = u - share * row.gain[i];
            row.gain[i] += u * v;
        }
        row.gain[j] = v;
    }

    /// Sets what is too small to matter to zero, before it becomes subnormal: row `index` of U and of theta's second word.
    ///
    /// One index per sample in turn is enough. Cost: 4 instructions for each parameter.
    #[inline(always)]
    pub fn flush(&mut self, index: usize) {
        for column in &mut self.factor {
            if let Some(entry) = column.get_mut(index) {
                flush(entry, NEGLIGIBLE);
            }
        }
        if let Some(low) = self.low.get_mut(index) {
            flush(low, NEGLIGIBLE);
        }
        flush(&mut self.samples, NEGLIGIBLE);
        self.residual.flush();
    }

    /// Makes the last parameter uncertain again: adds `variance` to P_nn and leaves all other entries of P.
    ///
    /// The part of P that the last column of U carried moves into the factors before
    /// it, by the rank-one update of Agee and Turner. Cost: about one `update`.
    pub fn widen_last(&mut self, variance: f32) {
        let Some(last) = N.checked_sub(1) else {
            return;
        };
        let before = self.diagonal[last];
        let after = before + variance;
        if !(after > 0.0) {
            return;
        }
        let mut vector = self.factor[last];
        let mut weight = before * (variance / after);
        for entry in self.factor[last].iter_mut().take(last) {
            *entry *= before / after;
        }
        self.diagonal[last] = after;
        // From the last but one down, without an index that would have to be checked.
        let mut rest = match vector.split_last_mut() {
            Some((_, below)) => below,
            None => return,
        };
        let columns = self.diagonal.iter_mut().zip(&mut self.factor);
        for (diagonal, column) in columns.rev().skip(1) {
            let Some((v, below)) = core::mem::take(&mut rest).split_last_mut() else {
                break;
            };
            let (v, old) = (*v, *diagonal);
            let new = old + weight * v * v;
            if new > 0.0 {
                let share = weight * v / new;
                for (entry, x) in column.iter_mut().zip(below.iter_mut()) {
                    *x -= v * *entry;
                    *entry += share * *x;
                }
                weight *= old / new;
                *diagonal = new;
            }
            rest = below;
        }
    }

    /// Entry (i, j) of P = U D U', relative to the noise variance.
    pub fn covariance(&self, i: usize, j: usize) -> f32 {
        let mut sum = 0.0;
        // U is zero below its diagonal.
        for k in i.max(j)..N {
            sum += self.entry(i, k) * self.diagonal[k] * self.entry(j, k);
        }
        sum
    }

    /// P, bit for bit the entries that [`covariance`](Self::covariance) gives, for less than half the instructions.
    pub(crate) fn covariances(&self) -> [[f32; N]; N] {
        let mut p = [[0.0; N]; N];
        for (k, (column, d)) in self.factor.iter().zip(&self.diagonal).enumerate() {
            // Column k of U down to its diagonal.
            let mut u = *column;
            if let Some(one) = u.get_mut(k) {
                *one = 1.0;
            }
            for (row, left) in p.iter_mut().zip(&u).take(k + 1) {
                let weighted = left * d;
                for (entry, right) in row.iter_mut().zip(&u).take(k + 1) {
                    *entry += weighted * right;
                }
            }
        }
        p
    }

    /// U_ik with its unit diagonal and its zeros.
    fn entry(&self, i: usize, k: usize) -> f32 {
        if i < k {
            self.factor[k][i]
        } else if i == k {
            1.0
        } else {
            0.0
        }
    }

    /// The factors D_j: positive, or 0 for a known parameter.
    pub const fn diagonal(&self) -> &[f32; N] {
        &self.diagonal
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
        self.theta = theta;
        self.low = [0.0; N];
        for (d, limit) in self.diagonal.iter_mut().zip(limit) {
            let scaled = *d * scale;
            *d = if scaled < *limit || scale < 1.0 {
                scaled
            } else {
                d.max(*limit)
            };
        }
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
    fn all_of_the_covariance_at_once_has_the_same_bits() {
        for rows in [0, 3, 200] {
            let estimator = moved(0.99, rows);
            let all = estimator.covariances();
            for (i, row) in all.iter().enumerate() {
                for (j, entry) in row.iter().enumerate() {
                    assert_eq!(entry.to_bits(), estimator.covariance(i, j).to_bits());
                }
            }
        }
    }

    #[test]
    fn covariance_is_the_inverse_of_the_information() {
        let estimator = moved(1.0, 200);
        let mut information = [[0.0_f32; 3]; 3];
        for i in 0..3 {
            information[i][i] = 1e-4;
        }
        for k in 0..200 {
            let (phi, _) = row(k);
            for i in 0..3 {
                for j in 0..3 {
                    information[i][j] += phi[i] * phi[j];
                }
            }
        }
        for i in 0..3 {
            for j in 0..3 {
                let product: f32 = (0..3)
                    .map(|k| information[i][k] * estimator.covariance(k, j))
                    .sum();
                let unit = if i == j { 1.0 } else { 0.0 };
                assert!((product - unit).abs() < 1e-4, "{i} {j}: {product}");
            }
        }
        for (found, truth) in estimator.theta().iter().zip([2.0, -1.0, 0.5]) {
            assert!((found - truth).abs() < 1e-4);
        }
    }

    #[test]
    fn widening_adds_to_the_last_variance_only() {
        let before = moved(0.99, 100);
        let mut after = before;
        after.widen_last(3.0);
        for i in 0..3 {
            for j in 0..3 {
                let added = after.covariance(i, j) - before.covariance(i, j);
                let wanted = if (i, j) == (2, 2) { 3.0 } else { 0.0 };
                assert!((added - wanted).abs() < 1e-5, "{i} {j}: {added}");
            }
        }
        assert_eq!(before.theta(), after.theta());
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
