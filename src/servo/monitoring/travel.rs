//! The end of the travel, before the axis is there.

use crate::servo::monitoring::bounds::Bounds;
use crate::servo::motion::{Setpoint, Travel};

/// Whether an axis can still stop within its travel.
///
/// ```text
/// s(x, v) = x + v (delay + 0.25/w) + 2 v |v| / (C w)
/// ```
///
/// This is the stopping distance under the full reverse command, with some to spare. The reference
/// comes to rest within the travel by itself; an axis close to it does so too. Therefore the place
/// where the axis would stop counts when it is beyond the travel and beyond that of a reference a
/// third faster, each by more than the speed `end_speed` needs, which an end may take. A loop that
/// brakes already has the delay and 1/w to show it. Cost: about 25 instructions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TravelMonitor {
    travel: Travel,
    /// Samples in a row in which the axis would go beyond its travel, and the speed at the begin.
    beyond: u32,
    speed: f32,
}

/// What the axis must do at an end of the travel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    /// Nothing.
    Free,
    /// The full command against the motion, now.
    Brake,
    /// The axis must stop: it does not brake.
    Lost,
}

/// Share of the speed that a brake takes away in its time, at least.
const BRAKED: f32 = 0.9;

impl TravelMonitor {
    pub(crate) const fn new(travel: Travel) -> Self {
        Self {
            travel,
            beyond: 0,
            speed: 0.0,
        }
    }

    /// Whether a position is at an end, or nearer to it than `grain`.
    #[inline]
    pub(crate) fn is_end(&self, y: f32, grain: f32) -> bool {
        y > self.travel.max - grain || y < self.travel.min + grain
    }

    /// Whether the axis must brake now.
    #[inline]
    pub(crate) fn update(
        &mut self,
        y: f32,
        velocity: f32,
        command: f32,
        r: &Setpoint,
        bounds: &Bounds,
    ) -> End {
        let stop = |x: f32, v: f32| {
            x + v * bounds.end.reaction + v * v.abs() * bounds.end.half_inverse_brake
        };
        let slow = bounds.end_speed;
        let spare = slow * bounds.end.reaction + slow * slow * bounds.end.half_inverse_brake;
        let (axis, reference) = (stop(y, velocity), stop(r.position, 1.3 * r.velocity));
        let beyond = |at: f32, end: f32| {
            let upper = if at > end { at } else { end };
            axis > upper + spare
        };
        let below = |at: f32, end: f32| {
            let lower = if at < end { at } else { end };
            axis < lower - spare
        };
        let leaves = (velocity > slow && beyond(reference, self.travel.max))
            || (velocity < -slow && below(reference, self.travel.min));
        if !leaves {
            self.beyond = 0;
            return End::Free;
        }
        let speed = velocity.abs();
        if self.beyond == 0 {
            self.speed = speed;
        }
        self.beyond = self.beyond.saturating_add(1);
        if self.beyond > bounds.end.braking {
            if !(speed < BRAKED * self.speed) {
                return End::Lost;
            }
            self.beyond = 0;
        }
        if command * velocity < 0.0 {
            End::Free
        } else {
            End::Brake
        }
    }
}
