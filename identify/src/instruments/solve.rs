//! Parameters and standard deviations from the sums of a pass.

use nalgebra::{DMatrix, DVector};

use crate::instruments::factored::{Factored, sizes};
use crate::instruments::later::DelayFound;
use crate::instruments::rounding::rounding;
use crate::instruments::spread::{Score, larger, spread};
use crate::instruments::sums::{BLOCKS, Sums};

/// Repetitions with the numerators of the estimate.
const REPETITIONS: usize = 3;

/// Energy of a column of the initial state, over that of the whole record, below which its blocks
/// say nothing of it.
const ABSENT: f64 = 1e-9;

/// Smallest pivot of equations with rows and columns of size one.
const SINGULAR: f64 = 1e-11;

/// How the equations are solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// The regressors themselves as instruments.
    LeastSquares,
    /// The inputs filtered twice.
    Instruments,
}

/// Parameters in the plane of the trends, with the matrix that found them.
pub(crate) struct Solution {
    /// In the order of theta, without the initial state.
    pub(super) theta: Vec<f64>,
    /// Covariance by batch means of the scores; none where there are too few blocks.
    pub(super) covariance: Option<DMatrix<f64>>,
    /// Blocks that carry information, as an effective number.
    pub(super) effective_blocks: f64,
    /// The delay where it is an unknown; its covariances are those of the plane of the trends.
    pub(super) delay: Option<DelayFound>,
}

/// The square system of one choice of instruments: matrix and right-hand side side by side.
type Equations = DMatrix<f64>;

impl Sums {
    /// The sum of all blocks but those left out.
    fn total(&self, left_out: impl Fn(usize) -> bool) -> Vec<f64> {
        let mut total = vec![0.0; self.blocks[0].len()];
        for (_, block) in self
            .blocks
            .iter()
            .enumerate()
            .filter(|(b, _)| !left_out(*b))
        {
            for (sum, value) in total.iter_mut().zip(block) {
                *sum += value;
            }
        }
        total
    }

    /// The equations of least squares, or with the rows of the twice filtered inputs combined by
    /// numerators.
    fn combined(&self, sums: &[f64], numerators: Option<&[f64]>) -> Equations {
        let layout = &self.layout;
        let (columns, auxiliary) = (layout.columns(), layout.auxiliary_rows());
        let q = layout.outputs();
        DMatrix::from_fn(columns, columns + 1, |row, column| {
            let at = |row: usize| sums[row * (columns + 1) + column];
            match numerators {
                Some(b) if row < q => layout.combined(row, b, at),
                _ => at(auxiliary + row),
            }
        })
    }

    /// The columns that the blocks say something of: a decayed initial state is left out.
    fn present(&self, sums: &[f64], whole: &[f64]) -> Vec<usize> {
        let layout = &self.layout;
        let (columns, auxiliary) = (layout.columns(), layout.auxiliary_rows());
        let energy = |sums: &[f64], j: usize| sums[(auxiliary + j) * (columns + 1) + j];
        let present =
            |j: &usize| *j < layout.unknowns() || energy(sums, *j) > ABSENT * energy(whole, *j);
        (0..columns).filter(present).collect()
    }

    /// Parameters from all blocks but those left out, covariance included where it is wanted.
    pub(super) fn solve(
        &self,
        method: Method,
        left_out: impl Fn(usize) -> bool + Copy,
    ) -> Option<Vec<f64>> {
        let found = self.found(method, left_out)?;
        Some(found.theta.as_slice()[..self.layout.parameters()].to_vec())
    }

    fn found(&self, method: Method, left_out: impl Fn(usize) -> bool + Copy) -> Option<Found> {
        let whole = self.total(|_| false);
        let sums = self.total(left_out);
        let present = self.present(&sums, &whole);
        let mut theta = solved(&self.combined(&sums, None), &present)?;
        let q = self.layout.outputs();
        if method == Method::LeastSquares || q == 0 {
            return Some(Found {
                theta,
                numerators: None,
                present,
            });
        }
        let numerators: usize = self.layout.terms.iter().sum();
        let mut b = Vec::new();
        for _ in 0..REPETITIONS {
            b = theta.as_slice()[q..q + numerators].to_vec();
            theta = solved(&self.combined(&sums, Some(&b)), &present)?;
        }
        Some(Found {
            theta,
            numerators: Some(b),
            present,
        })
    }

