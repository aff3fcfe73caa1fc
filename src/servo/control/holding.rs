//! The flow that holds an axis at rest, learned from its slips.

use crate::math::within;

/// Largest flow: less than what the monitors take a valve to be wrong by.
const MOST: f32 = 0.05;
/// Largest flow that a single slip shows: an axis that stopped near its breakaway slips early,
/// whatever the flow.
const SHOWN: f32 = 0.002;
/// Factor on what a slip shows, at first, after another one the same way and after one the other
/// way; and its bounds.
const FIRST: f32 = 0.5;
const SAME: f32 = 1.5;
const OTHER: f32 = 0.5;
const TRUST: [f32; 2] = [0.1, 4.0];

/// Flow of the valve at rest beyond that of its middle.
///
/// A valve in the middle of its dead zone leaks, and where its middle is, is known to some per mil.
/// While friction holds the axis its drive goes on by `b0 q`, unseen, and the axis slips when the
/// drive has come from the middle of what friction holds to its edge, after
/// `t = friction / (b0 |q|)`. A slip so tells q: its sign by the direction, its size by t. From
/// then on the valve lets the opposite flow through. What is left of q makes the axis slip later
/// and the next correction smaller; what a slip shows is halved when it was the other way than the
/// one before, and grows while they go the same way, through the dead zone of which nobody knows
/// the width. The bounds keep an early slip and a shove from counting for more than they show.
///
/// Without it an axis with gravity and a leak slips from its rest again and again, and the loop
/// brings it back: a cycle that no window ends, because the drive drifts and does not hunt.
///
/// Known as: accelerated stochastic approximation (Kesten 1958), with the size of a step from the
/// time between slips.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Holding {
    flow: f32,
    trust: f32,
    /// Direction of the latest slip.
    last: f32,
    /// Time for which the axis has been held with the valve at rest, in s.
    time: f32,
}

impl Holding {
    /// Nothing is known.
    pub(crate) const NONE: Self = Self {
        flow: 0.0,
        trust: FIRST,
        last: 0.0,
        time: 0.0,
    };

    /// One sample; `holds`: friction holds the axis, and the valve is at rest.
    #[inline]
    pub(crate) fn pass(&mut self, sample_time: f32, holds: bool) {
        self.time = if holds { self.time + sample_time } else { 0.0 };
    }

    /// The axis slips in a direction; `friction`: friction over b0, the time in s in which the full
    /// flow brings the drive through it.
    #[inline]
    pub(crate) fn slip(&mut self, direction: f32, friction: f32) {
        if !(self.time > 0.0) {
            return;
        }
        let back = direction * self.last < 0.0;
        let [least, most] = TRUST;
        let trust = self.trust * if back { OTHER } else { SAME };
        self.trust = if trust < least {
            least
        } else if trust < most {
            trust
        } else {
            most
        };
        self.last = direction;
        let shown = within(friction / self.time, SHOWN);
        self.flow = within(self.flow - direction * self.trust * shown, MOST);
        self.time = 0.0;
    }

    /// Whether the axis has ever slipped from its rest.
    pub(crate) fn has_slipped(&self) -> bool {
        self.last != 0.0
    }

    /// The flow.
    pub(crate) const fn flow(&self) -> f32 {
        self.flow
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drive that drifts by `b0 (leak + flow)` between -friction and friction, held from its
    /// middle at each slip.
    #[test]
    fn slips_become_rare_whatever_leaks() {
        let friction_over_b0 = 0.004;
        for leak in [-0.02_f32, -0.003, 0.001, 0.01, 0.03] {
            let (mut holding, mut drive, mut late) = (Holding::NONE, 0.0_f32, 0);
            for k in 0..60_000 {
                holding.pass(0.001, true);
                drive += 0.001 * (leak + holding.flow());
                if drive.abs() > friction_over_b0 {
                    holding.slip(drive.signum(), friction_over_b0);
                    drive = 0.0;
                    late += u32::from(k >= 50_000);
                }
            }
            let without = 10.0 * leak.abs() / friction_over_b0;
            assert!(
                (late as f32) < 0.1 * without + 1.0,
                "leak {leak}: {late} slips in the last 10 s"
            );
            assert!(
                (leak + holding.flow()).abs() < 0.1 * leak.abs() + 1e-3,
                "leak {leak}"
            );
        }
    }

    #[test]
    fn a_slip_in_motion_shows_nothing() {
        let mut holding = Holding::NONE;
        holding.pass(0.001, false);
        holding.slip(1.0, 0.004);
        assert_eq!(holding, Holding::NONE);
    }
}
