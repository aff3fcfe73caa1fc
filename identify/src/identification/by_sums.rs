//! Filter and delay by folds, and the model by the sums of the whole record.

use super::model::Way;
use crate::delay_choice::{Delays, LONGEST_DELAY, between_samples};
use crate::error::{Error, Weakness};
use crate::estimate::Estimate;
use crate::filter_choice::{self, Elsewhere, Judged, choose, guarded, with_own_filter};
use crate::instruments::{Fit, Found, Method};
use crate::poor_input::PoorInput;
use crate::problem::Problem;
use crate::search::{Choice, Freedom, Progress};
use crate::signals::Signals;
use crate::tuning::{ModelFilter, Tuning};

/// The recursion settles in 30 time constants of its filter over a record, at the slowest.
const RECURSION: f64 = 30.0;

/// Samples over which filter and delay are searched at most.
pub(super) const LONGEST_SEARCH: usize = 200_000;

/// Standard deviations within which an error is taken to be.
const DEVIATIONS: f64 = 3.0;

/// What the sums of a record give.
pub(super) struct Sharp {
    pub(super) way: Way,
    pub(super) pole: f64,
    pub(super) own_filter: Option<Vec<f64>>,
    filter: Vec<f64>,
    method: Method,
    pub(super) delay: f64,
    pub(super) at_end: bool,
    pub(super) delay_alike: Option<[usize; 2]>,
    pub(super) found: Found,
    pub(super) least_squares: Option<Estimate>,
}

/// The delay to begin with.
pub(super) fn given(delay: Choice<usize>) -> usize {
    match delay {
        Choice::Given(delay) => delay,
        Choice::Auto => 0,
    }
}

/// Filter and delay, found or given.
struct Chosen {
    pole: f64,
    own: bool,
    filter: Vec<f64>,
    delay: f64,
    at_end: bool,
    delay_alike: Option<[usize; 2]>,
    method: Method,
}

/// The window of [`LONGEST_SEARCH`] samples, of eight, in which the output moves most.
fn window<'a>(signals: &Signals<'a>) -> Signals<'a> {
    let n = signals.output.len();
    let starts = (0..8).map(|i| i * (n - LONGEST_SEARCH) / 7);
    let movement = |start: usize| {
        let y = &signals.output[start..start + LONGEST_SEARCH];
        let mean = y.iter().sum::<f64>() / y.len() as f64;
        y.iter().map(|y| (y - mean).powi(2)).sum::<f64>()
    };
    let most = starts.map(|start| (movement(start), start));
    let start = most
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map_or(0, |(_, start)| start);
    signals.part(start..start + LONGEST_SEARCH)
}

/// Filter and delay by folds.
fn chosen(problem: &Problem, freedom: Freedom, progress: &dyn Progress) -> Result<Chosen, Error> {
    let poles = match freedom.pole {
        Choice::Given(Some(pole)) => vec![pole],
        _ => filter_choice::poles(problem.samples(), problem.signals.dt),
    };
    progress.begin(poles.len());
    let given = given(freedom.delay);
    let judged = choose(problem, &poles, given as f64, progress);
    let (mut at_end, mut delay_alike) = (false, None);
    let mut judged = match freedom.delay {
        Choice::Given(_) => judged?,
        Choice::Auto => {
            let (judged, delays) = Delays::of(problem, &poles, judged)?;
            let delay = delays.best;
            (at_end, delay_alike) = (delay == LONGEST_DELAY, Some(delays.alike));
            let judged = match delay == given && judged.fit.delay() == given as f64 {
                true => judged,
                false => choose(problem, &poles, delay as f64, &())?,
            };
            between_samples(problem, judged)
        }
    };
    if freedom.pole == Choice::Auto {
        judged = with_own_filter(problem, judged);
    }
    let (Judged { pole, own, fit, .. }, _) = guarded(problem, judged);
    Ok(Chosen {
        pole,
        own,
        filter: fit.filter().to_vec(),
        delay: fit.delay(),
        at_end,
        delay_alike,
        method: fit.method(),
    })
}

/// Whether no second change of the input makes up for a delay that the first one does not tell.
fn one_step(problem: &Problem) -> bool {
    PoorInput::of(problem.signals) == Some(PoorInput::Step)
}

