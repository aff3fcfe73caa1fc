//! Coulomb friction in a simulation: the axis moves in a direction, or sticks.

use crate::math::within;
use crate::servo::design::constants::STOP_HOLD_RATIO;
use crate::servo::motion::Motion;

/// Stick-slip friction as a state machine beside a simulated drive.
///
/// ```text
/// moving    x'' = p - friction sgn(x')
/// sticking  x' = x'' = 0,   p' = b0 flow
/// moving -> sticking: the velocity changes its sign while |p| < 1.2 friction
/// sticking -> moving: |p| > 1.2 friction
/// ```
///
/// The *drive* p is the acceleration that the drive force alone would give.
///
/// | symbol | field | unit |
/// |---|---|---|
/// | friction | `coulomb` | y/s^2 |
/// | p | `drive` | y/s^2 |
///
/// Known as: Karnopp model of stick-slip friction (Karnopp 1985), with breakaway above the Coulomb
/// level.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StickSlip {
    sample_time: f32,
    coulomb: f32,
    /// Direction of motion; 0 while the axis sticks or the model has no friction.
    direction: f32,
    drive: f32,
}

/// The sign of a value that is not zero.
#[inline]
fn sign(value: f32) -> f32 {
    if value > 0.0 { 1.0 } else { -1.0 }
}

impl StickSlip {
    /// Friction of a model, at rest.
    pub(crate) const fn new(sample_time: f32, coulomb: f32) -> Self {
        Self {
            sample_time,
            coulomb,
            direction: 0.0,
            drive: 0.0,
        }
    }

    /// Goes on with the friction of another model.
    pub(crate) const fn retune(&mut self, coulomb: f32) {
        self.coulomb = coulomb;
    }

    /// Begins with a velocity and without drive.
    pub(crate) fn place(&mut self, velocity: f32) {
        self.drive = 0.0;
        self.direction = if velocity == 0.0 || velocity.is_nan() {
            0.0
        } else {
            sign(velocity)
        };
    }

    /// Whether the model has friction and the axis sticks.
    #[inline]
    pub(crate) fn sticks(&self) -> bool {
        self.coulomb > 0.0 && self.direction == 0.0
    }

    /// One sample at rest while the drive changes by `rate` per s; the acceleration if it breaks
    /// away.
    #[inline]
    pub(crate) fn hold(&mut self, rate: f32) -> Option<f32> {
        self.drive += self.sample_time * rate;
        let limit = STOP_HOLD_RATIO * self.coulomb;
        if within(self.drive, limit) == self.drive {
            return None;
        }
        self.direction = sign(self.drive);
        Some(self.drive - self.coulomb * self.direction)
    }

    /// Where the velocity has changed its sign: sticks, or reverses. Corrects `motion` accordingly.
    #[inline]
    pub(crate) fn stop(&mut self, motion: &mut Motion) {
        let friction = self.coulomb;
        if !(friction > 0.0 && motion.velocity * self.direction <= 0.0) {
            return;
        }
        let drive = motion.acceleration + friction * self.direction;
        let hold = STOP_HOLD_RATIO * friction;
        if drive > hold || drive < -hold {
            self.direction = sign(drive);
            motion.acceleration = drive - friction * self.direction;
            return;
        }
        self.drive = drive;
        self.direction = 0.0;
        motion.velocity = 0.0;
        motion.acceleration = 0.0;
    }
}