    /// Parameters of the whole record with their covariance.
    ///
    /// Known as: cluster-robust (sandwich) covariance over blocks of time, batch means. The scores
    /// of a block are its equations at the parameters of the whole record (`spread`).
    pub(super) fn solve_whole(
        &self,
        method: Method,
        of_output_noise: impl FnOnce(&Whole) -> Option<DMatrix<f64>>,
    ) -> Option<Solution> {
        let Found {
            theta,
            numerators,
            present,
        } = self.found(method, |_| false)?;
        let (p, unknowns) = (self.layout.parameters(), self.layout.unknowns());
        let n = present.len();
        let b = numerators.as_deref();
        let scores: Vec<Score> = self
            .blocks
            .iter()
            .map(|block| {
                let equations = self.combined(block, b);
                let columns = equations.ncols() - 1;
                let left = equations.column(columns) - equations.columns(0, columns) * &theta;
                Score {
                    matrix: DMatrix::from_fn(n, n, |i, j| equations[(present[i], present[j])]),
                    left: DVector::from_iterator(n, present.iter().map(|j| left[*j])),
                }
            })
            .collect();
        let whole = self.combined(&self.total(|_| false), b);
        let matrix = DMatrix::from_fn(n, n, |i, j| whole[(present[i], present[j])]);
        let factored = Factored::new(&matrix)?;
        let (mut covariance, effective_blocks) = spread(&factored, &scores, unknowns)?;
        let whole = Whole {
            theta,
            numerators,
            present,
            factored,
        };
        if let Some(of_noise) = of_output_noise(&whole) {
            covariance = larger(&covariance, effective_blocks, &of_noise).unwrap_or(covariance);
        }
        let of_column = |j: &usize| match *j < unknowns && *j >= p {
            true => 1.0,
            false => whole.theta[*j],
        };
        let of_columns: Vec<f64> = whole.present.iter().map(of_column).collect();
        let order = self.layout.order;
        let covariance = covariance + rounding(&whole.factored, &scores, &of_columns, order)?;
        let delay = self.layout.later.then(|| DelayFound {
            shift: whole.theta[p],
            sigma: covariance[(p, p)].sqrt(),
            with: (0..p).map(|j| covariance[(j, p)]).collect(),
            reach: f64::INFINITY,
        });
        Some(Solution {
            theta: whole.theta.as_slice()[..p].to_vec(),
            covariance: (BLOCKS > unknowns + 1)
                .then(|| covariance.view((0, 0), (p, p)).into_owned()),
            effective_blocks,
            delay,
        })
    }

    /// Numerators of all inputs in the plane of the trends.
    pub(super) fn numerators(&self, method: Method) -> Option<Vec<f64>> {
        let q = self.layout.outputs();
        let terms: usize = self.layout.terms.iter().sum();
        Some(self.solve(method, |_| false)?[q..q + terms].to_vec())
    }
}

/// The solution of the whole record with its equations.
pub(super) struct Whole {
    /// All columns.
    pub(super) theta: DVector<f64>,
    /// Numerators that combined the instruments; least squares have none.
    pub(super) numerators: Option<Vec<f64>>,
    /// The columns with data.
    pub(super) present: Vec<usize>,
    /// The equations over them.
    pub(super) factored: Factored,
}

/// A solution of the combined equations.
struct Found {
    theta: DVector<f64>,
    /// Numerators that combined the instruments; least squares have none.
    numerators: Option<Vec<f64>>,
    /// The columns with data.
    present: Vec<usize>,
}

/// The solution over some of the columns, the others 0; `None` where the equations are singular.
fn solved(equations: &Equations, present: &[usize]) -> Option<DVector<f64>> {
    let columns = equations.ncols() - 1;
    let n = present.len();
    let matrix = DMatrix::from_fn(n, n, |i, j| equations[(present[i], present[j])]);
    let (rows, sizes) = sizes(&matrix)?;
    let lu = DMatrix::from_fn(n, n, |i, j| matrix[(i, j)] / (rows[i] * sizes[j])).full_piv_lu();
    let pivots = lu.u();
    if !(0..n).all(|i| pivots[(i, i)].abs() > SINGULAR) {
        return None;
    }
    let right = DVector::from_fn(n, |i, _| equations[(present[i], columns)] / rows[i]);
    let found = lu.solve(&right)?;
    let mut theta = DVector::zeros(columns);
    for (place, (j, value)) in present.iter().zip(found.iter()).enumerate() {
        theta[*j] = value / sizes[place];
    }
    theta.iter().all(|v| v.is_finite()).then_some(theta)
}
