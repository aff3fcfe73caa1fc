//! Sums over a pass of a fit, and how certain they make the parameters.

use crate::math::matrix::{Matrix, forward};
use crate::math::sqrt;
use crate::servo::commissioning::predictor::PARAMETERS;

/// Standard deviations, in scales, with which the parameters are known beforehand: weak, so that
/// nothing runs away.
const PRIOR: [f32; PARAMETERS] = [5.0, 3.0, 5.0, 2.0, 2.0, 3.0, 5.0, 0.7, 2.4, 1.0];
/// Largest correlation of neighbouring errors that counts.
const CORRELATION_MAX: f32 = 0.8;

/// Sums over a pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sums {
    pub(crate) normal: Matrix<PARAMETERS>,
    pub(crate) gradient: [f32; PARAMETERS],
    pub(crate) cost: f32,
    /// Sum of products of neighbouring errors, and the last error.
    pub(crate) lagged: f32,
    pub(crate) last: f32,
    pub(crate) count: u32,
}

/// Columns of a factor of the normal equations that are worked out in a sample.
pub(crate) const HALF: usize = PARAMETERS / 2;

/// No point yet.
pub(crate) const NO_SUMS: Sums = Sums {
    normal: [[0.0; PARAMETERS]; PARAMETERS],
    gradient: [0.0; PARAMETERS],
    cost: 0.0,
    lagged: 0.0,
    last: 0.0,
    count: 0,
};

impl Sums {
    /// Adds a point. Slopes are smooth: those of every other point are those of two.
    #[inline]
    pub(crate) fn add(&mut self, slope: &[f32; PARAMETERS], error: f32) {
        for (sum, si) in self.gradient.iter_mut().zip(slope) {
            *sum += si * error;
        }
        if self.count.is_multiple_of(2) {
            self.double(slope);
        }
        self.cost += error * error;
        self.lagged += error * self.last;
        self.last = error;
        self.count += 1;
    }

    /// Adds the products of the slopes of a point twice.
    #[inline]
    fn double(&mut self, slope: &[f32; PARAMETERS]) {
        let twice = slope.map(|s| s + s);
        let [row0, row1, row2, row3, row4, row5, row6, row7, row8, row9] = &mut self.normal;
        add::<1>(row0, slope, &twice);
        add::<2>(row1, slope, &twice);
        add::<3>(row2, slope, &twice);
        add::<4>(row3, slope, &twice);
        add::<5>(row4, slope, &twice);
        add::<6>(row5, slope, &twice);
        add::<7>(row6, slope, &twice);
        add::<8>(row7, slope, &twice);
        add::<9>(row8, slope, &twice);
        add::<10>(row9, slope, &twice);
    }

    /// Variance of an error that counts alone: neighbouring errors are alike.
    pub(crate) fn variance(&self) -> f32 {
        let correlation = self.lagged / self.cost;
        let correlation = if correlation > CORRELATION_MAX {
            CORRELATION_MAX
        } else if correlation > 0.0 {
            correlation
        } else {
            0.0
        };
        let factor = (1.0 + correlation) / (1.0 - correlation);
        factor * self.cost / (self.count as f32 + 1.0)
    }

    /// What is added to the diagonal of the normal equations for what is known of the parameters
    /// beforehand, in these scales.
    pub(crate) fn prior(&self, scale: &[f32; PARAMETERS]) -> [f32; PARAMETERS] {
        let variance = self.variance();
        core::array::from_fn(|j| {
            let known = PRIOR[j] * scale[j];
            variance / (known * known)
        })
    }

    /// The normal equations with the parameters in reverse order, in these scales: those of the
    /// standard deviations are the last ones, and the last rows of the Cholesky factor that of the
    /// inverse of their own covariance.
    pub(crate) fn reversed(&self, scale: &[f32; PARAMETERS]) -> Matrix<PARAMETERS> {
        let prior = self.prior(scale);
        let last = PARAMETERS - 1;
        let mut reversed = [[0.0; PARAMETERS]; PARAMETERS];
        for (i, row) in reversed.iter_mut().enumerate() {
            for (j, value) in row.iter_mut().enumerate().take(i + 1) {
                *value = self.normal[last - j][last - i];
            }
            row[i] += prior[last - i];
        }
        reversed
    }

    /// Standard deviations of a1, a2 and of the gain b0/a1, in the scales of a1, a2 and b0, and of
    /// the dead zone in its scale, by the Cholesky factor of [`Self::reversed`].
    pub(crate) fn std(&self, factor: &Matrix<PARAMETERS>, scale: &[f32; PARAMETERS]) -> [f32; 4] {
        let variance = self.variance();
        let [.., r4, r5, r6, r7] = factor;
        let own = [r4, r5, r6, r7].map(|[.., dead_zone, b0, a2, a1]| [*dead_zone, *b0, *a2, *a1]);
        let [a1, a2, b0, dead_zone, ..] = scale.map(|s| 1.0 / s);
        let of = |direction: [f32; 4]| {
            let seen = forward(&own, direction);
            let squares: f32 = seen.iter().map(|x| x * x).sum();
            sqrt(variance * squares)
        };
        [
            of([0.0, 0.0, 0.0, a1]),
            of([0.0, 0.0, a2, 0.0]),
            of([0.0, b0, 0.0, -a1]),
            of([dead_zone, 0.0, 0.0, 0.0]),
        ]
    }
}

/// Adds the products of the last of the first K slopes with twice all of them: a row of the lower
/// triangle, without a loop.
#[inline(always)]
fn add<const K: usize>(
    row: &mut [f32; PARAMETERS],
    slope: &[f32; PARAMETERS],
    twice: &[f32; PARAMETERS],
) {
    const { assert!(K > 0 && K <= PARAMETERS) }
    for j in 0..K {
        row[j] += slope[K - 1] * twice[j];
    }
}

#[cfg(test)]
mod tests;
