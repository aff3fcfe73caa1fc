//! Which structures simulate alike, and what a structure that is dropped would.

use crate::filter_choice::Judged;
use crate::folds::{Folds, Refitted};
use crate::problem::Problem;
use crate::structure_choice::drop::Drop;

/// Standard errors over the folds within which two structures simulate alike.
const ALIKE: f64 = 3.0;

/// And the error over that of the best, up to which they do.
const ALIKE_ERROR: f64 = 1.5;

/// Error over that of the best that is alike in any case.
const ALIKE_AT_ONCE: f64 = 1.03;

/// Whether the folds are simulated about as well as the best.
pub(super) fn simulates_alike(folds: &Folds, best: &Folds) -> bool {
    let both = Refitted::StateAndConstant;
    let ratio = (folds.total(both) / best.total(both)).sqrt();
    ratio <= ALIKE_AT_ONCE || (ratio <= ALIKE_ERROR && folds.behind(best, both) <= ALIKE)
}

/// Free simulation of all folds over the distance of the output from its mean \[%\].
pub(super) fn fit_x0c(problem: &Problem, folds: &Folds) -> f64 {
    let y = problem.signals.output;
    let mean = y.iter().sum::<f64>() / y.len() as f64;
    let spread: f64 = y.iter().map(|y| (y - mean).powi(2)).sum();
    let error = folds.total(Refitted::StateAndConstant);
    100.0 * (1.0 - (error / spread).sqrt())
}

/// A structure at the delay of any loop, where it is dropped for a parameter that is not
/// significant.
#[derive(Debug, Clone)]
pub struct Shorter {
    /// Delay in samples, also between two of them.
    pub delay: f64,
    /// Free simulation of all folds, as that of a candidate \[%\].
    pub fit_x0c: f64,
    pub(super) folds: Folds,
}

impl Shorter {
    pub(super) fn of(problem: &Problem, judged: &Judged) -> Self {
        Self {
            delay: judged.fit.delay(),
            fit_x0c: fit_x0c(problem, &judged.folds),
            folds: judged.folds.clone(),
        }
    }
}

/// Why a structure is no candidate.
pub(super) struct Missing {
    pub(super) reason: Drop,
    pub(super) shorter: Option<Box<Shorter>>,
}

impl From<Drop> for Missing {
    fn from(reason: Drop) -> Self {
        Self {
            reason,
            shorter: None,
        }
    }
}
