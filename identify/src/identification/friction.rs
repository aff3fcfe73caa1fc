//! The friction of a force balance as its own model has it, where that simulates the record better.

use nalgebra::{DMatrix, DVector};

use super::by_sums::LONGEST_SEARCH;
use super::model::{Friction, Identification, Way};
use super::once::once;
use crate::estimate::Estimate;
use crate::held_friction::{coulomb, signs};
use crate::instruments::{Fit, Method};
use crate::polynomials::Polynomials;
use crate::problem::Problem;
use crate::search::Freedom;
use crate::signals::Signals;
use crate::tuning::binomial;

/// Estimates with the signs of the one before, ahead of the search of filter and delay.
const REPETITIONS: usize = 4;

/// Steps to the estimate whose signs are its own: the second corrects what the first has left.
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
/// simulates better than that with measured signs: the whole record and the half held out, with the
/// initial state refitted and with the constant refitted too.
pub(super) fn held(
    problem: &Problem,
    freedom: Freedom,
    trace_points: usize,
    measured: Identification,
) -> Identification {
    // Some hundred passes over the record: a longer one keeps its measured signs.
    let long = problem.samples() > LONGEST_SEARCH;
    if long || measured.way == Way::Recursion || coulomb(problem).is_none() {
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
    let mut errors = whole(problem, &measured);
    let mut best = measured;
    for (problem, friction) in ways {
        let found = held_in(&problem, freedom, trace_points, &best, friction);
        if let Some((found, of_it)) = found
            && errors.is_none_or(|best| of_it[0] < best[0] && of_it[1] < best[1])
            && simulates_better(&found, &best)
        {
            (best, errors) = (found, Some(of_it));
        }
    }
    if best.friction == Friction::Measured {
        // Behind measured signs, which are late, the command seems early.
        best.delay_found = best.delay_found.filter(|_| best.delay_alike.is_some());
        best.delay_found
            .iter_mut()
            .for_each(|delay| delay.shift = 0.0);
    }
    best
}

/// Errors of a simulation of the whole record, sums of squares; a rest that is measured has none.
fn whole(problem: &Problem, found: &Identification) -> Option<[f64; 2]> {
    let e = &found.estimate;
    let model = Polynomials {
        a: e.a.clone(),
        b: e.b.clone(),
        constant: e.constant,
    };
    let simulated = problem.simulate(&model, found.delay, 0..problem.samples())?;
    Some(simulated.squares)
}

/// Whether the half held out is simulated better, too.
fn simulates_better(found: &Identification, best: &Identification) -> bool {
    match (&found.free_run, &best.free_run) {
        (Some(found), Some(best)) => found.fit_x0 > best.fit_x0 && found.fit_x0c > best.fit_x0c,
        (found, _) => found.is_some(),
    }
}

/// The model whose friction is its own, from an identification on.
fn held_in(
    problem: &Problem,
    freedom: Freedom,
    trace_points: usize,
    start: &Identification,
    friction: Friction,
) -> Option<(Identification, [f64; 2])> {
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
    let signs = self::signs(problem, &found.estimate, found.delay)?;
    let signals = with_signs(problem, &signs)?;
    let own = Problem::new(&signals, problem.structure, problem.options).ok()?;
    let errors = whole(&own, &found)?;
    Some((found, errors))
}

/// Newton's steps to the estimate that its own friction leads to, with its covariance: what moves
/// the parameters moves the reversals, and they the parameters again.
fn settle(problem: &Problem, found: &mut Identification) -> Option<()> {
    let n = found.estimate.theta.len();
    for step in 1..=STEPS {
        let here = &found.estimate;
        let at = next(problem, found, here, true)?;
        let mut left = DMatrix::<f64>::identity(n, n);
        for j in 0..n {
            let step = here.sigma[j];
            if !(step > 0.0 && step.is_finite()) {
                continue;
            }
            let mut theta = here.theta.clone();
            theta[j] += step;
            let model = problem.polynomials(&theta);
            let moved = Estimate {
                theta,
                a: model.a,
                b: model.b,
                constant: model.constant,
                ..here.clone()
            };
            let moved = next(problem, found, &moved, true)?;
            for i in 0..n {
                left[(i, j)] -= (moved.theta[i] - at.theta[i]) / step;
            }
        }
        let inverse = left.try_inverse()?;
        let rest = DVector::from_vec(at.moves_from(here));
        let theta = DVector::from_column_slice(&here.theta) + &inverse * rest;
        let mut covariance = DMatrix::from_fn(n, n, |i, j| here.covariance[i][j]);
        if step == STEPS {
            covariance = &inverse * covariance * inverse.transpose();
        }
        let theta = theta.as_slice().to_vec();
        let settled = problem.estimate_of(problem.polynomials(&theta), theta, &covariance);
        found.estimate = settled;
    }
    Some(())
}
