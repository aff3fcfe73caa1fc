//! One structure over one record: filter, delay, estimate and a fit on samples that nothing of it has seen.

use std::ops::Range;

use trendid::trends::Scheme;

use crate::delay_choice::{best_delay, between_samples};
use crate::error::Error;
use crate::estimate::Estimate;
use crate::filter_choice::{self, Judged, choose, guarded, with_own_filter};
use crate::free_run::FreeRun;
use crate::instruments::{Fit, Found, Method};
use crate::problem::{Options, Problem};
use crate::run::{PredictionErrors, Trace};
use crate::search::{Choice, Freedom, Progress};
use crate::signals::{Input, Signals};
use crate::tuning::{ModelFilter, Tuning};

/// The recursion settles in 30 time constants of its filter over a record, at the slowest.
const RECURSION: f64 = 30.0;

/// Samples over which filter and delay are searched at most.
const LONGEST_SEARCH: usize = 200_000;

/// How the model was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// By instruments.
    Instruments,
    /// By least squares over the sums, because the instruments were weak.
    WeakInstruments,
    /// By the recursion of the core: with a memory, raw trends or the scheme of Goodwin, and for what is not stable.
    Recursion,
}

/// A model with what speaks for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Identification {
    /// How it was found.
    pub way: Way,
    /// The pole of the filter \[rad/s\]; `None` for raw trends.
    pub pole: Option<f64>,
    /// f_0 .. f_{m-1} of the filter 1/A with the poles of the model itself, where that was taken.
    pub own_filter: Option<Vec<f64>>,
    /// Delay in samples.
    pub delay: f64,
    /// Whether the longest delay that is offered was taken.
    pub delay_at_end: bool,
    /// The model of the whole record.
    pub estimate: Estimate,
    /// Blocks that its standard deviations rest on; `None` for those of the recursion, which take the noise for white.
    pub effective_blocks: Option<f64>,
    /// The same by least squares behind the same filter, for comparison.
    pub least_squares: Option<Estimate>,
    /// One-step prediction errors of the recursion over the whole record.
    pub errors: PredictionErrors,
    /// Free simulation of the second half; `None` where the model runs away.
    pub free_run: Option<FreeRun>,
    /// Whether the simulated model, its filter and its delay come from the first half alone. The whole record stands in
    /// where the first half does not separate the parameters.
    pub held_out: bool,
    /// The course of the parameters in the recursion.
    pub trace: Trace,
}

/// What the sums of a record give.
struct Sharp {
    way: Way,
    pole: f64,
    own_filter: Option<Vec<f64>>,
    delay: f64,
    at_end: bool,
    found: Found,
    least_squares: Option<Estimate>,
}

/// Identifies the model of a problem, with a trace of about `trace_points` rows (0 for none).
///
/// Cost: two passes over the record for each of some 14 poles and of 7 delays or more, on all processors, and half of that again
/// for the fit held out.
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
    let recursive = problem.options.memory.is_some()
        || problem.options.scheme != Scheme::Tustin
        || freedom.pole == Choice::Given(None);
    if recursive {
        return recursion(problem, freedom, trace_points);
    }
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
    let n = problem.samples();
    let half = part(problem.signals, 0..n / 2);
    let half = Problem::new(&half, problem.structure, problem.options)
        .and_then(|half| self::sharp(&half, freedom, &()).map(|s| (s.found.estimate, s.delay)));
    let held_out = half.is_ok();
    let (simulated, delay) = half.unwrap_or((sharp.found.estimate.clone(), sharp.delay));
    Ok(Identification {
        way: sharp.way,
        pole: Some(sharp.pole),
        own_filter: sharp.own_filter,
        delay: sharp.delay,
        delay_at_end: sharp.at_end,
        free_run: problem.free_run(&simulated, delay, n / 2..n),
        held_out,
        errors,
        trace,
        effective_blocks: Some(sharp.found.effective_blocks),
        estimate: sharp.found.estimate,
        least_squares: sharp.least_squares,
    })
}

/// The delay to begin with.
fn given(delay: Choice<usize>) -> usize {
    match delay {
        Choice::Given(delay) => delay,
        Choice::Auto => 0,
    }
}

/// What the recursion cannot tell apart, behind the middle one of all filters.
fn inseparable(problem: &Problem, delay: usize) -> Option<Error> {
    let poles = filter_choice::poles(problem.samples(), problem.signals.dt);
    let tuning = Tuning {
        pole: poles.get(poles.len() / 2).copied(),
        model: None,
        delay,
    };
    let run = problem.run(tuning, None).ok()?;
    problem.check(&run.end).err()
}

/// Some samples of all signals.
fn part<'a>(signals: &Signals<'a>, range: Range<usize>) -> Signals<'a> {
    let inputs = signals.inputs.iter().map(|input| Input {
        samples: &input.samples[range.clone()],
        ..*input
    });
    Signals {
        dt: signals.dt,
        output: &signals.output[range.clone()],
        inputs: inputs.collect(),
        standstill: signals.standstill.map(|still| &still[range.clone()]),
    }
}

/// Filter and delay, found or given.
struct Chosen {
    pole: f64,
    own: bool,
    filter: Vec<f64>,
    delay: f64,
    at_end: bool,
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
    part(signals, start..start + LONGEST_SEARCH)
}

