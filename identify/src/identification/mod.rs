//! One structure over one record: filter, delay, estimate and a fit on samples that nothing of it
//! has seen.

mod by_sums;
mod friction;
mod model;
mod recursion;
#[cfg(test)]
mod tests;

use trendid::trends::Scheme;

use by_sums::{elsewhere, given, sharp};
pub use model::{Friction, Identification, Way};
use recursion::{inseparable, recursion, recursive_errors};

use crate::error::Error;
use crate::problem::Problem;
use crate::search::{Choice, Freedom, Progress};

/// Identifies the model of a problem, with a trace of about `trace_points` rows (0 for none).
///
/// Cost: two passes over the record for each of some 14 poles and of 7 delays or more, on all
/// processors, and half of that again for the fit held out.
///
/// # Errors
/// [`Error::Filter`]; [`Error::CannotCarry`] when the samples do not separate the parameters or no
/// model of the search can be simulated; a configuration that the core refuses.
pub fn identify(
    problem: &Problem,
    freedom: Freedom,
    trace_points: usize,
    progress: &dyn Progress,
) -> Result<Identification, Error> {
    freedom.check(problem.signals.dt)?;
    let recursive = problem.options.memory.is_some()
        || problem.options.scheme != Scheme::Tustin
        || freedom.pole == Choice::Given(None);
    if recursive {
        return recursion(problem, freedom, trace_points);
    }
    let found = once(problem, freedom, trace_points, progress)?;
    Ok(friction::held(problem, freedom, trace_points, found))
}

/// The same with the inputs as they are.
fn once(
    problem: &Problem,
    freedom: Freedom,
    trace_points: usize,
    progress: &dyn Progress,
) -> Result<Identification, Error> {
    let sharp = match sharp(problem, freedom, progress) {
        Ok(sharp) => sharp,
        // A model that is not stable has no folds, but it has parameters.
        Err(_) if matches!(freedom.pole, Choice::Given(_)) => {
            return recursion(problem, freedom, trace_points);
        }
        Err(error) => return Err(inseparable(problem, given(freedom.delay)).unwrap_or(error)),
    };
    problem.check(&sharp.found.estimate)?;
    let tuning = sharp.tuning(problem);
    let (errors, trace) = recursive_errors(problem, tuning, trace_points).unwrap_or_default();
    let elsewhere = match freedom.pole {
        Choice::Auto => elsewhere(problem, &sharp),
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
        pole: Some(sharp.pole),
        filter_shifts: elsewhere.as_ref().map(|elsewhere| elsewhere.shifts),
        own_filter: sharp.own_filter,
        delay: sharp.delay,
        delay_at_end: sharp.at_end,
        delay_alike: sharp.delay_alike,
        delay_found: sharp.found.delay,
        friction: Friction::Measured,
        free_run: problem.free_run(&simulated, delay, n / 2..n),
        held_out,
        errors,
        trace,
        effective_blocks: Some(sharp.found.effective_blocks),
        estimate: match elsewhere {
            Some(elsewhere) => elsewhere.contained_in(problem, sharp.found.estimate),
            None => sharp.found.estimate,
        },
        least_squares: sharp.least_squares,
    })
}
