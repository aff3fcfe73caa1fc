//! How much an estimate by instruments varies: from the scores of blocks of time.
//!
//! Known as: cluster-robust covariance with bias reduced linearisation (Bell and McCaffrey, Survey
//! Methodology 28 (2002)).
//!
//! ```text
//! s_b = g_b - G_b theta      i_b = M^-1 s_b      H_b = M^-1 G_b         M = sum G_b, p parameters, K blocks
//! V   = sum j_b j_b'         j_b = (1 + H_b/2 + 3/8 H_b^2) i_b
//! ```
//!
//! Three things make the scores of few blocks smaller than their noise.
//!
//! - theta follows each block: of its noise `(1 - H_b)^(1/2)` is left. j_b is the inverse to second
//!   order, which no block makes large: for `H_b = 1` the series gives 1.9.
//! - Blocks shorter than the noise remembers are not independent. Their correlation is compared
//!   with that of white noise, of which theta takes a part that follows from the H_b:
//!   ```text
//!   v   = sum s_b' i_b / (p - sum tr H_b^2)
//!   r   = (sum s_b' i_b+1 + v sum tr H_b H_b+1) / (p v)
//!   rho = TAKEN (r - 1/sqrt(p K))     V <- V (1 + rho) / (1 - rho)      as of noise with rho^|b - c| between blocks
//!   ```
//! - V is itself found from K blocks, so that an error over its root has Student's distribution
//!   with K - 1 degrees of freedom. What is reported is half of what covers 95.4 %, so that twice
//!   the deviation covers as much as of a normal error (Abramowitz and Stegun, 26.7.5):
//!   ```text
//!   t/2 = 1 + 1.25/n + 1.53/n^2         n = K - 1
//!   ```

use crate::instruments::solve::Factored;
use crate::math::matrix::{Matrix, add_square, dot};
use crate::math::sqrt;

/// Correlation between neighbours over what theta leaves of it beyond a standard deviation of
/// chance, 1/sqrt(p K); for records of 2.5 to 15 correlation times of the noise, seeds 1001
/// to 1300.
const TAKEN: f32 = 3.0;

/// Beyond this correlation there is hardly a second block.
const MOST: f32 = 0.8;

/// Sums over the blocks so far.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Spread<const N: usize> {
    /// sum j_b j_b'.
    covariance: Matrix<N>,
    /// Sum of the fourth powers of j_b.
    fourth: [f32; N],
    /// s, i and H of the block before.
    score: [f32; N],
    influence: [f32; N],
    share: Matrix<N>,
    /// Sums of s_b' i_b and of tr H_b^2, then of neighbours.
    own: [f32; 2],
    neighbours: [f32; 2],
}

/// The covariance of a whole record.
pub(super) struct Found<const N: usize> {
    pub(super) covariance: Matrix<N>,
    /// Independent blocks of equal variance with this spread.
    pub(super) effective: f32,
}

impl<const N: usize> Spread<N> {
    pub(super) const ZERO: Self = Self {
        covariance: [[0.0; N]; N],
        fourth: [0.0; N],
        score: [0.0; N],
        influence: [0.0; N],
        share: [[0.0; N]; N],
        own: [0.0; 2],
        neighbours: [0.0; 2],
    };

    /// Adds a block with its matrix G_b and its score; whether it follows the one before without a
    /// gap.
    pub(super) fn add(
        &mut self,
        factored: &Factored<N>,
        matrix: &Matrix<N>,
        score: [f32; N],
        follows: bool,
    ) {
        let influence = factored.solve(&score);
        let mut share = [[0.0; N]; N];
        for j in 0..N {
            let column = factored.solve(&core::array::from_fn(|i| matrix[i][j]));
            for (row, value) in share.iter_mut().zip(column) {
                row[j] = value;
            }
        }
        self.own[0] += dot(&score, &influence);
        self.own[1] += trace(&share, &share);
        if follows {
            self.neighbours[0] +=
                0.5 * (dot(&score, &self.influence) + dot(&self.score, &influence));
            self.neighbours[1] += trace(&share, &self.share);
        }
        let once = times(&share, &influence);
        let twice = times(&share, &once);
        let whole: [f32; N] =
            core::array::from_fn(|i| influence[i] + 0.5 * once[i] + 0.375 * twice[i]);
        add_square(&mut self.covariance, &whole, 1.0);
        for (fourth, whole) in self.fourth.iter_mut().zip(whole) {
            let square = whole * whole;
            *fourth += square * square;
        }
        (self.score, self.influence, self.share) = (score, influence, share);
    }

    /// rho of neighbours, in 0 .. [`MOST`].
    fn correlation(&self, blocks: f32, parameters: f32) -> f32 {
        let level = self.own[0] / (parameters - self.own[1]);
        let seen = (self.neighbours[0] + level * self.neighbours[1]) / (parameters * level);
        let rho = TAKEN * (seen - 1.0 / sqrt(parameters * blocks));
        // Instruments that hardly move with y have no level.
        if level > 0.0 && rho > 0.0 {
            rho.min(MOST)
        } else {
            0.0
        }
    }

