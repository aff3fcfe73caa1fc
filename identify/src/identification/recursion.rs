//! What the recursion of the core says of a record: a model, its prediction errors, the parameters
//! it cannot separate.

use super::by_sums::{Sharp, sharp};
use super::model::{Friction, Identification, Way};
use crate::error::Error;
use crate::filter_choice;
use crate::problem::{Options, Problem};
use crate::run::{PredictionErrors, Trace};
use crate::search::{Choice, Freedom};
use crate::tuning::Tuning;

/// The one-step prediction errors and the course of the parameters of the core over the record.
pub(super) fn recursive_errors(
    problem: &Problem,
    tuning: Tuning,
    trace_points: usize,
) -> Option<(PredictionErrors, Trace)> {
    let mut trace = Trace::default();
    let every = problem
        .samples()
        .checked_div(trace_points)
        .map(|every| every.max(1));
    let run = problem
        .run(tuning, every.map(|every| (&mut trace, every)))
        .ok()?;
    Some((run.errors, trace))
}

/// Filter and delay that instruments would take where they are not given, and what the sums say of
/// the record at this delay.
fn tuned(problem: &Problem, freedom: Freedom) -> Result<(Tuning, Option<Sharp>), Error> {
    let plain = Problem {
        options: Options::default(),
        ..*problem
    };
    let raw = freedom.pole == Choice::Given(None);
    let pole = if raw { Choice::Auto } else { freedom.pole };
    // Their model of the record says whether the delay, given or searched, is that of the record.
    let sharp = sharp(&plain, Freedom { pole, ..freedom }, &());
    Ok(match (freedom.pole, freedom.delay) {
        (Choice::Given(pole), Choice::Given(delay)) => {
            let tuning = Tuning {
                pole,
                model: None,
                delay: delay as f64,
            };
            (tuning, sharp.ok())
        }
        _ => {
            let sharp = sharp?;
            let tuning = sharp.tuning(&plain);
            let tuning = Tuning {
                pole: tuning.pole.filter(|_| !raw),
                ..tuning
            };
            (tuning, Some(sharp))
        }
    })
}

/// The model by the recursion of the core, with the filter and the delay that instruments would
/// take.
pub(super) fn recursion(
    problem: &Problem,
    freedom: Freedom,
    trace_points: usize,
) -> Result<Identification, Error> {
    let (tuning, sharp) = tuned(problem, freedom)?;
    let mut trace = Trace::default();
    let every = problem
        .samples()
        .checked_div(trace_points)
        .map(|every| every.max(1));
    let run = problem.run(tuning, every.map(|every| (&mut trace, every)))?;
    problem.check(&run.end)?;
    let half = problem.run_held(tuning)?.half;
    let held_out = problem.check(&half).is_ok();
    let simulated = if held_out { &half } else { &run.end };
    let n = problem.samples();
    let sharp = sharp.as_ref();
    Ok(Identification {
        way: Way::Recursion,
        pole: tuning.pole,
        filter_shifts: None,
        own_filter: tuning.model.map(|model| {
            let coefficients = model.coefficients().iter().copied();
            coefficients.map(f64::from).collect()
        }),
        delay: tuning.delay,
        delay_at_end: sharp.is_some_and(|sharp| sharp.chosen.at_end),
        delay_alike: sharp.and_then(|sharp| sharp.chosen.delay_alike),
        delay_found: sharp.and_then(|sharp| sharp.found.delay.clone()),
        delay_imitated: None,
        poor_input: sharp.and_then(|sharp| sharp.poor_input),
        friction: Friction::Measured,
        free_run: problem.free_run(simulated, tuning.delay, n / 2..n),
        held_out,
        errors: run.errors,
        trace,
        effective_blocks: None,
        estimate: run.end,
        least_squares: None,
    })
}

/// What the recursion cannot tell apart, behind the middle one of all filters.
pub(super) fn inseparable(problem: &Problem, delay: usize) -> Option<Error> {
    let run = problem.run(middle(problem, delay as f64), None).ok()?;
    problem.check(&run.end).err()
}

/// The middle one of all filters.
pub(super) fn middle(problem: &Problem, delay: f64) -> Tuning {
    let poles = filter_choice::poles(problem.samples(), problem.signals.dt);
    Tuning {
        pole: poles.get(poles.len() / 2).copied(),
        model: None,
        delay,
    }
}
