//! What a delay by one sample more makes of the right-hand side: the regressor that has the delay
//! as its parameter.
//!
//! `B u(t - d h)` is linear in d between two samples, so `d/dd = B (u(k-w-1) - u(k-w))`, w the whole
//! samples of d. With that column among the regressors the delay is one more unknown (Gauss and
//! Newton), and every standard deviation contains that it is.

use crate::error::Error;
use crate::instruments::lanes::{Design, Lane};
use crate::signals::{Input, Signals};

/// The part of one input.
pub(super) struct Later {
    samples: Vec<f32>,
    trends: Box<dyn Lane>,
    numerators: Vec<f64>,
}

impl Later {
    /// The part of an input with these numerators in the plane of the trends, around a delay in
    /// samples.
    pub(super) fn of(
        (signals, input): (&Signals, &Input),
        delay: f64,
        numerators: &[f64],
        design: &dyn Design,
    ) -> Self {
        let whole = delay.floor() as usize;
        let at = |k: usize, d: usize| input.samples[k.saturating_sub(d)];
        let step = |k: usize| signals.acting(k, at(k, whole + 1) - at(k, whole)) as f32;
        Self {
            samples: (0..input.samples.len()).map(step).collect(),
            trends: design.of_input(input.hold),
            numerators: numerators.to_vec(),
        }
    }

    /// The part of the column at sample `k`; every sample in turn.
    pub(super) fn at(&mut self, k: usize) -> f64 {
        let trends = self.trends.input(self.samples[k]);
        let terms = self.numerators.iter().zip(&trends);
        terms.map(|(b, trend)| b * trend).sum()
    }
}

/// The delay of a record as an unknown.
#[derive(Debug, Clone, PartialEq)]
pub struct DelayFound {
    /// Samples to add to the delay of the sums.
    pub shift: f64,
    /// Standard deviation \[samples\].
    pub sigma: f64,
    /// Covariances with the parameters, in the order of theta.
    pub with: Vec<f64>,
}

/// Movement in samples below which a delay is found.
const SETTLED: f64 = 0.01;

/// Steps at most, each of at most one sample: the sums are linear in the delay over no more.
const STEPS: usize = 6;
const FARTHEST: f64 = 1.0;

impl<'a> super::Fit<'a> {
    /// The same with the delay among the unknowns, at the delay that the sums find, from the one
    /// that it has on. Negative ones stay at 0.
    ///
    /// # Errors
    /// As [`Fit::new`](super::Fit::new).
    pub fn with_free_delay(mut self) -> Result<Self, Error> {
        for _ in 0..STEPS {
            self = self.around_delay()?;
            let delay = self.setting.delay;
            let Some(found) = self.found()?.delay else {
                break;
            };
            let next = (delay + found.shift.clamp(-FARTHEST, FARTHEST)).max(0.0);
            if (next - delay).abs() < SETTLED {
                break;
            }
            self.setting.delay = next;
            self.setting.later = None;
            self.sums = super::Sums::of(self.problem, &self.setting)?;
        }
        match self.setting.later {
            Some(_) => Ok(self),
            None => self.around_delay(),
        }
    }

    /// The same with the delay among the unknowns, around the one that it has.
    ///
    /// # Errors
    /// As [`Fit::new`](super::Fit::new).
    pub fn around_delay(mut self) -> Result<Self, Error> {
        self.setting.later = self.sums.numerators(self.method);
        self.sums = super::Sums::of(self.problem, &self.setting)?;
        Ok(self)
    }
}
