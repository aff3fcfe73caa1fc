//! The factors U D U' of a covariance, and their update by a row.

mod widening;

use crate::estimation::mean_square::flush;
use crate::math::sum::EMPTY;

/// Entries of U below this change no digit of any result.
const NEGLIGIBLE: f32 = 1e-18;

/// A covariance P = U D U', relative to the noise variance; D stays positive by construction
/// (Bierman).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Factors<const N: usize> {
    /// `upper[j][i]` is U_ij, with its unit diagonal and its zeros.
    upper: [[f32; N]; N],
    diagonal: [f32; N],
}

/// Gain and variance carried from column to column while one row is folded in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Row<const N: usize> {
    /// k, the gain before it is divided by alpha.
    pub(crate) gain: [f32; N],
    /// alpha_j, in the end the variance of the innovation relative to the noise.
    pub(crate) alpha: f32,
    inverse: f32,
}

impl<const N: usize> Row<N> {
    /// The row before the first column; `alpha` is alpha_0 and `inverse` one over it.
    #[inline(always)]
    pub(crate) const fn new(alpha: f32, inverse: f32) -> Self {
        Self {
            gain: [0.0; N],
            alpha,
            inverse,
        }
    }
}

impl<const N: usize> Factors<N> {
    /// Independent parameters with the standard deviations `std`.
    pub(crate) const fn independent(std: &[f32; N]) -> Self {
        let mut diagonal = [0.0; N];
        let mut upper = [[0.0; N]; N];
        let mut j = 0;
        while j < N {
            diagonal[j] = std[j] * std[j];
            upper[j][j] = 1.0;
            j += 1;
        }
        Self { upper, diagonal }
    }

    /// The factors D_j: positive, or 0 for a known parameter.
    pub(crate) const fn diagonal(&self) -> &[f32; N] {
        &self.diagonal
    }

    /// z' P z.
    #[inline(always)]
    pub(crate) fn spread(&self, z: [f32; N]) -> f32 {
        let mut sum = EMPTY;
        for j in 0..N {
            let mut f = z[j];
            for i in 0..j {
                f += self.upper[j][i] * z[i];
            }
            sum += self.diagonal[j] * f * f;
        }
        sum
    }

    /// Folds the row `z` in: P becomes `(P^-1 lambda + z z')^-1`, with `forgetting` = lambda and
    /// `growth` = 1/lambda.
    #[inline(always)]
    pub(crate) fn fold(&mut self, z: &[f32; N], forgetting: f32, growth: f32) -> Row<N> {
        // f = U' z
        let mut f = *z;
        for j in 0..N {
            for i in 0..j {
                f[j] += self.upper[j][i] * z[i];
            }
        }
        let mut row = Row::new(forgetting, growth);
        for j in 0..N {
            self.fold_column(&mut row, j, f[j], growth);
        }
        row
    }

    /// Folds the first columns of the unit row e_i, i = `index`, of the noise variance `variance`
    /// in, where P_ii is above `least`; [`fold_unit_rest`](Self::fold_unit_rest) folds the others.
    ///
    /// Gives P_ii before the step, 0 for an index that does not exist.
    #[inline(always)]
    pub(crate) fn fold_unit(
        &mut self,
        index: usize,
        variance: impl FnOnce() -> f32,
        least: f32,
    ) -> (f32, Option<Row<N>>) {
        // f = U' e_i: zero before the parameter, so that the columns before it stay as they are.
        let f: [f32; N] =
            core::array::from_fn(|j| self.upper[j].get(index).copied().unwrap_or(0.0));
        let mut before = EMPTY;
        for j in 0..N {
            before += f[j] * f[j] * self.diagonal[j];
        }
        if !(before > least) {
            return (before, None);
        }
        let variance = variance();
        let mut row = Row::new(variance, 1.0 / variance);
        for j in 0..Self::FIRST {
            if j >= index {
                self.fold_column(&mut row, j, f[j], 1.0);
            }
        }
        (before, Some(row))
    }

