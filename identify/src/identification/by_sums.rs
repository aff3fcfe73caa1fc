//! Filter and delay by folds, and the model by the sums of the whole record.

use super::model::Way;
use crate::delay_choice::{Delays, LONGEST_DELAY, between_samples};
use crate::error::{Error, Weakness};
use crate::estimate::Estimate;
use crate::filter_choice::{self, Elsewhere, Judged, choose, guarded, with_own_filter};
use crate::imitated_delay::{Longer, Other, longer};
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
    pub(super) chosen: Chosen,
    pub(super) delay: f64,
    pub(super) found: Found,
    pub(super) least_squares: Option<Estimate>,
    pub(super) poor_input: Option<PoorInput>,
}

/// The delay to begin with.
pub(super) fn given(delay: Choice<usize>) -> usize {
    match delay {
        Choice::Given(delay) => delay,
        Choice::Auto => 0,
    }
}

/// Filter and delay, found or given.
pub(super) struct Chosen {
    pub(super) pole: f64,
    own: bool,
    filter: Vec<f64>,
    delay: f64,
    pub(super) at_end: bool,
    pub(super) delay_alike: Option<[usize; 2]>,
    /// A longer delay that a zero in the right half plane imitates.
    pub(super) imitated: Option<Other>,
    method: Method,
}

/// What the sums are made behind.
#[derive(Clone, Copy)]
pub(crate) struct Behind<'a> {
    /// f_0 .. f_{m-1} of the filter.
    pub(crate) filter: &'a [f64],
    /// Its pole \[rad/s\], or the one that stands for the integrator.
    pub(crate) pole: f64,
    /// Delay in samples.
    pub(crate) delay: f64,
    /// How the equations are solved.
    pub(crate) method: Method,
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
    let (mut at_end, mut delay_alike, mut imitated) = (false, None, None);
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
            let judged = between_samples(problem, judged);
            match longer(problem, &judged) {
                Some(Longer::Better(longer)) => {
                    let delay = longer.fit.delay();
                    delay_alike = Some([delay.floor() as usize, delay.ceil() as usize]);
                    longer
                }
                Some(Longer::Alike(longer)) => {
                    imitated = Other::of(&longer);
                    judged
                }
                None => judged,
            }
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
        imitated,
        method: fit.method(),
    })
}

/// Whether a delay is told from the parameters: the equations are linear in it over the fastest
/// time constant of the model, and three deviations of it are promised to hold.
fn told(problem: &Problem, found: &Found) -> bool {
    let sigma = found.delay.as_ref().map_or(0.0, |delay| delay.sigma);
    DEVIATIONS * sigma * problem.signals.dt * found.estimate.fastest() <= 1.0
}

/// The model of a whole record, with a delay that is searched among its unknowns; the delay that
/// its parameters belong to, in samples.
///
/// Where the record does not tell the delay from the parameters, these contain what the whole
/// delays `alike`, the shortest and the longest that simulate as well, make of them.
///
/// # Errors
/// [`Error::CannotCarry`] where the equations are singular, or a delay that rests on one step is
/// not told from the parameters.
pub(crate) fn model(
    problem: &Problem,
    behind: Behind,
    alike: Option<[usize; 2]>,
    poor_input: Option<PoorInput>,
) -> Result<(f64, Found), Error> {
    let Behind { filter, method, .. } = behind;
    let at = |delay: f64| Fit::new(problem, filter, delay, method)?.refined();
    let Some(ends) = alike else {
        let fit = at(behind.delay)?;
        let mut found = fit.found_behind_noise()?;
        let around = fit.around_delay().and_then(|fit| fit.found_behind_noise());
        found.delay = around.ok().and_then(|found| found.delay);
        return Ok((behind.delay, found));
    };
    let free = || {
        let fit = at(behind.delay)?.with_free_delay()?;
        let mut found = fit.found_behind_noise()?;
        // The parameters are those at the delay that the sums add, which are linear over a sample;
        // what is left of it is missed.
        let shift = found.delay.as_ref().map_or(0.0, |found| found.shift);
        let delay = (fit.delay() + shift.clamp(-1.0, 1.0)).max(0.0);
        let left = shift - (delay - fit.delay());
        found.delay.iter_mut().for_each(|found| found.shift = left);
        Ok::<_, Error>((delay, found))
    };
    match free() {
        Ok(both) if told(problem, &both.1) => Ok(both),
        _ if poor_input == Some(PoorInput::Step) => Err(problem.cannot_carry(Weakness::Delay)),
        Ok(both) => Ok(both),
        // The record does not tell the delay from the parameters.
        Err(_) => {
            let mut found = at(behind.delay)?.found_behind_noise()?;
            let moves = ends.into_iter().filter_map(|end| {
                let there = at(end as f64).ok()?.found().ok()?.estimate;
                Some(there.moves_from(&found.estimate))
            });
            found.estimate = problem.widened(&found.estimate, &moves.collect::<Vec<_>>());
            Ok((behind.delay, found))
        }
    }
}

