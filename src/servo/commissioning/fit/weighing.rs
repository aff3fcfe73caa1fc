//! The standard deviations of what a fit has found.

use crate::servo::commissioning::fit::Fit;
use crate::servo::commissioning::fit::certainty::Certainty;
use crate::servo::commissioning::range::scales;

impl Fit {
    /// Works out the standard deviations of the best parameters, in three samples; whether that is
    /// done. Behind the end of a pass, whose sums make room.
    pub(crate) fn weigh(&mut self) -> bool {
        let (factor, scale) = (&mut self.sums.normal, scales(&self.best));
        self.certainty = self.certainty.advance(factor, &self.best_sums, &scale);
        matches!(self.certainty, Certainty::Known(_))
    }

    /// Standard deviations of the best parameters: see
    /// [`Sums::std`](crate::servo::commissioning::sums::Sums::std). Infinite when they are not
    /// known.
    pub(crate) const fn std(&self) -> [f32; 4] {
        match self.certainty {
            Certainty::Known(std) => std,
            _ => [f32::INFINITY; 4],
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
    use crate::servo::commissioning::predictor::PARAMETERS;
    use crate::servo::commissioning::sums::NO_SUMS;

    #[test]
    fn what_no_point_shows_is_not_known() {
        let mut fit = Fit::new(true);
        assert_eq!(fit.std(), [f32::INFINITY; 4]);
        for (j, calls) in [(PARAMETERS - 1, 1), (0, 2)] {
            fit.best_sums = NO_SUMS;
            for k in 0..PARAMETERS {
                fit.best_sums.normal[k][k] = 1.0;
            }
            fit.best_sums.normal[j][j] = f32::NAN;
            fit.know([0.0; 4]);
            assert_eq!((1..9).find(|_| fit.weigh()), Some(calls));
            assert_eq!(fit.std(), [f32::INFINITY; 4]);
        }
    }
}
