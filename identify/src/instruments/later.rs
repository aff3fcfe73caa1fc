//! What a delay by one sample more makes of the right-hand side: the regressor that has the delay
//! as its parameter.
//!
//! `B u(t - d h)` is linear in d between two samples: `d/dd = B (u(k-w-1) - u(k-w))`, w the whole
//! samples of d, and what changes within a sample ([`Within`]) grows with it, too. With that column
//! among the regressors the delay is one more unknown (Gauss and Newton), and every standard
//! deviation contains that it is.

use crate::instruments::lanes::{Design, Lane, Values};
use crate::instruments::within::{Within, steps};
use crate::signals::{Input, Signals};

/// The part of one input.
pub(super) struct Later {
    samples: Vec<f32>,
    trends: Box<dyn Lane>,
    within: Option<Within>,
    numerators: Vec<f64>,
}

impl Later {
    /// The part of an input with these numerators in the plane of the trends, around a delay in
    /// samples; `model` is the denominator.
    pub(super) fn of(
        (signals, input): (&Signals, &Input),
        delay: f64,
        (numerators, model): (&[f64], &[f64]),
        design: &dyn Design,
    ) -> Self {
        Self {
            samples: steps(signals, input, delay),
            trends: design.of_input(input.hold),
            within: Within::growth((signals, input), delay, model, design),
            numerators: numerators.to_vec(),
        }
    }

    /// The part of the column at sample `k`; every sample in turn.
    pub(super) fn at(&mut self, k: usize) -> f64 {
        let mut trends: Values = self.trends.input(self.samples[k]);
        let trends = &mut trends[..self.numerators.len()];
        if let Some(within) = &mut self.within {
            within.add(k, trends);
        }
        let terms = self.numerators.iter().zip(trends.iter());
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
