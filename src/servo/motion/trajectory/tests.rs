//! Moves, sines and run-outs against their limits.

mod ends;
mod in_motion;

use super::planning::PAUSES;
use super::*;
use crate::error::ConfigError;
use crate::math::sqrt;
use crate::servo::motion::search::PLANNING;

const LIMITS: MotionLimits = MotionLimits {
    velocity: 800.0,
    acceleration: 9000.0,
    jerk: 2.5e5,
};

fn at_rest() -> Trajectory {
    let travel = Travel {
        min: -1000.0,
        max: 1000.0,
    };
    let mut trajectory = Trajectory::new(LIMITS, travel, 1e-3);
    trajectory.hold(0.0);
    trajectory
}

/// Runs until it stands; checks that nothing jumps and nothing exceeds its limit.
fn run(reference: &mut Trajectory, samples: usize) -> usize {
    let mut before = reference.setpoint();
    for k in 0..samples {
        let now = reference.update();
        assert!(now.velocity.abs() <= 1.001 * LIMITS.velocity);
        assert!(now.acceleration.abs() <= 1.001 * LIMITS.acceleration);
        let step = 1e-3 * LIMITS.jerk + 1e-3 * LIMITS.acceleration;
        assert!((now.acceleration - before.acceleration).abs() <= 1.01 * step);
        assert!((now.position - before.position).abs() <= 1.001e-3 * LIMITS.velocity + 1e-4);
        before = now;
        if reference.is_finished() {
            return k;
        }
    }
    samples
}

#[test]
fn moves_from_rest_and_in_motion_end_at_their_targets() {
    let mut reference = at_rest();
    for (target, pause) in [
        (60.0, 40),
        (-3.0, 90),
        (0.02, 10),
        (200.0, 200),
        (900.0, 900),
        (200.0, 700),
        (199.99, 5),
    ] {
        assert_eq!(reference.move_to(target), Ok(()));
        let _ = run(&mut reference, pause);
    }
    assert!(run(&mut reference, 2000) < 2000);
    assert_eq!(reference.setpoint(), Setpoint::at(199.99));
}

#[test]
fn a_move_begins_after_its_planning_and_takes_the_time_of_the_limits() {
    let mut reference = at_rest();
    assert_eq!(reference.move_to(60.0), Ok(()));
    for _ in 0..PLANNING {
        assert_eq!(reference.update(), Setpoint::at(0.0));
    }
    // 60 units without cruise: v^2/a + v a/j = 60, and twice v/a + a/j to go up and down.
    let (a, j) = (LIMITS.acceleration, LIMITS.jerk);
    let v = 0.5 * (sqrt(a * a * a * a / (j * j) + 4.0 * a * 60.0) - a * a / j);
    let time = 2.0 * (v / a + a / j);
    let taken = 1e-3 * run(&mut reference, 2000) as f32;
    assert!((taken - time).abs() < 2e-3, "{taken} s instead of {time} s");
}

#[test]
fn targets_in_every_sample_are_followed() {
    let mut reference = at_rest();
    let mut free = 0;
    for k in 0..400 {
        assert_eq!(reference.move_to(0.1 * k as f32), Ok(()));
        free += u32::from(!reference.is_planning());
        let _ = reference.update();
    }
    // A planning, the samples between, and the one that takes up the next target.
    let [pauses, planning] = [PAUSES, PLANNING].map(u32::from);
    assert_eq!(free, pauses * (400 / (planning + pauses + 1)));
    assert!(reference.setpoint().position > 25.0);
    assert!(run(&mut reference, 2000) < 2000);
    assert_eq!(reference.setpoint(), Setpoint::at(0.1 * 399.0));
}

const TRAVEL: Travel = Travel {
    min: 0.0,
    max: 400.0,
};

fn standing_at(position: f32, limits: MotionLimits) -> Trajectory {
    let mut reference = Trajectory::new(limits, TRAVEL, 1e-3);
    reference.hold(position);
    reference
}

#[test]
fn a_slow_move_is_on_time_after_hours() {
    // 6 min, 1 h and 11 h of constant velocity.
    for (velocity, milliseconds) in [(1.0, 400_000_u32), (0.1, 4_000_000), (0.01, 40_000_000)] {
        let mut reference = standing_at(
            0.0,
            MotionLimits {
                velocity,
                acceleration: 1e5,
                jerk: 1e8,
            },
        );
        assert_eq!(reference.move_to(400.0), Ok(()));
        let half = milliseconds / 2;
        let mut samples = 0_u32;
        while !reference.is_finished() && samples < 3 * half {
            let now = reference.update();
            samples += 1;
            if samples == half + u32::from(PLANNING) {
                assert!((now.position - 200.0).abs() < 2e-3, "{}", now.position);
            }
        }
        let late = samples.abs_diff(milliseconds);
        assert!(
            late < 20 + milliseconds / 1_000_000,
            "{velocity}: {late} ms off"
        );
    }
}

