//! The state of an identifier: everything that a sample changes.

use crate::estimation::forgetting::StabilisedForgetting;
use crate::estimation::noise_level::NoiseLevel;
use crate::estimation::rls::Estimator;
use crate::identifier::gate::{Gate, Verdict};
use crate::identifier::outcome::{Outcome, Refusal};
use crate::identifier::plan::{Plan, Prior};
use crate::model::evaluation::PredictionError;
use crate::trends::delay_line::{DelayLine, acceptable};
use crate::trends::{Hold, Memory, TrendOperator, Trends};

/// Memory of the signals; begins anew after a gap in the samples.
#[derive(Debug, Clone, PartialEq)]
struct Signals<T: TrendOperator<M>, const M: usize, const I: usize, const D: usize> {
    output: T::Memory,
    inputs: [T::Memory; I],
    constant: T::Memory,
    lines: [DelayLine<D>; I],
    /// What the initial state still contributes to the trends.
    initial: f32,
    /// Zero of the output.
    reference: f32,
    /// Samples until the trends have settled.
    remaining: u32,
    begun: bool,
    gate: Gate<T::Memory>,
    /// The newest y in the trends, and the newest inputs.
    last: f32,
    last_inputs: [f32; I],
    /// Samples without y since the last one.
    gap: u32,
}

impl<T: TrendOperator<M>, const M: usize, const I: usize, const D: usize> Signals<T, M, I, D> {
    fn new<const N: usize>(plan: &Plan<T, M, N, I>, warm_up: u32) -> Self {
        let design = plan.trends.design();
        Self {
            output: Memory::output_at_rest(design, plan.output_form, 0.0),
            inputs: plan
                .holds
                .map(|hold| Memory::input_at_rest(design, hold, 0.0)),
            constant: Memory::input_at_rest(design, Hold::Zero, 0.0),
            lines: [DelayLine::new(); I],
            initial: 0.0,
            reference: 0.0,
            remaining: warm_up,
            begun: false,
            gate: Gate::new(plan.gate_open),
            last: 0.0,
            last_inputs: plan.initial_inputs,
            gap: 0,
        }
    }
}

/// The trends of everything but y.
struct Others<const M: usize, const I: usize> {
    inputs: [[f32; M]; I],
    extra: [f32; 2],
}

