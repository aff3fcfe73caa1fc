//! The velocity that a search finds, from any motion.

use super::*;

const TRAVEL: Travel = Travel {
    min: -1e5,
    max: 1e5,
};

/// The largest velocity from which the axis stops in time, to the last digits.
fn largest(search: &ProfileSearch, limits: &MotionLimits) -> f32 {
    let need = search.direction * (search.target - search.start.position);
    let (mut low, mut high) = (0.0, limits.velocity.min(1e4));
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if search.direction * search.reach(middle, limits).1 > need {
            high = middle;
        } else {
            low = middle;
        }
    }
    low
}

/// Nothing but acceleration and jerk limits the velocity, so that the bracket alone decides how
/// near a dozen halvings come to it.
#[test]
fn a_search_finds_the_largest_velocity_from_any_motion() {
    for jerk in [2.5e5, 2.5e7] {
        let limits = MotionLimits {
            velocity: 1e7,
            acceleration: 9000.0,
            jerk,
        };
        for (velocity, acceleration) in [
            (0.0, 0.0),
            (300.0, 0.0),
            (1500.0, 0.0),
            (-700.0, 0.0),
            (0.0, 9000.0),
            (0.0, -9000.0),
            (200.0, 6000.0),
            (-200.0, 6000.0),
        ] {
            let start = Motion {
                position: 5.0,
                velocity,
                acceleration,
            };
            for distance in [-900.0, -300.0, 300.0, 900.0] {
                let target = start.position + distance;
                let mut search = ProfileSearch::new(start, target, limits);
                assert_eq!(search.target(), target);
                for _ in 0..PLANNING - 2 {
                    assert!(search.step(&limits, &TRAVEL).is_none());
                }
                let (best, found) = (largest(&search, &limits), search.low);
                assert!(
                    found <= 1.0001 * best && found > 0.995 * best - 0.5,
                    "{velocity} {acceleration} {jerk}, {distance}: {found} of {best}"
                );
            }
        }
    }
}

/// The first halving tests the limit itself, so that a long move has all of it.
#[test]
fn a_move_that_is_long_enough_has_the_whole_of_its_velocity() {
    for (velocity, distance) in [(800.0, 2000.0), (120.0, 30.0), (0.5, -1.0)] {
        let limits = MotionLimits {
            velocity,
            acceleration: 9000.0,
            jerk: 2.5e5,
        };
        let mut search = ProfileSearch::new(Motion::at(5.0), 5.0 + distance, limits);
        for _ in 0..PLANNING - 2 {
            assert!(search.step(&limits, &TRAVEL).is_none());
        }
        assert_eq!(search.low, velocity);
    }
}
