//! The delay at which the equation of least squares leaves least, of all delays after one pass.
//!
//! A delay by d samples moves the trends of an input by d samples, but for what the state of the
//! filter begins with: the trends are made once, only their products with the others are summed
//! again. No valley is followed: an input that changes every so many samples makes one around
//! every multiple of them.
//!
//! Noise of the output biases the parameters, so that this says where to look; the folds judge.

use nalgebra::{DMatrix, DVector};
use trendid::trends::{Form, Hold};

use crate::instruments::lanes::{Values, design};
use crate::instruments::layout::Layout;
use crate::problem::Problem;

/// Samples of the equations at most, evenly over the record: behind a filter those between say
/// nearly the same.
const ROWS: usize = 20_000;

/// Share of the square of a column that is added to it: a decayed initial state, or two columns
/// alike behind a slow filter, still have a solution.
const RIDGE: f64 = 1e-12;

/// Trends of a record.
struct Trends {
    /// The samples of the equations.
    rows: Vec<usize>,
    /// Columns that no delay moves, over the rows: those of the output, of other inputs, of the
    /// constant, of the initial state; last the left-hand side.
    fixed: Vec<DVector<f64>>,
    /// Columns of the delayed inputs, over all samples.
    delayed: Vec<Vec<f64>>,
    /// Products of the fixed columns, on and below the diagonal.
    products: DMatrix<f64>,
}

/// The delays at which least squares behind the filter f_0 .. f_{m-1} leaves the smallest error: of
/// all up to `longest` samples, or a quarter of the record, of the shorter half of them, and so on
/// down to `shortest`. None where the filter has no trends.
///
/// Delays are compared over the samples that have all of their inputs in the record. What comes
/// before, which may be all that a short record has, is lost to the longest ones only.
pub(crate) fn likely_delays(
    problem: &Problem,
    filter: &[f64],
    [shortest, longest]: [usize; 2],
) -> Vec<usize> {
    let mut longest = longest.min(problem.samples() / 4);
    let mut likely = Vec::new();
    while longest >= shortest {
        likely.extend(likely_delay(problem, filter, longest));
        longest /= 2;
    }
    likely.sort_unstable();
    likely.dedup();
    likely
}

/// The one of all up to `longest` samples.
fn likely_delay(problem: &Problem, filter: &[f64], longest: usize) -> Option<usize> {
    let trends = Trends::of(problem, filter, longest)?;
    let errors = (0..=longest).filter_map(|delay| Some((delay, trends.error(delay)?)));
    errors.min_by(|x, y| x.1.total_cmp(&y.1)).map(|(d, _)| d)
}

/// The trends of samples, all of a lane's.
fn trends(samples: usize, trends: impl FnMut(usize) -> Values) -> Vec<Values> {
    (0..samples).map(trends).collect()
}

/// One of the trends, over all samples.
fn column(trends: &[Values], i: usize) -> Vec<f64> {
    trends.iter().map(|trends| trends[i]).collect()
}

impl Trends {
    fn of(problem: &Problem, filter: &[f64], longest: usize) -> Option<Self> {
        let (signals, samples) = (problem.signals, problem.samples());
        let layout = Layout::of(problem);
        let (m, first) = (layout.order, layout.first);
        let design = design(signals.dt, filter, Some(filter)).ok()?;
        let form = match first {
            0 => Form::Position,
            _ => Form::Increment,
        };
        // As behind the sums of one delay.
        let reference = match layout.constant || first > 0 {
            true => signals.output[0],
            false => 0.0,
        };
        let every = (samples - longest).div_ceil(ROWS);
        let rows = (longest..samples).step_by(every);
        let rows: Vec<usize> = rows.filter(|k| signals.acts(*k)).collect();
        let over_rows = |trends: &[Values], i: usize| {
            DVector::from_iterator(rows.len(), rows.iter().map(|k| trends[*k][i]))
        };
        let mut lane = design.of_output(form, 0.0);
        let y = trends(samples, |k| {
            lane.output((signals.output[k] - reference) as f32)
        });
        let mut lane = design.of_output(Form::Position, 0.0);
        let start = trends(samples, |k| lane.output(f32::from(u8::from(k == 0))));
        let mut fixed: Vec<_> = (first..m).map(|i| over_rows(&y, i)).collect();
        fixed.extend((0..m).map(|i| over_rows(&start, i)));
        let mut delayed = Vec::new();
        for (input, terms) in signals.inputs.iter().zip(&layout.terms) {
            let mut lane = design.of_input(input.hold);
            let u = trends(samples, |k| {
                lane.input(signals.acting(k, input.samples[k]) as f32)
            });
            match input.delayed {
                true => delayed.extend((0..*terms).map(|i| column(&u, i))),
                false => fixed.extend((0..*terms).map(|i| over_rows(&u, i))),
            }
        }
        if layout.constant {
            let mut lane = design.of_input(Hold::Zero);
            let one = trends(samples, |k| {
                lane.input(f32::from(u8::from(signals.acts(k))))
            });
            fixed.push(over_rows(&one, 0));
        }
        fixed.push(over_rows(&y, m));
        let n = fixed.len();
        let product = |i: usize, j: usize| if j <= i { fixed[i].dot(&fixed[j]) } else { 0.0 };
        Some(Self {
            products: DMatrix::from_fn(n, n, product),
            rows,
            fixed,
            delayed,
        })
    }

    /// The squared error that least squares leaves at a delay.
    fn error(&self, delay: usize) -> Option<f64> {
        let rows = || self.rows.iter();
        let late: Vec<DVector<f64>> = self
            .delayed
            .iter()
            .map(|u| DVector::from_iterator(self.rows.len(), rows().map(|k| u[k - delay])))
            .collect();
        let (f, d) = (self.fixed.len() - 1, late.len());
        // The delayed columns, then the fixed ones, the left-hand side last.
        let product = |i: usize, j: usize| match (i.checked_sub(d), j.checked_sub(d)) {
            (None, None) => late[i].dot(&late[j]),
            (Some(i), None) => self.fixed[i].dot(&late[j]),
            (Some(i), Some(j)) => self.products[(i, j)],
            (None, Some(_)) => 0.0,
        };
        let n = d + f + 1;
        let lower = DMatrix::from_fn(n, n, |i, j| if j <= i { product(i, j) } else { 0.0 });
        let size = |i: usize| lower[(i, i)].sqrt().max(f64::MIN_POSITIVE);
        let matrix = DMatrix::from_fn(n - 1, n - 1, |i, j| {
            let (i, j) = (i.max(j), i.min(j));
            let ridge = if i == j { RIDGE } else { 0.0 };
            lower[(i, j)] / (size(i) * size(j)) + ridge
        });
        let right = DVector::from_fn(n - 1, |j, _| lower[(n - 1, j)] / size(j));
        let solution = matrix.cholesky()?.solve(&right);
        let left = lower[(n - 1, n - 1)] - solution.dot(&right);
        left.is_finite().then_some(left)
    }
}
