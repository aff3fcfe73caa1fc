//! Standard deviations from blocks in f64.

use nalgebra::{DMatrix, DVector};
use trendid_host_tests::signals::experiment::Record;

use crate::common::servo_rows;

/// Standard deviations of a1, a2, b0 in f64: rows of the oracle, blocks of equal length, scores at
/// the estimate in f64.
pub(crate) fn in_f64(record: &Record) -> ([f64; 3], f64) {
    let (phi, psi) = servo_rows(record);
    let scale = DVector::from_fn(5, |j, _| phi.column(j).norm());
    let phi = DMatrix::from_fn(phi.nrows(), 5, |k, j| phi[(k, j)] / scale[j]);
    let information = (phi.transpose() * &phi).full_piv_lu();
    let theta = information.solve(&(phi.transpose() * &psi)).unwrap();
    let residual = &psi - &phi * &theta;
    // The trends of the first sample give no row.
    let n = phi.nrows() - 1;
    let mut length = 8;
    while n / length >= 16 {
        length *= 2;
    }
    let mut sum = DMatrix::zeros(5, 5);
    let (mut first, mut squares) = (0, 0.0);
    while first < n {
        let count = length.min(n - first);
        let score = phi.rows(1 + first, count).transpose() * residual.rows(1 + first, count);
        let influence = information.solve(&score).unwrap();
        sum += &influence * influence.transpose();
        squares += (count * count) as f64;
        first += count;
    }
    let blocks = (n * n) as f64 / squares;
    let variance = |j: usize| sum[(j, j)] / (scale[j] * scale[j]) * blocks / (blocks - 3.0);
    ([0, 1, 2].map(|j| variance(j).sqrt()), blocks)
}
