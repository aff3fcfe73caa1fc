//! A longer delay in the place of a zero in the right half plane that imitates it.
//!
//! `1 - s/z` over `1 + s/z` is late by `2/z` at low frequencies, so that a shorter delay with such
//! a zero simulates nearly as well: a valley of its own, from which no step leads to the right one.
//! That one is narrow, and ends where it is deepest: behind a delay that is longer than that of the
//! record no causal model is left. So the longest delays within the reach of the zeros that have a
//! model are followed, too, and taken where they simulate better by more than chance. Where they
//! simulate as well the record does not tell the delay from the zero.

use std::ops::RangeInclusive;

use crate::delay_choice::{LONGEST_DELAY, best_of, followed};
use crate::filter_choice::{Judged, judged};
use crate::folds::Refitted;
use crate::instruments::{Fit, Found, Method};
use crate::problem::Problem;
use crate::side_by_side::side_by_side;

/// How late the zeros in the right half plane of a model make its delayed inputs, the most of all,
/// in samples.
fn imitated(problem: &Problem, fit: &Fit) -> f64 {
    let Some(model) = fit.model() else {
        return 0.0;
    };
    let of_input = |input: usize| {
        let zeros = model.zeros(input).into_iter().filter(|zero| zero.0 > 0.0);
        zeros
            .map(|(re, im)| 2.0 * re / (re * re + im * im))
            .sum::<f64>()
    };
    let inputs = problem.signals.inputs.iter().enumerate();
    let delayed = inputs.filter(|(_, input)| input.delayed);
    let late = delayed.map(|(c, _)| of_input(c)).fold(0.0, f64::max);
    late / problem.signals.dt
}

/// Shares of the pole of the filter that are tried, too: behind a fast one no delay near that of
/// the record may have a stable model.
const POLES: [f64; 4] = [0.25, 0.5, 1.0, 2.0];

/// The fit behind a filter at the longest of some whole delays that has a model, or of the one
/// before them, or at the quarters of two samples behind it: the right valley is narrower than a
/// sample, and even the whole delay before it may have no stable model.
fn longest<'a>(
    problem: &'a Problem<'a>,
    pole: f64,
    tried: RangeInclusive<usize>,
    method: Method,
) -> Option<Judged<'a>> {
    let at = |delay: f64| judged(problem, pole, delay, method);
    let before = (*tried.start() - 1) as f64;
    let whole = tried.map_while(|delay| at(delay as f64)).last();
    let delay = whole.as_ref().map_or(before, |whole| whole.fit.delay());
    let quarters = (1..8).filter_map(|quarters| at(delay + 0.25 * f64::from(quarters)));
    best_of(quarters.chain(whole))
}

/// What a longer delay says of a fit.
pub(crate) enum Longer<'a> {
    /// It simulates better by more than chance.
    Better(Judged<'a>),
    /// It simulates as well, so that the record does not tell it from the zero.
    Alike(Judged<'a>),
}

/// The longer delay in the place of what a fit has in the right half plane, where that is not worse
/// by more than chance.
pub(crate) fn longer<'a>(problem: &'a Problem<'a>, found: &Judged<'a>) -> Option<Longer<'a>> {
    let late = imitated(problem, &found.fit);
    let first = found.fit.delay().floor() + 1.0;
    let last = (found.fit.delay() + late).ceil().min(LONGEST_DELAY as f64);
    if !(late > 0.0 && first <= last) {
        return None;
    }
    let tried = (first as usize)..=(last as usize);
    let alternatives = POLES.len() * tried.clone().count();
    let (pole, method) = (found.pole, found.fit.method());
    let at_end = side_by_side(&POLES, |share| {
        longest(problem, share * pole, tried.clone(), method)
    });
    let longer = followed(problem, &best_of(at_end.into_iter().flatten())?)?;
    let beats = |one: &Judged, other: &Judged| {
        let simulated = (problem, one.fit.delay(), Refitted::StateAndConstant);
        one.folds.beat(simulated, &other.folds, (1, alternatives))
    };
    if beats(&longer, found) {
        Some(Longer::Better(longer))
    } else if beats(found, &longer) {
        None
    } else {
        Some(Longer::Alike(longer))
    }
}

/// A model of another delay.
pub(crate) struct Other {
    /// In samples.
    pub(crate) delay: f64,
    theta: Vec<f64>,
}

impl Other {
    /// `None` where it has no parameters.
    pub(crate) fn of(judged: &Judged) -> Option<Self> {
        Some(Self {
            delay: judged.fit.delay(),
            theta: judged.fit.found().ok()?.estimate.theta,
        })
    }

    /// A model, at its delay in samples, with the error that it makes of it not to be told from
    /// this one.
    pub(crate) fn contained_in(&self, problem: &Problem, (delay, found): (f64, Found)) -> Found {
        let here = &found.estimate.theta;
        let moves: Vec<f64> = self.theta.iter().zip(here).map(|(o, h)| o - h).collect();
        let late = self.delay - delay;
        let of_delay = found.delay.map(|mut found| {
            found.widen(late, &moves);
            found
        });
        Found {
            estimate: problem.widened(&found.estimate, &[moves]),
            delay: of_delay,
            ..found
        }
    }
}
