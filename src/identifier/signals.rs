//! The memory of the signals: from the samples to their trends.

use crate::estimation::mean_square::flush;
use crate::identifier::gate::Gate;
use crate::identifier::plan::Plan;
use crate::identifier::start::{Start, Verdict};
use crate::trends::delay_line::DelayLine;
use crate::trends::{Hold, Memory, TrendOperator, Trends};

/// The trends of everything but y.
pub(crate) struct Others<const M: usize, const I: usize> {
    pub(crate) inputs: [[f32; M]; I],
    pub(crate) extra: [f32; 2],
    /// The inputs as they act: behind their delays.
    pub(super) acting: [f32; I],
}

/// Memory of the signals; begins anew after a gap in the samples.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Signals<T: TrendOperator<M>, const M: usize, const I: usize, const D: usize> {
    pub(crate) output: T::Memory,
    pub(crate) inputs: [T::Memory; I],
    pub(crate) constant: T::Memory,
    lines: [DelayLine<D>; I],
    /// Contribution of the initial state to the trends, whether the structure has it or not.
    pub(crate) initial: f32,
    /// Zero of the output.
    pub(crate) reference: f32,
    /// Samples until the trends have settled.
    pub(crate) remaining: u32,
    pub(crate) begun: bool,
    pub(crate) gate: Gate<T::Memory>,
    /// The newest y in the trends, and the newest inputs.
    pub(crate) last: f32,
    pub(crate) last_inputs: [f32; I],
    /// The newest inputs as they act: behind their delays.
    pub(crate) acting: [f32; I],
    /// Where y began, while that is being found.
    pub(crate) start: Option<Start>,
    /// Samples without y since the last one.
    pub(crate) gap: u32,
    /// Samples, modulo 2^32.
    pub(crate) turn: u32,
}

impl<T: TrendOperator<M>, const M: usize, const I: usize, const D: usize> Signals<T, M, I, D> {
    /// Signals at rest; the first `warm_up` samples are not estimated from.
    pub(crate) fn new<const N: usize>(plan: &Plan<T, M, N, I>, warm_up: u32) -> Self {
        let design = plan.trends.design();
        Self {
            output: Memory::output_at_rest(design, plan.output_form, 0.0),
            inputs: plan
                .inputs
                .holds
                .map(|hold| Memory::input_at_rest(design, hold, 0.0)),
            constant: Memory::input_at_rest(design, Hold::Zero, 0.0),
            lines: [const { DelayLine::new() }; I],
            initial: 0.0,
            reference: 0.0,
            remaining: warm_up,
            begun: false,
            gate: Gate::new(plan.times.gate_open),
            last: 0.0,
            last_inputs: plan.inputs.initial,
            acting: plan.inputs.initial,
            start: None,
            gap: 0,
            turn: 0,
        }
    }

    /// Begins at the equilibrium of y(0) and the inputs before it, and looks for where y began;
    /// gives y from its zero.
    #[inline(never)]
    pub(crate) fn begin<const N: usize>(&mut self, plan: &Plan<T, M, N, I>, y: f32) -> f32 {
        // Behind an integrator only increments count; small numbers keep their digits.
        let integrates = plan.structure.integrators() > 0;
        self.reference = if integrates { y } else { 0.0 };
        let y = y - self.reference;
        // A drive that integrates is in equilibrium under the initial inputs alone.
        let inputs = match integrates {
            true => &plan.inputs.initial,
            false => &{ self.last_inputs },
        };
        self.settle(plan, y, inputs);
        self.initial = 1.0;
        if plan.times.start.longest > 0 {
            self.start = Some(Start::new(y));
            let unit = Memory::output_at_rest(plan.trends.design(), plan.output_form, 1.0);
            self.gate.aside = Some((1.0, unit));
        }
        self.begun = true;
        y
    }

    /// All trends are those of an equilibrium at `y` with these inputs.
    #[inline(never)]
    fn settle<const N: usize>(&mut self, plan: &Plan<T, M, N, I>, y: f32, inputs: &[f32; I]) {
        let design = plan.trends.design();
        self.output = Memory::output_at_rest(design, plan.output_form, y);
        for c in 0..I {
            let (hold, value) = (plan.inputs.holds[c], inputs[c]);
            self.inputs[c] = Memory::input_at_rest(design, hold, value);
        }
        let integrates = plan.structure.integrators() > 0;
        let constant = if integrates { 0.0 } else { 1.0 };
        self.constant = Memory::input_at_rest(design, Hold::Zero, constant);
    }

    /// The trends begin again at rest at `y`; nothing of the initial state is left to be found.
    #[inline(never)]
    pub(crate) fn rest<const N: usize>(&mut self, plan: &Plan<T, M, N, I>, y: f32) {
        self.settle(plan, y, &plan.inputs.initial);
        self.initial = 0.0;
        // The mean innovation and what was set aside belong to the trends of before.
        (self.start, self.gate.aside) = (None, None);
        self.gate.mean = 0.0;
    }