#[test]
fn a_sine_without_room_is_refused_with_what_there_is_room_for() {
    let mut reference = standing_at(370.0, LIMITS);
    for (amplitude, frequency) in [
        (60.0, 1.0),
        (1e6, 1.0),
        (20.0, 400.0),
        (20.0, 1e30),
        (20.0, 0.0),
        (20.0, -1.0),
        (f32::NAN, 1.0),
        (20.0, f32::NAN),
        (f32::INFINITY, 1.0),
        (20.0, 5.0),
    ] {
        let refused = reference.oscillate(amplitude, frequency);
        assert!(refused.is_err(), "{amplitude} at {frequency} Hz");
        assert_eq!(reference.update(), Setpoint::at(370.0));
    }
    let refused = reference.oscillate(60.0, 1.0);
    let Err(Error::Setting(ConfigError::OutOfRange { limits, .. })) = refused else {
        panic!("no room for 60");
    };
    let max = limits[1];
    assert_eq!(max, 30.0);
    assert_eq!(reference.oscillate(max, 1.0), Ok(()));
}

/// Runs; nothing jumps, leaves its limits or the travel.
fn watch(reference: &mut Trajectory, samples: usize) {
    let mut before = reference.setpoint();
    for k in 0..samples {
        let now = reference.update();
        assert!(TRAVEL.contains(now.position), "{k}: {now:?}");
        assert!(
            now.velocity.abs() <= 1.001 * LIMITS.velocity,
            "{k}: {now:?}"
        );
        assert!(
            now.acceleration.abs() <= 1.001 * LIMITS.acceleration,
            "{k}: {now:?}"
        );
        assert!(now.jerk.abs() <= 1.001 * LIMITS.jerk, "{k}: {now:?}");
        let v = now.velocity - before.velocity;
        assert!(
            v.abs() <= 1.01e-3 * LIMITS.acceleration,
            "{k}: {before:?} {now:?}"
        );
        before = now;
    }
}

#[test]
fn a_sine_continues_the_motion_within_the_limits() {
    for interrupted in 17..330 {
        let mut reference = standing_at(40.0, LIMITS);
        assert_eq!(reference.move_to(300.0), Ok(()));
        watch(&mut reference, interrupted);
        assert_eq!(reference.oscillate(15.0, 2.0), Ok(()));
        watch(&mut reference, 700);
        // In motion again, and a move out of the sine.
        assert_eq!(reference.oscillate(10.0, 1.0), Ok(()));
        watch(&mut reference, interrupted);
        assert_eq!(reference.move_to(390.0), Ok(()));
        watch(&mut reference, 900);
        assert_eq!(reference.setpoint(), Setpoint::at(390.0));
    }
}

#[test]
fn a_motion_that_is_taken_over_comes_to_rest_within_the_travel() {
    for position in [1.0_f32, 20.0, 100.0, 200.0, 390.0, 399.0] {
        for velocity in [-1500.0_f32, -800.0, -100.0, 0.0, 30.0, 800.0, 1500.0] {
            for acceleration in [-9e3_f32, 0.0, 5e3] {
                let mut reference = standing_at(position, LIMITS);
                let from = Motion {
                    position,
                    velocity,
                    acceleration,
                };
                reference.run_out(from, 25.0);
                for _ in 0..2000 {
                    let now = reference.update();
                    assert!(TRAVEL.contains(now.position), "{from:?}: {now:?}");
                }
                assert!(reference.setpoint().is_rest(), "{from:?}");
            }
        }
    }
}

/// A number from -1 to 1; xorshift (Marsaglia 2003).
fn draw(state: &mut u32) -> f32 {
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    *state as f32 / (u32::MAX as f32) * 2.0 - 1.0
}

#[test]
fn requests_after_any_motion_that_was_taken_over_keep_within_the_travel() {
    let mut random = 0x2545_F491_u32;
    for case in 0..2000 {
        let mut next = || draw(&mut random);
        let from = Motion {
            position: 200.0 + 150.0 * next(),
            velocity: 0.5 * LIMITS.velocity * next(),
            // A lightly damped axis swings harder than a move may.
            acceleration: 3.0 * LIMITS.acceleration * next(),
        };
        let limits = MotionLimits {
            jerk: LIMITS.jerk * if case % 2 == 0 { 1.0 } else { 0.05 },
            ..LIMITS
        };
        let mut reference = standing_at(from.position, limits);
        reference.run_out(from, 10.0 + 15.0 * next().abs());
        let hardest = 64.0 * 4.0 * LIMITS.acceleration;
        let mut before = from.velocity;
        let mut target = None;
        for sample in 0..4000 {
            if sample < 400 && next() > 0.97 {
                let wanted = 200.0 + 200.0 * next();
                assert_eq!(reference.move_to(wanted), Ok(()));
                target = Some(wanted);
            }
            let now = reference.update();
            assert!(TRAVEL.contains(now.position), "{case}: {now:?}");
            let change = (now.velocity - before).abs();
            assert!(
                change <= 1e-3 * hardest,
                "{case}, {sample}: {before} {now:?}"
            );
            before = now.velocity;
        }
        assert!(reference.is_finished(), "{case}");
        let end = reference.setpoint();
        assert_eq!(end, Setpoint::at(target.unwrap_or(end.position)), "{case}");
    }
}

#[test]
fn a_sine_at_the_limits_grows_within_them() {
    for frequency in [0.5, 2.0, 5.0, 12.0, 30.0] {
        let mut reference = standing_at(200.0, LIMITS);
        let Err(Error::Setting(ConfigError::OutOfRange { limits, .. })) =
            reference.oscillate(1e6, frequency)
        else {
            panic!("{frequency} Hz");
        };
        let [_, most] = limits;
        for part in [0.5, 0.7, 0.95, 1.0] {
            reference.hold(200.0);
            assert_eq!(reference.oscillate(part * most, frequency), Ok(()));
            watch(&mut reference, (6e3 / frequency) as usize);
        }
    }
}
