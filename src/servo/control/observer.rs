//! Observer of velocity and acceleration on a model, and its free simulation.

use crate::servo::control::friction::StickSlip;
use crate::servo::design::ObserverDesign;
use crate::servo::model::Model;
use crate::servo::motion::Motion;

/// Luenberger observer with friction that sticks beside it; without correction a free simulation.
///
/// ```text
/// x' = v      v' = a      a' = - a1 v - a2 a + b0 flow
/// correction by (y - x): l1, l2, l3 times Delta
/// s^3 + (l1+a2) s^2 + (l2+a2 l1+a1) s + (l3+a2 l2+a1 l1) = (s + w)^3
/// ```
///
/// Known as: Luenberger observer (Luenberger 1964).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Observer {
    design: ObserverDesign,
    model: Model,
    /// The drive over a sample.
    step: Transition,
    motion: Motion,
    friction: StickSlip,
    gain: [f32; 3],
}

impl Observer {
    /// An observer at rest in zero with three poles at `-rate` (rad/s).
    pub(crate) fn new(design: &ObserverDesign, model: Model) -> Self {
        let mut observer = Self {
            design: *design,
            model,
            step: Transition::default(),
            motion: Motion::default(),
            friction: StickSlip::new(design.sample_time, model.friction),
            gain: [0.0; 3],
        };
        observer.tune(model);
        observer
    }

    /// Goes on with another model; the observed motion stays.
    pub(crate) fn tune(&mut self, model: Model) {
        self.gain = gains(&model, &self.design);
        self.step = Transition::new(&model, self.design.sample_time);
        self.model = model;
        self.friction.retune(model.friction);
    }

    /// Begins at a motion.
    pub(crate) fn place(&mut self, motion: Motion) {
        self.motion = motion;
        self.friction.place(motion.velocity);
    }

    /// One sample on under the flow that was in force. Cost: about 40 instructions.
    #[inline(always)]
    pub(crate) fn predict(&mut self, flow: f32) {
        if self.friction.sticks() {
            if let Some(acceleration) = self.friction.hold(self.model.b0 * flow) {
                self.motion.acceleration = acceleration;
            }
            return;
        }
        self.step.advance(&mut self.motion, flow);
        self.friction.stop(&mut self.motion);
    }

    /// One observed sample: on under the flow that was in force, then to the measured position.
    /// Cost: about 50 instructions.
    #[inline(always)]
    pub(crate) fn observe(&mut self, flow: f32, y: f32) {
        if self.friction.sticks() {
            if let Some(acceleration) = self.friction.hold(self.model.b0 * flow) {
                self.motion.acceleration = acceleration;
            }
            self.motion.position = y;
            return;
        }
        self.step.advance(&mut self.motion, flow);
        let innovation = y - self.motion.position;
        correct(self.gain, &mut self.motion, innovation);
        self.friction.stop(&mut self.motion);
    }

    /// A small deviation from the motion one sample on, under a deviation of the flow; friction is
    /// no part of it. Cost: about 25 instructions.
    #[inline]
    pub(crate) fn deviate(&self, deviation: &mut Motion, flow: f32) {
        self.step.advance(deviation, flow);
    }

    /// The same in an observed sample: the measured position does not deviate.
    #[inline]
    pub(crate) fn deviate_observed(&self, deviation: &mut Motion, flow: f32) {
        self.step.advance(deviation, flow);
        let innovation = -deviation.position;
        correct(self.gain, deviation, innovation);
    }

    /// Counts positions from here on: in free simulation only the velocity has a meaning.
    pub(crate) const fn forget_position(&mut self) {
        self.motion.position = 0.0;
    }

    /// The observed motion.
    pub(crate) const fn motion(&self) -> Motion {
        self.motion
    }

    /// The model in use.
    pub(crate) const fn model(&self) -> &Model {
        &self.model
    }
}

/// What velocity, acceleration and flow at the begin of a sample add to position, velocity and
/// acceleration until its end: those of [`Model::advance`] as a matrix.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Transition {
    position: [f32; 3],
    velocity: [f32; 3],
    acceleration: [f32; 3],
}

