//! The control law: state feedback while the axis slides, a push while friction holds it, and the
//! stop by friction.

use crate::math::{sign, within};
use crate::servo::control::axis_state::AxisState;
use crate::servo::control::controller::Controller;
use crate::servo::control::poles::Feedback;
use crate::servo::motion::Setpoint;

/// Largest speed over C at which an error of the position is worked off.
const CATCH_UP: f32 = 0.3;
/// Stopping deceleration over friction: below the first it is left to friction, beyond the second
/// it would reverse the drive.
const NEED: [f32; 2] = [0.15, 3.0];
/// Rate at which the drive of a sticking axis is brought to its goal, per delay and per sample.
const QUICK: [f32; 2] = [1.0, 0.3];
/// Drive over friction that counts as the middle of what friction holds.
const CENTRED: f32 = 0.6;
/// Drive over friction towards a target that a slow axis has not reached: friction is not known
/// better, and an axis with no more than that stops anywhere.
const BEYOND: f32 = 1.2;
/// Distance over friction deflection within which a slow axis stops by its friction.
const NEAR: f32 = 3.0;

impl Controller {
    /// The command that brakes to velocity zero, wherever that is; [`Controller::applied`] must
    /// follow.
    pub(crate) fn brake(&mut self, y: f32) -> f32 {
        self.observe(y, y, true);
        let model = self.estimator.model();
        if self.sticks() {
            return self.middle();
        }
        let feedback = self.feedback();
        let [_, k1, k2] = feedback.k;
        let AxisState {
            velocity: v,
            drive: p,
            disturbance: d,
            ..
        } = *self.estimator.ahead();
        let friction = model.friction * sign(v);
        let flow = (k2 * (friction - p) - k1 * v - d) / self.estimator.step().b0;
        self.load.bear(self.steady());
        let flow = flow / self.load.passes(flow);
        within(
            model.valve_command(flow, self.design.blend) - self.null.value(),
            1.0,
        )
    }

    /// Follows the sign of the next motion; its rate per s.
    #[inline]
    pub(super) fn head(&mut self, r: &Setpoint) -> f32 {
        let poles = self.estimator.poles();
        let next = self.next_direction(r, 1.0 / poles.observer);
        let rate = 0.5 * poles.observer * (next - self.heading);
        self.heading += self.design.estimator.sample_time * rate;
        rate
    }

    /// Direction of the reference a time from now; 0 at rest.
    #[inline]
    fn next_direction(&self, r: &Setpoint, time: f32) -> f32 {
        sign(r.velocity + time * r.acceleration)
    }

    /// Bears the drive that the reference takes; of an axis that is held it takes none.
    #[inline(always)]
    pub(super) fn bear(&mut self, r: &Setpoint) {
        let drive = if self.sticks() {
            0.0
        } else {
            let friction = self.estimator.model().friction * self.heading;
            r.acceleration + self.estimator.step().a2 * r.velocity + friction
        };
        self.load.bear(drive);
    }

    /// The drive that the present motion takes where it is steady.
    pub(super) fn steady(&self) -> f32 {
        let velocity = self.estimator.now().velocity;
        self.estimator.step().a2 * velocity + self.estimator.model().friction * sign(velocity)
    }

    fn feedback(&self) -> Feedback {
        let (step, poles) = (self.estimator.step(), self.estimator.poles());
        let w = self.frequency * self.estimator.frequency_ratio();
        poles.feedback(step.a1, step.a2, w)
    }

    /// The control law at the present state, within the full command.
    #[inline(always)]
    pub(super) fn law(&self, r: &Setpoint, at_rest: bool, heading_rate: f32) -> f32 {
        let model = self.estimator.model();
        if self.rest.rests() && !self.centres() {
            return self.standing_command(r.position);
        }
        let rate = if self.rest.rests() {
            -self.quick() * self.estimator.ahead().drive
        } else if self.sticks() {
            self.break_away(r, at_rest, heading_rate)
        } else {
            self.slide(r, at_rest, heading_rate)
        };
        let flow = (rate - self.estimator.ahead().disturbance) / self.estimator.step().b0;
        let flow = self.with_room(flow, r);
        let flow = flow / self.load.passes(flow);
        within(
            model.valve_command(flow, self.design.blend) - self.null.value(),
            1.0,
        )
    }