    /// Folds the columns in that [`fold_unit`](Self::fold_unit) left.
    #[inline(always)]
    pub(crate) fn fold_unit_rest(&mut self, index: usize, mut row: Row<N>) -> Row<N> {
        self.fold_unit_from(Self::FIRST, index, &mut row);
        row
    }

    /// Folds the unit row e_i, i = `index`, of the noise variance `variance` in; one that is 0 or
    /// infinite, of a parameter that is known or has no bound, changes nothing.
    #[inline(never)]
    pub(crate) fn observe(&mut self, index: usize, variance: f32) {
        if !(f32::MIN_POSITIVE..=f32::MAX).contains(&variance) {
            return;
        }
        self.fold_unit_from(0, index, &mut Row::new(variance, 1.0 / variance));
    }

    /// The columns from `first` on of the unit row e_i, i = `index`.
    #[inline(always)]
    fn fold_unit_from(&mut self, first: usize, index: usize, row: &mut Row<N>) {
        for j in first..N {
            if j >= index {
                let f = self.upper[j].get(index).copied().unwrap_or(0.0);
                self.fold_column(row, j, f, 1.0);
            }
        }
    }

    /// Columns in the first part of a unit row, which also finds P_ii; the second part also moves
    /// theta: about half each.
    const FIRST: usize = N.saturating_sub(1);

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
            let u = self.upper[j][i];
            self.upper[j][i] = u - share * row.gain[i];
            row.gain[i] += u * v;
        }
        row.gain[j] = v;
    }

    /// Multiplies P by `growth`.
    #[inline(always)]
    pub(crate) fn grow(&mut self, growth: f32) {
        for d in &mut self.diagonal {
            *d *= growth;
        }
    }

    /// P becomes the diagonal matrix of these `variances`; a known parameter stays known.
    pub(crate) fn begin_again(&mut self, variances: &[f32; N]) {
        let before = self.diagonal;
        *self = Self::independent(&[0.0; N]);
        for ((d, before), variance) in self.diagonal.iter_mut().zip(before).zip(variances) {
            *d = if before > 0.0 { *variance } else { 0.0 };
        }
    }

    /// Multiplies P by `scale`; no D_j grows beyond the one in `limit`, or beyond itself where it
    /// is larger already.
    pub(crate) fn grow_within(&mut self, scale: f32, limit: &[f32; N]) {
        for (d, limit) in self.diagonal.iter_mut().zip(limit) {
            let scaled = *d * scale;
            *d = if scaled < *limit || scale < 1.0 {
                scaled
            } else {
                d.max(*limit)
            };
        }
    }

    /// Row `index` of U, entries that change no digit as zero.
    #[inline(always)]
    pub(crate) fn flush(&mut self, index: usize) {
        for column in &mut self.upper {
            if let Some(entry) = column.get_mut(index) {
                flush(entry, NEGLIGIBLE);
            }
        }
    }

    /// U above the diagonal and D on it, column by column.
    pub(crate) fn packed(&self) -> [[f32; N]; N] {
        let mut packed = self.upper;
        for (j, (column, d)) in packed.iter_mut().zip(&self.diagonal).enumerate() {
            if let Some(slot) = column.get_mut(j) {
                *slot = *d;
            }
        }
        packed
    }

    /// Entry (i, j) of P = U D U', relative to the noise variance.
    pub(crate) fn covariance(&self, i: usize, j: usize) -> f32 {
        let mut sum = 0.0;
        // U is zero below its diagonal.
        for k in i.max(j)..N {
            sum += self.upper[k][i] * self.diagonal[k] * self.upper[k][j];
        }
        sum
    }

    /// P, bit for bit the entries that [`covariance`](Self::covariance) gives, for less than half
    /// the instructions.
    pub(crate) fn covariances(&self) -> [[f32; N]; N] {
        let mut p = [[0.0; N]; N];
        for (k, (column, d)) in self.upper.iter().zip(&self.diagonal).enumerate() {
            for (row, left) in p.iter_mut().zip(column).take(k + 1) {
                let weighted = left * d;
                for (entry, right) in row.iter_mut().zip(column).take(k + 1) {
                    *entry += weighted * right;
                }
            }
        }
        p
    }
}

#[cfg(test)]
mod tests;
