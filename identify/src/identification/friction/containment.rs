//! What a friction found by trying says against another model.

use super::start::{Start, Trial};
use crate::identification::model::Identification;

/// Standard deviations by which two estimates may differ by chance.
const CHANCE: f64 = 2.0;

impl Start {
    /// Lets the standard deviations of a model contain how far away this one is, which simulates
    /// better, where that is more than chance: the most likely one, where it leaves noise alone,
    /// and one with another delay, which the equations are linear in over a sample.
    pub(super) fn contained_in(&self, trial: &Trial, found: &mut Identification) {
        let better = self.left < trial.left_by(&found.estimate, found.delay);
        if !(better && (self.white || found.delay_sigma().is_some())) {
            return;
        }
        let of = &found.estimate;
        let moves = self.estimate.moves_from(of);
        let later = self.delay - found.delay;
        let beyond = |moved: f64, sigma: f64| !(moved.abs() <= CHANCE * sigma);
        let parameters = moves.iter().zip(&of.sigma);
        let far = parameters.into_iter().any(|(m, sigma)| beyond(*m, *sigma));
        let late = found
            .delay_sigma()
            .is_some_and(|sigma| beyond(later, sigma));
        if !(far || late) {
            return;
        }
        if let Some(delay) = &mut found.delay_found {
            delay.widen(later, &moves);
        }
        found.estimate = trial.problem.widened(&found.estimate, &[moves]);
    }
}
