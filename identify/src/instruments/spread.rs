//! How much an estimate varies, from the scores of the blocks of its record.
//!
//! What `trendid::instruments` does behind its sums, in f64 and for whatever number of parameters:
//! scores without what the estimate has taken of them, the correlation of neighbours, Student's
//! distribution. The reasons stand there.

use nalgebra::{DMatrix, DVector};

use crate::instruments::factored::Factored;

/// Correlation between neighbours over what the estimate leaves of it; as in the core.
const TAKEN: f64 = 3.0;

/// Beyond this correlation there is hardly a second block; as in the core.
const MOST: f64 = 0.8;

/// The equations of a block at the parameters of the whole record.
pub(crate) struct Score {
    /// Matrix of the block.
    pub(crate) matrix: DMatrix<f64>,
    /// What is left of its right-hand side.
    pub(crate) left: DVector<f64>,
}

/// Covariance of all columns, and independent blocks of equal variance that spread as these: the
/// fewest of the first `parameters` columns.
pub(crate) fn spread(
    factored: &Factored,
    scores: &[Score],
    parameters: usize,
) -> Option<(DMatrix<f64>, f64)> {
    let blocks = scores.len() as f64;
    let n = scores.first()?.left.len();
    let (mut influences, mut shares) = (Vec::new(), Vec::new());
    for score in scores {
        influences.push(factored.solve(&score.left)?);
        shares.push(factored.solve_columns(&score.matrix)?);
    }
    let mut covariance = DMatrix::zeros(n, n);
    let mut effective = vec![Vec::new(); parameters];
    for (influence, share) in influences.iter().zip(&shares) {
        let once = share * influence;
        let whole = influence + 0.5 * &once + 0.375 * share * &once;
        covariance += &whole * whole.transpose();
        for (squares, value) in effective.iter_mut().zip(whole.iter()) {
            squares.push(value * value);
        }
    }
    let pairs = || (1..scores.len()).map(|b| (b - 1, b));
    let own: f64 = scores
        .iter()
        .zip(&influences)
        .map(|(s, i)| s.left.dot(i))
        .sum();
    let own_shares: f64 = shares.iter().map(|share| (share * share).trace()).sum();
    let neighbours: f64 = pairs()
        .map(|(a, b)| {
            0.5 * (scores[a].left.dot(&influences[b]) + scores[b].left.dot(&influences[a]))
        })
        .sum();
    let neighbour_shares: f64 = pairs()
        .map(|(a, b)| (&shares[a] * &shares[b]).trace())
        .sum();
    let columns = n as f64;
    let level = own / (columns - own_shares);
    let seen = (neighbours + level * neighbour_shares) / (columns * level);
    let rho = TAKEN * (seen - 1.0 / (columns * blocks).sqrt());
    let rho = match level > 0.0 && rho > 0.0 {
        true => rho.min(MOST),
        false => 0.0,
    };
    let independent = (1.0 - rho) / (1.0 + rho);
    let freedom = blocks - 1.0;
    let student = 1.0 + 1.25 / freedom + 1.53 / (freedom * freedom);
    let fewest = effective
        .iter()
        .map(|squares| evenly(squares))
        .fold(blocks, f64::min);
    Some((
        covariance * (student * student / independent),
        fewest * independent,
    ))
}

/// How many normal scores spread their squares as these: 3 (sum)^2 / sum of squares.
fn evenly(squares: &[f64]) -> f64 {
    let sum: f64 = squares.iter().sum();
    let of_squares: f64 = squares.iter().map(|s| s * s).sum();
    match of_squares > 0.0 {
        true => 3.0 * sum * sum / of_squares,
        false => 0.0,
    }
}

/// The second covariance, and the first, that of blocks, in the directions in which it is larger by
/// more than chance; `None` where the second one is not positive definite.
///
/// Known as: the Marchenko-Pastur edge. Ratios of the covariance of B samples in n directions to
/// the true one lie up to `(1 + sqrt(n/B))^2` by chance.
pub(crate) fn larger(
    one: &DMatrix<f64>,
    blocks: f64,
    other: &DMatrix<f64>,
) -> Option<DMatrix<f64>> {
    let n = one.nrows();
    let edge = (1.0 + (n as f64 / blocks).sqrt()).powi(2);
    let size: Vec<f64> = (0..n).map(|i| other[(i, i)].sqrt()).collect();
    let scaled = |p: &DMatrix<f64>| DMatrix::from_fn(n, n, |i, j| p[(i, j)] / (size[i] * size[j]));
    let root = scaled(other).cholesky()?.unpack();
    let half = root.solve_lower_triangular(&scaled(one))?;
    let ratio = root.solve_lower_triangular(&half.transpose())?;
    let ratio = 0.5 * (&ratio + ratio.transpose());
    let eigen = ratio.symmetric_eigen();
    let values = DMatrix::from_diagonal(&eigen.eigenvalues.map(|v| if v > edge { v } else { 1.0 }));
    let back = &root * &eigen.eigenvectors;
    let both = &back * values * back.transpose();
    Some(DMatrix::from_fn(n, n, |i, j| {
        both[(i, j)] * size[i] * size[j]
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_larger_covariance_is_that_of_each_direction() {
        let one = DMatrix::from_row_slice(2, 2, &[4.0, 0.0, 0.0, 1.0]);
        let other = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, 9.0]);
        // Of 32 blocks in two directions 1.56 is the edge.
        let both = larger(&one, 32.0, &other).expect("a covariance");
        let expected = DMatrix::from_row_slice(2, 2, &[4.0, 0.0, 0.0, 9.0]);
        assert!((both - expected).norm() < 1e-12);
        let correlated = DMatrix::from_row_slice(2, 2, &[1.0, 0.9, 0.9, 1.0]);
        for (ratio, kept) in [(0.5, 1.0), (0.7, 0.7)] {
            let both = larger(&correlated, 32.0, &(ratio * &correlated)).expect("a covariance");
            assert!((both - kept * &correlated).norm() < 1e-12, "{ratio}");
        }
    }
}
