//! One structure over one record: search, estimate and a fit on samples that it has not seen.

use crate::error::Error;
use crate::estimate::Estimate;
use crate::free_run::FreeRun;
use crate::problem::Problem;
use crate::run::{PredictionErrors, Run, Trace};
use crate::search::{Choice, Freedom, Progress, iterate_filter, tune};
use crate::tuning::Tuning;

/// A model with what speaks for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Identification {
    /// Filter and delay, given or found.
    pub tuning: Tuning,
    /// The model of the whole record.
    pub estimate: Estimate,
    /// One-step prediction errors over the whole record.
    pub errors: PredictionErrors,
    /// Free simulation of the second half; `None` where the model runs away.
    pub free_run: Option<FreeRun>,
    /// Whether the simulated model is that of the first half. The whole record stands in where the
    /// first half alone does not separate the parameters.
    pub held_out: bool,
    /// The course of the parameters.
    pub trace: Trace,
}

/// Identifies the model of a problem, with a trace of about `trace_points` rows (0 for none).
///
/// # Errors
/// [`Error::CannotCarry`] when the samples do not separate the parameters or no model of the search can
/// be simulated; a configuration that the core refuses.
pub fn identify(
    problem: &Problem,
    freedom: Freedom,
    trace_points: usize,
    progress: &dyn Progress,
) -> Result<Identification, Error> {
    let tuning = match (freedom.pole, freedom.delay) {
        (Choice::Given(pole), Choice::Given(delay)) => Tuning {
            pole,
            model: None,
            delay,
        },
        _ => tune(problem, freedom, progress)?,
    };
    let tuning = match freedom.pole {
        Choice::Auto => iterate_filter(problem, tuning),
        Choice::Given(_) => tuning,
    };
    let samples = problem.samples();
    let mut trace = Trace::default();
    let every = samples.checked_div(trace_points).map(|every| every.max(1));
    let Run {
        end: estimate,
        errors,
        ..
    } = problem.run(tuning, every.map(|every| (&mut trace, every)))?;
    problem.check(&estimate)?;
    let half = problem.run_held(tuning)?.half;
    let held_out = problem.check(&half).is_ok();
    let simulated = if held_out { &half } else { &estimate };
    let free_run = problem.free_run(simulated, tuning.delay as f64, samples / 2..samples);
    Ok(Identification {
        tuning,
        estimate,
        errors,
        free_run,
        held_out,
        trace,
    })
}
