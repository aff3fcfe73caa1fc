//! The friction of a force balance as its own model has it, where that simulates the record better.

use nalgebra::{DMatrix, DVector};

use super::model::{Friction, Identification, Way};
use super::once;
use crate::estimate::Estimate;
use crate::held_friction::{coulomb, signs};
use crate::instruments::{Fit, Method};
use crate::problem::Problem;
use crate::search::Freedom;
use crate::signals::Signals;
use crate::tuning::binomial;

/// Estimates with the signs of the one before, ahead of the search of filter and delay.
const REPETITIONS: usize = 4;

/// Steps to the estimate whose signs are its own, all with the derivatives of the first.
const STEPS: usize = 2;

/// The signals with other friction.
fn with_signs<'a>(problem: &Problem<'a>, signs: &'a [f64]) -> Option<Signals<'a>> {
    let mut signals = problem.signals.clone();
    signals.inputs[coulomb(problem)?].samples = signs;
    Some(signals)
}

/// The fit with the friction of an estimate at the filter and the delay of an identification, with
/// further passes until it has settled where that is wanted.
fn next(
    problem: &Problem,
    found: &Identification,
    of: &Estimate,
    refined: bool,
) -> Option<Estimate> {
    let signs = signs(problem, of, found.delay)?;
    let signals = with_signs(problem, &signs)?;
    let problem = Problem::new(&signals, problem.structure, problem.options).ok()?;
    let equal = || binomial(found.pole.unwrap_or_default(), problem.structure.order);
    let filter = match &found.own_filter {
        Some(filter) => filter.clone(),
        None => equal().into_iter().map(f64::from).collect(),
    };
    let method = match found.way {
        Way::WeakInstruments => Method::LeastSquares,
        _ => Method::Instruments,
    };
    let mut fit = Fit::new(&problem, &filter, found.delay, method).ok()?;
    if refined {
        fit = fit.refined().ok()?;
    }
    Some(fit.found().ok()?.estimate)
}

/// The model whose friction is its own, with the measured rests and without, where one of the two
/// simulates better than that with measured signs.
pub(super) fn held(
    problem: &Problem,
    freedom: Freedom,
    trace_points: usize,
    measured: Identification,
) -> Identification {
    if measured.way == Way::Recursion || coulomb(problem).is_none() {
        return measured;
    }
    let mut signals = problem.signals.clone();
    signals.standstill = None;
    let throughout = Problem {
        signals: &signals,
        ..*problem
    };
    let mut ways = vec![(*problem, Friction::Held)];
    if problem.signals.standstill.is_some() {
        ways.push((throughout, Friction::HeldAtRest));
    }
    let fit = |found: &Identification| found.free_run.as_ref().map(|f| f.fit_x0c);
    let mut best = measured;
    for (problem, friction) in ways {
        let found = held_in(&problem, freedom, trace_points, &best, friction);
        if let Some(found) = found.filter(|found| fit(found) > fit(&best)) {
            best = found;
        }
    }
    best
}

/// The model whose friction is its own, from an identification on.
fn held_in(
    problem: &Problem,
    freedom: Freedom,
    trace_points: usize,
    start: &Identification,
    friction: Friction,
) -> Option<Identification> {
    let mut estimate = start.estimate.clone();
    for _ in 0..REPETITIONS {
        estimate = next(problem, start, &estimate, false)?;
    }
    let signs = signs(problem, &estimate, start.delay)?;
    let signals = with_signs(problem, &signs)?;
    let own = Problem::new(&signals, problem.structure, problem.options).ok()?;
    let mut found = once(&own, freedom, trace_points, &()).ok()?;
    if found.way == Way::Recursion {
        return None;
    }
    found.friction = friction;
    settle(problem, &mut found)?;
    Some(found)
}

/// Newton's steps to the estimate that its own friction leads to, with its covariance: what moves
/// the parameters moves the reversals, and they the parameters again.
fn settle(problem: &Problem, found: &mut Identification) -> Option<()> {
    let here = found.estimate.clone();
    let n = here.theta.len();
    let with = |theta: Vec<f64>| {
        let model = problem.polynomials(&theta);
        Estimate {
            theta,
            a: model.a,
            b: model.b,
            constant: model.constant,
            ..here.clone()
        }
    };
    let at = next(problem, found, &here, false)?;
    let mut left = DMatrix::<f64>::identity(n, n);
    for j in 0..n {
        let step = here.sigma[j];
        if !(step > 0.0 && step.is_finite()) {
            continue;
        }
        let mut theta = here.theta.clone();
        theta[j] += step;
        let moved = next(problem, found, &with(theta), false)?;
        for i in 0..n {
            left[(i, j)] -= (moved.theta[i] - at.theta[i]) / step;
        }
    }
    let inverse = left.try_inverse()?;
    let mut theta = here.theta.clone();
    for _ in 0..STEPS {
        let now = with(theta);
        let rest = DVector::from_vec(next(problem, found, &now, true)?.moves_from(&now));
        let moved = DVector::from_vec(now.theta) + &inverse * rest;
        theta = moved.as_slice().to_vec();
    }
    let covariance = DMatrix::from_fn(n, n, |i, j| here.covariance[i][j]);
    let covariance = &inverse * covariance * inverse.transpose();
    found.estimate = problem.estimate_of(problem.polynomials(&theta), theta, &covariance);
    Some(())
}
