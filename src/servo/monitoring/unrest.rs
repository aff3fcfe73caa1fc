//! An axis that moves although its reference rests.

use crate::servo::design::MonitoringDesign;
use crate::servo::motion::Setpoint;

/// Share of a sample in the mean of the latest, whose deviation is 0.42 of that of one.
const SHARE: f32 = 0.3;

/// Departures of the position from where it was at rest.
///
/// The place is where the axis is when its reference has rested for the settling time; a mean of
/// the latest positions that is further away than two resolutions and two standard deviations of
/// the noise, 4.8 of its own, is a move, and the next place. Whatever range the axis covers, it is
/// half of it away from the place at least once: no cycle of more than twice the band goes
/// unnoticed, however slow or fast, and neither does an axis that slips once or creeps. Cost: about
/// 12 instructions.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Unrest {
    band: f32,
    settling: u32,
    /// Samples of a reference at rest.
    rest: u32,
    place: f32,
    /// Mean of the latest positions, from the place.
    away: f32,
}

impl Unrest {
    pub(crate) fn new(design: &MonitoringDesign) -> Self {
        Self::of(design.noise, design.resolution, design.cycle_settling)
    }

    fn of(noise: f32, resolution: f32, settling: u32) -> Self {
        Self {
            band: 2.0 * (noise + resolution),
            settling,
            rest: 0,
            place: 0.0,
            away: 0.0,
        }
    }

    /// One sample; whether the axis moves away in it.
    #[inline]
    pub(crate) fn update(&mut self, r: &Setpoint, y: f32) -> bool {
        self.rest = if r.is_rest() {
            self.rest.saturating_add(1)
        } else {
            0
        };
        if self.rest <= self.settling {
            self.place = y;
            self.away = 0.0;
            return false;
        }
        self.away += SHARE * (y - self.place - self.away);
        if self.away.abs() <= self.band {
            return false;
        }
        self.place = y;
        self.away = 0.0;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Moves that are counted in 4 s about a reference at rest, with a resolution of 0.01 and
    /// uniform noise of +-0.02.
    fn moves(axis: impl Fn(f32) -> f32) -> u32 {
        let mut unrest = Unrest::of(0.012, 0.01, 500);
        let (mut state, mut count) = (1_u32, 0);
        for k in 0..4000 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let noise = 0.04 * ((state >> 8) as f32 / 16_777_216.0 - 0.5);
            let y = 200.0 + axis(0.001 * k as f32) + noise;
            let code = (y / 0.01 + 0.5) as i32;
            count += u32::from(unrest.update(&Setpoint::at(200.0), 0.01 * code as f32));
        }
        count
    }

    #[test]
    fn a_move_at_rest_is_counted() {
        assert_eq!(moves(|_| 0.0), 0, "noise is no move");
        assert_eq!(moves(|t| if t < 2.0 { 0.0 } else { 0.12 }), 1, "a slip");
        assert!(moves(|t| 0.05 * t) >= 2, "creep");
        let square = |period: f32| {
            move |t: f32| {
                if ((t / period) as u32).is_multiple_of(2) {
                    0.0
                } else {
                    0.12
                }
            }
        };
        for period in [0.03, 0.3, 1.1] {
            assert!(moves(square(period)) >= 3, "half waves of {period} s");
        }
    }

    #[test]
    fn a_reference_that_moves_counts_nothing() {
        let mut unrest = Unrest::of(0.012, 0.01, 500);
        let r = Setpoint {
            velocity: 1.0,
            ..Setpoint::at(0.0)
        };
        assert!((0..5000).all(|k| !unrest.update(&r, k as f32)));
    }
}
