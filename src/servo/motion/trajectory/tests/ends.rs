//! What the ends of the travel leave.

extern crate std;

use std::vec::Vec;

use super::*;

#[test]
fn a_sine_has_room_on_both_sides_of_its_middle() {
    let travel = Travel {
        min: 100.0,
        max: 500.0,
    };
    for (place, room) in [(150.0, 50.0), (440.0, 60.0)] {
        let mut trajectory = Trajectory::new(LIMITS, travel, 1e-3);
        trajectory.hold(place);
        assert!(trajectory.oscillate(room + 1.0, 0.5).is_err());
        assert_eq!(trajectory.oscillate(room - 1.0, 0.5), Ok(()));
    }
}

#[test]
fn a_brake_is_as_much_harder_as_the_end_of_the_travel_needs() {
    let travel = Travel {
        min: -1000.0,
        max: 1000.0,
    };
    let trajectory = Trajectory::new(LIMITS, travel, 1e-3);
    for velocity in [600.0, -600.0_f32] {
        let way = velocity.signum();
        let from = |distance: f32| Motion {
            position: way * (1000.0 - distance),
            velocity,
            acceleration: 0.0,
        };
        // v^2 / 2a + v a / 2j at the limits, and with twice and four times of them.
        let distance = |harder: f32| 20.0 / harder + 10.8 / harder;
        for (room, harder) in [(31.0, 1.0), (30.0, 2.0), (15.5, 2.0), (15.3, 4.0)] {
            let start = from(room);
            let target = trajectory.brake(start).target();
            let gone = way * (target - start.position);
            assert!((gone - distance(harder)).abs() < 0.02, "{room}: {gone}");
        }
    }
}

#[test]
fn slow_limits_do_not_keep_a_brake_from_ending_within_the_travel() {
    let travel = Travel {
        min: -1000.0,
        max: 1000.0,
    };
    for share in [1e-3, 3e-4, 1e-6] {
        let slow = MotionLimits {
            acceleration: share * LIMITS.acceleration,
            jerk: share * LIMITS.jerk,
            ..LIMITS
        };
        for way in [1.0, -1.0_f32] {
            for (room, gains) in [(300.0, 0.0), (30.0, 0.0), (3.0, 0.0), (100.0, 500.0)] {
                let mut trajectory = Trajectory::new(slow, travel, 1e-3);
                let start = Motion {
                    position: way * (1000.0 - room),
                    velocity: 200.0 * way,
                    acceleration: gains * way,
                };
                trajectory.run_out(start, 10.0);
                let (mut last, mut hardest) = (start.velocity, 0.0_f32);
                for _ in 0..20_000 {
                    let next = trajectory.update().velocity;
                    hardest = hardest.max((next - last).abs());
                    last = next;
                }
                // v^2 / 2 room is the least that any brake needs.
                let needed = 200.0 * 200.0 / (2.0 * room) * 1e-3;
                assert!(hardest < 6.0 * needed, "{share} {room}: {hardest} {needed}");
                assert!(trajectory.is_finished());
            }
        }
    }
}

/// Setpoints of a move from 0 by a generator that knows how an axis comes to an end, or not.
fn moved(target: f32, knows: bool) -> Vec<Setpoint> {
    let mut trajectory = at_rest();
    if knows {
        trajectory.approach(EndApproach {
            time: 1.0 / 30.0,
            speed: 30.0,
        });
    }
    assert_eq!(trajectory.move_to(target), Ok(()));
    let setpoints = (0..4000).map(|_| trajectory.update()).collect();
    assert!(trajectory.is_finished());
    setpoints
}

#[test]
fn only_a_move_to_an_end_brakes_more_gently_and_it_arrives_there() {
    for target in [1.0, 500.0, 985.0, -985.0_f32] {
        assert_eq!(moved(target, true), moved(target, false), "{target}");
    }
    for end in [1000.0, -1000.0_f32] {
        let (gentle, free) = (moved(end, true), moved(end, false));
        assert_eq!(gentle.last(), Some(&Setpoint::at(end)));
        let hardest = |setpoints: &[Setpoint]| {
            let along = setpoints.iter().map(|s| -end.signum() * s.acceleration);
            along.fold(0.0_f32, f32::max)
        };
        // end speed w / sqrt 2.
        let most = 30.0 * 30.0 * core::f32::consts::FRAC_1_SQRT_2;
        assert!(hardest(&gentle) < 1.01 * most);
        assert!(hardest(&free) > 0.99 * LIMITS.acceleration);
        // A deflection before the end it is as slow as that.
        let lead = most / 900.0;
        for s in gentle
            .iter()
            .filter(|s| end.abs() - s.position.abs() < lead)
        {
            assert!(s.velocity.abs() < 1.01 * 30.0, "{s:?}");
        }
    }
}