    /// Takes a sample of the beginning whose trends have been computed; `noise` is the variance of
    /// y. Gives that of where y began, over that of y, once it is found.
    #[inline(never)]
    pub(crate) fn find_start<const N: usize>(
        &mut self,
        plan: &Plan<T, M, N, I>,
        y: f32,
        noise: f32,
    ) -> Option<f32> {
        let (Some(start), Some((_, unit))) = (&mut self.start, &mut self.gate.aside) else {
            return None;
        };
        enter(plan, unit, 0.0);
        let variance = match start.take(y, noise, plan.times.start) {
            Verdict::Wait => {
                self.remaining = self.remaining.max(1);
                return None;
            }
            Verdict::Begin(at) => {
                self.output.add(unit, at);
                start.variance()
            }
            Verdict::Stay => 1.0,
        };
        (self.start, self.gate.aside) = (None, None);
        Some(variance)
    }

    /// The trends of y.
    #[inline(always)]
    pub(crate) fn output_trends<const N: usize>(
        &mut self,
        plan: &Plan<T, M, N, I>,
        y: f32,
    ) -> Trends<M> {
        plan.trends.output(&mut self.output, y, plan.output_form)
    }

    /// Takes y into the trends without a row of it.
    pub(crate) fn enter_output<const N: usize>(&mut self, plan: &Plan<T, M, N, I>, y: f32) {
        enter(plan, &mut self.output, y);
    }

    /// What has decayed in the trends of y becomes zero before it becomes subnormal.
    pub(crate) fn flush_output(&mut self) {
        self.output.flush();
    }

    /// The same for the constant, and for the initial state, which ends at a millionth.
    pub(crate) fn flush_constant(&mut self) {
        self.constant.flush();
        flush(&mut self.initial, 1e-6);
    }

    /// The same for the inputs.
    pub(crate) fn flush_inputs(&mut self) {
        for input in &mut self.inputs {
            input.flush();
        }
    }

    /// Takes inputs; gives the trends of the inputs, of the constant and of the initial state.
    #[inline(always)]
    pub(crate) fn other_trends<const N: usize>(
        &mut self,
        plan: &Plan<T, M, N, I>,
        u: [f32; I],
    ) -> Others<M, I> {
        let acting = self.acting(plan, u);
        self.trends_under(plan, acting)
    }

    /// The same where code counts for more than time.
    #[inline(never)]
    pub(crate) fn other_trends_of_a_gap<const N: usize>(
        &mut self,
        plan: &Plan<T, M, N, I>,
        u: [f32; I],
    ) -> Others<M, I> {
        let acting = self.acting(plan, u);
        self.again(plan, acting)
    }

    /// The trends under inputs that are in their delay lines, behind trends that begin again.
    #[inline(never)]
    pub(crate) fn again<const N: usize>(
        &mut self,
        plan: &Plan<T, M, N, I>,
        acting: [f32; I],
    ) -> Others<M, I> {
        self.trends_under(plan, acting)
    }

    /// Takes inputs; gives those that act.
    #[inline(always)]
    fn acting<const N: usize>(&mut self, plan: &Plan<T, M, N, I>, u: [f32; I]) -> [f32; I] {
        self.last_inputs = u;
        let acting = self.delayed(plan, u);
        // Only beside an input of friction.
        if I > 1 {
            self.acting = acting;
        }
        acting
    }

    #[inline(always)]
    fn delayed<const N: usize>(&mut self, plan: &Plan<T, M, N, I>, u: [f32; I]) -> [f32; I] {
        if D == 0 {
            return u;
        }
        let mut acting = u;
        for (c, u) in acting.iter_mut().enumerate() {
            let (delay, part) = (plan.inputs.delays[c], plan.inputs.delay_parts[c]);
            *u = if part > 0.0 {
                self.lines[c].update_between(*u, delay, part)
            } else {
                self.lines[c].update(*u, delay)
            };
        }
        acting
    }

    #[inline(always)]
    fn trends_under<const N: usize>(
        &mut self,
        plan: &Plan<T, M, N, I>,
        acting: [f32; I],
    ) -> Others<M, I> {
        let mut inputs = [[0.0; M]; I];
        for c in 0..I {
            inputs[c] = plan
                .trends
                .input(&mut self.inputs[c], acting[c], plan.inputs.holds[c]);
        }
        Others {
            inputs,
            extra: self.extra_columns(plan),
            acting,
        }
    }

    /// Entries of the regressor for the constant and the initial state.
    #[inline(always)]
    fn extra_columns<const N: usize>(&mut self, plan: &Plan<T, M, N, I>) -> [f32; 2] {
        let constant = if plan.structure.constant() {
            let trends = plan.trends.input(&mut self.constant, 1.0, Hold::Zero);
            trends[0]
        } else {
            0.0
        };
        let initial = self.initial;
        self.initial = initial * plan.trends.design().slow_mode;
        [constant, initial]
    }
}

/// A sample into trends of y that no row needs: once in the image.
#[inline(never)]
fn enter<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize>(
    plan: &Plan<T, M, N, I>,
    memory: &mut T::Memory,
    y: f32,
) {
    let _ = plan.trends.output(memory, y, plan.output_form);
}

#[cfg(test)]
mod tests;
