//! One structure over the inputs as they are.

use super::by_sums::{elsewhere, given, sharp};
use super::model::{Friction, Identification};
use super::recursion::{inseparable, recursion, recursive_errors};
use crate::error::Error;
use crate::problem::Problem;
use crate::search::{Choice, Freedom, Progress};

/// Filter, delay, estimate and the fit held out, by sums where they separate the parameters.
///
/// # Errors
/// As those of an identification.
pub(super) fn once(
    problem: &Problem,
    freedom: Freedom,
    trace_points: usize,
    progress: &dyn Progress,
) -> Result<Identification, Error> {
    let sharp = match sharp(problem, freedom, progress) {
        Ok(sharp) => sharp,
        Err(error @ Error::OneSine { .. }) => return Err(error),
        // A model that is not stable has no folds, but it has parameters.
        Err(_) if matches!(freedom.pole, Choice::Given(_)) => {
            return recursion(problem, freedom, trace_points);
        }
        Err(error) => return Err(inseparable(problem, given(freedom.delay)).unwrap_or(error)),
    };
    problem.check_centred(&sharp.found.estimate)?;
    let found = match &sharp.chosen.imitated {
        Some(other) => other.contained_in(problem, (sharp.delay, sharp.found.clone())),
        None => sharp.found.clone(),
    };
    let tuning = sharp.tuning(problem);
    let (errors, trace) = recursive_errors(problem, tuning, trace_points).unwrap_or_default();
    let elsewhere = match freedom.pole {
        Choice::Auto => elsewhere(problem, sharp.behind()),
        Choice::Given(_) => None,
    };
    let n = problem.samples();
    let half = problem.signals.part(0..n / 2);
    let half = Problem::new(&half, problem.structure, problem.options)
        .and_then(|half| self::sharp(&half, freedom, &()).map(|s| (s.found.estimate, s.delay)));
    let held_out = half.is_ok();
    let (simulated, delay) = half.unwrap_or((sharp.found.estimate.clone(), sharp.delay));
    Ok(Identification {
        way: sharp.way,
        pole: Some(sharp.chosen.pole),
        filter_shifts: elsewhere.as_ref().map(|elsewhere| elsewhere.shifts),
        own_filter: sharp.own_filter().map(<[f64]>::to_vec),
        delay: sharp.delay,
        delay_at_end: sharp.chosen.at_end,
        delay_alike: sharp.chosen.delay_alike,
        delay_imitated: sharp.chosen.imitated.as_ref().map(|other| other.delay),
        delay_found: found.delay,
        poor_input: sharp.poor_input,
        friction: Friction::Measured,
        free_run: problem.free_run(&simulated, delay, n / 2..n),
        held_out,
        errors,
        trace,
        effective_blocks: Some(found.effective_blocks),
        estimate: match elsewhere {
            Some(elsewhere) => elsewhere.contained_in(problem, found.estimate),
            None => found.estimate,
        },
        least_squares: sharp.least_squares,
    })
}
