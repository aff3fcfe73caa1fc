//! A structure that passed, with what the choice counts.

use crate::delay_choice::DELAYS;
use crate::filter_choice;
use crate::folds::Folds;
use crate::instruments::Found;
use crate::problem::Structure;

/// One structure at its best filter and delay.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// The structure.
    pub structure: Structure,
    /// Delay that it is compared at, in whole samples.
    pub delay: usize,
    /// The same as it is, also between two samples.
    pub compared_delay: f64,
    /// Delay of the model `found` in samples, between two of them where it was searched.
    pub model_delay: f64,
    /// Its standard deviation in samples, contained in those of the parameters; `None` where it was
    /// given.
    pub delay_sigma: Option<f64>,
    /// Whether the longest delay that was tried is the best.
    pub delay_at_end: bool,
    /// Filter pole \[rad/s\].
    pub pole: f64,
    /// Names of its parameters.
    pub names: Vec<String>,
    /// The model of the whole record.
    pub found: Found,
    /// Errors of the folds left out.
    pub folds: Folds,
    /// Free simulation of all folds, each by the model without it, initial state and constant
    /// refitted \[%\].
    pub fit_x0c: f64,
    /// How far the first parameter moves behind filter poles at half and at twice this one, in the
    /// standard deviations of both estimates together, where the pole was not given. Where that is
    /// more than chance the standard deviations of `found` contain the moves.
    pub filter_shifts: Option<[f64; 2]>,
}

impl Candidate {
    /// Parameters that count in the choice: its own, and a delay longer than that of any loop.
    pub fn parameters(&self) -> usize {
        self.names.len() + usize::from(self.long_delay())
    }

    /// Whether the delay is longer than those tried first, which every loop may have.
    pub const fn long_delay(&self) -> bool {
        self.delay >= DELAYS
    }

    /// Whether the deviation of a delay that was searched is beyond what the equations are linear
    /// over.
    pub fn delay_untold(&self) -> bool {
        let delay = self.found.delay.as_ref();
        let beyond = delay.is_some_and(|delay| delay.sigma > delay.reach);
        self.delay_sigma.is_some() && beyond
    }

    /// The larger one of `filter_shifts`, where it is more than chance.
    pub fn filter_dependence(&self) -> Option<f64> {
        self.filter_shifts.and_then(filter_choice::far)
    }
}
