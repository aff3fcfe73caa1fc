//! The estimate that its own friction leads to, with its covariance: what moves the parameters or
//! the delay moves the reversals, and they parameters and delay again.
//!
//! ```text
//! x = (theta, d)       x -> signs of x -> g(x), the estimate with them
//! x + (I - dg/dx)^-1 (g(x) - x)             Newton's step to x = g(x)
//! (I - dg/dx)^-1 C (I - dg/dx)^-T           covariance, C that with signs which stand still
//! ```

use nalgebra::{DMatrix, DVector};

use crate::estimate::Estimate;
use crate::held_friction::{coulomb, signs};
use crate::identification::model::{Identification, Way};
use crate::instruments::{Fit, Found, Method};
use crate::problem::Problem;
use crate::tuning::binomial;

/// Steps to the estimate whose signs are its own at most, and the part of a standard deviation that
/// need not be gone any more.
const STEPS: usize = 8;
const SETTLED: f64 = 0.1;

/// Samples by which a delay moves at most in a step: what comes earlier or later is linear in it
/// over no more.
const FARTHEST: f64 = 1.0;

/// What `one` makes of a problem with the friction that an estimate has at a delay.
pub(super) fn with_signs_of<T>(
    problem: &Problem,
    (estimate, delay): (&Estimate, f64),
    one: impl FnOnce(&Problem) -> Option<T>,
) -> Option<T> {
    let signs = signs(problem, estimate, delay)?;
    let mut signals = problem.signals.clone();
    signals.inputs[coulomb(problem)?].samples = &signs;
    one(&Problem::new(&signals, problem.structure, problem.options).ok()?)
}

/// The estimate with the signs of another one, at the filter of an identification and at a delay;
/// where that is wanted with further passes until it has settled, and a delay that is searched as
/// an unknown.
pub(super) fn next(
    problem: &Problem,
    found: &Identification,
    of: (&Estimate, f64),
    refined: bool,
) -> Option<Found> {
    let equal = || binomial(found.pole.unwrap_or_default(), problem.structure.order);
    let filter = match &found.own_filter {
        Some(filter) => filter.clone(),
        None => equal().into_iter().map(f64::from).collect(),
    };
    let method = match found.way {
        Way::WeakInstruments => Method::LeastSquares,
        _ => Method::Instruments,
    };
    with_signs_of(problem, of, |own| {
        let mut fit = Fit::new(own, &filter, of.1, method).ok()?;
        if refined {
            fit = fit.refined().ok()?;
            if found.delay_sigma().is_some() {
                fit = fit.around_delay().ok()?;
            }
        }
        fit.found().ok()
    })
}

/// theta, and the delay where it is an unknown.
fn unknowns(theta: &[f64], delay: Option<f64>) -> DVector<f64> {
    let all: Vec<f64> = theta.iter().copied().chain(delay).collect();
    DVector::from_vec(all)
}

/// An estimate at other parameters, without their covariance.
fn moved(problem: &Problem, of: &Estimate, x: &DVector<f64>) -> Estimate {
    let theta = x.as_slice()[..of.theta.len()].to_vec();
    let model = problem.polynomials(&theta);
    Estimate {
        theta,
        a: model.a,
        b: model.b,
        constant: model.constant,
        ..of.clone()
    }
}

/// Newton's steps, in place.
pub(super) fn settle(problem: &Problem, found: &mut Identification) -> Option<()> {
    let free = found.delay_sigma().is_some();
    let delay_at = |x: &DVector<f64>| match free {
        true => x[x.len() - 1],
        false => found.delay,
    };
    let of = found.estimate.clone();
    let sigma = unknowns(&of.sigma, found.delay_sigma());
    let g = |x: &DVector<f64>| {
        let delay = delay_at(x);
        let there = next(problem, found, (&moved(problem, &of, x), delay), true)?;
        let shift = there.delay.as_ref().map_or(0.0, |delay| delay.shift);
        Some(unknowns(
            &there.estimate.theta,
            free.then_some(delay + shift),
        ))
    };
    let mut x = unknowns(&of.theta, free.then_some(found.delay));
    let n = x.len();
    let mut inverse = DMatrix::identity(n, n);
    for _ in 0..STEPS {
        let at = g(&x)?;
        let left = left(g, &x, &at, &sigma)?;
        inverse = left.try_inverse()?;
        let mut step = &inverse * (at - &x);
        if free {
            let last = &mut step[n - 1];
            *last = last.clamp(-FARTHEST, FARTHEST).max(-delay_at(&x));
        }
        x += &step;
        let far = |(step, sigma): (&f64, &f64)| step.abs() > SETTLED * sigma;
        if !step.iter().zip(sigma.iter()).any(far) {
            break;
        }
    }
    let covariance = &inverse * joint(found, free) * inverse.transpose();
    let p = of.theta.len();
    let theta = moved(problem, &of, &x).theta;
    let of_theta = covariance.view((0, 0), (p, p)).into_owned();
    if free {
        found.delay = x[p];
        if let Some(delay) = &mut found.delay_found {
            delay.shift = 0.0;
            delay.sigma = covariance[(p, p)].sqrt();
            delay.with = (0..p).map(|i| covariance[(i, p)]).collect();
        }
    }
    found.estimate = problem.estimate_of(problem.polynomials(&theta), theta, &of_theta);
    Some(())
}

/// I - dg/dx at x, where g(x) is `at`, by differences of a standard deviation.
fn left(
    g: impl Fn(&DVector<f64>) -> Option<DVector<f64>>,
    x: &DVector<f64>,
    at: &DVector<f64>,
    sigma: &DVector<f64>,
) -> Option<DMatrix<f64>> {
    let mut left = DMatrix::identity(x.len(), x.len());
    for (j, step) in sigma.iter().copied().enumerate() {
        if !(step > 0.0 && step.is_finite()) {
            continue;
        }
        let mut there = x.clone();
        there[j] += step;
        left.set_column(j, &(left.column(j) - (g(&there)? - at) / step));
    }
    Some(left)
}

/// The covariance of the unknowns with signs that stand still.
fn joint(found: &Identification, free: bool) -> DMatrix<f64> {
    let of = &found.estimate;
    let p = of.theta.len();
    let delay = found.delay_found.as_ref().filter(|_| free);
    DMatrix::from_fn(p + usize::from(free), p + usize::from(free), |i, j| match (
        i < p,
        j < p,
        delay,
    ) {
        (true, true, _) => of.covariance[i][j],
        (false, false, Some(delay)) => delay.sigma * delay.sigma,
        (_, _, Some(delay)) => delay.with[i.min(j)],
        _ => 0.0,
    })
}
