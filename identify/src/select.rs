//! The choice of a structure: orders, zeros and delays compared on held-out samples.

use rayon::prelude::*;

use crate::error::{Error, Weakness};
use crate::estimate::Estimate;
use crate::problem::{Options, Problem, Structure};
use crate::run::PredictionErrors;
use crate::search::{Choice, Freedom, Progress, delays, tune};
use crate::signals::Signals;
use crate::tuning::Tuning;

/// A structure is as good as the best when its ISE is at most this much larger.
pub const TOLERANCE: f64 = 0.1;

/// And only when its free simulation fits at most so many points worse: slow disturbances lower the ISE of
/// a richer structure without making it truer.
pub const POINTS: f64 = 1.0;

/// One structure at its best delay.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// The structure.
    pub structure: Structure,
    /// Delay with the smallest ISE, in samples.
    pub delay: usize,
    /// The model of the first half.
    pub estimate: Estimate,
    /// Names of its parameters.
    pub names: Vec<String>,
    /// One-step prediction errors over the second half, parameters held.
    pub errors: PredictionErrors,
    /// Fit of a free simulation of the second half, initial state and constant refitted \[%\]; minus
    /// infinity where the model runs away.
    pub fit_x0c: f64,
}

/// A structure that is no candidate, at a delay or at all of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Dropped {
    /// The structure.
    pub structure: Structure,
    /// The delay in samples; `None` where the structure fails whatever the delay.
    pub delay: Option<usize>,
    /// Why.
    pub reason: Error,
}

/// All candidates and the recommended one.
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    /// Filter pole of all candidates \[rad/s\]; `None` for raw trends.
    pub pole: Option<f64>,
    /// In the order of orders, integrators and zeros.
    pub candidates: Vec<Candidate>,
    /// What is missing among them, in the same order.
    pub dropped: Vec<Dropped>,
    /// Index of the recommended candidate.
    pub recommended: usize,
    /// Index of the smallest ISE among those that simulate well.
    pub smallest: usize,
}

/// The structures that are compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Highest order, 1 to 4, the integrator included.
    pub max_order: usize,
    /// Only structures with an integrator.
    pub integrating: bool,
    /// Whether all have a constant input.
    pub constant: bool,
}

impl Range {
    fn structures(self) -> Vec<Structure> {
        let mut all = Vec::new();
        for order in 1..=self.max_order {
            for integrator in [true, false] {
                if integrator || !self.integrating {
                    all.extend((0..order).map(|zeros| Structure {
                        order,
                        integrator,
                        zeros,
                        constant: self.constant,
                    }));
                }
            }
        }
        all
    }
}

/// Estimates every structure with the first half of the record at every delay, all behind the same filter,
/// and judges it on the second.
///
/// Recommended is the structure with the fewest parameters whose ISE is within [`TOLERANCE`] of the smallest
/// among those whose free simulation fits within [`POINTS`] of the best.
///
/// # Errors
/// What is wrong with the signals; [`Error::NoStructure`] when no structure passes.
pub fn select(
    signals: &Signals,
    range: Range,
    options: Options,
    freedom: Freedom,
    progress: &dyn Progress,
) -> Result<Selection, Error> {
    let structures = range.structures();
    let Some(&simplest) = structures.first() else {
        return Err(Error::Order(range.max_order));
    };
    // What is wrong with the simplest structure is wrong with the record.
    Problem::new(signals, simplest, options)?;
    let pole = pole(signals, range, options, freedom, progress)?;
    let delays: Vec<usize> = delays(freedom.delay).collect();
    progress.begin(structures.len() * delays.len());
    let (mut candidates, mut dropped) = (Vec::new(), Vec::new());
    for structure in structures {
        let problem = match Problem::new(signals, structure, options) {
            Ok(problem) => problem,
            Err(reason) => {
                dropped.push(Dropped {
                    structure,
                    delay: None,
                    reason,
                });
                continue;
            }
        };
        let tried: Vec<Result<Candidate, Dropped>> = delays
            .par_iter()
            .map(|&delay| {
                let found = candidate(&problem, pole, delay).map_err(|reason| Dropped {
                    structure,
                    delay: Some(delay),
                    reason,
                });
                progress.step();
                found
            })
            .collect();
        let (passed, failed): (Vec<_>, Vec<_>) = tried.into_iter().partition(Result::is_ok);
        dropped.extend(failed.into_iter().filter_map(Result::err));
        let passed = passed.into_iter().flatten();
        let ise = |c: &Candidate| c.errors.ise;
        candidates.extend(passed.min_by(|a, b| ise(a).total_cmp(&ise(b))));
    }
    let (recommended, smallest) = recommend(&candidates).ok_or(Error::NoStructure {
        max_order: range.max_order,
    })?;
    Ok(Selection {
        pole,
        candidates,
        dropped,
        recommended,
        smallest,
    })
}

/// The filter pole for all candidates: given, or the best for a simple structure of second order.
fn pole(
    signals: &Signals,
    range: Range,
    options: Options,
    freedom: Freedom,
    progress: &dyn Progress,
) -> Result<Option<f64>, Error> {
    if let Choice::Given(pole) = freedom.pole {
        return Ok(pole);
    }
    let rough = Structure {
        order: range.max_order.min(2),
        integrator: range.integrating,
        zeros: 0,
        constant: range.constant,
    };
    let problem = Problem::new(signals, rough, options)?;
    tune(&problem, freedom, progress).map(|tuning| tuning.pole)
}

fn candidate(problem: &Problem, pole: Option<f64>, delay: usize) -> Result<Candidate, Error> {
    let tuning = Tuning {
        pole,
        model: None,
        delay,
    };
    let run = problem.run_held(tuning)?;
    problem.check(&run.half)?;
    if !run.errors.ise.is_finite() {
        return Err(problem.cannot_carry(Weakness::NoPrediction));
    }
    let n = problem.samples();
    let free = problem.free_run(&run.half, delay as f64, n / 2..n);
    Ok(Candidate {
        structure: problem.structure,
        delay,
        names: problem.parameter_names(),
        estimate: run.half,
        errors: run.errors,
        fit_x0c: free.map_or(f64::NEG_INFINITY, |f| f.fit_x0c),
    })
}

/// The recommended candidate and the one with the smallest ISE.
fn recommend(candidates: &[Candidate]) -> Option<(usize, usize)> {
    let best_fit = candidates
        .iter()
        .map(|c| c.fit_x0c)
        .fold(f64::NEG_INFINITY, f64::max);
    let fits = |k: &usize| candidates[*k].fit_x0c >= best_fit - POINTS;
    let ise = |k: &usize| candidates[*k].errors.ise;
    let smallest = (0..candidates.len())
        .filter(fits)
        .min_by(|i, j| ise(i).total_cmp(&ise(j)))?;
    let near = |k: &usize| ise(k) <= (1.0 + TOLERANCE) * ise(&smallest);
    let count = |k: &usize| candidates[*k].names.len();
    let simplest = (0..candidates.len())
        .filter(fits)
        .filter(near)
        .min_by(|i, j| count(i).cmp(&count(j)).then(ise(i).total_cmp(&ise(j))))?;
    Some((simplest, smallest))
}
