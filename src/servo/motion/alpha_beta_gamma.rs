//! Motion of the axis before a model exists.

use crate::math::sqrt;
use crate::servo::motion::Motion;

/// Total variations of the responses of velocity and acceleration to a step, over w and w^2.
const VELOCITY_VARIATION: f32 = 1.76;
const ACCELERATION_VARIATION: f32 = 0.62;

/// Position, velocity and acceleration from measured positions alone.
///
/// ```text
/// x' = v   v' = a   a' = 0,   corrected by (y - x) with the gains 3 w T, 3 w^2 T, w^3 T
/// ```
///
/// Known as: alpha-beta-gamma filter (Bar-Shalom, Li and Kirubarajan, Estimation with Applications
/// to Tracking and Navigation, 2001). Exact for a constant acceleration. Cost: about 15
/// instructions.
#[derive(Debug, Clone, PartialEq)]
#[doc(alias = "Tracker")]
pub(crate) struct AlphaBetaGamma {
    motion: Motion,
    gain: [f32; 3],
    sample_time: f32,
}

impl AlphaBetaGamma {
    /// A filter with three poles at `-rate` (rad/s).
    pub(crate) fn new(rate: f32, sample_time: f32) -> Self {
        let mut filter = Self {
            motion: Motion::default(),
            gain: [0.0; 3],
            sample_time,
        };
        filter.retune(rate);
        filter
    }

    /// Goes on with three poles at `-rate` (rad/s).
    pub(crate) fn retune(&mut self, rate: f32) {
        let x = rate * self.sample_time;
        let per_s = x / self.sample_time;
        self.gain = [3.0 * x, 3.0 * x * per_s, x * per_s * per_s];
    }

    /// The rate of its poles in rad/s.
    pub(crate) fn rate(&self) -> f32 {
        self.gain[1] / self.gain[0]
    }

    /// Standard deviation of the velocity over that of white noise of the positions, in 1/s.
    ///
    /// Of a density T of noise `w^2 s (3 s + w) / (s + w)^3` lets through `7/4 w^3 T`.
    pub(crate) fn velocity_noise(&self) -> f32 {
        let rate = self.rate();
        rate * sqrt(1.75 * rate * self.sample_time)
    }

    /// Standard deviation of the acceleration over that of white noise of the positions, in 1/s^2.
    ///
    /// Of a density T of noise `w^3 s^2 / (s + w)^3` lets through `3/16 w^5 T`.
    pub(crate) fn acceleration_noise(&self) -> f32 {
        let rate = self.rate();
        rate * rate * sqrt(0.1875 * rate * self.sample_time)
    }

    /// Starts again at rest at `position`.
    pub(crate) fn place(&mut self, position: f32) {
        self.motion = Motion::at(position);
    }

    /// Starts again with a motion.
    pub(crate) fn begin(&mut self, motion: Motion) {
        self.motion = motion;
    }

    /// Takes a measured position.
    #[inline]
    pub(crate) fn update(&mut self, y: f32) {
        let m = &mut self.motion;
        m.position = m.after(self.sample_time);
        m.velocity += self.sample_time * m.acceleration;
        let error = y - m.position;
        m.position += self.gain[0] * error;
        m.velocity += self.gain[1] * error;
        m.acceleration += self.gain[2] * error;
    }

    /// The motion at the newest sample.
    pub(crate) const fn motion(&self) -> Motion {
        self.motion
    }

    /// The motion without what positions of an axis at rest may show that are off by up to `grain`.
    ///
    /// From y to velocity and acceleration the filter is `w^2 s (3 s + w) / (s + w)^3` and
    /// `w^3 s^2 / (s + w)^3`. The total variations of their step responses,
    /// `w x (3 - x) e^-x` and `w^2 x (1 - x/2) e^-x` over `x = w t`, are 1.76 w and 0.62 w^2: no
    /// signal within `grain` makes more of it.
    pub(crate) fn significant(&self, grain: f32) -> Motion {
        let Motion {
            velocity,
            acceleration,
            ..
        } = self.motion;
        let rate = self.rate();
        let beyond = |x: f32, most: f32| if x.abs() > most { x } else { 0.0 };
        Motion {
            velocity: beyond(velocity, VELOCITY_VARIATION * rate * grain),
            acceleration: beyond(acceleration, ACCELERATION_VARIATION * rate * rate * grain),
            ..self.motion
        }
    }
}

#[cfg(test)]
mod tests;
