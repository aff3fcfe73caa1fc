//! What rounding to f32 makes of an estimate.
//!
//! Samples, trends and their coefficients are rounded. The error of a coefficient, or of a level
//! that returns, is no noise: it is the same wherever the signals are, so that the scores of the
//! blocks do not contain all of it. Column j of the equations is taken to be wrong by the same
//! share in the whole record and by another one in each block:
//!
//! ```text
//! P = r e^2 sum_j theta_j^2 (1_j 1_j' + sum_b x_bj x_bj')    x_bj = M^-1 (column j of M_b)
//! r = 2 m + 1    of the sample, and of coefficient and sum of each of m integrations
//! ```
//!
//! and the left-hand side as a column whose parameter is 1; so is that of a delay, the difference
//! of two samples of which each is rounded. Known as: the error of least squares by perturbed
//! columns (Golub and Van Loan, Matrix Computations, section 5.3).

use nalgebra::DMatrix;

use crate::instruments::factored::Factored;
use crate::instruments::spread::Score;

/// Error of a number by rounding to f32, over its size: at most.
const ROUNDING: f64 = 0.5 * f32::EPSILON as f64;

/// Standard deviation of the share by which a column is wrong behind filters of an order.
fn share(order: usize) -> f64 {
    ROUNDING * ((2 * order + 1) as f64).sqrt()
}

/// Standard deviation of a delay by rounding \[samples\], behind the filter f_0 .. f_{m-1}: a share
/// of the time of one of its integrations, `f_0^(-1/m)`.
pub(super) fn rounding_of_delay(filter: &[f64], dt: f64) -> f64 {
    let rate = filter[0].powf(1.0 / filter.len() as f64);
    share(filter.len()) / (rate * dt)
}

/// Covariance of the parameters `theta` by rounding behind filters of an order; `None` where the
/// equations are singular.
pub(super) fn rounding(
    factored: &Factored,
    scores: &[Score],
    theta: &[f64],
    order: usize,
) -> Option<DMatrix<f64>> {
    let n = theta.len();
    let mut covariance = DMatrix::from_fn(n, n, |i, j| match i == j {
        true => theta[j].powi(2),
        false => 0.0,
    });
    for score in scores {
        let mut columns = score.matrix.clone();
        let mut right = score.left.clone();
        for (mut column, theta) in columns.column_iter_mut().zip(theta) {
            column *= *theta;
            right += &column;
        }
        let moves = factored.solve_columns(&columns)?;
        let of_right = factored.solve(&right)?;
        covariance += &moves * moves.transpose() + &of_right * of_right.transpose();
    }
    Some(share(order).powi(2) * covariance)
}
