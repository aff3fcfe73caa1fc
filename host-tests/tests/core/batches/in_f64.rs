//! Standard deviations from blocks in f64.

use nalgebra::{DMatrix, DVector};
use trendid_host_tests::signals::experiment::Record;

use crate::common::servo_rows;

/// What the equation of `theta` (a1, a2, ..) leaves of a position alone.
fn left_of(y: impl Fn(usize) -> f64, like: &Record, theta: &[f64]) -> DVector<f64> {
    let mut record = like.clone();
    record.u.fill(0.0);
    record.y = (0..like.len()).map(y).collect();
    let (phi, psi) = servo_rows(&record);
    psi - phi.column(0) * theta[0] - phi.column(1) * theta[1]
}

/// Standard deviations of a1, a2, b0 in f64: rows of the oracle from sample `first` on, blocks of
/// equal length, scores at the estimate in f64; and an error of the first position as large as the
/// noise of all others.
pub(crate) fn in_f64(record: &Record, first: usize) -> ([f64; 3], f64) {
    let (phi, psi) = servo_rows(record);
    let n = phi.nrows() - first;
    let (phi, psi) = (phi.rows(first, n), psi.rows(first, n));
    let scale = DVector::from_fn(5, |j, _| phi.column(j).norm());
    let phi = DMatrix::from_fn(n, 5, |k, j| phi[(k, j)] / scale[j]);
    let information = (phi.transpose() * &phi).full_piv_lu();
    let theta = information.solve(&(phi.transpose() * psi)).unwrap();
    let residual = psi - &phi * &theta;
    let mut length = 8;
    while n / length >= 16 {
        length *= 2;
    }
    let mut sum = DMatrix::zeros(5, 5);
    let (mut begin, mut squares) = (0, 0.0);
    while begin < n {
        let count = length.min(n - begin);
        let score = phi.rows(begin, count).transpose() * residual.rows(begin, count);
        let influence = information.solve(&score).unwrap();
        sum += &influence * influence.transpose();
        squares += (count * count) as f64;
        begin += count;
    }
    let blocks = (n * n) as f64 / squares;
    let in_units = [0, 1].map(|j| theta[j] / scale[j]);
    let spread = left_of(|k| f64::from(u8::from(k == 1)), record, &in_units).norm_squared();
    let step = left_of(|k| -f64::from(u8::from(k > 0)), record, &in_units);
    let begun = information
        .solve(&(phi.transpose() * step.rows(first, n)))
        .unwrap();
    let noise = residual.norm_squared() / (n as f64 - 5.0) / spread;
    let variance = |j: usize| {
        let by_scores = sum[(j, j)] * blocks / (blocks - 3.0);
        (by_scores + begun[j] * begun[j] * noise) / (scale[j] * scale[j])
    };
    ([0, 1, 2].map(|j| variance(j).sqrt()), blocks)
}
