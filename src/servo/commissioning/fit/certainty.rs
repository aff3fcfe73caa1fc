//! How certain the parameters are that a fit has found.

use super::{Fit, HALF};
use crate::math::matrix::factor_columns;
use crate::servo::commissioning::predictor::PARAMETERS;
use crate::servo::commissioning::range::scales;

/// Deviations of what no point shows.
pub(super) const UNKNOWN: [f32; 4] = [f32::INFINITY; 4];

/// How far the standard deviations are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Certainty {
    /// The normal of the sums is half of the Cholesky factor of the normal equations in reverse
    /// order, or all of it.
    Halved,
    Factored,
    Known([f32; 4]),
}

impl Fit {
    /// Works out the standard deviations of the best parameters, in three samples; whether that is
    /// done. Behind the end of a pass, whose sums make room. Cost: some 1500 instructions each.
    pub(crate) fn weigh(&mut self) -> bool {
        let factor = &mut self.sums.normal;
        let (next, solved) = match self.certainty {
            Certainty::Known(_) => {
                *factor = self.best_sums.reversed(&scales(&self.best));
                (Certainty::Halved, factor_columns(factor, 0, HALF))
            }
            Certainty::Halved => (
                Certainty::Factored,
                factor_columns(factor, HALF, PARAMETERS),
            ),
            Certainty::Factored => {
                let std = self.best_sums.std(factor, &scales(&self.best));
                (Certainty::Known(std), true)
            }
        };
        self.certainty = if solved {
            next
        } else {
            Certainty::Known(UNKNOWN)
        };
        matches!(self.certainty, Certainty::Known(_))
    }

    /// Standard deviations of the best parameters: see
    /// [`Sums::std`](crate::servo::commissioning::sums::Sums::std). Infinite when they are not
    /// known.
    pub(crate) const fn std(&self) -> [f32; 4] {
        match self.certainty {
            Certainty::Known(std) => std,
            _ => UNKNOWN,
        }
    }

    /// Takes these for the standard deviations.
    #[cfg(test)]
    pub(crate) const fn know(&mut self, std: [f32; 4]) {
        self.certainty = Certainty::Known(std);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::commissioning::sums::NO_SUMS;

    #[test]
    fn what_no_point_shows_is_not_known() {
        let mut fit = Fit::new(true);
        assert_eq!(fit.std(), UNKNOWN);
        for (j, calls) in [(PARAMETERS - 1, 1), (0, 2)] {
            fit.best_sums = NO_SUMS;
            for k in 0..PARAMETERS {
                fit.best_sums.normal[k][k] = 1.0;
            }
            fit.best_sums.normal[j][j] = f32::NAN;
            fit.know([0.0; 4]);
            assert_eq!((1..9).find(|_| fit.weigh()), Some(calls));
            assert_eq!(fit.std(), UNKNOWN);
        }
    }
}
