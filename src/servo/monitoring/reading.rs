//! Whether a position can be true.

use crate::servo::design::MonitoringDesign;
use crate::servo::motion::Motion;
use crate::servo::supervision::state::Reason;

/// A gate on every reading: the distance that the axis can have moved since the last good one, and
/// no more.
///
/// ```text
/// |y - x| <= 8 sigma + 3 resolutions + 2 |v| Delta + a ((t + 2 Delta)^2 / 2 + 0.27 / rate^2)
/// ```
///
/// x, v: position and velocity expected from earlier readings alone; t: time since the last good
/// reading. Two missed slots move the axis by 2 |v| Delta, an obstacle takes at most |v| Delta
/// away; a = C w is what the full force can change, 2.5 times the friction what a breakaway can;
/// the filter with three poles at `-rate` that x comes from lags behind a step of the acceleration
/// by 0.27 a / rate^2. sigma is the larger of the stated noise and the rms of the residual itself,
/// each part of which enters with at most the gate, so that no outlier opens it.
///
/// Readings that last are a jump, unless they stay at the last good one: no force stops an axis so
/// fast, but an obstacle does, and so does a sensor that is stuck.
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
    /// The last good one, and the largest distance of those after it.
    last: f32,
    furthest: f32,
}

/// What becomes of a reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Credibility {
    /// It can be true.
    Good,
    /// It cannot; the expected position replaces it.
    Bridge,
    /// It cannot, and neither could those before it.
    Lasting(Reason),
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
            last: 0.0,
            furthest: 0.0,
            residual_share: design.residual_share,
            bridged: 0,
        }
    }

    /// Takes the acceleration that the drive can give.
    pub(crate) const fn tune(&mut self, acceleration: f32) {
        self.acceleration = acceleration;
    }

    /// Classifies a reading beside the motion of the earlier ones; `missed`: samples in a row
    /// without any.
    #[inline]
    pub(crate) fn classify(&mut self, y: f32, earlier: &Motion, missed: u32) -> Credibility {
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
        let grain = 8.0 * sigma + 3.0 * self.resolution;
        let gate = grain
            + 2.0 * speed * self.sample_time
            + self.acceleration * (0.5 * late * late + self.lag);
        let next = earlier.position + self.sample_time * earlier.velocity;
        let residual = (y - next).abs();
        if residual <= gate {
            self.bridged = 0;
            self.last = y;
            self.furthest = 0.0;
            self.residual += self.residual_share * (residual - self.residual);
            return Credibility::Good;
        }
        self.bridged = self.bridged.saturating_add(1);
        let away = (y - self.last).abs();
        if away > self.furthest {
            self.furthest = away;
        }
        if self.bridged < self.longest {
            return Credibility::Bridge;
        }
        self.bridged = 0;
        Credibility::Lasting(if self.furthest > grain {
            Reason::Implausible
        } else if self.furthest > 0.0 {
            Reason::Blocked
        } else {
            Reason::SensorStuck
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::Config;
    use crate::servo::motion::Travel;

    /// What becomes of readings after an axis at a speed that no force takes away at once, 300 mm/s
    /// against 10 mm/s^2.
    fn lasting(after: impl Fn(u32) -> f32) -> Option<Reason> {
        let travel = Travel {
            min: 0.0,
            max: 400.0,
        };
        let Ok(design) = Config::new(0.001, 20.0, travel).resolve() else {
            panic!("a setting is refused");
        };
        let mut readings = Plausibility::new(&design.monitoring.with_resolution(0.01));
        readings.tune(10.0);
        for k in 0..200_u32 {
            let motion = Motion {
                position: 0.3 * (k as f32 - 1.0),
                velocity: 300.0,
                ..Motion::default()
            };
            let y = if k < 100 { 0.3 * k as f32 } else { after(k) };
            match readings.classify(y, &motion, 0) {
                Credibility::Good => assert!(k < 104, "sample {k}"),
                Credibility::Bridge => assert!(k >= 100, "sample {k}"),
                Credibility::Lasting(reason) => return Some(reason),
            }
        }
        None
    }

    #[test]
    fn a_stop_that_no_force_explains_is_no_jump() {
        let stop = 0.3 * 99.0;
        assert_eq!(lasting(|_| stop), Some(Reason::SensorStuck));
        let noisy = |k: u32| stop + if k.is_multiple_of(2) { 0.01 } else { 0.0 };
        assert_eq!(lasting(noisy), Some(Reason::Blocked));
        assert_eq!(
            lasting(|k| 100.0 + 0.3 * k as f32),
            Some(Reason::Implausible)
        );
        assert_eq!(lasting(|_| 100.0), Some(Reason::Implausible));
    }
}
