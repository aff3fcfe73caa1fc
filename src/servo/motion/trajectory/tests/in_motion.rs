//! Where a move begins that is asked for in motion.

use super::*;

/// A reference in some motion: a move, a run-out, a sine, each `samples` after its begin.
fn moving(kind: u32, draws: [f32; 4]) -> Trajectory {
    let [place, velocity, acceleration, wanted] = draws;
    let mut reference = standing_at(200.0 + 100.0 * place, LIMITS);
    match kind {
        0 => assert_eq!(reference.move_to(200.0 + 200.0 * wanted), Ok(())),
        1 => {
            let frequency = 1.0 + 0.9 * velocity;
            assert_eq!(reference.oscillate(20.0 * wanted, frequency), Ok(()));
        }
        2 => {
            let from = Motion {
                position: 200.0 + 100.0 * place,
                velocity: 400.0 * velocity,
                acceleration: 5e3 * acceleration,
            };
            reference.run_out(from, 20.0 + 15.0 * wanted);
        }
        // Towards an end of the travel that is too near, and on from it.
        _ => {
            let from = Motion {
                position: if wanted > 0.0 { 399.5 } else { 0.5 } + 0.5 * place,
                velocity: 2000.0 * velocity,
                acceleration: 2e5 * acceleration,
            };
            reference.run_out(from, 30.0);
        }
    }
    reference
}

#[test]
fn a_swing_of_the_drive_is_none_of_the_reference() {
    for way in [1.0, -1.0] {
        for velocity in [0.0, 200.0, -200.0] {
            for share in [2.0, 10.0, 30.0] {
                let mut reference = at_rest();
                let from = Motion {
                    velocity,
                    acceleration: way * share * LIMITS.acceleration,
                    ..Motion::at(0.0)
                };
                reference.run_out(from, 25.0);
                assert_eq!(reference.setpoint().velocity, velocity);
                assert!(run(&mut reference, 2000) < 2000, "{velocity} {share}");
                // Speed and acceleration are gone in 0.1 s.
                let gone = reference.setpoint().position.abs();
                assert!(gone < 30.0, "{way} {velocity} {share}: {gone}");
            }
        }
    }
}

#[test]
fn the_motion_ahead_is_that_of_the_samples_to_come() {
    let mut random = 0x1234_5678_u32;
    let mut ended = 0;
    for case in 0..3000 {
        let draws = [0; 4].map(|_| draw(&mut random));
        let mut reference = moving(case % 3, draws);
        let samples = 150.0 * (1.0 + draw(&mut random));
        for _ in 0..samples as usize {
            let _ = reference.update();
        }
        let ahead = reference.ahead();
        for _ in 0..PLANNING {
            let _ = reference.advance();
        }
        let then = reference.setpoint().motion();
        let rests = reference.setpoint().is_rest();
        ended += u32::from(rests);
        // A run-out ends at a ten-thousandth of the limits.
        let left = if rests { 1e-4 } else { 0.0 };
        let off = |a: f32, b: f32, limit: f32| (a - b).abs() / limit;
        assert!(
            off(ahead.position, then.position, 400.0) < 1e-6,
            "{case}: {ahead:?} {then:?}"
        );
        let velocity = off(ahead.velocity, then.velocity, LIMITS.velocity);
        assert!(velocity < 1e-5 + left, "{case}: {ahead:?} {then:?}");
        let acceleration = off(ahead.acceleration, then.acceleration, LIMITS.acceleration);
        assert!(acceleration < 1e-5 + left, "{case}: {ahead:?} {then:?}");
    }
    assert!(ended > 100, "{ended}");
}

#[test]
fn a_move_begins_at_rest_where_the_reference_was_stopped_meanwhile() {
    let mut random = 0x0BAD_CAFE_u32;
    for case in 0..3000 {
        let draws = [0; 4].map(|_| draw(&mut random));
        let mut reference = moving(case % 4, draws);
        let often = case % 8 < 4;
        let mut before = reference.setpoint();
        let mut target = 0.0;
        for sample in 0..3000 {
            if sample == 0 || (often && sample < 400 && draw(&mut random) > 0.95) {
                target = 200.0 * (1.0 + draw(&mut random));
                assert_eq!(reference.move_to(target), Ok(()));
            }
            let now = reference.update();
            // From rest at most as the jerk leads, and beforehand no place but that of rest.
            if before.is_rest() {
                let place = (now.position - before.position).abs();
                assert!(place < 1e-3, "{case}, {sample}: {before:?} {now:?}");
                let limit = 0.51e-6 * LIMITS.jerk;
                assert!(
                    now.velocity.abs() < limit,
                    "{case}, {sample}: {before:?} {now:?}"
                );
            }
            before = now;
        }
        assert_eq!(before, Setpoint::at(target), "{case}");
    }
}
