//! Covariance of the trends behind a filter under white noise on y.

use crate::math::matrix::{Matrix, product, product_transposed};
use crate::trends::difference::Trends;

/// Covariances of the filtered trends of white noise of variance 1 on y.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseGain<const M: usize> {
    /// Between the trends of order i and j below m.
    pub lower: [[f32; M]; M],
    /// Between the trend of order i and the highest.
    pub mixed: [f32; M],
    /// Of the highest.
    pub top: f32,
}

/// Most doublings of the sum over time: 2^24 samples are longer than the memory of any filter in
/// f32.
const DOUBLINGS: usize = 24;

impl<const M: usize> NoiseGain<M> {
    /// No noise passes.
    pub const ZERO: Self = Self {
        lower: [[0.0; M]; M],
        mixed: [0.0; M],
        top: 0.0,
    };

    /// Between the trends of order i and j, m being the highest; `None` for those that are none.
    pub(crate) fn between(&self, i: usize, j: usize) -> Option<f32> {
        match (i == M, j == M) {
            (true, true) => Some(self.top),
            (true, false) => self.mixed.get(j).copied(),
            (false, true) => self.mixed.get(i).copied(),
            (false, false) => self.lower.get(i)?.get(j).copied(),
        }
    }

    /// Sum of g g' over the response g of `chain` to one unit sample, in closed form.
    ///
    /// `chain` takes its memory and a sample to the trends. With b the memory after the sample and
    /// F the step of the memory, `X = sum F^k b b' F'^k` doubles its number of terms by
    /// `X + F^n X F^n'`, `F^2n = F^n F^n`.
    pub(crate) fn of(chain: impl Fn(&mut [f32; M], f32) -> Trends<M>) -> Self {
        let mut gain = Self::ZERO;
        let mut memory = [0.0; M];
        let first = chain(&mut memory, 1.0);
        gain.add(&first, &first);
        // Columns of F, and the trends of a unit in each place of the memory.
        let mut step = [[0.0; M]; M];
        let mut seen = [first; M];
        for i in 0..M {
            let mut unit = [0.0; M];
            unit[i] = 1.0;
            seen[i] = chain(&mut unit, 0.0);
            for j in 0..M {
                step[j][i] = unit[j];
            }
        }
        let outer = |i: usize| core::array::from_fn(|j| memory[i] * memory[j]);
        let mut sum: Matrix<M> = core::array::from_fn(outer);
        for _ in 0..DOUBLINGS {
            let more = product_transposed(&product(&step, &sum), &step);
            let before = sum;
            for i in 0..M {
                for j in 0..M {
                    sum[i][j] += more[i][j];
                }
            }
            // What adds nothing adds nothing later: each further addition is that one, decayed.
            if sum == before {
                break;
            }
            step = product(&step, &step);
        }
        // C X C', one row of X at a time.
        for (seen_here, row) in seen.iter().zip(&sum) {
            gain.add(seen_here, &combined(&seen, row));
        }
        gain
    }

    /// Adds the outer product of two vectors of trends.
    fn add(&mut self, left: &Trends<M>, right: &Trends<M>) {
        for k in 0..M {
            for l in 0..M {
                self.lower[k][l] += left.lower[k] * right.lower[l];
            }
            self.mixed[k] += left.lower[k] * right.top;
        }
        self.top += left.top * right.top;
    }
}

/// The sum of trends with these weights.
fn combined<const M: usize>(trends: &[Trends<M>; M], weights: &[f32; M]) -> Trends<M> {
    let mut sum = Trends {
        lower: [0.0; M],
        top: 0.0,
    };
    for (trends, weight) in trends.iter().zip(weights) {
        for (sum, lower) in sum.lower.iter_mut().zip(&trends.lower) {
            *sum += weight * lower;
        }
        sum.top += weight * trends.top;
    }
    sum
}