/// Filter and delay by folds.
fn chosen(problem: &Problem, freedom: Freedom, progress: &dyn Progress) -> Result<Chosen, Error> {
    let poles = match freedom.pole {
        Choice::Given(Some(pole)) => vec![pole],
        _ => filter_choice::poles(problem.samples(), problem.signals.dt),
    };
    progress.begin(poles.len());
    let given = given(freedom.delay);
    let mut judged = choose(problem, &poles, given as f64, progress)?;
    let mut at_end = false;
    if freedom.delay == Choice::Auto {
        let (delay, end) = best_delay(problem, &judged);
        at_end = end;
        if delay != given {
            judged = choose(problem, &poles, delay as f64, &())?;
        }
        judged = between_samples(problem, judged);
    }
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
        method: fit.method(),
    })
}

/// Filter and delay by folds, in a long record over a part of it, then the model of the whole record.
fn sharp(problem: &Problem, freedom: Freedom, progress: &dyn Progress) -> Result<Sharp, Error> {
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
    let fitted = |method: Method| {
        Fit::new(problem, &filter, delay, method)?
            .refined()?
            .found()
    };
    let least_squares = fitted(Method::LeastSquares).map(|found| found.estimate);
    Ok(Sharp {
        way: match method {
            Method::LeastSquares => Way::WeakInstruments,
            Method::Instruments => Way::Instruments,
        },
        found: fitted(method)?,
        least_squares: least_squares.ok(),
        pole: chosen.pole,
        own_filter: chosen.own.then(|| filter.clone()),
        delay,
        at_end: chosen.at_end,
    })
}

impl Sharp {
    /// Filter and delay as the recursion takes them.
    fn tuning(&self, problem: &Problem) -> Tuning {
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

/// The one-step prediction errors and the course of the parameters of the core over the record.
fn recursive_errors(
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

/// The model by the recursion of the core, with the filter and the delay that instruments would take.
fn recursion(
    problem: &Problem,
    freedom: Freedom,
    trace_points: usize,
) -> Result<Identification, Error> {
    let tuning = match (freedom.pole, freedom.delay) {
        (Choice::Given(pole), Choice::Given(delay)) => Tuning {
            pole,
            model: None,
            delay,
        },
        (pole, delay) => {
            let plain = Problem {
                options: Options::default(),
                ..*problem
            };
            let pole = match pole {
                Choice::Given(None) => Choice::Auto,
                other => other,
            };
            let sharp = sharp(&plain, Freedom { pole, delay }, &())?;
            let raw = freedom.pole == Choice::Given(None);
            Tuning {
                pole: sharp.tuning(&plain).pole.filter(|_| !raw),
                ..sharp.tuning(&plain)
            }
        }
    };
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
    Ok(Identification {
        way: Way::Recursion,
        pole: tuning.pole,
        own_filter: tuning.model.map(|model| {
            let coefficients = model.coefficients().iter().copied();
            coefficients.map(f64::from).collect()
        }),
        delay: tuning.delay as f64,
        delay_at_end: false,
        free_run: problem.free_run(simulated, tuning.delay as f64, n / 2..n),
        held_out,
        errors: run.errors,
        trace,
        effective_blocks: None,
        estimate: run.end,
        least_squares: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Weakness;
    use crate::problem::Structure;
    use trendid::trends::Hold;

    /// `y' = -2 y + 6 u` with a drift of the output: least squares is low, instruments are not.
    #[test]
    fn instruments_stand_where_least_squares_is_biased() {
        let (dt, decay) = (0.01, (-0.02_f64).exp());
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 23) - 1.0
        };
        let u: Vec<f64> = (0..6000)
            .map(|k| if (k / 70) % 2 == 0 { 1.0 } else { -0.5 })
            .collect();
        let (mut x, mut drift, mut y) = (0.0, 0.0, Vec::new());
        for u in &u {
            drift = 0.98 * drift + 0.1 * random();
            y.push(x + drift + 0.3 * random());
            x = decay * x + 3.0 * (1.0 - decay) * u;
        }
        let signals = Signals {
            dt,
            output: &y,
            inputs: vec![Input {
                name: "u",
                samples: &u,
                delayed: true,
                hold: Hold::Zero,
            }],
            standstill: None,
        };
        let structure = Structure {
            order: 1,
            integrator: false,
            zeros: 0,
            constant: true,
        };
        let problem = Problem::new(&signals, structure, Options::default()).expect("a problem");
        let freedom = Freedom {
            pole: Choice::Given(Some(20.0)),
            delay: Choice::Given(0),
        };
        let found = identify(&problem, freedom, 0, &()).expect("a model");
        assert_eq!(found.way, Way::Instruments);
        let off = (found.estimate.a[0] - 2.0) / found.estimate.sigma[0];
        assert!(off.abs() < 3.0, "{off}");
        let ls = found.least_squares.expect("least squares");
        assert!(ls.a[0] > 2.1 || ls.a[0] < 1.9, "{:?}", ls.a);
        let off = (found.estimate.a[0] - 2.0).abs();
        assert!(off < 0.5 * (ls.a[0] - 2.0).abs(), "{off}");
    }

    #[test]
    fn what_no_filter_can_simulate_is_refused() {
        let u: Vec<f64> = (0..400).map(|k| f64::from(k % 7)).collect();
        let y: Vec<f64> = (0..400).map(|k| (0.1 * f64::from(k)).exp()).collect();
        let signals = Signals {
            dt: 0.01,
            output: &y,
            inputs: vec![Input {
                name: "u",
                samples: &u,
                delayed: true,
                hold: Hold::Zero,
            }],
            standstill: None,
        };
        let structure = Structure {
            order: 1,
            integrator: false,
            zeros: 0,
            constant: false,
        };
        let problem = Problem::new(&signals, structure, Options::default()).expect("a problem");
        let refused = identify(&problem, Freedom::default(), 0, &());
        assert_eq!(refused, Err(problem.cannot_carry(Weakness::NoSimulation)));
    }
}
