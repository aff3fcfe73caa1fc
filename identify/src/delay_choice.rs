//! The delay of the inputs by the errors of the folds left out.
//!
//! From 0 on, for as long as a longer one simulates better: every loop has a delay of some samples.
//! That valley ends where the input has changed once more. So all delays are compared by what least
//! squares leaves of the equation, too, and the one with the smallest error is simulated; it is
//! taken where that is more than chance.

use std::ops::Range;

use crate::error::Error;
use crate::filter_choice::{Judged, judged};
use crate::folds::{Folds, Refitted};
use crate::instruments::every_delay::likely_delays;
use crate::instruments::{Fit, Method};
use crate::problem::Problem;
use crate::side_by_side::side_by_side;
use crate::tuning::binomial;

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

/// Errors of the folds at some delays.
struct Tried<'a> {
    problem: &'a Problem<'a>,
    pole: f64,
    all: Vec<(usize, Folds)>,
}

impl<'a> Tried<'a> {
    /// Those from 0 on, longer ones for as long as one of the two longest wins.
    fn from_zero(problem: &'a Problem<'a>, start: &Judged) -> Self {
        let mut tried = Self::nothing(problem, start);
        let mut next = 0;
        loop {
            let end = (next + DELAYS.max(next / 2)).min(LONGEST_DELAY + 1);
            tried.add(next..end);
            next = end;
            let best = tried
                .best()
                .map_or(start.fit.delay() as usize, |(delay, _)| *delay);
            if best + 2 < end || next > LONGEST_DELAY {
                return tried;
            }
        }
    }

    /// Those around the delay of a fit, further ones for as long as one of the two outermost wins.
    fn around(problem: &'a Problem<'a>, start: &Judged) -> Self {
        let mut tried = Self::nothing(problem, start);
        let middle = start.fit.delay() as usize;
        let (mut first, mut end) = (middle, middle);
        loop {
            let best = tried.best().map_or(middle, |(delay, _)| *delay);
            let (down, up) = (
                best < first + 2 && first > 0,
                best + 2 >= end && end <= LONGEST_DELAY,
            );
            if !(down || up) {
                return tried;
            }
            if down {
                let next = first.saturating_sub(DELAYS / 2);
                tried.add(next..first);
                first = next;
            }
            if up {
                let next = (end + DELAYS / 2).min(LONGEST_DELAY + 1);
                tried.add(end..next);
                end = next;
            }
        }
    }

    fn nothing(problem: &'a Problem<'a>, start: &Judged) -> Self {
        Self {
            problem,
            pole: start.pole,
            all: Vec::new(),
        }
    }

    fn add(&mut self, delays: Range<usize>) {
        let delays: Vec<usize> = delays.collect();
        let tried = side_by_side(&delays, |delay| {
            let judged = judged(self.problem, self.pole, *delay as f64, Method::Instruments)?;
            Some((*delay, judged.folds))
        });
        self.all.extend(tried.into_iter().flatten());
    }

    fn best(&self) -> Option<&(usize, Folds)> {
        smallest(&self.all)
    }
}

fn smallest(all: &[(usize, Folds)]) -> Option<&(usize, Folds)> {
    let error = |folds: &Folds| folds.total(Refitted::StateAndConstant);
    all.iter()
        .min_by(|a, b| error(&a.1).total_cmp(&error(&b.1)))
}

/// The delay where the equation of least squares leaves least behind one of these filters, at the
/// filter where that simulates best.
fn likely<'a>(problem: &'a Problem<'a>, poles: &[f64]) -> Option<Judged<'a>> {
    let at = |pole: &f64| {
        let filter = binomial(*pole, problem.structure.order);
        let filter: Vec<f64> = filter.into_iter().map(f64::from).collect();
        let delays = likely_delays(problem, &filter, [DELAYS, LONGEST_DELAY]).into_iter();
        let judged = |delay| judged(problem, *pole, delay as f64, Method::Instruments);
        best_of(delays.filter_map(judged))
    };
    best_of(side_by_side(poles, at).into_iter().flatten())
}