/// The regressor with its equation error, and that as an innovation in the unit of y.
struct Row<const N: usize> {
    phi: [f32; N],
    error: f32,
    innovation: f32,
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
            forgetting,
        }
    }

    /// Takes u(k) and y(k).
    #[inline(always)]
    pub(crate) fn update(&mut self, plan: &Plan<T, M, N, I>, u: [f32; I], y: f32) -> Outcome {
        if let Some(refusal) = refused(plan, &u, y) {
            self.refuse(plan, &u);
            return Outcome::Refused(refusal);
        }
        if !self.signals.begun {
            self.begin(plan, y);
        }
        let reference = self.signals.reference;
        let y = y - reference;
        self.signals.gap = 0;
        let others = self.other_trends(plan, u);
        if self.signals.remaining > 0 {
            self.signals.last = y;
            self.noise.update(y);
            let _ = self.output_trends(plan, y);
            self.signals.remaining -= 1;
            self.prediction = y + reference;
            return Outcome::WarmingUp {
                remaining: self.signals.remaining,
            };
        }
        let row = match plan.has_gate {
            false => self.row(plan, y, &others),
            true => {
                let before = self.signals.output.clone();
                let row = self.row(plan, y, &others);
                let third = self.noise.third_difference(y);
                let gate = &mut self.signals.gate;
                match gate.judge(
                    row.innovation,
                    third,
                    &self.noise,
                    plan.least_noise,
                    plan.gate_pause,
                ) {
                    Verdict::Plausible => row,
                    Verdict::Implausible => {
                        gate.replaced = Some((y, before.clone()));
                        self.go_on(plan, before, &others);
                        return Outcome::Replaced {
                            innovation: row.innovation,
                        };
                    }
                    Verdict::Lasting => self.row_of_two(plan, y, &others),
                }
            }
        };
        self.signals.last = y;
        self.noise.update(y);
        self.prediction = y - row.innovation + reference;
        self.errors.update(row.innovation);
        self.learn(plan, &row)
    }

    /// Takes the row in, unless the estimate is held.
    #[inline(always)]
    fn learn(&mut self, plan: &Plan<T, M, N, I>, row: &Row<N>) -> Outcome {
        let innovation = row.innovation;
        if !self.adapting {
            return Outcome::Held { innovation };
        }
        if plan.forgets {
            self.noise.flush();
            let moves = plan.moves(&row.phi, &self.noise);
            if moves {
                self.estimator.correct(&row.phi, row.error);
            } else {
                self.estimator.pass();
            }
            self.forgetting.apply(&mut self.estimator);
            if !moves {
                return Outcome::Held { innovation };
            }
        } else {
            self.estimator.correct(&row.phi, row.error);
        }
        Outcome::Estimated { innovation }
    }

    /// The row that y makes with the trends of everything else.
    #[inline(always)]
    fn row(&mut self, plan: &Plan<T, M, N, I>, y: f32, others: &Others<M, I>) -> Row<N> {
        let output = self.output_trends(plan, y);
        let (phi, psi) = plan
            .regressor
            .assemble(&output, &others.inputs, &others.extra);
        let error = self.estimator.innovation(&phi, psi);
        // (10): y minus its evaluation is the equation error over the weight of y(k) in it.
        let beta = plan.regressor.feedthrough(self.estimator.theta());
        Row {
            phi,
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
            let _ = self.output_trends(plan, newest);
            self.replaced = self.replaced.saturating_sub(1);
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
        let _ = self.output_trends(plan, predicted);
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
    pub(crate) fn skip(&mut self, plan: &Plan<T, M, N, I>, u: [f32; I]) {
        if !self.signals.begun {
            return;
        }
        self.signals.gap = self.signals.gap.saturating_add(1);
        if self.signals.gap > plan.longest_gap {
            self.restart_signals(plan, plan.warm_up);
            return;
        }
        let others = self.other_trends(plan, u);
        let before = self.signals.output.clone();
        self.signals.gate.replaced = None;
        self.signals.gate.keep_open(plan.gate_pause);
        self.go_on(plan, before, &others);
    }

    /// One sample time without y, under the newest inputs.
    pub(crate) fn skip_held(&mut self, plan: &Plan<T, M, N, I>) {
        self.skip(plan, self.signals.last_inputs);
    }

    /// A refused sample is a sample time without y; inputs that cannot be taken stay what they were.
    #[inline(never)]
    fn refuse(&mut self, plan: &Plan<T, M, N, I>, u: &[f32; I]) {
        match refused(plan, u, 0.0) {
            None => self.skip(plan, *u),
            Some(_) => self.skip_held(plan),
        }
    }

    #[inline(always)]
    fn output_trends(&mut self, plan: &Plan<T, M, N, I>, y: f32) -> Trends<M> {
        plan.trends
            .output(&mut self.signals.output, y, plan.output_form)
    }

    /// The trends of the inputs, of the constant and of the initial state.
    #[inline(always)]
    fn other_trends(&mut self, plan: &Plan<T, M, N, I>, u: [f32; I]) -> Others<M, I> {
        self.signals.last_inputs = u;
        Others {
            inputs: self.input_trends(plan, u),
            extra: self.extra_columns(plan),
        }
    }

    #[inline(always)]
    fn input_trends(&mut self, plan: &Plan<T, M, N, I>, u: [f32; I]) -> [[f32; M]; I] {
        let signals = &mut self.signals;
        let mut inputs = [[0.0; M]; I];
        for c in 0..I {
            let delayed = if D > 0 {
                signals.lines[c].update(u[c], plan.delays[c])
            } else {
                u[c]
            };
            inputs[c] = plan
                .trends
                .input(&mut signals.inputs[c], delayed, plan.holds[c]);
        }
        inputs
    }

    /// Entries of the regressor for the constant and the initial state.
    #[inline(always)]
    fn extra_columns(&mut self, plan: &Plan<T, M, N, I>) -> [f32; 2] {
        let signals = &mut self.signals;
        let constant = if plan.structure.constant() {
            let trends = plan.trends.input(&mut signals.constant, 1.0, Hold::Zero);
            trends[0]
        } else {
            0.0
        };
        let initial = signals.initial;
        if initial > 0.0 {
            // Ended at a millionth, before it becomes subnormal.
            let next = initial * plan.trends.design().slow_mode;
            signals.initial = if next > 1e-6 { next } else { 0.0 };
        }
        [constant, initial]
    }

    /// Begins at the equilibrium of y(0) and the initial inputs.
    #[inline(never)]
    fn begin(&mut self, plan: &Plan<T, M, N, I>, y: f32) {
        let signals = &mut self.signals;
        let integrates = plan.structure.integrators() > 0;
        let design = plan.trends.design();
        // Behind an integrator only increments count; small numbers keep their digits.
        signals.reference = if integrates { y } else { 0.0 };
        let y = y - signals.reference;
        self.noise.settle(y);
        signals.output = Memory::output_at_rest(design, plan.output_form, y);
        for c in 0..I {
            let (hold, value) = (plan.holds[c], plan.initial_inputs[c]);
            signals.inputs[c] = Memory::input_at_rest(design, hold, value);
        }
        let constant = if integrates { 0.0 } else { 1.0 };
        signals.constant = Memory::input_at_rest(design, Hold::Zero, constant);
        signals.initial = if plan.structure.initial_state() {
            1.0
        } else {
            0.0
        };
        signals.begun = true;
    }

    /// Forgets the signals; the next `warm_up` samples are not estimated from.
    pub(crate) fn restart_signals(&mut self, plan: &Plan<T, M, N, I>, warm_up: u32) {
        self.signals = Signals::new(plan, warm_up);
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
