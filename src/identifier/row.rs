//! One row of the equation: the regressor, and what is left of the left-hand side.

use crate::estimation::noise_level::NoiseLevel;
use crate::identifier::plan::Plan;
use crate::identifier::signals::Others;
use crate::identifier::state::State;
use crate::trends::TrendOperator;

/// Part of an implausible innovation below which the next one, implausible too, has another cause:
/// of a position that has changed they are alike, of an error s on a prediction that is off by p
/// the next is p of p + s. How far a change may have gone back by then is not derived: with 0.5
/// changes of the drive are followed late.
const WRONG: f32 = 0.05;

/// One over the third difference that noise does not make, in standard deviations of y: 4 times
/// sqrt(20).
const STEP: f32 = 1.0 / 18.0;

/// The regressor with its equation error, and that as an innovation in the unit of y.
#[derive(Clone, Copy)]
pub(super) struct Row<const N: usize> {
    pub(super) phi: [f32; N],
    pub(super) psi: f32,
    pub(super) error: f32,
    pub(super) innovation: f32,
}

impl<const N: usize> Row<N> {
    /// Weighs the row by how well it is resolved at the position `y`: beyond `coarse` f32 resolves
    /// y worse than the noise that is expected, and the row is divided by how much worse. Its
    /// digits would outweigh nominal values that nothing supports.
    #[inline(always)]
    pub(super) fn weigh(&mut self, y: f32, coarse: f32) {
        let far = y.abs();
        if far > coarse {
            let weight = coarse / far;
            self.phi = self.phi.map(|x| x * weight);
            self.psi *= weight;
            self.error *= weight;
        }
    }
}

/// Variance of the noise of y.
#[derive(Clone, Copy)]
pub(super) struct Noise {
    /// As measured; -1 while it is not known.
    pub(super) known: f32,
    /// That, but never less than a share of the expected one.
    pub(super) allowed: f32,
}

impl Noise {
    #[inline(always)]
    pub(super) fn of(level: &NoiseLevel, least: f32) -> Self {
        let known = level.known();
        let allowed = if known > least { known } else { least };
        Self { known, allowed }
    }

    /// The variance that is allowed; infinite, so that nothing exceeds it, while the noise is not
    /// known.
    #[inline(always)]
    pub(super) fn known_or_infinite(self) -> f32 {
        if self.known < 0.0 {
            f32::INFINITY
        } else {
            self.allowed
        }
    }
}

impl<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize, const D: usize>
    State<T, M, N, I, D>
{
    /// The row that y makes with the trends of everything else.
    #[inline(always)]
    pub(super) fn row(&mut self, plan: &Plan<T, M, N, I>, y: f32, others: &Others<M, I>) -> Row<N> {
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

    /// The row of y after all, where the sample before was replaced, too.
    ///
    /// That should not have been where this `innovation` is off their mean as the one of then was.
    /// Where it is by a small part of that, as of a prediction behind a gap, that one was wrong.
    #[inline(never)]
    pub(super) fn row_of_two(
        &mut self,
        plan: &Plan<T, M, N, I>,
        y: f32,
        others: &Others<M, I>,
        innovation: f32,
    ) -> Row<N> {
        if let Some((newest, memory)) = self.signals.gate.aside.take() {
            self.signals.output = memory;
            let predicted = self.signals.last;
            let (before, now) = (newest - predicted, innovation - self.signals.gate.mean);
            if !(now.abs() < WRONG * before.abs()) {
                self.noise.correct_newest(newest);
                self.signals.enter_output(plan, newest);
                self.replaced = self.replaced.saturating_sub(1);
            } else {
                self.signals.enter_output(plan, predicted);
            }
        }
        // Beyond all noise: the trends carry this step of the position or of the velocity for a
        // while.
        let third = self.noise.third_difference(y) * STEP;
        if third * third > Noise::of(&self.noise, plan.noise.least).allowed {
            self.standstill.pause(plan.times.after_step);
        }
        let row = self.row(plan, y, others);
        self.signals.gate.mean = row.innovation;
        row
    }
}

#[cfg(test)]
mod tests;
