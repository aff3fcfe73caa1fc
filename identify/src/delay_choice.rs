//! The delay of the inputs by the errors of the folds left out.

use crate::filter_choice::{Judged, judged};
use crate::folds::{Folds, Refitted};
use crate::instruments::{Fit, Method};
use crate::problem::Problem;
use crate::side_by_side::side_by_side;

/// Delays that are tried first, and as many more for as long as one of the two longest wins.
pub(crate) const DELAYS: usize = 7;

/// Longest delay that is tried, in samples.
pub const LONGEST_DELAY: usize = 200;

/// A delay between samples is taken where its error is smaller than this share of that of the next whole one.
const BETTER: f64 = 0.99;

fn error(judged: &Judged) -> f64 {
    judged.folds.total(Refitted::StateAndConstant)
}

/// The delay with the smallest error at a filter, and whether it is the longest that is offered.
pub(crate) fn best_delay(problem: &Problem, start: &Judged) -> (usize, bool) {
    let pole = start.pole;
    let at = |delay: usize| {
        let judged = judged(problem, pole, delay as f64, Method::Instruments);
        judged.map_or(f64::INFINITY, |judged| error(&judged))
    };
    let (mut best, mut smallest) = (start.fit.delay() as usize, f64::INFINITY);
    let mut next = 0;
    loop {
        let end = (next + DELAYS.max(next / 2)).min(LONGEST_DELAY + 1);
        let delays: Vec<usize> = (next..end).collect();
        let errors = side_by_side(&delays, |delay| at(*delay));
        for (delay, error) in delays.into_iter().zip(errors) {
            if error < smallest {
                (best, smallest) = (delay, error);
            }
        }
        next = end;
        if best + 2 < end || next > LONGEST_DELAY {
            return (best, best == LONGEST_DELAY);
        }
    }
}

/// The same fit with its delay between two samples, where that simulates better: halves, then quarters.
pub(crate) fn between_samples<'a>(problem: &'a Problem<'a>, judged: Judged<'a>) -> Judged<'a> {
    let mut best = judged;
    for step in [0.5, 0.25] {
        for delay in [best.fit.delay() - step, best.fit.delay() + step] {
            if delay < 0.0 {
                continue;
            }
            let fit = Fit::new(problem, best.fit.filter(), delay, best.fit.method());
            let Some((fit, folds)) = fit
                .ok()
                .and_then(|fit| Folds::of(problem, &fit).map(|f| (fit, f)))
            else {
                continue;
            };
            if folds.total(Refitted::StateAndConstant) < BETTER * error(&best) {
                best = Judged { fit, folds, ..best };
                break;
            }
        }
    }
    best
}
