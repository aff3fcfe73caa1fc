//! The whole loop on a drive that is its own model, and what it does with faults.

mod alarms;
mod awaited;
mod beginning;
pub(super) mod bench;
mod built;
mod missing;
mod patterns;
mod resumed;
mod slow;
mod stopped;
mod swinging;
mod waiting;
mod whole;

use super::*;
use crate::servo::control::tuning::Tuning;
use bench::{Bench, MODEL};

#[test]
fn on_its_own_model_the_loop_follows_every_reference() {
    for (damping, dead_zone, offset) in [(0.4, 0.0, 0.0), (0.8, 0.0, 0.0), (0.4, 0.03, 0.01)] {
        let model = Model {
            a2: 50.0 * damping,
            dead_zone,
            offset,
            ..MODEL
        };
        let mut bench = Bench::new(model);
        // The poles are sought within some samples.
        let _ = bench.worst(1500);
        // A step of the jerk comes a delay late; a sine has none. What the blend of the dead zone
        // leaves at reversals of the flow comes on top.
        let most = [0.5, if dead_zone > 0.0 { 0.1 } else { 0.03 }];
        for target in [320.0, 80.0, 81.0, 200.0] {
            bench.servo.move_to(target).expect("a target");
            let worst = bench.worst(2500);
            assert!(
                worst < most[0],
                "{damping} {dead_zone} to {target}: {worst}"
            );
            assert!((bench.motion.position - target).abs() < 0.02, "{target}");
        }
        bench.servo.oscillate(30.0, 1.0).expect("a sine");
        let worst = bench.worst(5000);
        assert!(worst < most[1], "{damping} {dead_zone} sine: {worst}");
    }
}

#[test]
fn a_force_that_nobody_told_is_worked_off() {
    let mut bench = Bench::new(MODEL);
    let _ = bench.worst(1500);
    // The valve of the drive is off by 0.02, which the model does not know.
    bench.model.offset = 0.02;
    let worst = bench.worst(3000);
    assert!(worst < 3.0, "{worst}");
    let left = bench.worst(500);
    assert!(left < 0.02, "{left}");
    // A gain that is a fifth off does not matter at rest, and little in motion.
    bench.model.b0 *= 0.8;
    bench.servo.move_to(300.0).expect("a target");
    assert!(bench.worst(3000) < 6.0);
    assert!(bench.worst(500) < 0.03);
}

#[test]
fn friction_is_overcome_and_left_to_hold_the_axis() {
    let model = Model {
        friction: 400.0,
        dead_zone: 0.02,
        ..MODEL
    };
    let mut bench = Bench::new(model);
    let _ = bench.worst(1500);
    // Friction of the drive of the bench: it takes what the acceleration would be.
    let slide = |bench: &mut Bench, samples: u32| {
        for _ in 0..samples {
            let before = bench.motion;
            let _ = bench.step();
            let v = bench.motion.velocity;
            let held = 0.4;
            let slower = if v.abs() <= held {
                0.0
            } else {
                v - held * v.signum()
            };
            bench.motion.velocity = slower;
            bench.motion.position = before.position + 5e-4 * (before.velocity + slower);
        }
    };
    for target in [250.0, 150.0] {
        bench.servo.move_to(target).expect("a target");
        slide(&mut bench, 4000);
        let error = (bench.motion.position - target).abs();
        assert!(error < 0.2, "{target}: {error}");
        assert!(bench.servo.supervisor().state().is_controlling());
    }
    let mut errors = [0.0_f32; 24];
    for (k, error) in errors.iter_mut().enumerate() {
        let target = 200.0 + 80.0 * libm::sinf(37.0 * k as f32);
        bench.servo.move_to(target).expect("a target");
        slide(&mut bench, 4000);
        *error = (bench.motion.position - target).abs();
        assert!(bench.servo.supervisor().state().is_controlling());
    }
    errors.sort_by(f32::total_cmp);
    // Friction holds a deflection of 400/625: the axis rests mostly well within it.
    let deflection = model.friction / model.a1;
    assert!(
        errors[12] < 0.2 * deflection && errors[23] < 2.0 * deflection,
        "{errors:?}"
    );
}

/// Fails for a reason while the axis moves; the loop behind it.
fn failed(model: Model, reason: Reason) -> Bench {
    let mut bench = Bench::new(model);
    let _ = bench.worst(1500);
    bench.servo.move_to(300.0).expect("a target");
    while bench.motion.velocity < 50.0 {
        let _ = bench.worst(1);
    }
    bench.servo.fail(reason);
    bench
}

#[test]
fn an_axis_whose_position_is_known_is_braked_and_then_its_valve_is_in_the_middle() {
    let model = Model {
        offset: 0.05,
        dead_zone: 0.02,
        ..MODEL
    };
    let mut bench = failed(model, Reason::FollowingError);
    let start = bench.motion.position;
    let mut pushed = 0.0_f32;
    for _ in 0..200 {
        let (report, _) = bench.step();
        assert_eq!(report.state, State::Failed(Reason::FollowingError));
        pushed = pushed.min(report.command);
    }
    // Against the motion, by more than the middle of the valve.
    assert!(pushed < -0.1, "{pushed}");
    for _ in 0..3000 {
        let _ = bench.step();
    }
    let (report, _) = bench.step();
    assert!((report.command + 0.05).abs() < 1e-4, "{}", report.command);
    assert!(bench.motion.velocity.abs() < 1.0 && bench.motion.position > start);
    // Not known: the middle at once, at the rate of the limiter.
    let mut blind = failed(model, Reason::SensorFault);
    for _ in 0..60 {
        let (report, _) = blind.step();
        assert!(report.command > -0.051, "{}", report.command);
    }
    assert!((blind.step().0.command + 0.05).abs() < 1e-4);
}

