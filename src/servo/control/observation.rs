//! What the controller sees: observer, anchor and offset of the valve; and where it begins.

use crate::math::{sign, within};
use crate::servo::control::anchor::Stiction;
use crate::servo::control::controller::Controller;
use crate::servo::control::holding::{Edges, Holding, Slip};
use crate::servo::control::hop::Hop;
use crate::servo::control::null::NullOffset;
use crate::servo::model::Model;
use crate::servo::motion::Motion;

/// Time constants of the observer in which it settles.
const SETTLING: f32 = 6.0;
/// Time over that of the observer after a breakaway in which the disturbance stays behind a moving
/// reference: three poles at the observer's rate are within a quarter of their way by then.
const STARTING: f32 = 4.0;
/// The same behind a stop in which what came before acts on the drive: errors of the observer are
/// within e^-30 of nothing, and a model that is wrong by half leaves e^-15.
const SETTLED: f32 = 30.0;
/// Least part of the friction that counts as the way of the drive to its edge.
const WAY_MIN: f32 = 0.2;

impl Controller {
    /// Begins at a motion, without an offset of earlier gains.
    pub fn place(&mut self, motion: Motion) {
        self.begin_at(motion, core::iter::empty());
    }

    fn begin_at(&mut self, motion: Motion, flows: impl Iterator<Item = f32>) {
        self.estimator.place(motion, flows);
        self.anchor.restart();
        self.transfer.settle();
        self.heading = 0.0;
        (self.pause, self.rested) = (0, 0);
        self.rest.wake();
    }

    /// Begins at a motion with a verified model and the latest commands, newest first, with no
    /// trace of earlier gains.
    pub(crate) fn begin(
        &mut self,
        model: Model,
        motion: Motion,
        commands: impl Iterator<Item = f32>,
    ) {
        self.transfer.forget_model();
        self.holding = Holding::NONE;
        self.hop = Hop::default();
        // The model contains all of its valve's offset.
        self.null = NullOffset::default();
        self.tune(model);
        let blend = self.design.blend;
        self.begin_at(motion, commands.map(|u| model.valve_flow_of(u, blend)));
    }

    /// Samples in which the observer settles: six of its time constants.
    pub(crate) fn settling(&self) -> u32 {
        let samples = SETTLING / (self.estimator.poles().observer * self.sample_time());
        1 + samples as u32
    }

    /// One sample in which somebody else controls: the observer settles.
    pub(crate) fn watch(&mut self, y: f32, command: f32) {
        self.observe(y, y, false);
        self.load.bear(self.steady());
        self.applied(command);
    }

    /// Control begins where the observer is.
    pub(crate) fn engage(&mut self) {
        self.transfer.settle();
        self.heading = sign(self.estimator.now().velocity);
        self.rest.wake();
    }

    /// Takes the command that was set, after range, rate and resolution of the valve.
    #[inline]
    pub fn applied(&mut self, command: f32) {
        // What the valve lets through at rest holds the axis: nothing is left of it.
        let flow = if self.rest.rests() && !self.centres() {
            self.rested = self.anchor.since();
            0.0
        } else {
            let flow = self.believed(self.estimator.model(), command);
            flow * self.load.passes(flow)
        };
        self.estimator.applied(flow);
    }

    /// The flow that the law meant by a command.
    fn believed(&self, model: &Model, command: f32) -> f32 {
        model.valve_flow_of(command + self.null.value(), self.design.blend)
    }

    /// Largest velocity that the observer sees of an axis that stands within the anchor's band.
    pub(super) fn standing(&self) -> f32 {
        self.design.anchor.band * self.estimator.poles().observer
    }

    /// One sample of the observer, with what friction holds.
    pub(super) fn observe(&mut self, y: f32, reference: f32, frozen: bool) {
        let now = *self.estimator.now();
        let slow = now.velocity.abs() < self.standing();
        let hold = if self.rest.sticky() {
            self.anchor.update(y, slow)
        } else {
            Stiction::Sliding
        };
        if let Stiction::Left(direction) = hold {
            let friction = self.estimator.model().friction;
            let slip = self.slip(direction);
            self.holding.slip(&slip, &self.edges());
            self.estimator.release(direction, y, friction);
            self.left = [reference - y, reference];
        }
        if hold == Stiction::Stuck {
            let (error, [before, from]) = (reference - y, self.left);
            let hop = error - before - (reference - from);
            let still = 2.0 * (reference - from).abs() < hop.abs();
            if error * before < 0.0 && still {
                self.rest.overshot(error);
            }
            let counts = !self.resumed() && still;
            self.hop.ended(sign(-hop), [before, error], counts);
            self.left[0] = 0.0;
            self.rested = 0;
        }
        let holds = self.is_held_at_rest();
        self.holding.pass(self.sample_time(), holds);
        let held = self.anchor.holds().then(|| self.anchor.place());
        let _ = self.estimator.update(y, held, frozen);
        if held.is_none() && !frozen {
            self.learn_null();
        }
    }

    /// Acceleration lost to friction, with the sign of the motion: at rest, all of the drive.
    pub(crate) fn friction_force(&self) -> f32 {
        if self.sticks() {
            return self.estimator.now().drive;
        }
        self.estimator.model().friction * sign(self.estimator.now().velocity)
    }

    /// A slip in a direction, as the model sees it.
    fn slip(&self, direction: f32) -> Slip {
        let (friction, drive) = (self.estimator.model().friction, self.estimator.now().drive);
        let (way, least) = (friction - direction * drive, WAY_MIN * friction);
        let way = if way > least { way } else { least };
        Slip {
            direction,
            way: way / self.estimator.step().b0,
            settled: self.design.delay + SETTLED / self.estimator.poles().observer,
        }
    }

    /// The valve as the model and what was learned of its offset see it.
    pub(super) fn edges(&self) -> Edges {
        Edges {
            middle: self.middle(),
            dead_zone: self.estimator.model().dead_zone,
        }
    }

    /// The command in the middle of the dead zone.
    pub(crate) fn middle(&self) -> f32 {
        -self.estimator.model().offset - self.null.value()
    }

    /// Whether the axis has just broken away.
    ///
    /// While it was held, the drive was only integrated, and how far beyond friction it broke away
    /// nobody measured: of the state it is the drive that is unknown. An integrator that took the
    /// error for a disturbance would keep it for 1/wd, and the axis would leave the reference to
    /// the other side.
    pub(super) fn starts(&self) -> bool {
        let time = self.sample_time() * self.anchor.since() as f32;
        self.rest.sticky() && time * self.estimator.poles().observer < STARTING
    }

    /// The offset of the valve from sliding both ways.
    fn learn_null(&mut self) {
        let flow = self.estimator.flow_in_force();
        if within(flow, self.design.blend) == flow {
            return;
        }
        let share = self.sample_time() * self.estimator.poles().disturbance;
        if let Some(step) = self.null.update(flow, self.disturbance(), share) {
            self.estimator.disturb(-step);
        }
    }
}

#[cfg(test)]
mod tests;
