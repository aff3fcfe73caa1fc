//! What an estimate still has of another drive: the one before a change that was followed.
//!
//! The estimate begins again with the information of one row, and of nominal values, of the old
//! values both; after t rows lambda^t of it is left. If the drive has changed by Delta,
//!
//! ```text
//! theta - theta_new = P lambda^t Omega_0 (theta_old - theta_new)           Omega_0: one row + diag(1 / left_k)
//! Sigma <- Sigma + lambda^2t sum over k: (P e_k / left_k) (P e_k / left_k)'  +  (lambda^t / (1 + q t))^2 I
//! ```
//!
//! with every coefficient off by its design size, one in normalised quantities. `left_k` is what a
//! nominal value alone leaves of P_kk. The one row was the mean of many and holds every direction;
//! those behind the change tell something new once in 1/(4 omega) only, q = 4 omega Delta. P says
//! what noise of the present size would do, and nothing of values that are wrong.

use crate::estimation::terms::Parameter;
use crate::math::matrix::Matrix;
use crate::readout::source::ReadOut;

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
}

impl<const M: usize, const N: usize, const I: usize> ReadOut<'_, M, N, I> {
    /// Adds the uncertainty of what is left of another drive; the constant and the initial state
    /// are none of its coefficients.
    pub(super) fn add_former_drive(&self, p: &Matrix<N>, covariance: &mut Matrix<N>) {
        let Former { share, rows, .. } = self.former;
        if share == 0.0 {
            return;
        }
        let angle = 4.0 * self.bandwidth * self.design.sample_time;
        let row = share / (1.0 + rows * if angle < 1.0 { angle } else { 1.0 });
        let left = self.forgetting.left();
        for (k, parameter) in self.structure.parameters().into_iter().enumerate() {
            let coefficient = !matches!(parameter, Parameter::Constant | Parameter::InitialState);
            if !coefficient || p[k][k] == 0.0 {
                continue;
            }
            covariance[k][k] += row * row;
            let weight = share / left[k];
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
}