    /// sum j_b j_b', without the corrections for few and dependent blocks.
    pub(super) const fn scores(&self) -> &Matrix<N> {
        &self.covariance
    }

    /// The covariance by so many `blocks` of equal length, more than one, for so many `parameters`;
    /// `fixed` are those that were not solved for.
    pub(super) fn found(&self, blocks: f32, parameters: f32, fixed: &[bool; N]) -> Found<N> {
        let rho = self.correlation(blocks, parameters);
        let independent = (1.0 - rho) / (1.0 + rho);
        let freedom = blocks - 1.0;
        let student = 1.0 + 1.25 / freedom + 1.53 / (freedom * freedom);
        let factor = student * student / independent;
        let mut effective = blocks;
        for j in 0..N {
            let square = self.covariance[j][j];
            let found = 3.0 * square * (square / self.fourth[j]);
            if !fixed[j] && found < effective {
                effective = found;
            }
        }
        Found {
            covariance: self.covariance.map(|row| row.map(|value| value * factor)),
            effective: effective * independent,
        }
    }
}

fn times<const N: usize>(a: &Matrix<N>, x: &[f32; N]) -> [f32; N] {
    core::array::from_fn(|i| dot(&a[i], x))
}

/// tr A B.
fn trace<const N: usize>(a: &Matrix<N>, b: &Matrix<N>) -> f32 {
    let mut sum = 0.0;
    for i in 0..N {
        for j in 0..N {
            sum += a[i][j] * b[j][i];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Uniform in -1 .. 1.
    struct Random(u32);

    impl Random {
        fn next(&mut self) -> f32 {
            self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (self.0 >> 8) as f32 / 8_388_608.0 - 1.0
        }
    }

    /// Deviations of two parameters in blocks with the noise `lag` x before + fresh, over what the
    /// estimates vary: root mean squares over many draws.
    fn ratio(lag: f32, blocks: usize) -> [f32; 2] {
        let mut random = Random(1);
        let (mut reported, mut squares) = ([0.0; 2], [0.0; 2]);
        for _ in 0..4000 {
            let (mut noise, mut matrices, mut sides) = (0.0, [[[0.0; 2]; 2]; 16], [[0.0; 2]; 16]);
            let mut total = ([[0.0; 2]; 2], [0.0; 2]);
            for (matrix, side) in matrices.iter_mut().zip(&mut sides).take(blocks) {
                for _ in 0..8 {
                    noise = lag * noise + random.next();
                    let phi = [1.0, random.next()];
                    for i in 0..2 {
                        for j in 0..2 {
                            matrix[i][j] += phi[i] * phi[j];
                            total.0[i][j] += phi[i] * phi[j];
                        }
                        side[i] += phi[i] * noise;
                        total.1[i] += phi[i] * noise;
                    }
                }
            }
            let factored = Factored::new(&total.0).unwrap();
            let theta = factored.solve(&total.1);
            let mut spread = Spread::ZERO;
            for (matrix, side) in matrices.iter().zip(&sides).take(blocks) {
                let score = core::array::from_fn(|i| side[i] - dot(&matrix[i], &theta));
                spread.add(&factored, matrix, score, true);
            }
            let found = spread.found(blocks as f32, 2.0, &[false; 2]);
            for i in 0..2 {
                reported[i] += found.covariance[i][i];
                squares[i] += theta[i] * theta[i];
            }
        }
        core::array::from_fn(|i| sqrt(reported[i] / squares[i]))
    }

    /// White noise: the factor of Student's distribution is left, and a little for correlation by
    /// chance.
    #[test]
    fn deviations_are_as_wide_as_estimates_vary() {
        for (blocks, student) in [(8, 1.21), (16, 1.09)] {
            for ratio in ratio(0.0, blocks) {
                assert!(
                    (0.98..1.1).contains(&(ratio / student)),
                    "{blocks}: {ratio}"
                );
            }
        }
    }

    /// Noise that remembers two blocks: without the correlation the mean would be half as uncertain
    /// as it is.
    #[test]
    fn blocks_that_are_not_independent_widen_the_deviations() {
        let [mean, _] = ratio(0.94, 16);
        assert!((0.9..1.6).contains(&mean), "{mean}");
    }

    #[test]
    fn a_block_that_is_all_there_is_stays_finite() {
        let matrix = [[2.0, 0.5], [0.5, 1.0]];
        let factored = Factored::new(&matrix).unwrap();
        let mut spread = Spread::ZERO;
        spread.add(&factored, &matrix, [1.0, -1.0], false);
        let found = spread.found(2.0, 2.0, &[false; 2]);
        assert!(
            found
                .covariance
                .as_flattened()
                .iter()
                .all(|v| v.is_finite())
        );
    }
}
