//! A limit cycle at rest.

use crate::servo::design::MonitoringDesign;
use crate::servo::motion::Setpoint;

/// Reversals of the position about a reference at rest.
///
/// Noise of 8 sigma and two resolutions do not count, and neither does an axis that comes to rest:
/// after 4 reversals, each within the longest pause after the one before, a loop with damping is at
/// rest. Friction that sticks makes slow cycles, so that the pause is seconds and not periods of
/// the drive. As long as the window in which the axis rests can widen, it ends those, and less
/// bandwidth would be kept for nothing: they count from where it is as wide as it may be. Cost:
/// about 20 instructions.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Oscillation {
    band: f32,
    pause: u32,
    settling: u32,
    /// Samples of a reference at rest.
    rest: u32,
    /// Extreme of the present half wave, its direction, samples since the last reversal.
    extreme: f32,
    direction: f32,
    since: u32,
    reversals: u32,
}

/// Reversals that are an oscillation.
const REVERSALS: u32 = 4;

impl Oscillation {
    pub(crate) const fn new(design: &MonitoringDesign) -> Self {
        Self {
            band: design.cycle,
            pause: design.cycle_pause,
            settling: design.cycle_settling,
            rest: 0,
            extreme: 0.0,
            direction: 0.0,
            since: 0,
            reversals: 0,
        }
    }

    /// One sample; whether an oscillation is noticed in it. The count then begins again. `hunts`:
    /// friction holds the axis, and the window can still widen.
    #[inline]
    pub(crate) fn update(&mut self, r: &Setpoint, y: f32, hunts: bool) -> bool {
        if !r.is_rest() {
            self.rest = 0;
            return false;
        }
        self.rest = self.rest.saturating_add(1);
        if self.rest <= self.settling {
            self.extreme = y;
            self.direction = 0.0;
            self.reversals = 0;
            self.since = 0;
            return false;
        }
        self.since = self.since.saturating_add(1);
        if hunts || self.since > self.pause {
            self.reversals = 0;
        }
        let from = y - self.extreme;
        if self.direction == 0.0 {
            if from.abs() > self.band {
                self.direction = if from > 0.0 { 1.0 } else { -1.0 };
                self.extreme = y;
                self.since = 0;
            }
            return false;
        }
        if from * self.direction > 0.0 {
            self.extreme = y;
        } else if from.abs() > self.band {
            self.direction = -self.direction;
            self.extreme = y;
            self.since = 0;
            self.reversals += 1;
        }
        if self.reversals < REVERSALS {
            return false;
        }
        self.reversals = 0;
        true
    }
}