/// Whether a delay is told from the parameters: the equations are linear in it over the fastest
/// time constant of the model, and three deviations of it are promised to hold.
fn told(problem: &Problem, found: &Found) -> bool {
    let sigma = found.delay.as_ref().map_or(0.0, |delay| delay.sigma);
    DEVIATIONS * sigma * problem.signals.dt * found.estimate.fastest() <= 1.0
}

/// Filter and delay by folds, in a long record over a part of it, then the model of the whole
/// record.
pub(super) fn sharp(
    problem: &Problem,
    freedom: Freedom,
    progress: &dyn Progress,
) -> Result<Sharp, Error> {
    let chosen = if problem.samples() > LONGEST_SEARCH {
        let window = window(problem.signals);
        let part = Problem::new(&window, problem.structure, problem.options)?;
        self::chosen(&part, freedom, progress)?
    } else {
        self::chosen(problem, freedom, progress)?
    };
    let Chosen {
        filter,
        delay,
        method,
        ..
    } = chosen;
    let at = |delay: f64, method: Method| Fit::new(problem, &filter, delay, method)?.refined();
    let free = || {
        let fit = at(delay, method)?.with_free_delay()?;
        let found = fit.found_behind_noise()?;
        // The parameters are those at the delay that the sums add, which are linear over a sample.
        let shift = found.delay.as_ref().map_or(0.0, |found| found.shift);
        Ok::<_, Error>(((fit.delay() + shift.clamp(-1.0, 1.0)).max(0.0), found))
    };
    let (delay, found) = match freedom.delay {
        Choice::Auto => match free() {
            Ok(both) if told(problem, &both.1) => both,
            _ if one_step(problem) => return Err(problem.cannot_carry(Weakness::Delay)),
            Ok(both) => both,
            // The record does not tell the delay from the parameters.
            Err(_) => {
                let mut found = at(delay, method)?.found_behind_noise()?;
                let ends = chosen.delay_alike.unwrap_or_default();
                let moves = ends.into_iter().filter_map(|end| {
                    let there = at(end as f64, method).ok()?.found().ok()?.estimate;
                    Some(there.moves_from(&found.estimate))
                });
                found.estimate = problem.widened(&found.estimate, &moves.collect::<Vec<_>>());
                (delay, found)
            }
        },
        Choice::Given(_) => {
            let fit = at(delay, method)?;
            let mut found = fit.found_behind_noise()?;
            let around = fit.around_delay().and_then(|fit| fit.found_behind_noise());
            found.delay = around.ok().and_then(|found| found.delay);
            (delay, found)
        }
    };
    let least_squares = at(delay, Method::LeastSquares).and_then(|fit| Ok(fit.found()?.estimate));
    Ok(Sharp {
        way: match method {
            Method::LeastSquares => Way::WeakInstruments,
            Method::Instruments => Way::Instruments,
        },
        found,
        least_squares: least_squares.ok(),
        pole: chosen.pole,
        own_filter: chosen.own.then(|| filter.clone()),
        filter,
        method,
        delay,
        at_end: chosen.at_end,
        delay_alike: chosen.delay_alike,
    })
}

/// What other filters make of the model, in a long record over a part of it.
pub(super) fn elsewhere(problem: &Problem, sharp: &Sharp) -> Option<Elsewhere> {
    let window = match problem.samples() > LONGEST_SEARCH {
        true => window(problem.signals),
        false => problem.signals.clone(),
    };
    let part = Problem::new(&window, problem.structure, problem.options).ok()?;
    let fit = Fit::new(&part, &sharp.filter, sharp.delay, sharp.method);
    filter_choice::elsewhere(&part, &fit.ok()?.refined().ok()?, sharp.pole)
}

impl Sharp {
    /// Filter and delay as the recursion takes them.
    pub(super) fn tuning(&self, problem: &Problem) -> Tuning {
        let slowest = RECURSION / (problem.samples() as f64 * problem.signals.dt);
        let integrator = problem.structure.integrator;
        let own = self.own_filter.as_ref();
        Tuning {
            pole: Some(self.pole.max(slowest)),
            model: own.and_then(|_| ModelFilter::of(&self.found.estimate, integrator, self.pole)),
            delay: self.delay.round() as usize,
        }
    }
}
