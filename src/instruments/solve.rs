//! The combined equations `M theta = r`, not symmetric, by orthogonal columns.
//!
//! Rows and columns are brought to size one, then `M = Q R` by the modified Gram-Schmidt process
//! with the right-hand side as a further column (Bjorck, BIT 7 (1967)): as stable as Householder's,
//! and without pivots there is no index that could be out of bounds.

use crate::math::matrix::{Matrix, dot};
use crate::math::sqrt;

/// A column that keeps less than this share of its length beside the others is one of them.
const SINGULAR: f32 = 1e-4;

/// Sweeps that bring rows and columns to size one.
const SWEEPS: usize = 2;

/// A matrix ready to solve for any right-hand side.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Factored<const N: usize> {
    /// Q, column by column.
    columns: Matrix<N>,
    /// R, above the diagonal and on it.
    upper: Matrix<N>,
    /// Divisors of the rows and of the columns.
    rows: [f32; N],
    sizes: [f32; N],
}

impl<const N: usize> Factored<N> {
    /// `None` where the matrix is singular in f32, or has an entry that is not finite.
    pub(crate) fn new(matrix: &Matrix<N>) -> Option<Self> {
        let mut scaled = *matrix;
        let (mut rows, mut sizes) = ([1.0; N], [1.0; N]);
        for _ in 0..SWEEPS {
            for i in 0..N {
                let largest = (0..N).fold(0.0_f32, |m, j| m.max(scaled[i][j].abs()));
                if !(largest > f32::MIN_POSITIVE && largest.is_finite()) {
                    return None;
                }
                rows[i] *= largest;
                scaled[i] = scaled[i].map(|value| value / largest);
            }
            for j in 0..N {
                let largest = (0..N).fold(0.0_f32, |m, i| m.max(scaled[i][j].abs()));
                if !(largest > f32::MIN_POSITIVE && largest.is_finite()) {
                    return None;
                }
                sizes[j] *= largest;
                for row in &mut scaled {
                    row[j] /= largest;
                }
            }
        }
        let mut columns: Matrix<N> =
            core::array::from_fn(|j| core::array::from_fn(|i| scaled[i][j]));
        let mut upper = [[0.0; N]; N];
        for j in 0..N {
            let before = length(&columns[j]);
            for k in 0..j {
                let share = dot(&columns[k], &columns[j]);
                upper[k][j] = share;
                for i in 0..N {
                    columns[j][i] -= share * columns[k][i];
                }
            }
            let left = length(&columns[j]);
            if !(left > SINGULAR * before) {
                return None;
            }
            upper[j][j] = left;
            columns[j] = columns[j].map(|value| value / left);
        }
        Some(Self {
            columns,
            upper,
            rows,
            sizes,
        })
    }

    /// The solution for a right-hand side.
    pub(crate) fn solve(&self, right: &[f32; N]) -> [f32; N] {
        let mut left: [f32; N] = core::array::from_fn(|i| right[i] / self.rows[i]);
        let mut x = [0.0; N];
        for j in 0..N {
            x[j] = dot(&self.columns[j], &left);
            for i in 0..N {
                left[i] -= x[j] * self.columns[j][i];
            }
        }
        for j in (0..N).rev() {
            for k in j + 1..N {
                x[j] -= self.upper[j][k] * x[k];
            }
            x[j] /= self.upper[j][j];
        }
        core::array::from_fn(|j| x[j] / self.sizes[j])
    }

    /// The solution, once refined.
    pub(crate) fn solve_refined(&self, matrix: &Matrix<N>, right: &[f32; N]) -> [f32; N] {
        let mut x = self.solve(right);
        let left =
            core::array::from_fn(|i| (0..N).fold(right[i], |left, j| left - matrix[i][j] * x[j]));
        let step = self.solve(&left);
        for (value, step) in x.iter_mut().zip(step) {
            *value += step;
        }
        x
    }
}

fn length<const N: usize>(a: &[f32; N]) -> f32 {
    sqrt(dot(a, a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_of_any_scale_is_solved() {
        // x = (1, -2, 3) with columns and rows of sizes 1e-6 to 1e6, not symmetric.
        let plain = [[2.0, 1.0, 0.0], [-1.0, 3.0, 0.5], [0.2, 0.0, 1.0]];
        let (rows, columns): ([f32; 3], [f32; 3]) = ([1e6, 1.0, 1e-6], [1e-3, 10.0, 1.0]);
        let matrix: Matrix<3> =
            core::array::from_fn(|i| core::array::from_fn(|j| plain[i][j] * rows[i] * columns[j]));
        let right = core::array::from_fn(|i| {
            (0..3)
                .map(|j| plain[i][j] * [1.0, -2.0, 3.0][j])
                .sum::<f32>()
                * rows[i]
        });
        let found = Factored::new(&matrix)
            .unwrap()
            .solve_refined(&matrix, &right);
        for (found, wanted) in found.iter().zip([1.0 / 1e-3, -2.0 / 10.0, 3.0]) {
            assert!((found / wanted - 1.0).abs() < 1e-6, "{found} {wanted}");
        }
    }

    #[test]
    fn what_cannot_be_solved_is_said() {
        assert_eq!(Factored::new(&[[1.0, 2.0], [2.0, 4.0]]), None);
        assert_eq!(Factored::new(&[[1.0, 0.0], [0.0, 0.0]]), None);
        assert_eq!(Factored::new(&[[f32::NAN, 0.0], [0.0, 1.0]]), None);
        assert_eq!(Factored::new(&[[f32::INFINITY, 0.0], [0.0, 1.0]]), None);
    }
}
