//! The state of an identifier: everything that a sample changes.
//!
//! | file | what changes it |
//! |---|---|
//! | `sample` | a sample: u and y to a row of the equation, and that into the estimate |
//! | `row` | the row of a sample, with its innovation |
//! | `gaps` | a sample time without y |
//! | `stuck` | a sample of a drive that its friction holds |
//! | `exceptions` | a sample that is not of the model: standstill, a change of the drive |

use crate::estimation::beginning::Beginning;
use crate::estimation::forgetting::StabilisedForgetting;
use crate::estimation::noise_level::NoiseLevel;
use crate::estimation::postponed::Postponed;
use crate::estimation::rls::Estimator;
use crate::estimation::start_error::StartError;
use crate::identifier::change::ChangeDetector;
use crate::identifier::plan::{Plan, Prior};
use crate::identifier::signals::Signals;
use crate::identifier::standstill::Standstill;
use crate::model::evaluation::PredictionError;
use crate::trends::TrendOperator;

/// Everything that a sample changes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct State<
    T: TrendOperator<M>,
    const M: usize,
    const N: usize,
    const I: usize,
    const D: usize,
> {
    pub(crate) estimator: Estimator<N>,
    pub(crate) noise: NoiseLevel,
    pub(crate) prediction: f32,
    pub(crate) errors: PredictionError,
    pub(crate) adapting: bool,
    /// Whether rows are taken: it adapts, and no debt is to be called in first.
    pub(super) learns: bool,
    /// Samples of y that were replaced by their prediction.
    pub(crate) replaced: u32,
    pub(super) signals: Signals<T, M, I, D>,
    pub(super) standstill: Standstill,
    pub(super) change: ChangeDetector,
    /// Changes of the drive that were found.
    pub(crate) changes: u32,
    /// Rows that make the model known; 0 for one that was given, or was known once.
    pub(super) known_rows: f32,
    pub(crate) forgetting: StabilisedForgetting<N>,
    pub(super) postponed: Postponed,
    /// Samples for which the drive still counts as one that moves.
    pub(super) moving: u32,
    /// The initial state of a structure that has none.
    pub(crate) beginning: Beginning<N>,
    /// The error of y(0) where it has one.
    pub(crate) start_error: StartError<M, N>,
}

