//! Samples that are not of the model: the axis stands against it, or the drive has changed.

use crate::estimation::postponed::Postponed;
use crate::identifier::plan::Plan;
use crate::identifier::row::{Noise, Row};
use crate::identifier::signals::Others;
use crate::identifier::standstill::StandstillEvidence;
use crate::identifier::state::State;
use crate::identifier::witness::Witness;
use crate::trends::TrendOperator;

impl<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize, const D: usize>
    State<T, M, N, I, D>
{
    /// The first sample, or the first one behind trends that were forgotten: what the slow pole
    /// carries of such a beginning is another initial state.
    #[inline(never)]
    pub(super) fn begin(
        &mut self,
        plan: &Plan<T, M, N, I>,
        y: f32,
        witness: &mut impl Witness<M, N, I>,
    ) {
        let settled = self.signals.begin(plan, y);
        self.noise.settle(settled);
        witness.begin();
        if self.estimator.samples() > 0.0 {
            if plan.structure.initial_state() {
                let before = self.estimator.theta().last().copied().unwrap_or(0.0);
                witness.another_initial_state(before);
            }
            self.lose_initial_state(plan);
            witness.widened();
        }
    }

    /// Whether the drive has just changed, or the filter still carries what it was: the row is left
    /// out.
    #[inline(never)]
    pub(super) fn changing(
        &mut self,
        plan: &Plan<T, M, N, I>,
        row: Row<N>,
        moves: bool,
        witness: &mut impl Witness<M, N, I>,
    ) -> bool {
        let change = &mut self.change;
        if change.settling > 0 {
            change.settle(row.psi, plan.change_shares);
            if change.settling == 0 {
                self.lose_initial_state(plan);
                witness.widened();
            }
            return true;
        }
        let estimator = &self.estimator;
        let known = || estimator.spread(row.phi);
        if !moves || !change.found([row.error, row.psi], plan.change_shares, known) {
            return false;
        }
        change.answer(
            plan.forgetting,
            plan.times.change_settling,
            plan.times.change_blind,
        );
        self.remain_known();
        self.estimator.begin_again(&self.forgetting.left());
        self.begin_sums(plan);
        self.estimator.forget(true);
        self.postponed = Postponed::new(plan.forgetting);
        self.postponed.suspect();
        self.signals.gate.keep_open(plan.times.gate_open);
        self.changes = self.changes.saturating_add(1);
        witness.changed();
        true
    }

    /// Whether the row may be of the model; where the axis stands against it the trends begin again
    /// at rest.
    #[inline(always)]
    pub(super) fn obeys(
        &mut self,
        plan: &Plan<T, M, N, I>,
        row: &Row<N>,
        others: &Others<M, I>,
        y: f32,
        noise: Noise,
        witness: &mut impl Witness<M, N, I>,
    ) -> bool {
        if plan.sticks(&self.signals.last_inputs) {
            if let Some(y) = self.standstill.sticks(y, plan.times.gate_pause) {
                self.begin_at_rest(plan, y, others, witness);
            }
            return false;
        }
        let limits = [plan.times.certain, plan.times.settled];
        let noise = noise.known_or_infinite();
        let innovation = row.innovation;
        let unexplained = self.standstill.unexplained(y, innovation, noise);
        // A closure that grows is a call, and the row in its memory a copy in every sample.
        let unexplained = match unexplained {
            Some(sample) => {
                let [size, _] = sample;
                let contradicts = !(size <= noise)
                    && !(size <= noise + noise * self.estimator.spread(row.phi))
                    && self.is_known()
                    && self.standstill.exceeds_digits(sample);
                Some((sample, contradicts))
            }
            None => None,
        };
        let found = (self.standstill).classify(y, innovation, limits, unexplained);
        if let StandstillEvidence::Stands | StandstillEvidence::Freed = found {
            self.begin_at_rest(plan, y, others, witness);
        }
        if found == StandstillEvidence::Freed {
            self.lose_initial_state(plan);
            witness.widened();
        }
        found == StandstillEvidence::Obeys
    }

    /// Whether the row just folded in, of this `spread`, contradicts what was learnt, and is one of
    /// a drive that moves.
    ///
    /// Inside the band of standstill it may as well be one of an axis that is held: the row that
    /// leaves the band decides.
    #[inline(never)]
    pub(super) fn contradicted(
        &self,
        plan: &Plan<T, M, N, I>,
        error: f32,
        spread: f32,
        y: f32,
    ) -> bool {
        let least = plan.change_shares.least;
        Postponed::contradicted(&self.estimator, error, spread, least)
            && (!plan.can_stand || self.standstill.has_left(y))
    }

    /// A sample while no rows are taken.
    #[inline(never)]
    pub(super) fn go_without(&mut self) {
        if self.adapting {
            self.let_pass();
        }
    }

    /// A sample without a row: forgetting is owed, or done all the same behind another filter; a
    /// call goes on.
    #[inline(never)]
    pub(super) fn let_pass(&mut self) {
        if !self.learns {
            if !self.estimator.is_inflating() {
                self.begin_call();
            }
            self.estimator.inflate();
            self.learns = !self.estimator.is_inflating();
            self.postponed.postpone();
            return;
        }
        if self.postponed.pass() {
            self.estimator.pass();
            let _ = self.forgetting.turn(&mut self.estimator, false);
        }
    }

    /// The trends begin again at rest at `y`, with the inputs of this sample: they are in force
    /// from now on, should the axis break away before the next one.
    #[inline(never)]
    fn begin_at_rest(
        &mut self,
        plan: &Plan<T, M, N, I>,
        y: f32,
        others: &Others<M, I>,
        witness: &mut impl Witness<M, N, I>,
    ) {
        self.signals.rest(plan, y);
        self.start_error.end(1.0, plan.forgets);
        witness.begin();
        let others = self.signals.again(plan, others.acting);
        witness.inputs(&others.inputs, &others.acting);
    }

    /// The initial state is again as uncertain as at the start; where no column stands for it the
    /// sums go on without that of another beginning.
    #[inline(never)]
    fn lose_initial_state(&mut self, plan: &Plan<T, M, N, I>) {
        if !plan.structure.initial_state() {
            self.signals.initial = 0.0;
            return;
        }
        self.signals.initial = 1.0;
        // U ends with a 1: the last factor is the last variance.
        let last = |of: &[f32; N]| of.last().copied().unwrap_or(0.0);
        let std = last(&plan.prior.std);
        let missing = std * std - last(self.estimator.diagonal());
        if missing > 0.0 {
            self.estimator.inflate_last(missing);
        }
    }
}

#[cfg(test)]
mod tests;
