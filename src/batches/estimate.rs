//! From the snapshots to an estimate.

use crate::batches::Batched;
use crate::estimation::rls::Estimator;
use crate::math::matrix::{Matrix, add_square};
use crate::readout::estimate::Estimate;
use crate::trends::TrendOperator;

/// Blocks below which their spread is too uncertain.
const FEWEST: f32 = 8.0;

/// An estimate by least squares and what its standard deviations rest on.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Batches<const M: usize, const N: usize, const I: usize> {
    /// The model.
    pub estimate: Estimate<M, N, I>,
    /// Whether the standard deviations come from the blocks; otherwise they are those of the
    /// identifier, because there are fewer than 8 blocks, or because the noise of y in the
    /// regressors is larger than the motion.
    pub by_blocks: bool,
    /// How many blocks of equal length would spread the samples as these.
    pub effective_blocks: f32,
}

/// Spread of the estimate over the blocks.
struct Spread<'a, const N: usize> {
    gain: &'a Matrix<N>,
    covariance: Matrix<N>,
    /// Sums of the weights of the samples that were forgotten for in each block, and of their
    /// squares.
    samples: f32,
    squares: f32,
}

impl<const N: usize> Spread<'_, N> {
    /// Adds a block with its scores and the weight of its samples.
    fn add(&mut self, score: &[f32; N], samples: f32) {
        let influence: [f32; N] =
            core::array::from_fn(|i| self.gain[i].iter().zip(score).map(|(g, s)| g * s).sum());
        add_square(&mut self.covariance, &influence, 1.0);
        self.samples += samples;
        self.squares += samples * samples;
    }
}

impl<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize, const D: usize>
    Batched<T, M, N, I, D>
{
    /// The model with standard deviations from the blocks, or those of the identifier, as the
    /// result states.
    ///
    /// Cost: see the table of instruction counts.
    pub fn estimate(&self) -> Batches<M, N, I> {
        let mut blocks = 0.0;
        let estimator = self.identifier.estimator();
        let found = (self.identifier.read_out()).under(|theta, gain| {
            let (covariance, count) = self.spread(estimator, theta, gain);
            blocks = count;
            let finite = covariance.as_flattened().iter().all(|v| v.is_finite());
            (blocks >= FEWEST && finite).then_some(covariance)
        });
        Batches {
            by_blocks: found.is_some(),
            estimate: found.unwrap_or_else(|| self.identifier.estimate()),
            effective_blocks: blocks,
        }
    }

    /// Covariance of the parameters, normalised, and the number of blocks.
    #[inline(never)]
    fn spread(
        &self,
        estimator: &Estimator<N>,
        theta: &[f32; N],
        gain: &Matrix<N>,
    ) -> (Matrix<N>, f32) {
        let now = self.snapshots.now(estimator);
        if !(now.samples > 0.0) {
            return ([[0.0; N]; N], 0.0);
        }
        // What takes the bias of noise out is as much for every sample: the scores then add up to
        // what the prior adds.
        let mean = now.score(theta).map(|d| d / now.samples);
        let mut spread = Spread {
            gain,
            covariance: [[0.0; N]; N],
            samples: 0.0,
            squares: 0.0,
        };
        let begin = (&self.snapshots.begin, self.snapshots.begin_weight());
        let (mut before, mut samples, mut forgotten) = ([0.0; N], 0.0, 0.0);
        let ends = core::iter::once(begin)
            .chain(self.snapshots.iter())
            .chain(core::iter::once((&now, 1.0)));
        for (end, weight) in ends {
            let rows = weight * end.samples - samples;
            let sum = end.score(theta).map(|d| weight * d);
            if rows > 0.0 {
                let score = core::array::from_fn(|j| sum[j] - before[j] - rows * mean[j]);
                spread.add(&score, weight * end.forgotten - forgotten);
            }
            (before, samples, forgotten) = (sum, weight * end.samples, weight * end.forgotten);
        }
        let blocks = spread.samples * (spread.samples / spread.squares);
        let freedom = freedom(blocks);
        for value in spread.covariance.as_flattened_mut() {
            *value *= freedom;
        }
        (spread.covariance, blocks)
    }
}

/// Variance of the estimate per sum of squares of the influences of K blocks.
///
/// The mean of their scores is known: K/(K-1). The variance is itself an estimate with K-1 degrees
/// of freedom, so that an error over the standard deviation has Student's distribution; what is
/// reported is the standard deviation of that, (K-1)/(K-3) times the variance.
fn freedom(blocks: f32) -> f32 {
    blocks / (blocks - 3.0)
}
