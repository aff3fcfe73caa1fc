//! What an estimate still has of another drive: the one before a change that was followed.
//!
//! The estimate begins again with the old values as nominal ones; after t rows lambda^t of them is
//! left. The first rows carry some e^-3 of what the filter had of the old drive, which goes with
//! the time constant of its pair.
//!
//! ```text
//! theta - theta_new = P lambda^t (diag(1 / left_k) + R_0) (theta_old - theta_new)
//! Sigma <- Sigma + lambda^2t sum over k: (P e_k / left_k) (P e_k / left_k)'  +  (lambda^t / (1 + q t))^2 I
//! ```
//!
//! with every coefficient off by its design size, one in normalised quantities. `left_k` is what a
//! nominal value alone leaves of P_kk. Rows tell something new once in 1/(4 omega) only,
//! q = 4 omega Delta; what the first of them carry, R_0, is less than one that does, in whatever
//! direction. P says what noise of the present size would do, and nothing of values that are wrong.

use crate::math::matrix::Matrix;

/// What counts of the drive before the newest change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Former {
    /// Whether nothing else does: no row of the new drive has been taken.
    pub(super) alone: bool,
    /// lambda^t; 0 where no change was found.
    share: f32,
    /// t, weighed by the memory.
    rows: f32,
}

impl Former {
    /// Of no other drive.
    pub(crate) const NONE: Self = Self {
        alone: false,
        share: 0.0,
        rows: 0.0,
    };

    /// Behind a change, `rows` as the sum of their weights; `eps` is 1 - lambda.
    pub(crate) fn behind(alone: bool, rows: f32, eps: f32) -> Self {
        let share = 1.0 - eps * rows;
        let share = if share > 0.0 { share } else { 0.0 };
        Self { alone, share, rows }
    }

    /// Adds the uncertainty of what is left of another drive to that of its `coefficients`: the
    /// constant and the initial state are none, nor is what is known. `angle` is omega Delta.
    pub(super) fn add<const N: usize>(
        &self,
        coefficients: [bool; N],
        left: impl FnOnce() -> [f32; N],
        angle: f32,
        p: &Matrix<N>,
        covariance: &mut Matrix<N>,
    ) {
        if self.share == 0.0 {
            return;
        }
        let (left, new) = (left(), 4.0 * angle);
        let row = self.share / (1.0 + self.rows * if new < 1.0 { new } else { 1.0 });
        for k in (0..N).filter(|k| coefficients[*k]) {
            covariance[k][k] += row * row;
            let weight = self.share / left[k];
            for i in 0..N {
                for j in 0..N {
                    covariance[i][j] += (p[i][k] * weight) * (p[j][k] * weight);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_of_another_drive_goes_with_the_memory() {
        let behind = |rows| Former::behind(false, rows, 0.01);
        assert_eq!(behind(0.0).share, 1.0);
        assert!((behind(50.0).share - 0.5).abs() < 1e-6);
        assert_eq!(behind(100.1).share, 0.0);
        assert_eq!(Former::NONE.share, 0.0);
    }

    #[test]
    fn a_row_and_the_nominal_values_of_the_old_drive_are_added() {
        let former = Former::behind(false, 50.0, 0.01);
        let (p, mut covariance) = ([[0.2, 0.1], [0.1, 0.3]], [[0.0; 2]; 2]);
        // Every eighth row tells something new: a share of 0.5 in 1 + 50/8 rows.
        let row = (0.5_f32 / 7.25) * (0.5 / 7.25);
        former.add([true, false], || [2.0, 9.0], 0.031_25, &p, &mut covariance);
        for (i, j, expected) in [(0, 0, row + 0.0025), (0, 1, 0.00125), (1, 1, 0.000_625)] {
            assert!((covariance[i][j] - expected).abs() < 1e-7, "{covariance:?}");
        }
        let before = covariance;
        Former::NONE.add([true; 2], || [1.0; 2], 0.02, &p, &mut covariance);
        assert_eq!(covariance, before);
        // At most every row does.
        former.add([true, false], || [1e9; 2], 3.0, &p, &mut covariance);
        let row = (0.5_f32 / 51.0) * (0.5 / 51.0);
        assert!((covariance[0][0] - before[0][0] - row).abs() < 1e-8);
    }
}