    /// Whether the drive of an axis that is held comes to the middle of what friction holds, which
    /// an axis that slips from its rest needs: it stopped at the edge, where a small drift is
    /// enough.
    pub(super) fn centres(&self) -> bool {
        let drive = self.estimator.ahead().drive;
        let most = CENTRED * self.estimator.model().friction;
        self.holding.has_slipped() && self.sticks() && within(drive, most) != drive
    }

    pub(super) fn quick(&self) -> f32 {
        let [per_delay, per_sample] = QUICK;
        let t = self.design.estimator.sample_time;
        let (slow, fast) = (per_delay / (self.design.delay + t), per_sample / t);
        if slow < fast { slow } else { fast }
    }

    /// Rate of the drive while the axis slides.
    #[inline]
    pub(super) fn slide(&self, r: &Setpoint, at_rest: bool, heading_rate: f32) -> f32 {
        let model = self.estimator.model();
        let step = self.estimator.step();
        let state = self.estimator.ahead();
        let error = r.position - state.position;
        if at_rest && self.rest.sticky() && self.stops_by_friction(error, state) {
            let goal = self.stopping_drive(error, state.velocity);
            return self.quick() * (goal - state.drive) + step.a1 * state.velocity;
        }
        let Feedback { k: [k0, k1, k2], p } = self.feedback();
        let friction = model.friction * self.heading;
        let pull = within(k0 * error, p[1] * CATCH_UP * model.b0 / model.a1);
        r.jerk
            + step.a2 * r.acceleration
            + step.a1 * r.velocity
            + model.friction * heading_rate
            + k2 * (r.acceleration + step.a2 * r.velocity + friction - state.drive)
            + k1 * (r.velocity - state.velocity)
            + pull
    }

    /// The drive with which friction stops the axis at the target.
    ///
    /// Of a velocity that may be none the sign is noise, and a drive that follows it swings from
    /// one edge of friction to the other: so much of it as the velocity is of the largest that an
    /// axis at rest shows, and for the rest one that points to the target.
    #[inline]
    fn stopping_drive(&self, error: f32, velocity: f32) -> f32 {
        let friction = self.estimator.model().friction;
        let moving = stopping_drive(error, velocity, friction);
        let share = velocity.abs() / self.standing();
        if share < 1.0 {
            let window = self.rest.window();
            let toward = if window > 0.0 {
                within(error / window, BEYOND)
            } else {
                BEYOND * sign(error)
            };
            share * moving + (1.0 - share) * friction * toward
        } else {
            moving
        }
    }

    /// Whether friction rules the rest of the way to a target at rest.
    #[inline]
    fn stops_by_friction(&self, error: f32, state: &AxisState) -> bool {
        let model = self.estimator.model();
        let wc = self.estimator.poles().bandwidth;
        let slow = within(state.velocity * wc, model.friction) == state.velocity * wc;
        slow && within(error * model.a1, NEAR * model.friction) == error * model.a1
    }
}

/// The drive with which friction stops the axis at the target: `friction - v^2/(2 distance)` along
/// the motion.
#[inline]
fn stopping_drive(error: f32, velocity: f32, friction: f32) -> f32 {
    let direction = sign(velocity);
    let distance = direction * error;
    let [least, most] = NEED;
    let need = if distance > 0.0 {
        let need = velocity * velocity / (2.0 * distance);
        if need < least * friction {
            0.0
        } else if need < most * friction {
            need
        } else {
            most * friction
        }
    } else {
        most * friction
    };
    let along = if direction == 0.0 {
        sign(error)
    } else {
        direction
    };
    along * (friction - need)
}

#[cfg(test)]
pub(crate) mod tests;