/// As where a measured motion was taken over too near to an end.
#[test]
fn what_would_lead_beyond_an_end_stands_at_it() {
    for way in [1.0, -1.0_f32] {
        for waits in [false, true] {
            let mut moves = at_rest();
            moves.move_to(100.0 * way).unwrap();
            while moves.update().position.abs() < 4.0 {}
            if waits {
                moves.move_to(2.0 * way).unwrap();
            }
            (moves.travel.min, moves.travel.max) = (-5.0, 5.0);
            while moves.setpoint().position.abs() < 5.0 {
                assert!(moves.update().position.abs() <= 5.0);
            }
            assert_eq!(moves.setpoint(), Setpoint::at(5.0 * way));
            for _ in 0..1000 {
                assert!(moves.update().position.abs() <= 5.0);
            }
            // What was asked for meanwhile is not forgotten.
            let place = if waits { 2.0 } else { 5.0 };
            assert!((moves.setpoint().position - place * way).abs() < 1e-3);
            assert!(moves.is_finished());
        }
    }
}

#[test]
fn a_sine_that_would_lead_beyond_an_end_is_cut_there_and_goes_on() {
    let mut moves = at_rest();
    moves.oscillate(20.0, 1.0).unwrap();
    (moves.travel.min, moves.travel.max) = (-5.0, 5.0);
    let path: Vec<f32> = (0..3000).map(|_| moves.update().position).collect();
    let (low, high) = path.iter().fold((0.0_f32, 0.0_f32), |(low, high), &at| {
        (low.min(at), high.max(at))
    });
    assert_eq!((low, high), (-5.0, 5.0));
    let turns = path.windows(2).filter(|w| w[0] < 0.0 && w[1] >= 0.0);
    assert!(turns.count() >= 2);
}

#[test]
fn a_stop_ends_whatever_was_asked_for() {
    for asked in 0..4 {
        let mut trajectory = at_rest();
        match asked {
            0 => {}
            1 => assert_eq!(trajectory.oscillate(100.0, 0.5), Ok(())),
            _ => assert_eq!(trajectory.move_to(900.0), Ok(())),
        }
        for _ in 0..if asked == 3 { 5 } else { 300 } {
            let _ = trajectory.update();
        }
        let inner = trajectory.travel.inner();
        trajectory.stop(&inner);
        for _ in 0..4000 {
            let _ = trajectory.update();
        }
        assert!(trajectory.is_finished(), "{asked}");
        assert!(trajectory.setpoint().position < 799.0, "{asked}");
    }
    // Near an end it leads to where there is room.
    let mut trajectory = at_rest();
    for target in [950.0, -1000.0] {
        assert_eq!(trajectory.move_to(target), Ok(()));
        while trajectory.setpoint().position != target {
            let _ = trajectory.update();
        }
        let inner = trajectory.travel.inner();
        trajectory.stop(&inner);
        assert!(!trajectory.is_finished(), "{target}: it is asked for");
        for _ in 0..4000 {
            let _ = trajectory.update();
        }
        assert!((trajectory.setpoint().position.abs() - 800.0).abs() < 1e-3);
    }
}

#[test]
fn an_acceleration_far_beyond_slow_limits_ends_within_the_travel() {
    let travel = Travel {
        min: -1000.0,
        max: 1000.0,
    };
    let slow = MotionLimits {
        acceleration: 10.0,
        jerk: 1000.0,
        ..LIMITS
    };
    let trajectory = Trajectory::new(slow, travel, 1e-3);
    for way in [1.0, -1.0_f32] {
        let start = Motion {
            position: way * 994.0,
            velocity: way,
            acceleration: way * 60_000.0,
        };
        // What the acceleration alone takes, and the brake from the velocity that it leaves, end
        // within the room with 2^6 and 2^7 times the limits.
        let stop = trajectory.brake(start);
        let gone = way * (stop.target() - start.position);
        assert!(stop.stays_within(&travel) && gone > 1.0, "{way}: {gone}");
    }
}
