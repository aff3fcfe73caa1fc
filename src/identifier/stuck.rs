//! Friction that holds the axis against its command: what did not act is taken out of the trends.
//!
//! ```text
//! y' = 0 at both ends of an interval   and   |b u + d| <= 2 |c|        u and 1 were 0 in it
//! ```
//!
//! A model `y'' + a y' = b u + d - c sgn y'` has the right-hand side 0 while friction holds the
//! axis; with sgn y' = 0 alone it has `b u + d`, which the trends carry for the memory of their
//! filter. So the command of an interval is given back once it is over.
//!
//! A measured velocity is 0 now and then while the drive turns, and then the command did act. The
//! size of the command decides which it was: an axis breaks away at the friction of rest, which is
//! seldom more than twice that of motion. Friction that is not known (three standard deviations)
//! holds nothing. Only the decision depends on the estimate: what enters the equation does not.
//!
//! This is a matter of forces, one integration before the velocity: of models of order 1 and 2,
//! whose inputs have a b_0 and no more. Others leave the rows out and give nothing back.

use crate::estimation::terms::Parameter;
use crate::identifier::plan::Plan;
use crate::identifier::state::State;
use crate::trends::{Hold, TrendOperator};

/// Friction of rest over that of motion up to which the axis may stand, squared.
const HOLDS: f32 = 4.0;

/// Standard deviations from zero at which a friction is known, squared.
const KNOWN: f32 = 9.0;

impl<T: TrendOperator<M>, const M: usize, const N: usize, const I: usize, const D: usize>
    State<T, M, N, I, D>
{
    /// Before the inputs of a sample whose velocity is given as 0 since the one before.
    #[inline(never)]
    pub(super) fn give_back(&mut self, plan: &Plan<T, M, N, I>) {
        if M > 2 || !self.friction_holds(plan) {
            return;
        }
        let signals = &mut self.signals;
        for (c, hold) in plan.inputs.holds.iter().enumerate() {
            if let (Hold::Zero, Some(memory), Some(u)) =
                (hold, signals.inputs.get_mut(c), signals.acting.get(c))
            {
                plan.trends.withdraw(memory, *u);
            }
        }
        if plan.structure.constant() {
            plan.trends.withdraw(&mut signals.constant, 1.0);
        }
    }

    /// Whether friction may hold the axis against the newest inputs.
    fn friction_holds(&self, plan: &Plan<T, M, N, I>) -> bool {
        let Some(noise) = self.estimator.noise_variance() else {
            return false;
        };
        let units = plan.regressor.units();
        let (mut drive, mut friction, mut variance) = (0.0, 0.0, 0.0);
        for (j, parameter) in plan.structure.parameters().into_iter().enumerate() {
            let value = units[j] * self.estimator.theta()[j];
            match parameter {
                Parameter::Input { input, power: 0 } if plan.friction_input() == Some(input) => {
                    friction = value;
                    variance = units[j] * units[j] * noise * self.estimator.covariance(j, j);
                }
                Parameter::Input { input, power: 0 } => {
                    drive += value * self.signals.acting.get(input).copied().unwrap_or(0.0);
                }
                Parameter::Input { .. } => return false,
                Parameter::Constant => drive += value,
                Parameter::Output { .. } | Parameter::InitialState => {}
            }
        }
        let square = friction * friction;
        square > KNOWN * variance && drive * drive <= HOLDS * square
    }
}

#[cfg(test)]
mod tests;