impl<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize, const D: usize>
    State<T, M, N, I, D>
{
    /// The state before the first sample.
    pub(crate) fn new(plan: &Plan<T, M, N, I>) -> Self {
        let Prior { theta, std } = plan.prior;
        let mut forgetting = StabilisedForgetting::new(theta, plan.forgetting);
        forgetting.set_nominal_std(&std);
        Self {
            estimator: Estimator::new(theta, std, plan.forgetting),
            noise: NoiseLevel::new(plan.forgetting),
            prediction: 0.0,
            errors: PredictionError::new(),
            adapting: true,
            learns: true,
            replaced: 0,
            signals: Signals::new(plan, plan.warm_up),
            standstill: Standstill::new(),
            change: ChangeDetector::new(plan.forgetting, plan.times.change_blind),
            changes: 0,
            known_rows: plan.times.known_rows,
            forgetting,
            postponed: Postponed::new(plan.forgetting),
            moving: 0,
            beginning: Beginning::new(!plan.structure.initial_state()),
            start_error: StartError::new(plan.trends.design(), plan.times.start_pace),
        }
    }

    /// Forgets the signals; the next `warm_up` samples are not estimated from.
    pub(crate) fn restart_signals(&mut self, plan: &Plan<T, M, N, I>, warm_up: u32) {
        let last_inputs = self.signals.last_inputs;
        self.signals = Signals::new(plan, warm_up);
        self.start_error.end(1.0, plan.forgets);
        self.signals.last_inputs = last_inputs;
        self.standstill = Standstill::new();
    }

    /// Forgets the signals; rows wait until nothing of how they begin in motion is left.
    pub(crate) fn restart(&mut self, plan: &Plan<T, M, N, I>) {
        self.restart_signals(plan, plan.times.anew);
    }

    /// Begins the recursion again from `prior`, whose mean becomes nominal.
    pub(crate) fn warm_start(&mut self, plan: &Plan<T, M, N, I>, prior: Prior<N>) {
        self.estimator = Estimator::new(prior.theta, prior.std, plan.forgetting);
        self.forgetting.set_nominal(prior.theta);
        self.forgetting.set_nominal_std(&prior.std);
        self.forgetting.set_own(prior.std.map(|std| std * std));
        self.free_initial_state(plan);
        self.postponed = Postponed::new(plan.forgetting);
        self.begin_sums(plan);
        self.change.begin();
        self.known_rows = 0.0;
        self.learns = self.adapting;
    }

    /// Whether the model may say what the drive does.
    #[inline(always)]
    pub(super) fn is_known(&self) -> bool {
        self.estimator.samples() >= self.known_rows
    }

    /// Before the rows are counted anew: what is known remains so.
    pub(super) fn remain_known(&mut self) {
        if self.is_known() {
            self.known_rows = 0.0;
        }
    }

    /// Begins the recursion again at the first values.
    pub(super) fn unlearn(&mut self, plan: &Plan<T, M, N, I>) {
        let Prior { theta, std } = &plan.prior;
        self.estimator.begin_again(&std.map(|std| std * std));
        self.begin_sums(plan);
        self.estimator.set_theta(*theta);
        self.forgetting.replace_nominal(*theta);
    }

    /// The rows of before count no more, and nothing of what they tell of the beginning.
    pub(super) fn begin_sums(&mut self, plan: &Plan<T, M, N, I>) {
        self.beginning = Beginning::new(!plan.structure.initial_state());
        self.start_error.clear();
    }

    /// Calls in what forgetting is owed, all at once. Not for the 1 ms path.
    pub(super) fn call_in(&mut self) {
        self.end_call();
        self.begin_call();
        self.end_call();
    }

    pub(super) fn begin_call(&mut self) {
        self.beginning = Beginning::new(self.beginning.lasts);
        if self.postponed.is_owed() {
            self.start_error.clear();
        }
        self.postponed
            .call(&mut self.estimator, self.forgetting.left());
    }

    fn end_call(&mut self) {
        while self.estimator.is_inflating() {
            self.estimator.inflate();
        }
        self.learns = self.adapting;
    }

    /// Takes rows, or holds the estimate.
    pub(crate) const fn adapt(&mut self, on: bool) {
        self.adapting = on;
        self.learns = on && !self.estimator.is_inflating();
    }

    /// The newest y.
    pub(crate) fn position(&self) -> f32 {
        self.signals.last + self.signals.reference
    }

    /// Makes the current estimate the nominal one, as well known as it is.
    pub(crate) fn set_nominal(&mut self, plan: &Plan<T, M, N, I>) {
        let (theta, p) = (*self.estimator.theta(), self.estimator.covariances());
        self.forgetting.set_known(theta, &p, self.noise_share(plan));
        self.free_initial_state(plan);
    }

    /// The same of an estimate that the data have shown, whatever was nominal before: by P alone,
    /// for a sample that has to do other things.
    pub(crate) fn set_nominal_as_shown(&mut self, plan: &Plan<T, M, N, I>) {
        let noise = self.noise_share(plan);
        self.forgetting.set_nominal(*self.estimator.theta());
        self.forgetting
            .set_own(self.estimator.variances().map(|variance| noise * variance));
        self.free_initial_state(plan);
    }

    /// The variance of psi over that of the noise that is expected.
    fn noise_share(&self, plan: &Plan<T, M, N, I>) -> f32 {
        let expected = plan.noise.prior * plan.noise.prior;
        self.estimator.noise_variance().unwrap_or(expected) / expected
    }

    /// No beginning tells the initial state of the next one.
    fn free_initial_state(&mut self, plan: &Plan<T, M, N, I>) {
        if plan.structure.initial_state() {
            self.forgetting.let_last_follow();
        }
    }
}

#[cfg(test)]
mod tests;
