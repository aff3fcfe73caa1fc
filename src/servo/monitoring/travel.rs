//! The end of the travel, before the axis is there.

use crate::servo::monitoring::bounds::Bounds;
use crate::servo::motion::{Setpoint, Travel};

/// Whether an axis can still stop within its travel.
///
/// ```text
/// s(x, v) = x + v reaction + v |v| / (2 a)
/// ```
///
/// a = C w / 2: half of what the full reverse command gives; reaction: delay and the time 1/w in which the force is built
/// up. The reference comes to rest within the travel by itself; an axis close to it does so too. Therefore the place where
/// the axis would stop counts when it is beyond the travel and beyond that of the reference, each by more than
/// the speed `end_speed` needs, which an end may take.
/// Cost: about 25 instructions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TravelMonitor {
    travel: Travel,
}

impl TravelMonitor {
    pub(crate) const fn new(travel: Travel) -> Self {
        Self { travel }
    }

    /// Whether the axis must brake now.
    #[inline]
    pub(crate) fn update(&self, y: f32, velocity: f32, r: &Setpoint, bounds: &Bounds) -> bool {
        let stop =
            |x: f32, v: f32| x + v * bounds.reaction + v * v.abs() * bounds.half_inverse_brake;
        let slow = bounds.end_speed;
        let spare = slow * bounds.reaction + slow * slow * bounds.half_inverse_brake;
        let (axis, reference) = (stop(y, velocity), stop(r.position, r.velocity));
        let beyond = |at: f32, end: f32| {
            let upper = if at > end { at } else { end };
            axis > upper + spare
        };
        let below = |at: f32, end: f32| {
            let lower = if at < end { at } else { end };
            axis < lower - spare
        };
        (velocity > slow && beyond(reference, self.travel.max))
            || (velocity < -slow && below(reference, self.travel.min))
    }
}
