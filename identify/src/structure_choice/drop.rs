//! Why a structure is dropped: it rests on a parameter that is not significant, or a zero cancels a
//! pole.

use std::f64::consts::PI;

use crate::error::Error;
use crate::folds::Folds;
use crate::instruments::Found;
use crate::polynomials::{Pole, Polynomials};
use crate::problem::Problem;

/// A highest b, or a_0 without an integrator, below so many deviations is not significant.
const TOLD: f64 = 3.0;

/// A zero this much slower than the slowest pole stands beside the integrator.
const BESIDE: f64 = 0.15;

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
    /// A zero cancels a pole: it is not told from it, or stands beside the integrator.
    Cancels {
        /// The zero \[rad/s\], real part and imaginary part.
        zero: (f64, f64),
    },
    /// A zero is faster than the sampling shows: it shifts the input by a part of a sample.
    Beyond {
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
            Self::Beyond { zero: (re, im) } => {
                let rate = re.hypot(*im);
                write!(
                    f,
                    "its zero at {rate:.0} rad/s is faster than the sampling shows"
                )
            }
        }
    }
}

/// Whether the parameters that the structure rests on are significant: the highest b of every
/// delayed input and, without an integrator, a_0. By the larger one of two deviations, the
/// jackknife over the folds and the scores of the blocks: either is blind to something.
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
        let by_blocks = found.estimate.sigma[place];
        // Infinite where there are too few blocks.
        let sigma = match by_blocks.is_finite() {
            true => folds.sigma[place].max(by_blocks),
            false => folds.sigma[place],
        };
        let ratio = (found.estimate.theta[place] / sigma).abs();
        if !(ratio >= TOLD) {
            return Err(Drop::Insignificant {
                name: names[place].clone(),
                ratio,
            });
        }
    }
    Ok(())
}

/// Whether both a zero and a pole may go: their distance is within three of its own deviations, by
/// the jackknife over the folds. A zero near an integrator, in units of the slowest other pole,
/// takes out of the record what the integrator brings in.
///
/// A share of their size would be no measure: a position loop has a slow pole beside a zero that a
/// good record tells apart, and of a lag that is not there the two are found far apart by chance.
pub(super) fn cancels(problem: &Problem, model: &Polynomials, folds: &Folds) -> Result<(), Drop> {
    let integrators = usize::from(problem.structure.integrator);
    let Some(poles) = model.poles(integrators) else {
        return Err(Drop::Unstable);
    };
    let slowest = poles.first().copied().map(size);
    for input in 0..problem.signals.inputs.len() {
        for zero in model.zeros(input) {
            if size(zero) > PI / problem.signals.dt {
                return Err(Drop::Beyond { zero });
            }
            let beside =
                integrators > 0 && slowest.is_some_and(|slowest| size(zero) < BESIDE * slowest);
            let same = |pole: &Pole| {
                let apart = distance(zero, *pole);
                !(apart >= TOLD * deviation(folds, integrators, input, [zero, *pole]))
            };
            if beside || poles.iter().any(same) {
                return Err(Drop::Cancels { zero });
            }
        }
    }
    Ok(())
}

fn size((re, im): Pole) -> f64 {
    re.hypot(im)
}

fn distance(p: Pole, q: Pole) -> f64 {
    (p.0 - q.0).hypot(p.1 - q.1)
}

/// Standard deviation of the distance of a zero from a pole, by the jackknife over the folds.
fn deviation(folds: &Folds, integrators: usize, input: usize, [zero, pole]: [Pole; 2]) -> f64 {
    let nearest = |all: Vec<Pole>, to: Pole| {
        let near = |p: &Pole, q: &Pole| distance(*p, to).total_cmp(&distance(*q, to));
        all.into_iter().min_by(near)
    };
    let each = folds.models.iter().filter_map(|model| {
        let z = nearest(model.zeros(input), zero)?;
        let p = nearest(model.poles(integrators)?, pole)?;
        Some((z.0 - p.0, z.1 - p.1))
    });
    let each: Vec<Pole> = each.collect();
    let n = each.len() as f64;
    let add = |sum: Pole, d: &Pole| (sum.0 + d.0, sum.1 + d.1);
    let sum = each.iter().fold((0.0, 0.0), add);
    let mean = (sum.0 / n, sum.1 / n);
    let squares: f64 = each.iter().map(|d| distance(*d, mean).powi(2)).sum();
    ((n - 1.0) / n * squares).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Folds whose models have the pole `-pole` and the zero `-zero`.
    fn folds(each: [(f64, f64); 8]) -> Folds {
        let models = each.map(|(pole, zero)| Polynomials {
            a: vec![pole],
            b: vec![vec![zero, 1.0]],
            constant: 0.0,
        });
        Folds {
            squares: [[1.0; 2]; 8],
            sigma: vec![0.1; 3],
            models: models.to_vec(),
        }
    }

    #[test]
    fn a_zero_is_told_from_a_pole_by_what_both_vary_together() {
        let shift = [-3.0, -2.0, -1.0, 0.0, 0.0, 1.0, 2.0, 3.0];
        // Both vary by 6, their distance of 2 by nothing; then the distance alone.
        let together = folds(shift.map(|x| (10.0 + x, 12.0 + x)));
        let apart = folds(shift.map(|x| (10.0, 12.0 + x)));
        let pair = [(-12.0, 0.0), (-10.0, 0.0)];
        assert!(deviation(&together, 0, 0, pair) < 1e-9);
        let found = deviation(&apart, 0, 0, pair);
        assert!(
            (found - (7.0 / 8.0 * 28.0_f64).sqrt()).abs() < 1e-9,
            "{found}"
        );
    }
}
