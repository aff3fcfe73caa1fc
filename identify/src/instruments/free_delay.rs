//! The delay of a fit as one more unknown.

use crate::error::Error;
use crate::instruments::Fit;
use crate::instruments::sums::Sums;

/// Movement in samples below which a delay is found, where its standard deviation is not too small
/// for that.
const SETTLED: f64 = 0.01;

/// Share of its standard deviation that a delay may be wrong by because the equations are linear in
/// it.
const BENT: f64 = 0.1;

/// Steps at most, each of at most one sample: the sums are linear in the delay over no more. Each
/// leaves about a tenth of itself, so that eight lead from a sample to its rounding; twice as many.
const STEPS: usize = 16;
const FARTHEST: f64 = 1.0;

impl Fit<'_> {
    /// The same with the delay among the unknowns, at the delay that the sums find, from the one
    /// that it has on. Negative ones stay at 0.
    ///
    /// # Errors
    /// As [`Fit::new`].
    pub fn with_free_delay(mut self) -> Result<Self, Error> {
        let mut before = FARTHEST;
        for _ in 0..STEPS {
            self = self.around_delay()?;
            let delay = self.setting.delay;
            let Some(found) = self.found()?.delay else {
                break;
            };
            let next = (delay + found.shift.clamp(-FARTHEST, FARTHEST)).max(0.0);
            let step = (next - delay).abs();
            // By a step s the input is bent by at most s^2/2 of its change, in units of a sample;
            // and the numerators, which belong to the step before, leave as much of this step as it
            // is of that one. Steps that are no longer smaller are rounding.
            let left = (0.5 * step * step).max(step * (step / before).min(1.0));
            let rounding = step >= before && step < found.sigma;
            if step < SETTLED && (rounding || !(left > BENT * found.sigma)) {
                break;
            }
            before = step;
            self.setting.delay = next;
            self.setting.later = None;
            self.sums = Sums::of(self.problem, &self.setting)?;
            // Within a sample the numerators rest on the denominator.
            self.repeat(1)?;
        }
        match self.setting.later {
            Some(_) => Ok(self),
            None => self.around_delay(),
        }
    }

    /// The same with the delay among the unknowns, around the one that it has.
    ///
    /// # Errors
    /// As [`Fit::new`].
    pub fn around_delay(mut self) -> Result<Self, Error> {
        self.setting.later = self.sums.numerators(self.method);
        self.sums = Sums::of(self.problem, &self.setting)?;
        Ok(self)
    }
}
