//! How the axis comes to rest at its target: held by friction, or behind a closed valve.

use crate::math::{sign, within};
use crate::servo::control::controller::Controller;
use crate::servo::control::holding::Slip;
use crate::servo::control::rest::INSIDE;
use crate::servo::design::constants::UNKNOWN_PART;
use crate::servo::model::Model;

/// Flow of offset and leaks beside which the valve closes all the same: where the axis then creeps,
/// the command that holds it is found, and that reaches farther.
const LEAKS: f32 = 0.01;
/// Windows by which the velocity of an axis that nothing holds may swing it once its valve is
/// closed: a swing that leaves the window decays meanwhile, and the valve closes again.
const SWING: f32 = 3.0;
/// Time over 1/w0 after which it no longer swings as it did when the valve closed: more than half a
/// period, in which it has been on both sides.
const SWUNG: f32 = 4.0;
/// Rate over a2, and over w0, at which a valve at rest leads an axis that nothing holds: see
/// [`lead`].
const LEAD: [f32; 2] = [0.25, 0.1];

impl Controller {
    /// A sample at a target at rest.
    ///
    /// What the integral action of an axis that nothing holds has found before it rests is the part
    /// of the dead zone that was not known: of the other sign in the other direction, and nothing
    /// behind a closed valve. It ends there.
    pub(super) fn come_to_rest(&mut self, target: f32) {
        let before = self.rest.rests();
        let error = target - self.estimator.now().position;
        let still = !before && self.is_still();
        self.rest.update(error, still);
        if self.rest.sticky() {
            return;
        }
        match (before, self.rest.rests()) {
            (false, true) => self.estimator.forget_disturbance(),
            (true, false) => self.creep(self.rest.rested_at() - error),
            _ => {}
        }
    }

    /// The command of a valve at rest.
    ///
    /// An axis that nothing holds is led back to its target, so slowly that it is stable whatever
    /// the delay, see [`lead`]: within the dead zone that moves nothing, and where the command that
    /// holds the axis is beyond it, by gravity or a leak, it is held there without a creep.
    pub(super) fn standing_command(&self, target: f32) -> f32 {
        let error = target - self.estimator.now().position;
        self.holding.command().unwrap_or(self.middle()) + self.rest.lead(error)
    }

    /// Whether the valve at rest, or friction behind it, holds the axis.
    pub(super) fn is_held_at_rest(&self) -> bool {
        self.rest.rests() && (self.sticks() || !self.rest.sticky())
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
        if self.rest.sticky() {
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
            way: moved.abs() * model.a1 / model.b0,
            settled: self.design.delay + SWUNG / self.frequency,
        };
        self.holding.slip(&slip, &self.edges());
    }
}

/// Command per unit of an error by which a valve at rest leads an axis that nothing holds.
///
/// ```text
/// L(s) = r w0^2 / (s (s^2 + a2 s + w0^2)),   r = C k = min(a2 / 4, w0 / 10)
/// ```
///
/// Beyond its crossover, near r, the loop is largest at its resonance, r / a2: with a quarter no
/// delay makes it unstable there, nor a mass that is three times as large, whose a2 is a third. At
/// the crossover a tenth of w0 leaves a margin of phase for a delay of ten times 1/w0.
pub(super) fn lead(model: &Model, frequency: f32) -> f32 {
    let [damped, slow] = [LEAD[0] * model.a2, LEAD[1] * frequency];
    let rate = if damped < slow { damped } else { slow };
    rate * model.a1 / model.b0
}

#[cfg(test)]
mod tests;
