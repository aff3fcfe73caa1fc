//! The filter of the trends chosen by parts of the record that its model has not seen.
//!
//! Every pole gives a model by instruments; each fold is simulated by the model without it. Among
//! the poles that simulate as well as the best, within one standard error over the folds, the one
//! with the sharpest parameters is taken. Then the filter `1/A` of the model itself (iterative
//! prefiltering: Steiglitz and McBride 1965; Young and Jakeman 1980), where it simulates better.

use crate::error::Error;
use crate::estimate::Estimate;
use crate::folds::{Folds, Refitted};
use crate::instruments::{Fit, Method};
use crate::problem::Problem;
use crate::search::Progress;
use crate::side_by_side::side_by_side;
use crate::tuning::binomial;

/// Poles from this many times the inverse of the record's length on.
const SLOWEST: f64 = 3.0;

/// Iterations of the own filter at most.
const ITERATIONS: usize = 4;

/// Smaller than this share of the error before, that of the own filter counts as better.
const BETTER: f64 = 0.995;

/// Instruments count as weak where their model simulates the folds worse than that of least
/// squares: by more than chance, and so in more than one of them, by so many standard errors. Of a
/// difference by chance Student's distribution with seven degrees of freedom has 4 % beyond.
const BEHIND: f64 = 2.0;

/// Standard deviations that another filter moves a parameter by beyond which it is not by chance.
const FAR: f64 = 3.0;

/// A fit with its folds.
pub struct Judged<'a> {
    /// The pole of the filter \[rad/s\]: of its m equal factors, or of the one that stands for the
    /// integrator.
    pub pole: f64,
    /// Whether the filter is that of the model itself.
    pub own: bool,
    /// The sums.
    pub fit: Fit<'a>,
    /// Its errors where it is left out.
    pub folds: Folds,
}

/// Poles that are tried \[rad/s\]: an octave apart from 3/T to 1/h.
pub fn poles(samples: usize, dt: f64) -> Vec<f64> {
    let lowest = SLOWEST / (samples as f64 * dt);
    let octaves = (1.0 / (dt * lowest)).log2().floor().max(0.0) as i32;
    (0..=octaves).map(|i| lowest * 2f64.powi(i)).collect()
}

/// A fit at one pole, by instruments.
pub fn judged<'a>(
    problem: &'a Problem<'a>,
    pole: f64,
    delay: f64,
    method: Method,
) -> Option<Judged<'a>> {
    let filter: Vec<f64> = binomial(pole, problem.structure.order)
        .into_iter()
        .map(f64::from)
        .collect();
    let fit = Fit::new(problem, &filter, delay, method).ok()?;
    let folds = Folds::of(problem, &fit)?;
    Some(Judged {
        pole,
        own: false,
        fit,
        folds,
    })
}

/// The best of some fits: the sharpest parameters within one standard error of the smallest error.
pub fn best<'a>(tried: Vec<Judged<'a>>) -> Option<Judged<'a>> {
    let total = |j: &Judged| j.folds.total(Refitted::State);
    let smallest = tried
        .iter()
        .map(total)
        .enumerate()
        .min_by(|a, b| a.1.total_cmp(&b.1))?
        .0;
    let near: Vec<bool> = tried
        .iter()
        .map(|j| j.folds.behind(&tried[smallest].folds, Refitted::State) <= 1.0)
        .collect();
    let near = tried.into_iter().zip(near).filter(|(_, near)| *near);
    near.map(|(judged, _)| judged)
        .min_by(|a, b| a.folds.sharpness().total_cmp(&b.folds.sharpness()))
}

/// The fit at the best of some poles, by instruments; by least squares where no instruments give a
/// stable model.
///
/// # Errors
/// [`Error::CannotCarry`] where no pole gives a model whose folds can be simulated.
pub fn choose<'a>(
    problem: &'a Problem<'a>,
    poles: &[f64],
    delay: f64,
    progress: &dyn Progress,
) -> Result<Judged<'a>, Error> {
    for method in [Method::Instruments, Method::LeastSquares] {
        let tried = side_by_side(poles, |&pole| {
            let judged = judged(problem, pole, delay, method);
            progress.step();
            judged
        });
        if let Some(best) = best(tried.into_iter().flatten().collect()) {
            return Ok(best);
        }
    }
    Err(problem.cannot_simulate())
}

/// The same with the filter of the model itself, for as long as that simulates better.
pub fn with_own_filter<'a>(problem: &'a Problem<'a>, judged: Judged<'a>) -> Judged<'a> {
    let mut best = judged;
    for _ in 0..ITERATIONS {
        let Some(next) = own_filter(problem, &best) else {
            break;
        };
        if !(next.folds.total(Refitted::State) < BETTER * best.folds.total(Refitted::State)) {
            break;
        }
        best = next;
    }
    best
}

