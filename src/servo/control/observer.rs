//! Observer of velocity, acceleration and disturbance on the identified model.

use crate::math::within;
use crate::servo::control::friction::StickSlip;
use crate::servo::design::ObserverDesign;
use crate::servo::design::constants::{DISTURBANCE_MAX, DISTURBANCE_POLE_RATIO};
use crate::servo::model::Model;
use crate::servo::motion::Motion;

/// Luenberger observer with a constant disturbance at the input of the model, and friction that sticks beside it.
///
/// ```text
/// x' = v      v' = a      a' = - a1 v - a2 a + b0 (flow + d)      d' = 0
/// correction by (y - x): l1, l2, l3, l4 times Delta
/// s^4 + (l1+a2) s^3 + (l2+a2 l1+a1) s^2 + (l3+a2 l2+a1 l1) s + b0 l4 = (s + w)^3 (s + 0.3 w)
/// without disturbance:  l4 = 0 and the first four terms divided by s are (s + w)^3
/// ```
///
/// d is what the controller subtracts: it is the integral action, and because the
/// observer sees the command that was set it does not wind up.
///
/// Known as: Luenberger observer (Luenberger 1964), extended state observer (Han 2009).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Observer {
    design: ObserverDesign,
    model: Model,
    motion: Motion,
    disturbance: f32,
    friction: StickSlip,
    gain: [f32; 4],
}

impl Observer {
    /// An observer at rest in zero with three poles at `-rate` (rad/s) and that of the disturbance at 0.3 of it.
    pub(crate) fn new(design: &ObserverDesign, model: Model) -> Self {
        let mut observer = Self {
            design: *design,
            model,
            motion: Motion::default(),
            disturbance: 0.0,
            friction: StickSlip::new(&design.friction, model.friction),
            gain: [0.0; 4],
        };
        observer.tune(model);
        observer
    }

    /// Goes on with another model; the observed motion and disturbance stay.
    pub(crate) fn tune(&mut self, model: Model) {
        self.gain = gains(&model, &self.design);
        self.model = model;
        self.friction.retune(model.friction);
    }

    /// Begins at a motion, without disturbance.
    pub(crate) fn place(&mut self, motion: Motion) {
        self.motion = motion;
        self.disturbance = 0.0;
        self.friction.place(motion.velocity);
    }

    /// One sample on under the flow that was in force. Cost: about 50 instructions.
    #[inline]
    pub(crate) fn predict(&mut self, flow: f32) {
        let time = self.design.sample_time;
        self.friction.tick();
        if self.friction.sticks() {
            if let Some(acceleration) = self.friction.hold(self.model.b0 * flow) {
                self.motion.acceleration = acceleration;
            }
            return;
        }
        self.friction.carry(time * self.model.b0 * flow);
        self.model
            .advance(&mut self.motion, flow + self.disturbance, time);
        self.friction.stop(&mut self.motion);
    }

    /// Takes a measured position; gives the innovation. Cost: about 30 instructions.
    #[inline]
    pub(crate) fn correct(&mut self, y: f32) -> f32 {
        let innovation = y - self.motion.position;
        if self.friction.sticks() {
            self.friction.observe(innovation, &mut self.motion);
            return innovation;
        }
        self.motion.position += self.gain[0] * innovation;
        self.motion.velocity += self.gain[1] * innovation;
        self.motion.acceleration += self.gain[2] * innovation;
        let v = self.motion.velocity;
        if self.friction.coulomb() > 0.0 && within(v, self.design.stiction_velocity) == v {
            // Friction dominates slow motion, and friction is not a flow.
            self.disturbance -= self.design.disturbance_leak * self.disturbance;
        } else {
            let d = self.disturbance + self.gain[3] * innovation;
            self.disturbance = within(d, DISTURBANCE_MAX);
        }
        self.friction.stop(&mut self.motion);
        innovation
    }

    /// Counts positions from here on: in free simulation only the velocity has a meaning.
    pub(crate) const fn forget_position(&mut self) {
        self.motion.position = 0.0;
    }

    /// Whether the model has friction and the axis sticks.
    #[inline]
    pub(crate) fn sticks(&self) -> bool {
        self.friction.sticks()
    }

    /// The drive p: the acceleration that the drive force alone would give.
    #[inline]
    pub(crate) fn drive(&self) -> f32 {
        self.friction.drive(self.motion.acceleration)
    }

    /// The friction.
    pub(crate) const fn friction(&self) -> &StickSlip {
        &self.friction
    }

    /// The friction, to limit its drive.
    pub(crate) const fn friction_mut(&mut self) -> &mut StickSlip {
        &mut self.friction
    }

    /// The observed motion.
    pub(crate) const fn motion(&self) -> Motion {
        self.motion
    }

    /// The observed disturbance, as a flow.
    pub(crate) const fn disturbance(&self) -> f32 {
        self.disturbance
    }

    /// The model in use.
    pub(crate) const fn model(&self) -> &Model {
        &self.model
    }
}

/// l1 to l4 times the sample time, from the coefficients of the wanted polynomial.
fn gains(model: &Model, design: &ObserverDesign) -> [f32; 4] {
    let w = design.rate;
    let [q3, q2, q1, q0] = if design.disturbed {
        let d = DISTURBANCE_POLE_RATIO * w;
        [
            3.0 * w + d,
            3.0 * w * (w + d),
            w * w * (w + 3.0 * d),
            w * w * w * d,
        ]
    } else {
        [3.0 * w, 3.0 * w * w, w * w * w, 0.0]
    };
    let l1 = q3 - model.a2;
    let l2 = q2 - model.a2 * l1 - model.a1;
    let l3 = q1 - model.a2 * l2 - model.a1 * l1;
    let l4 = q0 / model.b0;
    let t = design.sample_time;
    [t * l1, t * l2, t * l3, t * l4]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::config::Config;
    use crate::servo::error::Error;
    use crate::servo::motion::Travel;

    #[test]
    fn a_step_of_the_position_is_followed() -> Result<(), Error> {
        let travel = Travel {
            min: 0.0,
            max: 400.0,
        };
        let design = Config::new(1e-3, 13.7, travel).resolve()?;
        let model = Model::linear(400.0, 20.0, 1.0e6);
        let mut observer = Observer::new(&design.controller.observer, model);
        observer.place(Motion::at(5.0));
        for _ in 0..500 {
            observer.predict(0.0);
            observer.correct(6.0);
        }
        assert!((observer.motion().position - 6.0).abs() < 1e-3);
        Ok(())
    }
}
