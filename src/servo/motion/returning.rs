//! The way back of an axis that stands beyond an end of its travel.

use crate::servo::motion::profile::Move;
use crate::servo::motion::segment::Segment;
use crate::servo::motion::{Motion, MotionLimits};

/// Doublings of the time after which it is long enough for any limits.
const DOUBLINGS: u8 = 30;

/// From rest to rest over the distance D, in no less than `4 T` with T = 1/w of the axis.
///
/// ```text
/// jerk j, -j, j for T, 2 T, T:   D = 2 j T^3,   acceleration D/(2 T^2),   velocity D/(2 T)
/// ```
///
/// So the axis follows without swinging; where the limits of motion ask for more time it takes
/// that. No search: what is planned by it begins at once.
pub(crate) fn way_back(from: f32, target: f32, rate: f32, limits: &MotionLimits) -> Move {
    let distance = target - from;
    let mut time = 1.0 / rate;
    for _ in 0..DOUBLINGS {
        let velocity = 0.5 * distance.abs() / time;
        let acceleration = velocity / time;
        if velocity <= limits.velocity
            && acceleration <= limits.acceleration
            && acceleration <= limits.jerk * time
        {
            break;
        }
        time *= 2.0;
    }
    let jerk = 0.5 * distance / (time * time * time);
    let piece = |sign: f32, times: f32| Segment {
        jerk: sign * jerk,
        duration: times * time,
    };
    let none = Segment::default();
    let segments = [
        piece(1.0, 1.0),
        piece(-1.0, 2.0),
        piece(1.0, 1.0),
        none,
        none,
        none,
        none,
    ];
    Move::new(segments, Motion::at(from), target)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::motion::Setpoint;

    #[test]
    fn the_way_back_ends_at_its_target_within_the_limits() {
        let limits = MotionLimits {
            velocity: 50.0,
            acceleration: 200.0,
            jerk: 5000.0,
        };
        for (from, target) in [(-3.0, 0.0), (404.0, 400.0), (-0.001, 0.0)] {
            for rate in [5.0, 30.0, 100.0] {
                let mut way = way_back(from, target, rate, &limits);
                let (mut before, mut ended) = (Setpoint::at(from), false);
                for _ in 0..5000 {
                    let now;
                    (now, ended) = way.next(1e-3);
                    assert!(now.velocity.abs() <= limits.velocity);
                    assert!(now.acceleration.abs() <= 1.001 * limits.acceleration);
                    assert!(now.jerk.abs() <= 1.001 * limits.jerk);
                    let step = (now.position - before.position).abs();
                    assert!(
                        step < 1e-3 * limits.velocity + 1e-4,
                        "{from} {rate}: {step}"
                    );
                    before = now;
                    if ended {
                        break;
                    }
                }
                assert!(ended, "{from} {rate}");
                assert_eq!(before, Setpoint::at(target));
            }
        }
    }

    /// 4 T, doubled for the first limit that asks for more.
    #[test]
    fn the_way_back_takes_no_longer_than_the_axis_and_the_limits_ask_for() {
        let (from, target, rate) = (4.0, 0.0, 5.0);
        let [velocity, acceleration, jerk] = [10.0, 50.0, 250.0];
        let samples = |velocity, acceleration, jerk| {
            let limits = MotionLimits {
                velocity,
                acceleration,
                jerk,
            };
            let mut way = way_back(from, target, rate, &limits);
            (1..5000).find(|_| way.next(1e-3).1).unwrap()
        };
        let near = |found: u32, expected: u32| found.abs_diff(expected) <= 1;
        let (over, under) = (1.01, 0.99);
        let free = samples(over * velocity, over * acceleration, over * jerk);
        assert!(near(free, 800), "{free}");
        for limit in 0..3 {
            let [v, a, j] = core::array::from_fn(|i| if i == limit { under } else { over });
            let slow = samples(v * velocity, a * acceleration, j * jerk);
            assert!(near(slow, 1600), "{limit}: {slow}");
        }
    }
}
