//! What a width that is not known does to the estimate.

use crate::estimation::mean_square::flush;
use crate::estimation::rls::Estimator;
use crate::identifier::plan::Plan;
use crate::identifier::witness::Witness;
use crate::math::{larger, sign, smaller};
use crate::trends::{Hold, Memory, TrendOperator};

/// A sum that has decayed beyond any use, normalised.
const DECAYED: f32 = 1e-25;

/// Samples after which what has decayed becomes zero.
const FLUSHED: u32 = 256;

/// What the rows miss if the dead zone is as wide as it may be; see [`Valved`](super::Valved).
#[derive(Debug, Clone, PartialEq)]
pub(super) struct WidthError<S, const N: usize> {
    /// The largest width that is possible, in the unit of u.
    width: f32,
    /// F e; `None` at rest.
    memory: Option<S>,
    /// F e of the newest sample, as the column of b_0.
    column: f32,
    /// r = sum phi F e, normalised.
    scores: [f32; N],
    /// Smallest command so far that the inputs have not as 0.
    lowest: f32,
    /// Scale of the column of b_0; 0 where there is none.
    scale: f32,
    /// Samples, modulo 2^32.
    turn: u32,
}

impl<S, const N: usize> WidthError<S, N> {
    /// Nothing was seen; no dead zone is wider than `largest`.
    pub(super) const fn new(largest: f32, scale: f32) -> Self {
        Self {
            width: largest,
            memory: None,
            column: 0.0,
            scores: [0.0; N],
            lowest: f32::INFINITY,
            scale,
            turn: 0,
        }
    }

    /// r.
    pub(super) const fn scores(&self) -> &[f32; N] {
        &self.scores
    }

    /// From now on no larger width than this is possible.
    ///
    /// Of the commands so far a smaller width misses no larger share than of the smallest one: the
    /// sums become as much smaller. Of a larger one they know nothing more.
    pub(super) fn set_width<const M: usize>(&mut self, width: f32)
    where
        S: Memory<M>,
    {
        let missed = |width: f32| larger(width - self.lowest, 0.0);
        let [before, after] = [missed(self.width), missed(width)];
        self.width = width;
        if !(after < before) {
            return;
        }
        let share = after / before;
        self.scores = self.scores.map(|sum| share * sum);
        self.column *= share;
        if let Some(memory) = &mut self.memory {
            let whole = memory.clone();
            memory.add(&whole, share - 1.0);
        }
    }

    /// What takes a sample along.
    #[inline(always)]
    pub(super) fn seen<'a, T, const M: usize, const I: usize>(
        &'a mut self,
        plan: &'a Plan<T, M, N, I>,
    ) -> Seen<'a, T, M, N>
    where
        T: TrendOperator<M, Memory = S>,
    {
        Seen {
            error: self,
            trends: &plan.trends,
            hold: plan.inputs.holds.first().copied().unwrap_or(Hold::Zero),
            forgetting: plan.forgetting,
        }
    }

    /// What has decayed becomes zero before it becomes subnormal.
    #[inline(never)]
    fn flush<const M: usize>(&mut self)
    where
        S: Memory<M>,
    {
        if let Some(memory) = &mut self.memory {
            memory.flush();
        }
        for sum in &mut self.scores {
            flush(sum, DECAYED);
        }
    }
}

/// Takes the samples of an identifier along.
pub(super) struct Seen<'a, T: TrendOperator<M>, const M: usize, const N: usize> {
    error: &'a mut WidthError<T::Memory, N>,
    trends: &'a T,
    hold: Hold,
    /// lambda.
    forgetting: f32,
}

impl<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize> Witness<M, N, I>
    for Seen<'_, T, M, N>
{
    fn begin(&mut self) {
        self.error.memory = None;
    }

    /// A command that the inputs have as 0 passes no width that is possible.
    #[inline(always)]
    fn inputs(&mut self, _: &[[f32; M]; I], acting: &[f32; I]) {
        let u = acting.first().copied().unwrap_or(0.0);
        let error = &mut *self.error;
        error.turn = error.turn.wrapping_add(1);
        if error.turn.is_multiple_of(FLUSHED) {
            error.flush();
        }
        if u != 0.0 {
            error.lowest = smaller(u.abs(), error.lowest);
        }
        let missed = sign(u) * larger(error.width - u.abs(), 0.0);
        let at_rest = || Memory::input_at_rest(self.trends.design(), self.hold, 0.0);
        let memory = error.memory.get_or_insert_with(at_rest);
        let trends = self.trends.input(memory, missed, self.hold);
        error.column = error.scale * trends.first().copied().unwrap_or(0.0);
    }

    #[inline(always)]
    fn row(&mut self, phi: &[f32; N], _: f32, _: &Estimator<N>, forgot: bool) {
        let kept = if forgot { self.forgetting } else { 1.0 };
        let column = self.error.column;
        for (sum, phi) in self.error.scores.iter_mut().zip(phi) {
            *sum = kept * *sum + column * phi;
        }
    }

    fn changed(&mut self) {
        self.error.scores = [0.0; N];
    }
}

#[cfg(test)]
mod tests;
