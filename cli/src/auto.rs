//! Filter pole and delay chosen by the record itself.

use indicatif::ProgressBar;
use rayon::prelude::*;

use crate::estimate::{Estimate, Problem};
use crate::output::Refusal;
use crate::tuning::{OwnFilter, Tuning};

/// Rounds of [`own`] at most.
const ROUNDS: usize = 8;

/// Longest delay that `auto` tries, in samples.
pub const LONGEST_DELAY: usize = 10;

/// What may be chosen: a given pole or delay is left alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Freedom {
    pub pole: Choice<Option<f64>>,
    pub delay: Choice<usize>,
}

/// A value that the user has given, or one to be found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Choice<T> {
    Given(T),
    Auto,
}

/// Poles tried by `auto`, in rad/s: half an octave apart, from five settling
/// times in the record up to one and a half times the sampling rate.
pub fn poles(samples: usize, dt: f64) -> Vec<f64> {
    let lowest = 30.0 / (samples as f64 * dt);
    let highest = 1.5 / dt;
    let steps = (2.0 * (highest / lowest).log2()).floor().max(0.0) as i32;
    (0..=steps)
        .map(|i| lowest * 2f64.powf(0.5 * f64::from(i)))
        .collect()
}

/// How well the model that a tuning gives repeats the record: the mean fit of
/// free simulations of both halves, initial state and constant refitted.
pub fn merit(problem: &Problem, tuning: Tuning) -> Option<f64> {
    judged(problem, tuning).map(|(merit, _)| merit)
}

/// The merit with the estimate it is of.
fn judged(problem: &Problem, tuning: Tuning) -> Option<(f64, Estimate)> {
    let estimate = problem.run(tuning, None).ok()?.end;
    let n = problem.y.len();
    let first = problem.free_run(&estimate, tuning.delay, 0..n / 2)?;
    let second = problem.free_run(&estimate, tuning.delay, n / 2..n)?;
    Some((0.5 * (first.fit_x0c + second.fit_x0c), estimate))
}

/// The tuning with the filter 1/A of its own estimate, for as long as that raises the [`merit`].
///
/// Behind this filter the equation error is the error of the output, and what the model
/// does not hold (a nonlinearity between the samples) bends its parameters least.
pub fn own(problem: &Problem, tuning: Tuning) -> Tuning {
    let mut best = tuning;
    let Some(pole) = tuning.pole else {
        return best;
    };
    let Some((mut merit, mut estimate)) = judged(problem, tuning) else {
        return best;
    };
    for _ in 0..ROUNDS {
        let next = Tuning {
            own: OwnFilter::of(&estimate, problem.integrator, pole),
            ..tuning
        };
        match judged(problem, next) {
            Some((better, found)) if next.own.is_some() && better > merit => {
                (merit, estimate, best) = (better, found, next);
            }
            _ => break,
        }
    }
    best
}

/// The filter pole and delay of the best [`merit`].
///
/// A model that simulates the record well has both the slow and the fast part
/// right; the one-step prediction alone would be ruled by the fast part.
///
/// # Errors
///
/// When no candidate gives a model that can be simulated.
pub fn tune(problem: &Problem, freedom: Freedom, bar: &ProgressBar) -> Result<Tuning, Refusal> {
    let poles = match freedom.pole {
        Choice::Given(pole) => vec![pole],
        Choice::Auto => poles(problem.y.len(), problem.dt)
            .into_iter()
            .map(Some)
            .collect(),
    };
    let delays = match freedom.delay {
        Choice::Given(delay) => delay..=delay,
        Choice::Auto => 0..=LONGEST_DELAY,
    };
    let candidates: Vec<Tuning> = delays
        .flat_map(|delay| {
            poles.iter().map(move |&pole| Tuning {
                pole,
                own: None,
                delay,
            })
        })
        .collect();
    bar.set_length(candidates.len() as u64);
    let merits: Vec<Option<f64>> = candidates
        .par_iter()
        .map(|&tuning| {
            let merit = merit(problem, tuning);
            bar.inc(1);
            merit
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
    best.map(|(_, tuning)| tuning).ok_or_else(|| {
        Refusal::new(format!(
            "the data cannot carry a model of order {} with {} parameters: none that can be simulated was found",
            problem.order,
            problem.parameter_names().len()
        ))
    })
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
