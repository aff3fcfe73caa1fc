//! Why a structure is dropped: it rests on a parameter that is not significant, or a zero cancels a
//! pole.

use crate::error::Error;
use crate::folds::Folds;
use crate::instruments::Found;
use crate::polynomials::Polynomials;
use crate::problem::Problem;

/// A highest b, or a_0 without an integrator, below so many jackknife deviations is not
/// significant.
const TOLD: f64 = 3.0;

/// A zero nearer than this share to a pole cancels it.
const CANCELS: f64 = 0.15;

/// Why a structure is not among the candidates.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Drop {
    /// It cannot be estimated.
    Failed(Error),
    /// Its model is unstable, whole or without a fold.
    Unstable,
    /// A parameter that the structure rests on is within three deviations of zero.
    Insignificant {
        /// Its name.
        name: String,
        /// Value over standard deviation.
        ratio: f64,
    },
    /// A zero cancels a pole.
    Cancels {
        /// The zero \[rad/s\], real part and imaginary part.
        zero: (f64, f64),
    },
}

impl std::fmt::Display for Drop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Failed(error) => error.fmt(f),
            Self::Unstable => write!(f, "unstable, or unstable without one of the folds"),
            Self::Insignificant { name, ratio } => {
                write!(
                    f,
                    "{name} is not significant ({ratio:.1} standard deviations)"
                )
            }
            Self::Cancels { zero: (re, im) } => {
                let rate = re.hypot(*im);
                write!(f, "its zero at {rate:.3} rad/s cancels a pole")
            }
        }
    }
}

/// Whether the parameters that the structure rests on are significant: the highest b of every
/// delayed input and, without an integrator, a_0.
pub(super) fn rests_on(problem: &Problem, found: &Found, folds: &Folds) -> Result<(), Drop> {
    let names = problem.parameter_names();
    let q = problem.structure.order - usize::from(problem.structure.integrator);
    let mut places = Vec::new();
    if !problem.structure.integrator {
        places.push(0);
    }
    let mut place = q;
    for input in &problem.signals.inputs {
        place += problem.terms(input);
        if input.delayed {
            places.push(place - 1);
        }
    }
    for place in places {
        let ratio = (found.estimate.theta[place] / folds.sigma[place]).abs();
        if !(ratio >= TOLD) {
            return Err(Drop::Insignificant {
                name: names[place].clone(),
                ratio,
            });
        }
    }
    Ok(())
}

/// Whether a zero is so near to a pole that both may go; one near an integrator, in units of the
/// slowest other pole, takes out of the record what the integrator brings in.
pub(super) fn cancels(problem: &Problem, model: &Polynomials) -> Result<(), Drop> {
    let integrators = usize::from(problem.structure.integrator);
    let Some(poles) = model.poles(integrators) else {
        return Err(Drop::Unstable);
    };
    let size = |(re, im): (f64, f64)| re.hypot(im);
    let slowest = poles.first().copied().map(size);
    for input in 0..problem.signals.inputs.len() {
        for zero in model.zeros(input) {
            let near = |pole: &(f64, f64)| {
                let distance = (zero.0 - pole.0).hypot(zero.1 - pole.1);
                distance < CANCELS * size(zero).max(size(*pole))
            };
            let differences =
                integrators > 0 && slowest.is_some_and(|slowest| size(zero) < CANCELS * slowest);
            if differences || poles.iter().any(near) {
                return Err(Drop::Cancels { zero });
            }
        }
    }
    Ok(())
}