/// The fit behind the denominator of a model; a pole at 0 gives way to that of the filter before.
fn own_filter<'a>(problem: &'a Problem<'a>, judged: &Judged) -> Option<Judged<'a>> {
    let integrators = usize::from(problem.structure.integrator);
    let model = judged.fit.model()?;
    if !model.is_stable(integrators) {
        return None;
    }
    let filter: Vec<f64> = match problem.structure.integrator {
        false => model.a.clone(),
        // A/s (s + pole)
        true => (0..model.a.len())
            .map(|i| model.a[i] + judged.pole * model.a.get(i + 1).copied().unwrap_or(1.0))
            .collect(),
    };
    let fit = Fit::new(problem, &filter, judged.fit.delay(), judged.fit.method()).ok()?;
    let folds = Folds::of(problem, &fit)?;
    Some(Judged {
        pole: judged.pole,
        own: true,
        fit,
        folds,
    })
}

/// What filters at half and at twice the pole make of an estimate.
pub struct Elsewhere {
    /// How far they move the first parameter, in the standard deviations of both estimates
    /// together; not finite where one of them gives no model.
    pub shifts: [f64; 2],
    /// How far they move every parameter.
    moves: Vec<Vec<f64>>,
}

impl Elsewhere {
    /// The estimate with what its structure does not hold.
    ///
    /// Its error is the same in every block, so that no deviation of theirs contains it. Where the
    /// moves are not by chance they are its size: a compromise that is another one an octave away.
    pub fn contained_in(&self, problem: &Problem, estimate: Estimate) -> Estimate {
        match far(self.shifts) {
            Some(_) => problem.widened(&estimate, &self.moves),
            None => estimate,
        }
    }
}

/// The larger one of two shifts, where that is more than chance; one that is no number counts for
/// nothing.
pub fn far(shifts: [f64; 2]) -> Option<f64> {
    let far = shifts.iter().map(|shift| shift.abs()).fold(0.0, f64::max);
    (far > FAR && far.is_finite()).then_some(far)
}

/// What filter poles at half and at twice `pole` make of a fit.
///
/// Known as: Hausman's specification test. What the structure does not hold is no noise; but its
/// compromise changes with the frequencies that the filter weighs.
pub fn elsewhere(problem: &Problem, fit: &Fit, pole: f64) -> Option<Elsewhere> {
    let here = fit.found().ok()?.estimate;
    let (delay, method) = (fit.delay(), fit.method());
    let there = side_by_side(&[0.5, 2.0], |factor| {
        let filter: Vec<f64> = binomial(pole * factor, problem.structure.order)
            .into_iter()
            .map(f64::from)
            .collect();
        let fit = Fit::new(problem, &filter, delay, method).ok()?;
        Some(fit.refined().ok()?.found().ok()?.estimate)
    });
    let shift = |there: &Option<Estimate>| {
        there.as_ref().map_or(f64::NAN, |there| {
            (there.theta[0] - here.theta[0]) / there.sigma[0].hypot(here.sigma[0])
        })
    };
    Some(Elsewhere {
        shifts: [shift(&there[0]), shift(&there[1])],
        moves: {
            let there = there.iter().flatten();
            there.map(|there| there.moves_from(&here)).collect()
        },
    })
}

/// Falls back to least squares where the instruments are weak: where its model simulates the folds
/// clearly better.
pub fn guarded<'a>(problem: &'a Problem<'a>, judged: Judged<'a>) -> (Judged<'a>, bool) {
    if judged.fit.method() == Method::LeastSquares {
        return (judged, true);
    }
    let fit = Fit::new(
        problem,
        judged.fit.filter(),
        judged.fit.delay(),
        Method::LeastSquares,
    );
    let Some((fit, folds)) = fit
        .ok()
        .and_then(|fit| Some((Folds::of(problem, &fit)?, fit)))
        .map(|(folds, fit)| (fit, folds))
    else {
        return (judged, false);
    };
    let unknowns = problem.parameter_names().len();
    let simulated = (problem, fit.delay(), Refitted::State);
    let weak = folds.beat(simulated, &judged.folds, (unknowns, 1))
        && judged.folds.behind(&folds, Refitted::State) > BEHIND;
    match weak {
        true => (
            Judged {
                fit,
                folds,
                ..judged
            },
            true,
        ),
        false => (judged, false),
    }
}
