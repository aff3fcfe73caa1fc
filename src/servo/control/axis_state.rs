//! The state of the axis and how it goes on: a drive of third order with friction and a
//! disturbance.

use crate::math::{sign, within};
use crate::servo::model::Model;
use crate::servo::motion::Motion;

/// Position, velocity, drive p and rate of the disturbance.
///
/// ```text
/// x' = v     v' = p - a2 v - friction sgn v     p' = - a1 v + b0 f(t - T) + d     d' = 0
/// ```
///
/// The *drive* p is the acceleration that the force of the drive alone would give; at rest it goes
/// on while friction holds the axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct AxisState {
    pub(crate) position: f32,
    pub(crate) velocity: f32,
    pub(crate) drive: f32,
    pub(crate) disturbance: f32,
}

/// Coefficients of a step at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Step {
    time: f32,
    pub(crate) a1: f32,
    pub(crate) a2: f32,
    pub(crate) b0: f32,
    /// a1 and b0 times the time.
    pub(super) pull: f32,
    push: f32,
    /// 1 / (1 + a2 time/2).
    damped: f32,
    /// Velocity that friction takes in a sample.
    held: f32,
}

impl AxisState {
    /// One sample on, with friction as a soft threshold on the velocity: no velocity within it is
    /// left over.
    ///
    /// Trapezoids: for an undamped drive the step turns the state without growth. Cost: about 25
    /// instructions.
    #[inline]
    pub(crate) fn advance(&mut self, flow: f32, step: &Step) {
        let t = step.time;
        let gain = step.push * flow + t * self.disturbance;
        let reached = self.drive + gain - step.pull * self.velocity;
        let half = 0.5 * t;
        let free = self.velocity + half * (self.drive + reached - step.a2 * self.velocity);
        let v = step.damped * (free - within(free, step.held));
        let mean = 0.5 * (self.velocity + v);
        self.drive += gain - step.pull * mean;
        self.position += t * mean;
        self.velocity = v;
    }

    /// One sample on while friction holds.
    #[inline]
    pub(crate) fn hold(&mut self, flow: f32, step: &Step) {
        // A closed valve lets no offset through.
        if flow != 0.0 {
            self.drive += step.push * flow + step.time * self.disturbance;
        }
    }

    /// The motion of a state; `held`: friction holds the axis.
    pub(crate) fn motion(&self, model: &Model, held: bool) -> Motion {
        let velocity = self.velocity;
        let acceleration = if held {
            0.0
        } else {
            let force = self.drive - model.a2 * velocity;
            let sliding = match sign(velocity) {
                0.0 => within(force, model.friction),
                way => way * model.friction,
            };
            force - sliding
        };
        Motion {
            position: self.position,
            velocity,
            acceleration,
        }
    }
}

impl Step {
    /// The step of a model as it is in the middle.
    pub(crate) fn of(model: &Model, time: f32) -> Self {
        let mut step = Self {
            time,
            a1: 0.0,
            a2: model.a2,
            b0: 0.0,
            pull: 0.0,
            push: 0.0,
            damped: 1.0 / (1.0 + 0.5 * model.a2 * time),
            held: model.friction * time,
        };
        step.go(model, 1.0);
        step
    }

    /// To where the model is so many times as stiff as in the middle. Cost: about 10 instructions.
    #[inline]
    pub(crate) fn go(&mut self, model: &Model, stiffness: f32) {
        self.a1 = stiffness * model.a1;
        self.b0 = stiffness * model.b0;
        self.pull = self.time * self.a1;
        self.push = self.time * self.b0;
    }
}
