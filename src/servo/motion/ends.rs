//! The way of a move to an end of the travel, and of a sine near it.

use crate::math::sqrt;
use crate::servo::motion::{MotionLimits, Travel};

/// What an axis does behind a reference that brakes, and what an end may take.
///
/// A reference that brakes with `a` stands at its target when an axis whose drive comes later by
/// 1/w still goes on: it is ahead by up to `a / w^2`, the deflection of the drive under `a`. Where
/// the stroke ends before that, `d` behind the target, it strikes the stop at the speed that the
/// reference had that far before it:
///
/// ```text
/// v^2 = 2 a (a / w^2 - d) <= end speed^2,   a / w^2 <= d/2 + sqrt(d^2/4 + (end speed / w)^2 / 2)
/// ```
///
/// So a move to an end brakes more gently than others; from `d = a / w^2` on it is one of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EndApproach {
    /// 1/w.
    pub(crate) time: f32,
    /// Speed that an end may take.
    pub(crate) speed: f32,
}

impl EndApproach {
    /// Every way is free: nothing is known of the axis.
    pub(crate) const NONE: Self = Self {
        time: 0.0,
        speed: 0.0,
    };

    /// The largest amplitude of a sine of `omega` (rad/s) whose centre has `room` to an end.
    ///
    /// Where it turns back it brakes with `a = A omega^2`, and what lies behind it is `room - A`:
    ///
    /// ```text
    /// A (1 + q) <= room + end speed^2 / (2 A omega^2),   q = (omega / w)^2
    /// ```
    pub(crate) fn amplitude(&self, room: f32, omega: f32) -> f32 {
        let q = omega * self.time * omega * self.time;
        let swing = self.speed / omega;
        let most = room + sqrt(room * room + 2.0 * (1.0 + q) * swing * swing);
        let most = most / (2.0 * (1.0 + q));
        if most < room { most } else { room }
    }

    /// The limits for the brake of a move from a place to a target. Cost: about 10 instructions,
    /// near an end a root and two divisions.
    pub(crate) fn brake(
        &self,
        from: f32,
        target: f32,
        limits: &MotionLimits,
        travel: &Travel,
    ) -> MotionLimits {
        let room = if target > from {
            travel.max - target
        } else {
            target - travel.min
        };
        let square = self.time * self.time;
        if square * limits.acceleration <= room {
            return *limits;
        }
        let swing = self.speed * self.time;
        let ahead = 0.5 * room + sqrt(0.25 * room * room + 0.5 * swing * swing);
        if !(ahead > 0.0 && square * limits.acceleration > ahead) {
            return *limits;
        }
        let acceleration = ahead / square;
        let jerk = acceleration / self.time;
        MotionLimits {
            acceleration,
            jerk: if jerk < limits.jerk {
                jerk
            } else {
                limits.jerk
            },
            ..*limits
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: MotionLimits = MotionLimits {
        velocity: 800.0,
        acceleration: 9000.0,
        jerk: 2.5e5,
    };
    const TRAVEL: Travel = Travel {
        min: -100.0,
        max: 300.0,
    };
    const ENDS: EndApproach = EndApproach {
        time: 1.0 / 30.0,
        speed: 30.0,
    };

    #[test]
    fn an_axis_that_is_ahead_by_the_deflection_of_its_drive_meets_the_end_at_its_speed() {
        for room in [0.0, 0.5, 3.0, 9.0] {
            let [up, down] = [
                ENDS.brake(0.0, TRAVEL.max - room, &LIMITS, &TRAVEL),
                ENDS.brake(0.0, TRAVEL.min + room, &LIMITS, &TRAVEL),
            ];
            let a = up.acceleration;
            let ahead = a * ENDS.time * ENDS.time - room;
            let speed = sqrt(2.0 * a * ahead);
            assert!((speed - ENDS.speed).abs() < 0.1, "{room}: {speed}");
            assert!((down.acceleration / a - 1.0).abs() < 1e-4, "{room}");
            assert!(a < LIMITS.acceleration && up.velocity == LIMITS.velocity);
        }
    }

    #[test]
    fn a_sine_turns_back_where_what_is_ahead_of_it_meets_the_end_at_its_speed() {
        for room in [1.0, 20.0, 150.0_f32] {
            for omega in [0.5, 6.0, 20.0, 60.0_f32] {
                let most = ENDS.amplitude(room, omega);
                assert!(most > 0.0 && most <= room, "{room} {omega}: {most}");
                let a = most * omega * omega;
                let beyond = a * ENDS.time * ENDS.time - (room - most);
                let square = 2.0 * a * beyond;
                let limit = ENDS.speed * ENDS.speed;
                assert!(square < 1.01 * limit, "{room} {omega}: {square}");
                // No smaller than it must be.
                assert!(
                    most == room || square > 0.99 * limit,
                    "{room} {omega}: {square}"
                );
            }
        }
        assert_eq!(EndApproach::NONE.amplitude(7.0, 6.0), 7.0);
    }

    #[test]
    fn where_the_end_is_far_behind_the_target_nothing_changes() {
        // 9000 / 900 is a deflection of 10, with some to spare for the speed.
        for target in [TRAVEL.max - 10.0, 0.0, TRAVEL.min + 10.0] {
            for ends in [ENDS, EndApproach::NONE] {
                assert_eq!(ends.brake(50.0, target, &LIMITS, &TRAVEL), LIMITS);
            }
        }
        let none = EndApproach::NONE.brake(0.0, TRAVEL.max, &LIMITS, &TRAVEL);
        assert_eq!(none, LIMITS);
        let still = EndApproach { speed: 0.0, ..ENDS };
        assert_eq!(still.brake(0.0, TRAVEL.max, &LIMITS, &TRAVEL), LIMITS);
    }
}
