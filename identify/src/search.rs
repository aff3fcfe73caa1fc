//! Filter and delay chosen by the record itself.

use rayon::prelude::*;

use crate::error::{Error, Weakness};
use crate::estimate::Estimate;
use crate::problem::Problem;
use crate::tuning::{ModelFilter, Tuning};

/// Iterations of [`iterate_filter`] at most.
const ITERATIONS: usize = 8;

/// Longest delay that a search tries, in samples.
pub const LONGEST_DELAY: usize = 10;

/// A value that is given, or one to be found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Choice<T> {
    /// Taken as it is.
    Given(T),
    /// The best on the record.
    Auto,
}

/// What a search may choose: a given pole or delay is left alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Freedom {
    /// The filter poles \[rad/s\]; `Given(None)` for raw trends.
    pub pole: Choice<Option<f64>>,
    /// The delay in samples.
    pub delay: Choice<usize>,
}

impl Default for Freedom {
    /// The best filter without delay.
    fn default() -> Self {
        Self {
            pole: Choice::Auto,
            delay: Choice::Given(0),
        }
    }
}

/// Receives the progress of a search; `()` ignores it.
pub trait Progress: Sync {
    /// So many steps will follow.
    fn begin(&self, _steps: usize) {}
    /// One of them is done.
    fn step(&self) {}
}

impl Progress for () {}

/// Poles that are tried \[rad/s\]: half an octave apart, from five settling times in the record up to
/// one and a half times the sampling rate.
pub fn poles(samples: usize, dt: f64) -> Vec<f64> {
    let lowest = 30.0 / (samples as f64 * dt);
    let highest = 1.5 / dt;
    let steps = (2.0 * (highest / lowest).log2()).floor().max(0.0) as i32;
    (0..=steps)
        .map(|i| lowest * 2f64.powf(0.5 * f64::from(i)))
        .collect()
}

/// The delays that are tried, in samples.
pub fn delays(choice: Choice<usize>) -> std::ops::RangeInclusive<usize> {
    match choice {
        Choice::Given(delay) => delay..=delay,
        Choice::Auto => 0..=LONGEST_DELAY,
    }
}

/// How well the model of a tuning repeats the record, and the model: the mean fit of free simulations of
/// both halves, initial state and constant refitted.
fn merit(problem: &Problem, tuning: Tuning) -> Option<(f64, Estimate)> {
    let estimate = problem.run(tuning, None).ok()?.end;
    let n = problem.samples();
    let first = problem.free_run(&estimate, tuning.delay as f64, 0..n / 2)?;
    let second = problem.free_run(&estimate, tuning.delay as f64, n / 2..n)?;
    Some((0.5 * (first.fit_x0c + second.fit_x0c), estimate))
}

/// The tuning with the filter 1/A of its own estimate, for as long as that raises the merit.
///
/// Known as: iterative prefiltering (Steiglitz and McBride 1965; Young and Jakeman 1980). Behind this filter
/// the equation error is the error of the output, and what the model does not hold (a nonlinearity between
/// the samples) biases its parameters least.
pub fn iterate_filter(problem: &Problem, tuning: Tuning) -> Tuning {
    let mut best = tuning;
    let Some(pole) = tuning.pole else {
        return best;
    };
    let Some((mut highest, mut estimate)) = merit(problem, tuning) else {
        return best;
    };
    for _ in 0..ITERATIONS {
        let next = Tuning {
            model: ModelFilter::of(&estimate, problem.structure.integrator, pole),
            ..tuning
        };
        match merit(problem, next) {
            Some((better, found)) if next.model.is_some() && better > highest => {
                (highest, estimate, best) = (better, found, next);
            }
            _ => break,
        }
    }
    best
}

/// The filter pole and delay whose model simulates the record best.
///
/// Such a model has both the slow and the fast part right; the one-step prediction alone would be ruled
/// by the fast part. Cost: two passes over the record and 2 (m + 2) simulations for each of some 20 poles and 11 delays,
/// on all processors.
///
/// # Errors
/// [`Error::CannotCarry`] when no candidate gives a model that can be simulated.
pub fn tune(problem: &Problem, freedom: Freedom, progress: &dyn Progress) -> Result<Tuning, Error> {
    let poles = match freedom.pole {
        Choice::Given(pole) => vec![pole],
        Choice::Auto => poles(problem.samples(), problem.signals.dt)
            .into_iter()
            .map(Some)
            .collect(),
    };
    let candidates: Vec<Tuning> = delays(freedom.delay)
        .flat_map(|delay| {
            poles.iter().map(move |&pole| Tuning {
                pole,
                model: None,
                delay,
            })
        })
        .collect();
    progress.begin(candidates.len());
    let merits: Vec<Option<f64>> = candidates
        .par_iter()
        .map(|&tuning| {
            let merit = merit(problem, tuning);
            progress.step();
            merit.map(|(merit, _)| merit)
        })
        .collect();
    // The first of equals: the result does not depend on the number of processors.
    let mut best: Option<(f64, Tuning)> = None;
    for (merit, tuning) in merits.into_iter().zip(candidates) {
        if let Some(merit) = merit
            && best.is_none_or(|(b, _)| merit > b)
        {
            best = Some((merit, tuning));
        }
    }
    best.map(|(_, tuning)| tuning)
        .ok_or_else(|| problem.cannot_carry(Weakness::NoSimulation))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poles_span_the_record_in_half_octaves() {
        let p = poles(10_000, 1e-3);
        assert_eq!(p[0], 3.0);
        assert!((p[2] / p[0] - 2.0).abs() < 1e-12);
        assert!(p[p.len() - 1] <= 1500.0 && p[p.len() - 1] > 1500.0 / 2f64.sqrt());
    }
}