/// Filter and delay by folds, in a long record over a part of it, then the model of the whole
/// record.
pub(super) fn sharp(
    problem: &Problem,
    freedom: Freedom,
    progress: &dyn Progress,
) -> Result<Sharp, Error> {
    let poor_input = PoorInput::of_search(problem, freedom)?;
    let chosen = if problem.samples() > LONGEST_SEARCH {
        let window = window(problem.signals);
        let part = Problem::new(&window, problem.structure, problem.options)?;
        self::chosen(&part, freedom, progress)?
    } else {
        self::chosen(problem, freedom, progress)?
    };
    let behind = chosen.behind(chosen.delay);
    let (delay, found) = model(problem, behind, chosen.delay_alike, poor_input)?;
    let least_squares = Fit::new(problem, &chosen.filter, delay, Method::LeastSquares)
        .and_then(|fit| Ok(fit.refined()?.found()?.estimate));
    Ok(Sharp {
        way: match chosen.method {
            Method::LeastSquares => Way::WeakInstruments,
            Method::Instruments => Way::Instruments,
        },
        found,
        least_squares: least_squares.ok(),
        delay,
        chosen,
        poor_input,
    })
}

/// What other filters make of the model, in a long record over a part of it.
pub(crate) fn elsewhere(problem: &Problem, behind: Behind) -> Option<Elsewhere> {
    let window = match problem.samples() > LONGEST_SEARCH {
        true => window(problem.signals),
        false => problem.signals.clone(),
    };
    let part = Problem::new(&window, problem.structure, problem.options).ok()?;
    let fit = Fit::new(&part, behind.filter, behind.delay, behind.method);
    filter_choice::elsewhere(&part, &fit.ok()?.refined().ok()?, behind.pole)
}

impl Chosen {
    fn behind(&self, delay: f64) -> Behind<'_> {
        Behind {
            filter: &self.filter,
            pole: self.pole,
            delay,
            method: self.method,
        }
    }
}

impl Sharp {
    /// The filter of the model itself, where that was taken.
    pub(super) fn own_filter(&self) -> Option<&[f64]> {
        let chosen = &self.chosen;
        chosen.own.then_some(chosen.filter.as_slice())
    }

    /// What the model was found behind.
    pub(super) fn behind(&self) -> Behind<'_> {
        self.chosen.behind(self.delay)
    }

    /// Filter and delay as the recursion takes them.
    pub(super) fn tuning(&self, problem: &Problem) -> Tuning {
        let slowest = RECURSION / (problem.samples() as f64 * problem.signals.dt);
        let (integrator, pole) = (problem.structure.integrator, self.chosen.pole);
        let own = self.own_filter();
        Tuning {
            pole: Some(pole.max(slowest)),
            model: own.and_then(|_| ModelFilter::of(&self.found.estimate, integrator, pole)),
            delay: self.delay,
        }
    }
}
