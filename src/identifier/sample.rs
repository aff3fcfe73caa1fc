//! One sample: u and y to a row of the equation, and that into the estimate.

use crate::identifier::gaps::refused;
use crate::identifier::gate::SampleKind;
use crate::identifier::outcome::Outcome;
use crate::identifier::plan::Plan;
use crate::identifier::row::{Noise, Row};
use crate::identifier::signals::Others;
use crate::identifier::state::State;
use crate::identifier::witness::Witness;
use crate::trends::TrendOperator;

impl<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize, const D: usize>
    State<T, M, N, I, D>
{
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
            self.begin(plan, y, witness);
        }
        let position = y;
        let y = y - self.signals.reference;
        self.signals.gap = 0;
        self.signals.turn = self.signals.turn.wrapping_add(1);
        let turn = self.signals.turn;
        // With a memory the forgetting has samples with time for it.
        if turn.is_multiple_of(16) && !(plan.forgets && self.learns) {
            self.flush(turn / 16);
        }
        // Before the row: it moves theta.
        self.estimator.finish_observation();
        if I > 1 && plan.sticks(&u) {
            self.give_back(plan);
        }
        let others = self.signals.other_trends(plan, u);
        witness.inputs(&others.inputs, &others.acting);
        if self.signals.remaining > 0 {
            self.signals.last = y;
            self.noise.update(y);
            self.signals.enter_output(plan, y);
            self.signals.remaining -= 1;
            self.find_start(plan, y);
            self.prediction = position;
            return Outcome::WarmingUp {
                remaining: self.signals.remaining,
            };
        }
        let noise = Noise::of(&self.noise, plan.noise.least);
        let (mut row, third) = match self.screened(plan, y, &others, noise) {
            Ok(found) => found,
            Err(innovation) => return Outcome::Replaced { innovation },
        };
        self.signals.last = y;
        let lasting = third.is_none();
        self.noise
            .take(y, third.unwrap_or_else(|| self.noise.third_difference(y)));
        let innovation = row.innovation;
        self.prediction = position - innovation;
        self.errors.update(innovation);
        match lasting {
            // Two samples have entered the trends at once: the rest of this one is left out.
            true => Outcome::Held { innovation },
            false => self.learn(plan, &mut row, &others, [y, position], noise, witness),
        }
    }

    /// The row of y with the third difference that y makes, `None` where a change lasts; or the
    /// innovation of a sample that is replaced by its prediction.
    #[inline(always)]
    fn screened(
        &mut self,
        plan: &Plan<T, M, N, I>,
        y: f32,
        others: &Others<M, I>,
        noise: Noise,
    ) -> Result<(Row<N>, Option<f32>), f32> {
        let third = self.noise.third_difference(y);
        if !plan.has_gate {
            return Ok((self.row(plan, y, others), Some(third)));
        }
        let before = self.signals.output.clone();
        let row = self.row(plan, y, others);
        let gate = &mut self.signals.gate;
        let allowed = [noise.allowed, plan.noise.gate];
        match gate.classify(row.innovation, third, allowed, plan.times.gate_pause) {
            SampleKind::Plausible => Ok((row, Some(third))),
            SampleKind::Implausible => {
                gate.aside = Some((y, before.clone()));
                self.go_on(plan, before, others);
                Err(row.innovation)
            }
            SampleKind::Lasting => {
                let row = self.row_of_two(plan, y, others, row.innovation);
                Ok((row, None))
            }
        }
    }

    /// Takes the row of y in, from its zero and as it was given, unless the estimate is held.
    #[inline(always)]
    fn learn(
        &mut self,
        plan: &Plan<T, M, N, I>,
        row: &mut Row<N>,
        others: &Others<M, I>,
        [y, position]: [f32; 2],
        noise: Noise,
        witness: &mut impl Witness<M, N, I>,
    ) -> Outcome {
        let innovation = row.innovation;
        let obeys = !plan.can_stand || self.obeys(plan, row, others, y, noise, witness);
        if !self.learns {
            self.go_without();
            return Outcome::Held { innovation };
        }
        if plan.forgets {
            let moves = self.is_moving(plan, row, noise) && obeys;
            if plan.follows_changes && self.changing(plan, *row, moves, witness) {
                return Outcome::Held { innovation };
            }
            if !moves {
                self.let_pass();
                let turn = self.signals.turn;
                if turn.is_multiple_of(16) {
                    self.flush(turn / 16);
                }
                return Outcome::Held { innovation };
            }
            row.weigh(position, plan.noise.coarse);
            if self.beginning.lasts {
                self.sum_beginning(*row, true);
            }
            if self.forgetting.rests() && self.start_error.is_due(self.signals.turn) {
                self.heed_start(plan, &row.phi);
            }
            self.remember(plan, row, y, witness);
        } else if obeys {
            row.weigh(position, plan.noise.coarse);
            if self.beginning.lasts {
                self.sum_beginning(*row, false);
            }
            if self.start_error.is_due(self.signals.turn) {
                self.heed_start(plan, &row.phi);
            }
            let _ = self.estimator.fold(&row.phi, row.error);
            witness.row(&row.phi, row.psi, &self.estimator, true);
        } else {
            return Outcome::Held { innovation };
        }
        Outcome::Estimated { innovation }
    }

    /// Takes a row, which the estimator takes next, for the initial state of a structure without
    /// one.
    ///
    /// By value: a row whose address is taken is one in memory, in every sample.
    #[inline(never)]
    fn sum_beginning(&mut self, row: Row<N>, forgets: bool) {
        let (column, forgetting) = (self.signals.initial, self.estimator.forgets_for());
        self.beginning.take(&row.phi, row.psi, column, forgetting);
        self.beginning.end(column, forgets);
    }

    /// The part that is due of what an error of y(0) does to a structure with an initial state.
    #[inline(always)]
    fn heed_start(&mut self, plan: &Plan<T, M, N, I>, phi: &[f32; N]) {
        match self.start_error.wants_row() {
            true => self.sum_start(plan, *phi),
            false => self.step_start(plan),
        }
    }

    /// By value, as above.
    #[inline(never)]
    fn sum_start(&mut self, plan: &Plan<T, M, N, I>, phi: [f32; N]) {
        self.start_error
            .take(&phi, plan.times.start_pace, plan.forgets);
    }

    #[inline(never)]
    fn step_start(&mut self, plan: &Plan<T, M, N, I>) {
        let (design, forgetting) = (plan.trends.design(), self.estimator.forgets_for());
        self.start_error
            .advance(design, forgetting, plan.times.start_pace);
    }

    /// Looks for where y began, in samples without a row.
    #[inline(never)]
    fn find_start(&mut self, plan: &Plan<T, M, N, I>, y: f32) {
        if let Some(variance) = self.signals.find_start(plan, y, self.noise.known()) {
            self.start_error.variance = variance;
        }
        if self.start_error.is_due(self.signals.turn) {
            // The filter goes on; there is no row.
            self.heed_start(plan, &[0.0; N]);
        }
    }

    /// Whether the drive moves, or did so as lately as the trends show it.
    ///
    /// Noise as large as a motion would otherwise choose its rows one by one: those that it makes
    /// larger.
    #[inline(always)]
    fn is_moving(&mut self, plan: &Plan<T, M, N, I>, row: &Row<N>, noise: Noise) -> bool {
        if plan.moves(&row.phi, noise.known) {
            self.moving = plan.times.after_step;
            return true;
        }
        self.moving = self.moving.saturating_sub(1);
        self.moving > 0
    }

    /// Takes a row in with a memory, which forgets as much as the row before allowed for.
    #[inline(always)]
    fn remember(
        &mut self,
        plan: &Plan<T, M, N, I>,
        row: &Row<N>,
        y: f32,
        witness: &mut impl Witness<M, N, I>,
    ) {
        let forgot = self.postponed.forgets();
        let spread = self.estimator.fold(&row.phi, row.error);
        witness.row(&row.phi, row.psi, &self.estimator, forgot);
        let mut brings = true;
        if !self.postponed.is_usual(spread) {
            if self.postponed.is_owed() && self.contradicted(plan, row.error, spread, y) {
                // The rows that are left out meanwhile are those of the onset of a motion: noise
                // above all.
                self.learns = false;
                witness.widened();
                return;
            }
            brings = self.postponed.take(spread, &mut self.estimator);
        }
        if let Some(part) = self.forgetting.turn(&mut self.estimator, brings) {
            self.tidy(plan, part);
        }
    }

    /// Once in a while, in a sample with little else to do: whether nominal values may follow, and
    /// a part of [`flush`](Self::flush).
    ///
    /// They do while f32 resolves the position as well as the noise that is expected, or half as
    /// well as where it began.
    #[inline(never)]
    fn tidy(&mut self, plan: &Plan<T, M, N, I>, part: u32) {
        if part.is_multiple_of(8) {
            let far = self.position().abs();
            let resolved = far <= plan.noise.coarse || far <= 2.0 * self.signals.reference.abs();
            self.forgetting.heed(resolved);
        }
        self.flush(part);
    }

    /// Once in a while, a part at a time: what has decayed becomes zero before it becomes
    /// subnormal.
    #[inline(never)]
    fn flush(&mut self, part: u32) {
        match part % 8 {
            0 | 4 => self.signals.flush_output(),
            1 => self.signals.flush_inputs(),
            2 => self.estimator.flush_sums(),
            3 => self.noise.flush(),
            5 => self.signals.flush_constant(),
            6 => self.change.flush_lagged(),
            _ => self.change.flush_power(),
        }
    }
}

#[cfg(test)]
mod tests;
