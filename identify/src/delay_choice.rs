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

/// A delay between samples is taken where its error is smaller than this share of that of the next
/// whole one.
const BETTER: f64 = 0.99;

fn error(judged: &Judged) -> f64 {
    judged.folds.total(Refitted::StateAndConstant)
}

/// Errors of the folds at delays from 0 on, longer ones for as long as one of the two longest wins.
fn tried(problem: &Problem, start: &Judged) -> Vec<(usize, Folds)> {
    let pole = start.pole;
    let at = |delay: usize| {
        let judged = judged(problem, pole, delay as f64, Method::Instruments)?;
        Some((delay, judged.folds))
    };
    let (mut all, mut next) = (Vec::new(), 0);
    loop {
        let end = (next + DELAYS.max(next / 2)).min(LONGEST_DELAY + 1);
        let delays: Vec<usize> = (next..end).collect();
        all.extend(
            side_by_side(&delays, |delay| at(*delay))
                .into_iter()
                .flatten(),
        );
        next = end;
        let best = smallest(&all).map_or(start.fit.delay() as usize, |(delay, _)| *delay);
        if best + 2 < end || next > LONGEST_DELAY {
            return all;
        }
    }
}

fn smallest(all: &[(usize, Folds)]) -> Option<&(usize, Folds)> {
    let error = |folds: &Folds| folds.total(Refitted::StateAndConstant);
    all.iter()
        .min_by(|a, b| error(&a.1).total_cmp(&error(&b.1)))
}

/// Delays that stand out among those that were tried.
pub(crate) struct Delays {
    /// The one with the smallest error.
    pub(crate) best: usize,
    /// The shortest and the longest one that simulate as well, within one standard error over the
    /// folds.
    pub(crate) alike: [usize; 2],
    /// The best one of those that are tried first.
    pub(crate) usual: usize,
}

impl Delays {
    /// Those at the filter of a fit.
    pub(crate) fn of(problem: &Problem, start: &Judged) -> Self {
        let all = tried(problem, start);
        let given = start.fit.delay() as usize;
        let Some((best, folds)) = smallest(&all) else {
            return Self {
                best: given,
                alike: [given; 2],
                usual: given,
            };
        };
        let alike =
            |(_, other): &&(usize, Folds)| other.behind(folds, Refitted::StateAndConstant) <= 1.0;
        let alike = || all.iter().filter(alike).map(|(delay, _)| *delay);
        let usual: Vec<(usize, Folds)> = all.iter().filter(|d| d.0 < DELAYS).cloned().collect();
        Self {
            best: *best,
            alike: [
                alike().min().unwrap_or(*best),
                alike().max().unwrap_or(*best),
            ],
            usual: smallest(&usual).map_or(*best, |(delay, _)| *delay),
        }
    }
}

/// The same fit with its delay between two samples, where that simulates better: halves, then
/// quarters.
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
