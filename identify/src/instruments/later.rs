//! What a delay by one sample more makes of the right-hand side: the regressor that has the delay
//! as its parameter.
//!
//! `B u(t - d h)` is linear in d between two samples: `d/dd = B (u(k-w-1) - u(k-w))`, w the whole
//! samples of d. With that column among the regressors the delay is one more unknown (Gauss and
//! Newton), and every standard deviation contains that it is.

use crate::instruments::lanes::{Design, Lane};
use crate::polynomials::Polynomials;
use crate::problem::Problem;
use crate::signals::{Input, Signals};

/// How much more an input would be, `delay` whole samples late, if it came one sample later.
pub(super) fn steps(signals: &Signals, input: &Input, delay: f64) -> Vec<f32> {
    let whole = delay.floor() as usize;
    let at = |k: usize, d: usize| input.samples[k.saturating_sub(d)];
    let step = |k: usize| signals.acting(k, at(k, whole + 1) - at(k, whole)) as f32;
    (0..input.samples.len()).map(step).collect()
}

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
        Self {
            samples: steps(signals, input, delay),
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
    /// Samples beyond which `shift` and `sigma` say nothing: the equations are linear in the delay
    /// over the time constants of the model, and a delay is shorter than the record.
    pub reach: f64,
}

impl DelayFound {
    /// With the error that a delay so many samples later, not to be told from this one, makes of
    /// it; the parameters move by `moves`.
    pub(crate) fn widen(&mut self, late: f64, moves: &[f64]) {
        self.sigma = self.sigma.hypot(late);
        for (with, moved) in self.with.iter_mut().zip(moves) {
            *with += late * moved;
        }
    }
}

/// Time constants, and samples at least, over which a delay is taken to be linear.
const TIME_CONSTANTS: f64 = 3.0;
const FEW: f64 = 10.0;

/// The reach of a delay, by the fastest pole of a model.
pub(crate) fn reach(problem: &Problem, model: &Polynomials) -> f64 {
    let poles = model.poles(usize::from(problem.structure.integrator));
    let rates = poles.iter().flatten();
    let rates = rates.map(|(re, im)| re.hypot(*im) * problem.signals.dt);
    let linear = (TIME_CONSTANTS / rates.fold(0.0, f64::max)).max(FEW);
    linear.min(0.5 * problem.samples() as f64)
}
