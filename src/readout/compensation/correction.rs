//! The linear algebra of the correction: what is left of P^-1 without the noise of its regressors.
//!
//! With `M = L L'`, `B = P L` and `S = 1 - w L' P L = C C'`
//!
//! ```text
//! Y = sqrt(w) B C^-T           Q   = (P^-1 - w M)^-1 = P + Y Y'
//! Z = Y C^-1                   P_c = Q P^-1 Q        = Q + Z Z'
//! theta' = theta - w P m       theta_c = Q (P^-1 theta - w m) = theta' + sqrt(w) Z L' theta'
//! ```
//!
//! S is as large as the number of parameters of y, and positive as long as w is below one over the
//! largest eigenvalue of `L' P L`. That is at most its norm, which limits w. So Q and P_c are
//! positive, and no less than P, for any P.
//!
//! Known as: matrix inversion lemma. Golub and Van Loan, Matrix Computations (1996), ch. 2.1.3.

use crate::math::matrix::{Matrix, backward, dot, factor, forward, root};
use crate::math::{smaller, sqrt};

/// M, m and the same of psi psi, per sample of noise of variance 1, of the parameters of y.
pub(super) struct NoiseMoments<const M: usize> {
    pub(super) matrix: Matrix<M>,
    pub(super) vector: [f32; M],
    pub(super) top: f32,
}

impl<const M: usize> NoiseMoments<M> {
    /// Variance of the residual psi - phi' theta per variance of the noise.
    pub(super) fn spread<const N: usize>(&self, theta: &[f32; N]) -> f32 {
        let mut spread = self.top;
        for (i, left) in theta.iter().enumerate().take(M) {
            spread -= 2.0 * left * self.vector[i];
            for (j, right) in theta.iter().enumerate().take(M) {
                spread += left * self.matrix[i][j] * right;
            }
        }
        spread
    }

    /// Bias Q e of the estimate `theta` by the noise `level` = n s that its rows hold, where
    /// `found` was taken out of it: e = level (M theta - m).
    pub(super) fn bias<const N: usize>(
        &self,
        theta: &[f32; N],
        p: &Matrix<N>,
        found: Option<&Correction<M, N>>,
        level: f32,
    ) -> [f32; N] {
        let score: [f32; M] =
            core::array::from_fn(|i| level * (along(&self.matrix[i], theta) - self.vector[i]));
        moved(&score, p, found)
    }
}

/// Change of the estimate by a change of its scores, of the parameters of y: P, or Q of what was
/// taken out, times that.
fn moved<const M: usize, const N: usize>(
    score: &[f32; M],
    p: &Matrix<N>,
    found: Option<&Correction<M, N>>,
) -> [f32; N] {
    let mut change = core::array::from_fn(|i| along(score, &p[i]));
    if let Some(Correction { y, .. }) = found {
        let seen = transposed(y, score);
        for (change, y) in change.iter_mut().zip(y) {
            *change += dot(y, &seen);
        }
    }
    change
}