pub(crate) fn best_of<'a>(all: impl Iterator<Item = Judged<'a>>) -> Option<Judged<'a>> {
    all.min_by(|x, y| error(x).total_cmp(&error(y)))
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
    /// Those that simulate best from 0 on, with the fit that they were searched with; or those
    /// around a longer one, where that simulates better by more than chance.
    ///
    /// # Errors
    /// That of the fit `near`, at the shortest delays, where no other has a model either.
    pub(crate) fn of<'a>(
        problem: &'a Problem<'a>,
        poles: &[f64],
        near: Result<Judged<'a>, Error>,
    ) -> Result<(Judged<'a>, Self), Error> {
        let likely = likely(problem, poles);
        let near = match near {
            Ok(near) => near,
            Err(error) => {
                let far = likely.ok_or(error)?;
                let delays = Self::among(&Tried::around(problem, &far), &far, None);
                return Ok((far, delays));
            }
        };
        let tried = Tried::from_zero(problem, &near);
        let delays = Self::among(&tried, &near, None);
        // The delay is one unknown, the best of all.
        let best_of = (1, LONGEST_DELAY + 1);
        let beaten = |far: &Judged| {
            let simulated = (problem, far.fit.delay(), Refitted::StateAndConstant);
            let beats = |best: &Folds| far.folds.beat(simulated, best, best_of);
            tried.best().is_none_or(|(_, best)| beats(best))
        };
        Ok(match likely.filter(beaten) {
            Some(far) => {
                let around = Tried::around(problem, &far);
                let delays = Self::among(&around, &far, Some(delays.usual));
                (far, delays)
            }
            None => (near, delays),
        })
    }

    /// Those of some that were tried; the best one of those tried first may be of others.
    fn among(tried: &Tried, start: &Judged, usual: Option<usize>) -> Self {
        let given = start.fit.delay() as usize;
        let Some((best, folds)) = tried.best() else {
            return Self {
                best: given,
                alike: [given; 2],
                usual: usual.unwrap_or(given),
            };
        };
        let alike =
            |(_, other): &&(usize, Folds)| other.behind(folds, Refitted::StateAndConstant) <= 1.0;
        let alike = || tried.all.iter().filter(alike).map(|(delay, _)| *delay);
        let first: Vec<_> = tried.all.iter().filter(|d| d.0 < DELAYS).cloned().collect();
        let first = || smallest(&first).map(|(delay, _)| *delay);
        Self {
            best: *best,
            alike: [
                alike().min().unwrap_or(*best),
                alike().max().unwrap_or(*best),
            ],
            usual: usual.or_else(first).unwrap_or(*best),
        }
    }
}

/// The same fit with its delay between two samples, where that simulates better: halves, then
/// quarters.
pub(crate) fn between_samples<'a>(problem: &'a Problem<'a>, judged: Judged<'a>) -> Judged<'a> {
    let mut best = judged;
    for step in [0.5, 0.25] {
        let at = |delay: f64| {
            let fit = Fit::new(problem, best.fit.filter(), delay, best.fit.method()).ok()?;
            let folds = Folds::of(problem, &fit)?;
            Some(Judged { fit, folds, ..best })
        };
        let beside = [best.fit.delay() - step, best.fit.delay() + step];
        let beside = beside.into_iter().filter(|delay| *delay >= 0.0);
        let beside = best_of(beside.filter_map(at));
        if let Some(beside) = beside.filter(|beside| error(beside) < BETTER * error(&best)) {
            best = beside;
        }
    }
    best
}

/// The same filter with the delay as an unknown, where that has a model.
pub(crate) fn followed<'a>(problem: &'a Problem<'a>, start: &Judged<'a>) -> Option<Judged<'a>> {
    let (filter, method) = (start.fit.filter(), start.fit.method());
    let free = Fit::new(problem, filter, start.fit.delay(), method).ok()?;
    let free = free.with_free_delay().ok()?;
    let fit = Fit::new(problem, filter, free.delay(), method).ok()?;
    let folds = Folds::of(problem, &fit)?;
    Some(Judged {
        fit,
        folds,
        ..*start
    })
}

/// The same fit at the delay that the record shows, between samples where that simulates better.
pub(crate) fn at_its_delay<'a>(problem: &'a Problem<'a>, judged: Judged<'a>) -> Judged<'a> {
    let near = between_samples(problem, judged);
    let free = followed(problem, &near);
    match free.filter(|free| error(free) < BETTER * error(&near)) {
        Some(free) => free,
        None => near,
    }
}
