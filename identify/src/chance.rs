//! How much better one model simulates than another by chance alone.
//!
//! Of an error that nothing explains, p further unknowns take by chance a sum of squares of the
//! size of its spectrum where they act, at most the largest value of it (Ljung, System
//! Identification, section 16.4: the F test; there for white errors, whose spectrum is flat):
//!
//! ```text
//! S_other / S - 1 < chi^2_p / n     n = samples / g     g = largest value of the spectrum over its mean
//! ```
//!
//! `chi_p`, the length of p normal numbers, exceeds `sqrt(p) + t` in at most `e^(-t^2/2)` of the
//! cases (concentration of a function of slope 1: Boucheron, Lugosi and Massart, Concentration
//! Inequalities, theorem 5.6). The best of M alternatives does so in M times as many: t grows to
//! `sqrt(t^2 + 2 ln M)`.
//!
//! From the squares of the correlations of the error, as many samples apart as there are:
//!
//! ```text
//! g = 2 sum_k rho_k^2 - 1        white: 1      e(k+1) = r e(k) + ..: (1 + 3 r^2) / (1 - r^2)
//! ```
//!
//! where the largest value is `(1 + r)^2 / (1 - r^2)`: at most a third more, alike at both ends.

use crate::folds::{Folds, Refitted};
use crate::polynomials::Polynomials;
use crate::problem::Problem;

/// The t of one alternative: what is beyond three deviations is not chance, as of a parameter.
const DEVIATIONS: f64 = 3.0;

/// Share of a fold up to which correlations are summed: longer distances have too few pairs.
const LONGEST: usize = 8;

/// Distances beyond which not each one is taken, but one in every so many as this is contained in
/// it, for all of those: their spacing never stays that of an oscillation.
const EACH: usize = 64;

/// Independent errors in sums of squares as those of the folds: samples over the factor g.
fn independent(errors: &[Vec<f64>]) -> f64 {
    let samples: usize = errors.iter().map(Vec::len).sum();
    let shortest = errors.iter().map(Vec::len).min().unwrap_or(0);
    let at = |distance: usize| -> f64 {
        let each = errors.iter().map(|e| {
            let pairs = e.iter().zip(e.iter().skip(distance));
            pairs.map(|(x, y)| x * y).sum::<f64>()
        });
        each.sum()
    };
    let whole = at(0);
    if !(whole > 0.0) {
        return samples as f64;
    }
    let (mut squares, mut distance) = (0.0, 1);
    while distance <= shortest / LONGEST {
        let spacing = (distance / EACH).max(1);
        squares += spacing as f64 * (at(distance) / whole).powi(2);
        distance += spacing;
    }
    // On both sides.
    samples as f64 / (1.0 + 4.0 * squares)
}

impl Folds {
    /// Whether these errors are smaller than others by more than `unknowns` of the best of so many
    /// alternatives make them by chance.
    ///
    /// Cost: a simulation of each fold, and `64 n (1 + ln(n / 512))` multiplications for folds of n
    /// samples.
    pub(crate) fn beat(
        &self,
        (problem, delay, refitted): (&Problem, f64, Refitted),
        others: &Self,
        (unknowns, alternatives): (usize, usize),
    ) -> bool {
        let more = others.total(refitted) / self.total(refitted) - 1.0;
        let simulated = |(fold, model): (usize, &Polynomials)| {
            problem.left(model, delay, Self::range(problem, delay, fold), refitted)
        };
        let errors: Option<Vec<_>> = self.models.iter().enumerate().map(simulated).collect();
        let Some(errors) = errors else {
            return false;
        };
        let best_of = DEVIATIONS.powi(2) + 2.0 * (alternatives as f64).ln();
        let by_chance = ((unknowns as f64).sqrt() + best_of.sqrt()).powi(2);
        more * independent(&errors) > by_chance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// White numbers, and what a pole at `r` makes of them.
    fn errors(r: f64) -> Vec<Vec<f64>> {
        let (mut seed, mut e) = (7_u64, 0.0);
        let mut next = || {
            let mut sum = -6.0;
            for _ in 0..12 {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                sum += (seed >> 11) as f64 / (1_u64 << 53) as f64;
            }
            e = r * e + sum;
            e
        };
        (0..8)
            .map(|_| (0..4000).map(|_| next()).collect())
            .collect()
    }

    #[test]
    fn errors_count_by_the_largest_value_of_their_spectrum() {
        for r in [-0.9_f64, 0.0, 0.5, 0.9, 0.98] {
            let counted = 32_000.0 / independent(&errors(r));
            let of_spectrum = (1.0 + r.abs()).powi(2) / (1.0 - r * r);
            let ratio = counted / of_spectrum;
            assert!(
                (0.75..1.2).contains(&ratio),
                "{r}: {counted} for {of_spectrum}"
            );
        }
    }
}