/// Sum over the parameters of y, which are the first.
fn along<const M: usize, const N: usize>(a: &[f32; M], b: &[f32; N]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A' b, over the parameters of y.
fn transposed<const M: usize, const K: usize, const N: usize>(
    a: &[[f32; M]; K],
    b: &[f32; N],
) -> [f32; M] {
    let mut sum = [0.0; M];
    for (row, b) in a.iter().zip(b) {
        for (sum, a) in sum.iter_mut().zip(row) {
            *sum += a * b;
        }
    }
    sum
}

/// A corrected estimate, everything normalised.
pub(super) struct Correction<const M: usize, const N: usize> {
    /// theta_c.
    pub(super) theta: [f32; N],
    y: [[f32; M]; N],
    z: [[f32; M]; N],
    /// w over the one that was asked for, in [0, 1].
    pub(super) share: f32,
}

impl<const M: usize, const N: usize> Correction<M, N> {
    /// The correction of `bare` with the covariance `p` for the weight `level` = n s of the noise,
    /// which takes no more than `largest` < 1 of P^-1 in any direction; `None` for what is no
    /// number.
    #[inline(always)]
    pub(super) fn of(
        bare: &[f32; N],
        p: &Matrix<N>,
        noise: &NoiseMoments<M>,
        level: f32,
        largest: f32,
    ) -> Option<Self> {
        let l = root(&noise.matrix);
        let b: [[f32; M]; N] = core::array::from_fn(|i| transposed(&l, &p[i]));
        let mut s = [[0.0; M]; M];
        for (l, b) in l.iter().zip(&b) {
            for i in 0..M {
                for j in 0..M {
                    s[i][j] += l[i] * b[j];
                }
            }
        }
        let norm = sqrt(s.as_flattened().iter().map(|v| v * v).sum());
        let limited = level * norm > largest;
        let weight = if limited { largest / norm } else { level };
        for (i, row) in s.iter_mut().enumerate() {
            for entry in row.iter_mut() {
                *entry *= -weight;
            }
            row[i] += 1.0;
        }
        if !factor(&mut s) {
            return None;
        }
        let scale = sqrt(weight);
        let y: [[f32; M]; N] = core::array::from_fn(|i| forward(&s, b[i].map(|b| scale * b)));
        let z: [[f32; M]; N] = core::array::from_fn(|i| backward(&s, y[i]));
        let mut theta: [f32; N] =
            core::array::from_fn(|i| bare[i] - weight * along(&noise.vector, &p[i]));
        let seen = transposed(&l, &theta).map(|seen| scale * seen);
        for (value, z) in theta.iter_mut().zip(&z) {
            *value += dot(z, &seen);
        }
        if !theta.iter().all(|value| value.is_finite()) {
            return None;
        }
        let share = if limited { weight / level } else { 1.0 };
        Some(Self { theta, y, z, share })
    }

    /// The change of the estimate by the noise `level` in its rows, or as much less, for a drive
    /// whose parameters of y are off by these `sizes`, each on its own; the share of it that no
    /// estimate tells.
    pub(super) fn in_doubt(
        &self,
        p: &Matrix<N>,
        noise: &NoiseMoments<M>,
        level: f32,
        sizes: &[f32; M],
    ) -> [[f32; N]; M] {
        // M is symmetric.
        let mut changes =
            (noise.matrix).map(|row| moved(&row.map(|moment| level * moment), p, Some(self)));
        let own = changes.iter().enumerate();
        let trace = own.map(|(i, change)| change.get(i).copied().unwrap_or(0.0));
        let share = smaller(trace.sum(), 1.0);
        for (change, size) in changes.iter_mut().zip(sizes) {
            *change = change.map(|value| share * size * value);
        }
        changes
    }

    /// Column `index` of Y and of Z.
    pub(super) fn columns(&self, index: usize) -> [[f32; N]; 2] {
        let column = |rows: &[[f32; M]; N]| {
            core::array::from_fn(|j| rows[j].get(index).copied().unwrap_or(0.0))
        };
        [column(&self.y), column(&self.z)]
    }

    /// Adds Q - P to P.
    pub(super) fn add_gain(&self, p: &mut Matrix<N>) {
        add_square(p, &self.y);
    }

    /// Adds (Q - P) `score` to P `score`.
    pub(super) fn add_along(&self, score: &[f32; N], along: &mut [f32; N]) {
        let seen = transposed(&self.y, score);
        for (along, y) in along.iter_mut().zip(&self.y) {
            *along += dot(y, &seen);
        }
    }

    /// Adds P_c - P to P.
    pub(super) fn add_covariance(&self, p: &mut Matrix<N>) {
        add_square(p, &self.y);
        add_square(p, &self.z);
    }

    /// Adds row `index` of P_c - P to that of P.
    #[inline(always)]
    pub(super) fn add_row(&self, index: usize, row: &mut [f32; N]) {
        let (Some(y), Some(z)) = (self.y.get(index), self.z.get(index)) else {
            return;
        };
        for (j, entry) in row.iter_mut().enumerate() {
            *entry += dot(y, &self.y[j]) + dot(z, &self.z[j]);
        }
    }
}

/// Adds A A'.
fn add_square<const M: usize, const N: usize>(sum: &mut Matrix<N>, a: &[[f32; M]; N]) {
    for i in 0..N {
        for j in 0..N {
            sum[i][j] += dot(&a[i], &a[j]);
        }
    }
}

#[cfg(test)]
mod tests;
