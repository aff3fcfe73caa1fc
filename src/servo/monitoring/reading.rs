//! Whether a position can be true.

use crate::servo::design::MonitoringDesign;
use crate::servo::motion::Motion;

/// A gate on every reading: the distance that the axis can have moved since the last good one, and no more.
///
/// ```text
/// |y - x| <= 8 sigma + 3 resolutions + 2 |v| Delta + a ((t + 2 Delta)^2 / 2 + 0.27 / rate^2)
/// ```
///
/// x, v: position and velocity expected from earlier readings alone; t: time since the last good reading. Two missed slots move
/// the axis by 2 |v| Delta, an obstacle takes at most |v| Delta away; a = C w is what the full force can change, 2.5 times the friction what a
/// breakaway can; the filter with three poles at `-rate` that x comes from lags behind a step of the acceleration by 0.27 a / rate^2. sigma is
/// the larger of the stated noise and the rms of the residual itself, each part of which enters with at most the gate, so
/// that no outlier opens it.
///
/// Known as: innovation gate (Bar-Shalom, Li and Kirubarajan 2001). Cost: about 30 instructions.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Plausibility {
    sample_time: f32,
    noise: f32,
    resolution: f32,
    acceleration: f32,
    /// Position over acceleration by which the expectation lags.
    lag: f32,
    longest: u32,
    /// Mean of the absolute residual.
    residual: f32,
    residual_share: f32,
    /// Readings in a row that were replaced.
    bridged: u32,
}

/// What becomes of a reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// It can be true.
    Good,
    /// It cannot; the expected position replaces it.
    Bridge,
    /// The position has jumped for good.
    Jump,
}

impl Plausibility {
    pub(crate) const fn new(design: &MonitoringDesign) -> Self {
        Self {
            sample_time: design.sample_time,
            noise: design.noise,
            resolution: design.resolution,
            acceleration: design.acceleration,
            lag: design.tracking_lag,
            longest: design.jump,
            residual: 0.0,
            residual_share: design.residual_share,
            bridged: 0,
        }
    }

    /// Takes the acceleration that the drive can give.
    pub(crate) const fn tune(&mut self, acceleration: f32) {
        self.acceleration = acceleration;
    }

    /// Judges a reading beside the motion of the earlier ones; `missed`: samples in a row without any.
    #[inline]
    pub(crate) fn judge(&mut self, y: f32, earlier: &Motion, missed: u32) -> Verdict {
        let samples = (self.bridged.saturating_add(missed).saturating_add(1)) as f32;
        let t = samples * self.sample_time;
        let speed = earlier.velocity.abs();
        // Mean absolute deviation to standard deviation of a normal variable.
        let measured = 1.25 * self.residual;
        let sigma = if measured > self.noise {
            measured
        } else {
            self.noise
        };
        let late = t + 2.0 * self.sample_time;
        let gate = 8.0 * sigma
            + 3.0 * self.resolution
            + 2.0 * speed * self.sample_time
            + self.acceleration * (0.5 * late * late + self.lag);
        let next = earlier.position + self.sample_time * earlier.velocity;
        let residual = (y - next).abs();
        if residual <= gate {
            self.bridged = 0;
            self.residual += self.residual_share * (residual - self.residual);
            return Verdict::Good;
        }
        self.bridged = self.bridged.saturating_add(1);
        if self.bridged < self.longest {
            Verdict::Bridge
        } else {
            self.bridged = 0;
            Verdict::Jump
        }
    }
}
