//! The state of an identifier: everything that a sample changes.

use crate::estimation::forgetting::StabilisedForgetting;
use crate::estimation::noise_level::NoiseLevel;
use crate::estimation::rls::Estimator;
use crate::identifier::change::ChangeDetector;
use crate::identifier::gate::Verdict;
use crate::identifier::outcome::{Outcome, Refusal};
use crate::identifier::plan::{Plan, Prior};
use crate::identifier::signals::{Others, Signals};
use crate::identifier::standstill::{Motion, Standstill};
use crate::identifier::witness::Witness;
use crate::model::evaluation::PredictionError;
use crate::trends::TrendOperator;
use crate::trends::delay_line::acceptable;

/// One over the third difference that noise does not make, in standard deviations of y: 4 times sqrt(20).
const STEP: f32 = 1.0 / 18.0;

/// The regressor with its equation error, and that as an innovation in the unit of y.
struct Row<const N: usize> {
    phi: [f32; N],
    psi: f32,
    error: f32,
    innovation: f32,
}

/// Variance of the noise of y.
#[derive(Clone, Copy)]
struct Noise {
    /// As measured; -1 while it is not known.
    known: f32,
    /// That, but never less than a share of the expected one.
    allowed: f32,
}

impl Noise {
    #[inline(always)]
    fn of(level: &NoiseLevel, least: f32) -> Self {
        let known = level.known();
        let allowed = if known > least { known } else { least };
        Self { known, allowed }
    }
}

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
    /// Samples of y that were replaced by their prediction.
    pub(crate) replaced: u32,
    signals: Signals<T, M, I, D>,
    standstill: Standstill,
    change: ChangeDetector,
    /// Changes of the drive that were found.
    pub(crate) changes: u32,
    pub(crate) forgetting: StabilisedForgetting<N>,
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
            replaced: 0,
            signals: Signals::new(plan, plan.warm_up),
            standstill: Standstill::new(),
            change: ChangeDetector::new(plan.forgetting, plan.change_blind),
            changes: 0,
            forgetting,
        }
    }

    /// Takes u(k) and y(k).
    #[inline(always)]
    pub(crate) fn update(
        &mut self,
        plan: &Plan<T, M, N, I>,
        u: [f32; I],
        y: f32,
        witness: &mut impl Witness<M, N, I>,
    ) -> Outcome {
        if let Some(refusal) = refused(plan, &u, y) {
            self.refuse(plan, &u, witness);
            return Outcome::Refused(refusal);
        }
        if !self.signals.begun {
            let settled = self.signals.begin(plan, y);
            self.noise.settle(settled);
            witness.begin();
        }
        let reference = self.signals.reference;
        let y = y - reference;
        self.signals.gap = 0;
        self.signals.turn = self.signals.turn.wrapping_add(1);
        if self.signals.turn.is_multiple_of(16) {
            self.flush();
        }
        let others = self.signals.other_trends(plan, u);
        witness.inputs(&others.inputs);
        if self.signals.remaining > 0 {
            self.signals.last = y;
            self.noise.update(y);
            let _ = self.signals.output_trends(plan, y);
            self.signals.remaining -= 1;
            self.prediction = y + reference;
            return Outcome::WarmingUp {
                remaining: self.signals.remaining,
            };
        }
        let noise = Noise::of(&self.noise, plan.least_noise);
        let mut third = self.noise.third_difference(y);
        let row = match plan.has_gate {
            false => self.row(plan, y, &others),
            true => {
                let before = self.signals.output.clone();
                let row = self.row(plan, y, &others);
                let gate = &mut self.signals.gate;
                match gate.judge(row.innovation, third, noise.allowed, plan.gate_pause) {
                    Verdict::Plausible => row,
                    Verdict::Implausible => {
                        gate.replaced = Some((y, before.clone()));
                        self.go_on(plan, before, &others);
                        return Outcome::Replaced {
                            innovation: row.innovation,
                        };
                    }
                    Verdict::Lasting => {
                        let row = self.row_of_two(plan, y, &others);
                        third = self.noise.third_difference(y);
                        row
                    }
                }
            }
        };
        self.signals.last = y;
        self.noise.take(y, third);
        let noise = Noise::of(&self.noise, plan.least_noise);
        self.prediction = y - row.innovation + reference;
        self.errors.update(row.innovation);
        self.learn(plan, &row, u, y, noise, witness)
    }

    /// Once in a while, a part at a time: what has decayed becomes zero before it becomes subnormal.
    #[inline(never)]
    fn flush(&mut self) {
        match (self.signals.turn / 16) % 4 {
            0 => self.signals.flush_output(),
            1 => self.signals.flush_inputs(),
            2 => self.estimator.flush_sums(),
            _ => {
                self.noise.flush();
                self.change.flush();
            }
        }
    }

    /// Takes the row in, unless the estimate is held.
    #[inline(always)]
    fn learn(
        &mut self,
        plan: &Plan<T, M, N, I>,
        row: &Row<N>,
        u: [f32; I],
        y: f32,
        noise: Noise,
        witness: &mut impl Witness<M, N, I>,
    ) -> Outcome {
        let innovation = row.innovation;
        let obeys = !plan.can_stand || self.obeys(plan, row, u, y, noise.allowed, witness);
        if !self.adapting {
            return Outcome::Held { innovation };
        }
        if plan.forgets {
            let moves = obeys && plan.moves(&row.phi, noise.known);
            if plan.follows_changes && self.changing(plan, row, moves) {
                return Outcome::Held { innovation };
            }
            if moves {
                self.estimator.correct(&row.phi, row.error);
                witness.row(&row.phi, row.psi);
            } else {
                self.estimator.pass();
            }
            self.forgetting.apply(&mut self.estimator);
            if !moves {
                return Outcome::Held { innovation };
            }
        } else if obeys {
            self.estimator.correct(&row.phi, row.error);
            witness.row(&row.phi, row.psi);
        } else {
            return Outcome::Held { innovation };
        }
        Outcome::Estimated { innovation }
    }

    /// The initial state is again as uncertain as at the start.
    fn lose_initial_state(&mut self, plan: &Plan<T, M, N, I>) {
        if !plan.structure.initial_state() {
            return;
        }
        self.signals.initial = 1.0;
        // U ends with a 1: the last factor is the last variance.
        let last = |of: &[f32; N]| of.last().copied().unwrap_or(0.0);
        let std = last(&plan.prior.std);
        let missing = std * std - last(self.estimator.diagonal());
        if missing > 0.0 {
            self.estimator.widen_last(missing);
        }
    }

    /// Whether the drive has just changed, or the filter still carries what it was: the row is left out.
    #[inline(never)]
    fn changing(&mut self, plan: &Plan<T, M, N, I>, row: &Row<N>, moves: bool) -> bool {
        let change = &mut self.change;
        if change.settling > 0 {
            change.settling -= 1;
            self.forgetting.hold(&mut self.estimator);
            if change.settling == 0 {
                self.lose_initial_state(plan);
            }
            return true;
        }
        let estimator = &self.estimator;
        let known = || estimator.spread(&row.phi);
        if !moves || !change.found([row.error, row.psi], plan.change_shares, known) {
            return false;
        }
        change.answer(plan.forgetting, plan.change_settling, plan.change_blind);
        let limit = plan.prior.std.map(|std| std * std);
        let one_sample = self.estimator.samples().max(1.0);
        let theta = *self.estimator.theta();
        self.estimator.resume(theta, one_sample, &limit);
        self.signals.gate.keep_open(plan.gate_open);
        self.changes = self.changes.saturating_add(1);
        true
    }

    /// Whether the row may be of the model; where the axis stands against it the trends begin again at rest.
    #[inline(always)]
    fn obeys(
        &mut self,
        plan: &Plan<T, M, N, I>,
        row: &Row<N>,
        u: [f32; I],
        y: f32,
        noise: f32,
        witness: &mut impl Witness<M, N, I>,
    ) -> bool {
        if plan.sticks(&u) {
            if let Some(y) = self.standstill.sticks(y, plan.gate_pause) {
                self.signals.rest(plan, y);
                witness.begin();
                // In force from now on, should the axis break away before the next sample.
                let others = self.signals.other_trends(plan, u);
                witness.inputs(&others.inputs);
            }
            return false;
        }
        let limits = [plan.certain, plan.settled];
        let estimator = &self.estimator;
        let expected = || 1.0 + estimator.spread(&row.phi);
        let found = self
            .standstill
            .judge(y, row.innovation, noise, limits, expected);
        if let Motion::Stands | Motion::Freed = found {
            self.signals.rest(plan, y);
            witness.begin();
        }
        if found == Motion::Freed {
            self.lose_initial_state(plan);
        }
        found == Motion::Obeys
    }

    /// The row that y makes with the trends of everything else.
    #[inline(always)]
    fn row(&mut self, plan: &Plan<T, M, N, I>, y: f32, others: &Others<M, I>) -> Row<N> {
        let output = self.signals.output_trends(plan, y);
        let (phi, psi) = plan
            .regressor
            .assemble(&output, &others.inputs, &others.extra);
        let error = self.estimator.innovation(&phi, psi);
        // (10): y minus its evaluation is the equation error over the weight of y(k) in it.
        let beta = plan.regressor.feedthrough(self.estimator.theta());
        Row {
            phi,
            psi,
            error,
            innovation: error / beta,
        }
    }

    /// The row of y after all, where the sample before was replaced and should not have been.
    #[inline(never)]
    fn row_of_two(&mut self, plan: &Plan<T, M, N, I>, y: f32, others: &Others<M, I>) -> Row<N> {
        if let Some((newest, memory)) = self.signals.gate.replaced.take() {
            self.signals.output = memory;
            self.noise.correct_newest(newest);
            let _ = self.signals.output_trends(plan, newest);
            self.replaced = self.replaced.saturating_sub(1);
        }
        // Beyond all noise: the trends carry this step of the position or of the velocity for a while.
        let third = self.noise.third_difference(y) * STEP;
        if third * third > Noise::of(&self.noise, plan.least_noise).allowed {
            self.standstill.pause(plan.after_step);
        }
        let row = self.row(plan, y, others);
        self.signals.gate.mean = row.innovation;
        row
    }

    /// Lets the trends of y, from what they were before the sample, go on with the prediction.
    #[inline(never)]
    fn go_on(&mut self, plan: &Plan<T, M, N, I>, before: T::Memory, others: &Others<M, I>) {
        // From the newest y: that of a spike would leave no digits.
        let last = self.signals.last;
        self.signals.output = before.clone();
        let row = self.row(plan, last, others);
        let predicted = last - (row.innovation - self.signals.gate.mean);
        let settled = self.signals.remaining == 0 && plan.trends.design().filter.is_some();
        let predicted = match settled && acceptable(predicted, plan.output_limit) {
            true => predicted,
            false => last,
        };
        self.signals.output = before;
        let _ = self.signals.output_trends(plan, predicted);
        self.signals.last = predicted;
        self.noise.pass(predicted);
        self.prediction = predicted + self.signals.reference;
        self.replaced = self.replaced.saturating_add(1);
        self.signals.remaining = self.signals.remaining.saturating_sub(1);
        if plan.forgets && self.adapting {
            self.estimator.pass();
            self.forgetting.apply(&mut self.estimator);
        }
    }

    /// One sample time without y: the trends go on with what the model predicts under the inputs `u`.
    #[inline(never)]
    pub(crate) fn skip(
        &mut self,
        plan: &Plan<T, M, N, I>,
        u: [f32; I],
        witness: &mut impl Witness<M, N, I>,
    ) {
        if !self.signals.begun {
            return;
        }
        self.signals.gap = self.signals.gap.saturating_add(1);
        if self.signals.gap > plan.longest_gap {
            self.restart_signals(plan, plan.warm_up);
            return;
        }
        let others = self.signals.other_trends(plan, u);
        witness.inputs(&others.inputs);
        let before = self.signals.output.clone();
        self.signals.gate.replaced = None;
        self.signals.gate.keep_open(plan.gate_pause);
        self.go_on(plan, before, &others);
    }

    /// One sample time without y, under the newest inputs.
    pub(crate) fn skip_held(
        &mut self,
        plan: &Plan<T, M, N, I>,
        witness: &mut impl Witness<M, N, I>,
    ) {
        self.skip(plan, self.signals.last_inputs, witness);
    }

    /// A refused sample is a sample time without y; inputs that cannot be taken stay what they were.
    #[inline(never)]
    fn refuse(
        &mut self,
        plan: &Plan<T, M, N, I>,
        u: &[f32; I],
        witness: &mut impl Witness<M, N, I>,
    ) {
        match refused(plan, u, 0.0) {
            None => self.skip(plan, *u, witness),
            Some(_) => self.skip_held(plan, witness),
        }
    }

    /// Forgets the signals; the next `warm_up` samples are not estimated from.
    pub(crate) fn restart_signals(&mut self, plan: &Plan<T, M, N, I>, warm_up: u32) {
        self.signals = Signals::new(plan, warm_up);
        self.standstill = Standstill::new();
    }

    /// Begins the recursion again from `prior`, whose mean becomes nominal.
    pub(crate) fn warm_start(&mut self, plan: &Plan<T, M, N, I>, prior: Prior<N>) {
        self.estimator = Estimator::new(prior.theta, prior.std, plan.forgetting);
        self.forgetting.set_nominal(prior.theta);
        self.forgetting.set_nominal_std(&prior.std);
    }

    /// Makes the current estimate the nominal one.
    pub(crate) fn set_nominal(&mut self) {
        self.forgetting.set_nominal(*self.estimator.theta());
    }
}

/// Why this sample may not enter any buffer; `None` for a good one.
#[inline(always)]
fn refused<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize>(
    plan: &Plan<T, M, N, I>,
    u: &[f32; I],
    y: f32,
) -> Option<Refusal> {
    if !acceptable(y, plan.output_limit) {
        return Some(Refusal::Output);
    }
    for (input, (u, limit)) in u.iter().zip(&plan.input_limit).enumerate() {
        if !acceptable(*u, *limit) {
            return Some(Refusal::Input(input));
        }
    }
    None
}
