//! How the axis comes to rest at its target: held by friction, or behind a closed valve.

use crate::math::{sign, within};
use crate::servo::control::controller::Controller;
use crate::servo::control::holding::Slip;
use crate::servo::control::rest::INSIDE;
use crate::servo::design::constants::UNKNOWN_PART;

/// Flow of offset and leaks beside which the valve closes all the same: where the axis then creeps,
/// the command that holds it is found, and that reaches farther.
const LEAKS: f32 = 0.01;
/// Windows by which the velocity of an axis that nothing holds may swing it once its valve is
/// closed: a swing that leaves the window decays meanwhile, and the valve closes again.
const SWING: f32 = 3.0;
/// Time over 1/w0 after which it no longer swings as it did when the valve closed.
const SWUNG: f32 = 2.0;

impl Controller {
    /// A sample at a target at rest.
    ///
    /// What the integral action of an axis that nothing holds has found before it rests is the part
    /// of the dead zone that was not known: of the other sign in the other direction, and nothing
    /// behind a closed valve. It ends there.
    pub(super) fn come_to_rest(&mut self, target: f32) {
        let before = self.rest.rests();
        let error = target - self.estimator.now().position;
        let still = self.is_still();
        self.rest.update(error, still);
        if self.sticky {
            return;
        }
        match (before, self.rest.rests()) {
            (false, true) => self.estimator.forget_disturbance(),
            (true, false) => self.creep(self.rest.rested_at() - error),
            _ => {}
        }
    }

    /// Whether the valve may close: friction holds the axis, or it comes to rest by itself.
    ///
    /// Behind a closed valve an axis that nothing holds is a mass on the stiffness of its drive: a
    /// velocity v swings it by `v / w0` at most about where its drive comes to nothing, and that
    /// decays, however small the damping is. Without a leak it then stands wherever it is, which no
    /// control behind a dead zone that is not known exactly can do: there the commands of noise
    /// reach from one edge to the other. Where integral action has found more than what may not be
    /// known of the dead zone, it is an offset or a force, and a closed valve does not hold the
    /// axis.
    fn is_still(&self) -> bool {
        if self.sticky {
            return self.anchor.holds();
        }
        let found = self.disturbance();
        let unknown = UNKNOWN_PART * self.estimator.model().dead_zone + LEAKS;
        let slow = SWING * self.frequency * self.rest.window();
        within(found, unknown) == found && self.estimator.now().velocity.abs() < slow
    }

    /// The axis has left its window behind a closed valve by so much: a leak, gravity or an offset
    /// that is not known moves it, and the valve closes elsewhere the next time.
    fn creep(&mut self, moved: f32) {
        if !(moved.abs() > INSIDE * self.rest.window()) {
            return;
        }
        let model = self.estimator.model();
        let slip = Slip {
            direction: sign(moved),
            friction: moved.abs() * model.a1 / model.b0,
            drive: 0.0,
            settled: self.design.delay + SWUNG / self.frequency,
            middle: self.middle(),
            dead_zone: model.dead_zone,
        };
        self.holding.slip(&slip);
    }
}

#[cfg(test)]
mod tests;