impl Transition {
    /// Cost: some 40 instructions.
    pub(crate) fn new(model: &Model, time: f32) -> Self {
        let Model { a1, a2, b0, .. } = *model;
        let (half, third) = (0.5 * time, time * (1.0 / 3.0));
        let square = time * half;
        // Of velocity, acceleration and flow in the derivatives of the acceleration.
        let jerk = [-a1, -a2, b0];
        let snap = [-a2 * jerk[0], -a1 - a2 * jerk[1], -a2 * jerk[2]];
        let of = |k: usize| {
            let crackle = -a1 * jerk[k] - a2 * snap[k];
            (
                square * third * jerk[k],
                square * (jerk[k] + third * snap[k]),
                time * (jerk[k] + half * (snap[k] + third * crackle)),
            )
        };
        let [(xv, vv, av), (xa, va, aa), (xf, vf, af)] = [of(0), of(1), of(2)];
        Self {
            position: [time + xv, square + xa, xf],
            velocity: [vv, time + va, vf],
            acceleration: [av, aa, af],
        }
    }

    /// One sample on under a held flow. Cost: about 25 instructions.
    #[inline]
    pub(crate) fn advance(&self, motion: &mut Motion, flow: f32) {
        let (v, a) = (motion.velocity, motion.acceleration);
        let sum = |[of_v, of_a, of_flow]: [f32; 3]| of_v * v + of_a * a + of_flow * flow;
        motion.position += sum(self.position);
        motion.velocity += sum(self.velocity);
        motion.acceleration += sum(self.acceleration);
    }
}

/// Adds an innovation, times the gains.
#[inline]
fn correct([l1, l2, l3]: [f32; 3], motion: &mut Motion, innovation: f32) {
    motion.position += l1 * innovation;
    motion.velocity += l2 * innovation;
    motion.acceleration += l3 * innovation;
}

/// l1 to l3 times the sample time.
fn gains(model: &Model, design: &ObserverDesign) -> [f32; 3] {
    let w = design.rate;
    let l1 = 3.0 * w - model.a2;
    let l2 = 3.0 * w * w - model.a2 * l1 - model.a1;
    let l3 = w * w * w - model.a2 * l2 - model.a1 * l1;
    let t = design.sample_time;
    [t * l1, t * l2, t * l3]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::config::Config;
    use crate::servo::error::Error;
    use crate::servo::motion::Travel;

    #[test]
    fn a_sample_is_that_of_the_model() {
        let model = Model::linear(900.0, 14.0, 2.0e5);
        for time in [1e-3, 2e-3] {
            let step = Transition::new(&model, time);
            for (velocity, acceleration, flow) in [(300.0, -2e3, 0.4), (-20.0, 9e3, -1.0)] {
                let begin = Motion {
                    position: 100.0,
                    velocity,
                    acceleration,
                };
                let (mut found, mut exact) = (begin, begin);
                step.advance(&mut found, flow);
                model.advance(&mut exact, flow, time);
                for (found, exact) in [
                    (found.position, exact.position),
                    (found.velocity, exact.velocity),
                    (found.acceleration, exact.acceleration),
                ] {
                    assert!((found / exact - 1.0).abs() < 1e-6, "{found} {exact}");
                }
            }
        }
    }

    #[test]
    fn a_step_of_the_position_is_followed() -> Result<(), Error> {
        let travel = Travel {
            min: 0.0,
            max: 400.0,
        };
        let design = Config::new(1e-3, 13.7, travel).resolve()?;
        let model = Model::linear(400.0, 20.0, 1.0e6);
        let mut observer = Observer::new(&design.supervision.validation.observer, model);
        observer.place(Motion::at(5.0));
        for _ in 0..500 {
            observer.observe(0.0, 6.0);
        }
        assert!((observer.motion().position - 6.0).abs() < 1e-3);
        Ok(())
    }
}
