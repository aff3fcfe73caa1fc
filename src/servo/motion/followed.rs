//! The setpoint that the axis can follow now: the one of a delay ago.

use crate::servo::design::constants::DELAY_MAX;
use crate::servo::motion::Setpoint;

/// Setpoints on their way to the axis.
///
/// A command takes effect a delay after it is set. So the controller gets the newest setpoint, the
/// one to be met then, and the axis is compared with the one that it should have met now.
/// Nothing of a move needs to be foreseen: a setpoint that is continued over the delay by its
/// derivatives jumps where a move begins, and goes on where one ends.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Followed {
    /// A ring of `delay` setpoints, the oldest at `next`; so many of them are still `unknown`.
    setpoints: [Setpoint; DELAY_MAX],
    delay: usize,
    next: usize,
    unknown: usize,
    /// Instead of these: the way of constant acceleration that led to this one.
    begin: Setpoint,
    sample_time: f32,
}

impl Followed {
    /// At rest at a position.
    pub(crate) const fn at(position: f32) -> Self {
        Self {
            setpoints: [Setpoint::at(0.0); DELAY_MAX],
            delay: 0,
            next: 0,
            unknown: 0,
            begin: Setpoint::at(position),
            sample_time: 0.0,
        }
    }

    /// Begins, so many samples behind, at most [`DELAY_MAX`], on the way of constant acceleration
    /// that leads to `newest`.
    pub(crate) fn begin(&mut self, newest: Setpoint, delay: usize, sample_time: f32) {
        self.delay = delay.min(DELAY_MAX);
        self.next = 0;
        self.unknown = self.delay;
        self.begin = newest;
        self.sample_time = sample_time;
    }

    /// So many samples before the begin.
    #[cold]
    fn before(&self, samples: usize) -> Setpoint {
        let time = self.sample_time * samples as f32;
        let Setpoint {
            position,
            velocity,
            acceleration,
            ..
        } = self.begin;
        Setpoint {
            position: position - time * (velocity - 0.5 * time * acceleration),
            velocity: velocity - time * acceleration,
            acceleration,
            jerk: 0.0,
        }
    }

    /// Takes the newest setpoint; the one of a delay ago. Cost: about 20 instructions.
    #[inline]
    pub(crate) fn pass(&mut self, newest: Setpoint) -> Setpoint {
        let next = self.next;
        self.next = if next + 1 < self.delay { next + 1 } else { 0 };
        let oldest = match self.setpoints.get_mut(next) {
            Some(slot) if self.delay > 0 => core::mem::replace(slot, newest),
            _ => newest,
        };
        if self.unknown == 0 {
            return oldest;
        }
        self.unknown -= 1;
        self.before(self.unknown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setpoint_is_followed_a_delay_later() {
        for delay in [0, 1, 7, DELAY_MAX, DELAY_MAX + 3] {
            let mut followed = Followed::at(0.0);
            // Behind another delay, and behind the same again.
            for before in [3, delay, delay] {
                followed.begin(Setpoint::at(-5.0), before, 1e-3);
                for k in 0..200 {
                    let now = followed.pass(Setpoint::at(k as f32));
                    let back = before.min(DELAY_MAX);
                    let expected = if k < back { -5.0 } else { (k - back) as f32 };
                    assert_eq!(now, Setpoint::at(expected), "{before}: {k}");
                }
            }
        }
    }

    #[test]
    fn a_motion_that_is_taken_over_is_followed_from_where_it_was() {
        let newest = Setpoint {
            position: 100.0,
            velocity: 200.0,
            acceleration: -3000.0,
            jerk: 0.0,
        };
        for delay in [1_usize, 10, DELAY_MAX] {
            let mut followed = Followed::at(0.0);
            followed.begin(newest, delay, 1e-3);
            // The newest is the one before the first that is passed.
            for k in 0..delay {
                let now = followed.pass(Setpoint::at(500.0));
                let t = 1e-3 * (delay - 1 - k) as f32;
                assert!((now.position - (100.0 - t * (200.0 + 1500.0 * t))).abs() < 1e-3);
                assert!((now.velocity - (200.0 + 3000.0 * t)).abs() < 1e-2);
            }
            assert_eq!(followed.pass(newest), Setpoint::at(500.0));
        }
    }
}
