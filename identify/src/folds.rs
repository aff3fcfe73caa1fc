//! A model judged by parts of the record that it has not seen.
//!
//! Known as: cross validation over contiguous folds, jackknife. The sums of a [`Fit`] subtract, so
//! leaving a fold out costs no pass over the record.

use crate::instruments::{FOLDS, Fit};
use crate::polynomials::Polynomials;
use crate::problem::Problem;

/// Which error of a free simulation counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refitted {
    /// The initial state of each fold is refitted.
    State,
    /// And the constant of the differential equation.
    StateAndConstant,
}

/// The errors of free simulations of every fold by the model without it.
#[derive(Debug, Clone, PartialEq)]
pub struct Folds {
    /// Sum of the squared errors of each fold: initial state refitted, and the constant too.
    pub squares: [[f64; 2]; FOLDS],
    /// Standard deviations of the parameters by the jackknife over the folds.
    pub sigma: Vec<f64>,
    /// The models without each fold.
    pub models: Vec<Polynomials>,
}

impl Folds {
    /// The errors of a fit; `None` where a model without a fold is unstable, singular or runs away.
    pub fn of(problem: &Problem, fit: &Fit) -> Option<Self> {
        let integrators = usize::from(problem.structure.integrator);
        let (mut squares, mut models, mut thetas) = ([[0.0; 2]; FOLDS], Vec::new(), Vec::new());
        for (fold, squares) in squares.iter_mut().enumerate() {
            let (model, theta) = fit.without_fold(fold)?;
            if !model.is_stable(integrators) {
                return None;
            }
            let range = Self::range(problem, fit.delay(), fold);
            let share = range.len() as f64 / Self::range(problem, 0.0, fold).len() as f64;
            let simulated = problem.simulate(&model, fit.delay(), range)?;
            *squares = simulated.squares.map(|squares| squares / share);
            models.push(model);
            thetas.push(theta);
        }
        let n = FOLDS as f64;
        let sigma = (0..thetas[0].len()).map(|j| {
            let mean = thetas.iter().map(|theta| theta[j]).sum::<f64>() / n;
            let squares: f64 = thetas.iter().map(|theta| (theta[j] - mean).powi(2)).sum();
            ((n - 1.0) / n * squares).sqrt()
        });
        Some(Self {
            sigma: sigma.collect(),
            squares,
            models,
        })
    }

    /// Where a fold begins and ends; before the record no delayed input is known.
    pub(crate) fn range(problem: &Problem, delay: f64, fold: usize) -> std::ops::Range<usize> {
        let samples = problem.samples();
        let (start, end) = (fold * samples / FOLDS, (fold + 1) * samples / FOLDS);
        start.max((delay.ceil() as usize).min(end / 2))..end
    }

    /// The error of all folds, a sum of squares.
    pub fn total(&self, refitted: Refitted) -> f64 {
        self.each(refitted).sum()
    }

    fn each(&self, refitted: Refitted) -> impl Iterator<Item = f64> {
        self.squares
            .iter()
            .map(move |[state, both]| match refitted {
                Refitted::State => *state,
                Refitted::StateAndConstant => *both,
            })
    }

    /// How much larger the error is than another's, in standard errors of the difference over the
    /// folds.
    pub fn behind(&self, other: &Self, refitted: Refitted) -> f64 {
        let differences: Vec<f64> = self
            .each(refitted)
            .zip(other.each(refitted))
            .map(|(x, y)| x - y)
            .collect();
        let n = FOLDS as f64;
        let sum: f64 = differences.iter().sum();
        let variance = differences
            .iter()
            .map(|d| (d - sum / n).powi(2))
            .sum::<f64>()
            / (n - 1.0);
        let error = (n * variance).sqrt();
        match sum {
            0.0 => 0.0,
            _ => sum / error.max(f64::MIN_POSITIVE),
        }
    }

    /// The logarithm of the product of the relative standard deviations: small where all parameters
    /// are sharp.
    pub fn sharpness(&self) -> f64 {
        self.sigma
            .iter()
            .map(|sigma| sigma.max(f64::MIN_POSITIVE).ln())
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folds(squares: [f64; FOLDS], sigma: &[f64]) -> Folds {
        Folds {
            squares: squares.map(|square| [square, 0.5 * square]),
            sigma: sigma.to_vec(),
            models: Vec::new(),
        }
    }

    #[test]
    fn a_difference_counts_in_its_own_standard_errors() {
        let one = folds([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0], &[0.1, 2.0]);
        // Larger in every fold by about the same: surely worse, however uneven the folds are.
        let worse = folds([1.1, 2.1, 3.1, 4.1, 5.1, 6.1, 7.1, 8.2], &[0.1, 1.0]);
        assert!(worse.behind(&one, Refitted::State) > 8.0);
        // Larger in one of them only: as well by chance.
        let uneven = folds([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 9.0], &[0.1, 1.0]);
        let behind = uneven.behind(&one, Refitted::State);
        assert!((behind - 1.0).abs() < 1e-12, "{behind}");
        assert_eq!(one.behind(&one, Refitted::State), 0.0);
        assert_eq!(one.total(Refitted::StateAndConstant), 18.0);
        assert!(worse.sharpness() < one.sharpness());
    }
}
