//! Sample times without y: the model bridges them.
//!
//! A model that is not known bridges nothing: as a share of the motion its prediction may be off by
//! anything, and the trends carry that. The position stays instead, for as long as a drive of the
//! design size moves the trends by less than the expected noise of its samples does, and for one
//! sample always; behind a longer gap the trends begin anew, and the estimate with them:
//! the few rows before hold the noise of y(0) above all.
//!
//! Behind a gap that a model bridges the gate looks at the first reading as at any other: what made
//! readings fail may make one wrong, and where the axis went another way the second reading says
//! so. A position that stayed says nothing of where the axis is: there the gate is open.

use crate::identifier::outcome::Refusal;
use crate::identifier::plan::Plan;
use crate::identifier::signals::Others;
use crate::identifier::state::State;
use crate::identifier::witness::Witness;
use crate::trends::TrendOperator;
use crate::trends::delay_line::acceptable;

impl<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize, const D: usize>
    State<T, M, N, I, D>
{
    /// Lets the trends of y, from what they were before the sample, go on with the prediction.
    ///
    /// The estimator is left alone. For a sample that was replaced that is all: nothing learnt,
    /// nothing forgotten, P as it was. A sample without y is time that passed; [`skip`](Self::skip)
    /// adds that forgetting is owed.
    #[inline(never)]
    pub(super) fn go_on(
        &mut self,
        plan: &Plan<T, M, N, I>,
        before: T::Memory,
        others: &Others<M, I>,
    ) {
        // From the newest y: that of a spike would leave no digits.
        let last = self.signals.last;
        self.signals.output = before.clone();
        let row = self.row(plan, last, others);
        let predicted = last - (row.innovation - self.signals.gate.mean);
        let settled = self.signals.remaining == 0
            && plan.trends.design().filter.is_some()
            && (self.signals.gap == 0 || self.is_known());
        let predicted = match settled && acceptable(predicted, plan.output_limit) {
            true => predicted,
            false => last,
        };
        self.signals.output = before;
        self.signals.enter_output(plan, predicted);
        self.signals.last = predicted;
        self.noise.pass(predicted);
        self.prediction = predicted + self.signals.reference;
        self.replaced = self.replaced.saturating_add(1);
        self.signals.remaining = self.signals.remaining.saturating_sub(1);
    }

    /// One sample time without y: the trends go on with what the model predicts under the inputs
    /// `u`.
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
        let known = self.is_known();
        let longest = match known {
            true => plan.times.longest_gap,
            false => plan.times.unknown_gap,
        };
        if self.signals.gap > longest {
            if !known {
                self.unlearn(plan);
                witness.changed();
            }
            self.restart(plan);
            return;
        }
        self.signals.start = None;
        self.start_error.end(1.0, plan.forgets);
        let others = self.signals.other_trends_of_a_gap(plan, u);
        witness.inputs(&others.inputs, &others.acting);
        let before = self.signals.output.clone();
        self.signals.gate.aside = None;
        if !known {
            self.signals.gate.keep_open(plan.times.gate_pause);
        }
        self.go_on(plan, before, &others);
        if plan.forgets && self.adapting {
            self.let_pass();
        }
    }

    /// One sample time without y, under the newest inputs.
    fn skip_held(&mut self, plan: &Plan<T, M, N, I>, witness: &mut impl Witness<M, N, I>) {
        self.skip(plan, self.signals.last_inputs, witness);
    }

    /// So many sample times without y, under the newest inputs.
    pub(crate) fn skip_all(
        &mut self,
        plan: &Plan<T, M, N, I>,
        samples: u32,
        witness: &mut impl Witness<M, N, I>,
    ) {
        for _ in 0..samples.min(plan.times.longest_gap.saturating_add(1)) {
            self.skip_held(plan, witness);
        }
    }

    /// A refused sample is a sample time without y; inputs that cannot be taken stay what they
    /// were.
    #[inline(never)]
    pub(super) fn refuse(
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
}

/// Why this sample may not enter any buffer; `None` for a good one.
#[inline(always)]
pub(super) fn refused<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize>(
    plan: &Plan<T, M, N, I>,
    u: &[f32; I],
    y: f32,
) -> Option<Refusal> {
    if !acceptable(y, plan.output_limit) {
        return Some(Refusal::Output);
    }
    for (input, (u, limit)) in u.iter().zip(&plan.inputs.limit).enumerate() {
        if !acceptable(*u, *limit) {
            return Some(Refusal::Input(input));
        }
    }
    None
}

#[cfg(test)]
mod tests;
