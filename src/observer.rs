//! Observer of velocity, acceleration and disturbance on the identified model.

use crate::controller::within;
use crate::servo_model::{Motion, ServoModel};

/// Luenberger observer with a constant disturbance at the input of the model.
///
/// ```text
/// x' = v      v' = a      a' = - a1 v - a2 a + b0 (flow + d)      d' = 0
/// correction by (y - x): l1, l2, l3, l4 times Delta
/// s^4 + (l1+a2) s^3 + (l2+a2 l1+a1) s^2 + (l3+a2 l2+a1 l1) s + b0 l4 = (s + w)^4
/// without disturbance:  l4 = 0 and the first four terms divided by s are (s + w)^3
/// ```
///
/// d is what the controller subtracts: it is the integral action, and because the
/// observer sees the command that was really set it does not wind up.
///
/// # Examples
/// ```
/// use trendid::{Motion, Observer, ServoModel};
/// let model = ServoModel { a1: 400.0, a2: 20.0, b0: 1.0e6, dead_zone: 0.0, offset: 0.0 };
/// let mut observer = Observer::new(model, 120.0, 0.001);
/// observer.place(Motion { position: 5.0, ..Motion::default() });
/// for _ in 0..500 {
///     observer.predict(0.0);
///     observer.correct(6.0);
/// }
/// assert!((observer.motion().position - 6.0).abs() < 1e-3);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observer {
    model: ServoModel,
    motion: Motion,
    disturbance: f32,
    /// Whether there is a disturbance in the model of the observer.
    disturbed: bool,
    gain: [f32; 4],
    rate: f32,
    sample_time: f32,
}

/// Largest disturbance, as a flow: more than the full command is no disturbance.
const DISTURBANCE: f32 = 1.0;

impl Observer {
    /// An observer at rest in zero with four poles at `-rate` (rad/s).
    ///
    /// `rate` times `sample_time` should stay below 0.3: the correction is a rectangle.
    pub fn new(model: ServoModel, rate: f32, sample_time: f32) -> Self {
        Self::build(model, rate, sample_time, true)
    }

    /// An observer of the motion alone, with three poles at `-rate`: what remains is the model's error.
    pub fn undisturbed(model: ServoModel, rate: f32, sample_time: f32) -> Self {
        Self::build(model, rate, sample_time, false)
    }

    fn build(model: ServoModel, rate: f32, sample_time: f32, disturbed: bool) -> Self {
        let mut observer = Self {
            model,
            motion: Motion::default(),
            disturbance: 0.0,
            disturbed,
            gain: [0.0; 4],
            rate,
            sample_time,
        };
        observer.tune(model);
        observer
    }

    /// Goes on with another model; the observed motion and disturbance stay.
    pub fn tune(&mut self, model: ServoModel) {
        let w = self.rate;
        let [q3, q2, q1, q0] = if self.disturbed {
            [4.0 * w, 6.0 * w * w, 4.0 * w * w * w, w * w * w * w]
        } else {
            [3.0 * w, 3.0 * w * w, w * w * w, 0.0]
        };
        let l1 = q3 - model.a2;
        let l2 = q2 - model.a2 * l1 - model.a1;
        let l3 = q1 - model.a2 * l2 - model.a1 * l1;
        let l4 = q0 / model.b0;
        let t = self.sample_time;
        self.gain = [t * l1, t * l2, t * l3, t * l4];
        self.model = model;
    }

    /// Begins at a motion, without disturbance.
    pub fn place(&mut self, motion: Motion) {
        self.motion = motion;
        self.disturbance = 0.0;
    }

    /// One sample on under the flow that was in force. Cost: about 35 instructions.
    #[inline]
    pub fn predict(&mut self, flow: f32) {
        self.model
            .advance(&mut self.motion, flow + self.disturbance, self.sample_time);
    }

    /// Takes a measured position; gives the innovation. Cost: about 20 instructions.
    #[inline]
    pub fn correct(&mut self, y: f32) -> f32 {
        let innovation = y - self.motion.position;
        self.motion.position += self.gain[0] * innovation;
        self.motion.velocity += self.gain[1] * innovation;
        self.motion.acceleration += self.gain[2] * innovation;
        let d = self.disturbance + self.gain[3] * innovation;
        self.disturbance = within(d, DISTURBANCE);
        innovation
    }

    /// As [`Observer::correct`], and the disturbance stays: for times in which the input does nothing.
    #[inline]
    pub fn correct_motion(&mut self, y: f32) -> f32 {
        let disturbance = self.disturbance;
        let innovation = self.correct(y);
        self.disturbance = disturbance;
        innovation
    }

    /// The observed motion.
    pub const fn motion(&self) -> Motion {
        self.motion
    }

    /// The observed disturbance, as a flow.
    pub const fn disturbance(&self) -> f32 {
        self.disturbance
    }

    /// The model in use.
    pub const fn model(&self) -> &ServoModel {
        &self.model
    }
}
