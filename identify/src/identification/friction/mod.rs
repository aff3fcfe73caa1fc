//! The friction of a force balance as its own model has it, where that simulates the record better.

mod containment;
mod descent;
mod output_error;
mod settle;
mod start;

use super::by_sums::LONGEST_SEARCH;
use super::model::{Friction, Identification, Way};
use super::once::once;
use crate::error::Error;
use crate::estimate::Estimate;
use crate::held_friction::coulomb;
use crate::polynomials::Polynomials;
use crate::problem::Problem;
use crate::search::Freedom;
use output_error::MostLikely;
use settle::{next, settle, with_signs_of};
use start::{Start, Trial};

/// Estimates with the signs of the one before, ahead of the search of filter and delay.
const REPETITIONS: usize = 4;

/// A friction that is found by trying is gone on from where it leaves less than this share of what
/// the best so far leaves.
const BETTER: f64 = 0.9;

/// The most likely model with a friction of its own, where it leaves noise alone of the record:
/// there no other one is better. Elsewhere what is left is an error of the structure, and the model
/// is that by instruments.
///
/// # Errors
/// Those with measured signs, where no friction is found by trying either; parameters that the
/// motion does not tell apart.
pub(super) fn held(
    problem: &Problem,
    freedom: Freedom,
    trace_points: usize,
    measured: Result<Identification, Error>,
) -> Result<Identification, Error> {
    // Some hundred passes over the record: a longer one keeps its measured signs.
    let long = problem.samples() > LONGEST_SEARCH;
    let recursive = measured.as_ref().is_ok_and(|m| m.way == Way::Recursion);
    if long || recursive || coulomb(problem).is_none() {
        return measured;
    }
    let search = Search {
        freedom,
        trace_points,
    };
    let mut signals = problem.signals.clone();
    signals.standstill = None;
    let throughout = Problem {
        signals: &signals,
        ..*problem
    };
    let best = measured.map(|found| search.by_instruments(problem, &throughout, found));
    let trial = Trial::of(&throughout);
    let start = (trial.as_ref()).and_then(|trial| Some((trial, trial.best(freedom)?)));
    let Some((trial, start)) = start else {
        return Ok(finished(best?));
    };
    let friction = match problem.signals.standstill {
        Some(_) => Friction::HeldAtRest,
        None => Friction::Held,
    };
    let likely = MostLikely {
        trial,
        start: &start,
        friction,
        freedom,
        trace_points,
    };
    let so_far = best.as_ref().ok().map(|best| &best.found);
    if let Some(likely) = likely.identified(so_far) {
        throughout.check_centred(&likely.estimate)?;
        return Ok(likely);
    }
    let mut best = finished(search.with_trial(&throughout, (trial, &start), best, friction)?);
    start.contained_in(trial, &mut best);
    Ok(best)
}

/// A model of measured signs without what these feign.
fn finished(best: Candidate) -> Identification {
    let mut best = best.found;
    if best.friction == Friction::Measured {
        forget_early_command(&mut best);
    }
    best
}

/// Behind measured signs, which are late, the command seems early.
fn forget_early_command(found: &mut Identification) {
    found.delay_found = (found.delay_found.take()).filter(|_| found.delay_alike.is_some());
    if let Some(delay) = &mut found.delay_found {
        delay.shift = 0.0;
    }
}

/// A model with its errors in a simulation of the whole record.
struct Candidate {
    found: Identification,
    errors: Option<[f64; 2]>,
}

impl Candidate {
    /// The other one in the place of this one where it simulates better.
    fn replaced_by(&mut self, other: Option<Self>) {
        let better = |other: &Self| {
            let errors = match (self.errors, other.errors) {
                (Some(own), Some(other)) => other[0] < own[0] && other[1] < own[1],
                (_, other) => other.is_some(),
            };
            errors && simulates_better(&other.found, &self.found)
        };
        if let Some(other) = other.filter(better) {
            *self = other;
        }
    }
}

/// Errors of a simulation of the whole record, sums of squares; a rest that is measured has none.
fn whole(problem: &Problem, found: &Identification) -> Option<[f64; 2]> {
    let e = &found.estimate;
    let model = Polynomials {
        a: e.a.clone(),
        b: e.b.clone(),
        constant: e.constant,
    };
    let simulated = problem.simulate(&model, found.delay, 0..problem.samples())?;
    Some(simulated.squares)
}

/// Whether the half held out is simulated better, too.
fn simulates_better(found: &Identification, best: &Identification) -> bool {
    match (&found.free_run, &best.free_run) {
        (Some(found), Some(best)) => found.fit_x0 > best.fit_x0 && found.fit_x0c > best.fit_x0c,
        (found, _) => found.is_some(),
    }
}

/// How models are searched whose friction is their own.
struct Search {
    freedom: Freedom,
    trace_points: usize,
}

impl Search {
    /// The model whose friction is its own, with the measured rests and without, where one of the
    /// two simulates better than that with measured signs: the whole record and the half held out,
    /// with the initial state refitted and with the constant refitted too.
    fn by_instruments(
        &self,
        problem: &Problem,
        throughout: &Problem,
        measured: Identification,
    ) -> Candidate {
        let mut best = Candidate {
            errors: whole(problem, &measured),
            found: measured,
        };
        best.replaced_by(self.held_in(problem, &best.found, Friction::Held));
        if problem.signals.standstill.is_some() {
            best.replaced_by(self.held_in(throughout, &best.found, Friction::HeldAtRest));
        }
        best
    }

    /// The same from a friction on that is found by trying, where that promises more.
    fn with_trial(
        &self,
        problem: &Problem,
        (trial, start): (&Trial, &Start),
        best: Result<Candidate, Error>,
        friction: Friction,
    ) -> Result<Candidate, Error> {
        let so_far = best.as_ref().ok().map(|best| &best.found);
        let left = so_far.map(|found| trial.left_by(&found.estimate, found.delay));
        let promises = left.is_none_or(|left| start.left < BETTER * left);
        let tried = match promises {
            true => self.going_on(problem, start, friction),
            false => None,
        };
        match (best, tried) {
            (Ok(mut best), tried) => {
                best.replaced_by(tried);
                Ok(best)
            }
            (Err(_), Some(tried)) => Ok(tried),
            (Err(error), None) => Err(error),
        }
    }

    /// From an identification on.
    fn held_in(
        &self,
        problem: &Problem,
        start: &Identification,
        friction: Friction,
    ) -> Option<Candidate> {
        let mut estimate = start.estimate.clone();
        for _ in 0..REPETITIONS {
            estimate = next(problem, start, (&estimate, start.delay), false)?.estimate;
        }
        let mut found = self.found(problem, (&estimate, start.delay))?;
        found.friction = friction;
        settle(problem, &mut found)?;
        let own = (&found.estimate, found.delay);
        let errors = with_signs_of(problem, own, |own| whole(own, &found))?;
        Some(Candidate {
            errors: Some(errors),
            found,
        })
    }

    /// From the friction on that is found by trying.
    fn going_on(&self, problem: &Problem, start: &Start, friction: Friction) -> Option<Candidate> {
        let start = self.found(problem, (&start.estimate, start.delay))?;
        self.held_in(problem, &start, friction)
    }

    /// Filter, delay and estimate with the friction of another one.
    fn found(&self, problem: &Problem, of: (&Estimate, f64)) -> Option<Identification> {
        let found = with_signs_of(problem, of, |own| {
            once(own, self.freedom, self.trace_points, &()).ok()
        })?;
        (found.way != Way::Recursion).then_some(found)
    }
}