#[test]
fn the_middle_of_a_valve_is_where_it_is_known_and_zero_where_it_is_not() {
    let wide = Model {
        offset: -0.05,
        dead_zone: 0.02,
        ..MODEL
    };
    let narrow = Model {
        dead_zone: 0.06,
        ..wide
    };
    for (model, reason, middle) in [
        (wide, Reason::ValveFault, 0.05),
        (wide, Reason::ValveStuck, 0.0),
        (narrow, Reason::WrongSign, 0.0),
        (narrow, Reason::Blocked, 0.05),
    ] {
        let mut bench = Bench::new(model);
        let _ = bench.step();
        bench.servo.fail(reason);
        assert!((bench.servo.centre() - middle).abs() < 1e-6, "{reason:?}");
        // The first reason stays.
        bench.servo.fail(Reason::TravelEnd);
        assert_eq!(bench.servo.supervisor().state(), State::Failed(reason));
    }
    // Behind a wrong sign the way of the creep tells.
    let mut bench = Bench::new(wide);
    let _ = bench.step();
    bench.servo.fail(Reason::WrongSign);
    assert_eq!(bench.servo.centre(), 0.0);
    for _ in 0..3000 {
        let _ = bench.step();
        if bench.servo.centre() != 0.0 {
            break;
        }
    }
    assert_eq!(bench.servo.centre().abs(), 0.05);
    // Before there is a model, and while it controls, there is no middle.
    let mut bench = Bench::new(wide);
    let _ = bench.step();
    assert_eq!(bench.servo.centre(), 0.0);
}

#[test]
fn an_axis_that_is_aborted_has_its_valve_in_the_middle_too() {
    let model = Model {
        offset: 0.05,
        dead_zone: 0.02,
        ..MODEL
    };
    let mut bench = Bench::new(model);
    let _ = bench.worst(1500);
    bench.servo.abort();
    for _ in 0..500 {
        let _ = bench.step();
    }
    let start = bench.motion.position;
    for _ in 0..5000 {
        assert_eq!(bench.step().0.state, State::Idle);
    }
    let crept = (bench.motion.position - start).abs();
    assert!(crept < 0.1, "{crept}");
    assert_eq!(bench.servo.centre(), -0.05);
    // What a fault has shown of the valve holds behind an abort, until a model takes over.
    bench.servo.fail(Reason::ValveStuck);
    bench.servo.abort();
    assert_eq!(bench.servo.centre(), 0.0);
    bench
        .servo
        .install(model)
        .expect("a model that may control");
    bench.servo.abort();
    assert_eq!(bench.servo.centre(), -0.05);
}

#[test]
fn an_oscillation_takes_bandwidth_to_half_and_no_further() {
    let mut bench = Bench::new(MODEL);
    let _ = bench.step();
    for factor in [0.7, 0.49, 0.49] {
        bench.servo.calm();
        assert!(
            (bench.servo.fallback.derating - factor).abs() < 1e-6,
            "{factor}"
        );
        // The model of the commissioning is the one in use: nothing to consider again.
        assert!(!bench.servo.fallback.reconsiders);
    }
    bench.servo.fallback.known_good = Some(Model { a2: 21.0, ..MODEL });
    bench.servo.calm();
    assert!(bench.servo.fallback.reconsiders);
}

#[test]
fn the_poles_of_a_search_that_goes_on_reach_the_controller_of_their_model() {
    let mut bench = Bench::new(MODEL);
    let _ = bench.worst(100);
    let design = *bench.servo.controller.tuning_design();
    let slow = Tuning::slowest(&design, &MODEL);
    let mut tuning = Tuning::new(&design, &MODEL);
    while !tuning.step() {}
    let (fast, margins) = tuning.poles();
    assert!(fast.bandwidth > 1.5 * slow.bandwidth && margins.is_some());
    for (model, reached) in [(MODEL, true), (Model { a2: 21.0, ..MODEL }, false)] {
        bench.servo.controller.replace_poles(slow, None);
        let _ = bench.worst(2);
        assert_eq!(bench.servo.controller().bandwidth(), slow.bandwidth);
        assert_eq!(bench.servo.margins(), None);
        bench.servo.takeover.unsearched = Some(model);
        while bench.servo.takeover.is_searching() {
            let _ = bench.worst(1);
        }
        let _ = bench.worst(2);
        let (bandwidth, known) = if reached {
            (fast.bandwidth, margins)
        } else {
            (slow.bandwidth, None)
        };
        assert_eq!(bench.servo.controller().bandwidth(), bandwidth);
        assert_eq!(bench.servo.margins(), known);
    }
}

#[test]
fn a_creep_behind_a_wrong_sign_counts_where_a_valve_at_zero_is_open() {
    for (dead_zone, middle) in [(0.02, 0.05), (0.06, 0.0)] {
        let mut bench = Bench::new(Model {
            offset: -0.05,
            dead_zone,
            ..MODEL
        });
        let _ = bench.step();
        bench.servo.fail(Reason::WrongSign);
        for _ in 0..5000 {
            bench.servo.guard.stop.look(50.0);
        }
        assert_eq!(bench.servo.guard.stop.creeps(), 1.0);
        assert_eq!(bench.servo.centre(), middle);
    }
}
