//! Drives that do not reach the usual limits of motion.

use super::bench::{Bench, MODEL};
use crate::servo::Model;
use crate::servo::building::{carried_out, rough};
use crate::servo::motion::trajectory::Trajectory;
use crate::servo::motion::{MotionLimits, Travel};

const TRAVEL: Travel = Travel {
    min: 0.0,
    max: 400.0,
};

/// A drive with the natural frequency `w`, the damping `xi`, and `gain` travels per s.
fn drive(w: f32, xi: f32, gain: f32) -> Model {
    Model::linear(w * w, 2.0 * xi * w, gain * TRAVEL.length() * w * w)
}

/// Numbers in 0..1, always the same.
fn numbers(mut state: u32) -> impl FnMut() -> f32 {
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 16_777_216.0
    }
}

#[test]
fn no_move_from_rest_asks_for_more_flow_than_the_drive_has() {
    let mut number = numbers(5);
    for _ in 0..500 {
        let mut config = Bench::config();
        config.range = 0.3 + 0.7 * number();
        let xi = 0.05 * 40.0_f32.powf(number());
        let mut model = drive(
            5.0 * 20.0_f32.powf(number()),
            xi,
            0.1 * 100.0_f32.powf(number()),
        );
        (model.dead_zone, model.offset) = (0.1 * number(), 0.1 * (number() - 0.5));
        let limits = config.motion_limits(rough(&model)).expect("settings");
        let limits = carried_out(&config, limits, &model);
        let gain = model.b0 / model.a1;
        let flow = gain * (config.range - model.dead_zone - model.offset.abs());
        let step = 1e-3;
        let mut reference = Trajectory::new(limits, TRAVEL, step);
        reference.hold(TRAVEL.length() * number());
        reference
            .move_to(TRAVEL.length() * number())
            .expect("a target");
        let mut most = 0.0_f32;
        for _ in 0..20_000 {
            let at = reference.update();
            let wanted = at.velocity + (model.a2 * at.acceleration + at.jerk) / model.a1;
            most = most.max(wanted.abs());
            if reference.is_finished() {
                break;
            }
        }
        assert!(
            most <= 0.91 * flow,
            "{most} of {flow}: {model:?} {limits:?}"
        );
    }
}

#[test]
fn stated_limits_hold_as_they_are_and_quick_drives_have_the_usual_ones() {
    let mut config = Bench::config();
    let limits = config.motion_limits(20.0).expect("settings");
    assert_eq!(
        carried_out(&config, limits, &drive(20.0, 0.5, 10.0)),
        limits
    );
    config.motion = Some(limits);
    assert_eq!(carried_out(&config, limits, &drive(20.0, 0.5, 0.1)), limits);
}

#[test]
fn a_slow_drive_follows_its_moves() {
    for w in [20.0, 60.0] {
        for gain in [0.3, 0.6, 1.0] {
            let model = drive(w, 0.5, gain);
            let mut config = Bench::config();
            config.bandwidth = None;
            let mut bench = Bench::without_a_model(model, &config);
            bench.servo.install(model).expect("a model");
            let _ = bench.worst(1500);
            for target in [80.0, 320.0] {
                bench.servo.move_to(target).expect("a target");
                let worst = bench.worst(7000);
                assert!(worst < 2.0, "{w} {gain}: {worst}");
                assert!((bench.motion.position - target).abs() < 0.1);
            }
            let counters = bench.servo.guard.monitors.counters();
            // A step of the jerk comes a delay late.
            assert!(counters.saturated_samples < 20, "{w} {gain}: {counters:?}");
        }
    }
}

#[test]
fn a_model_that_is_installed_later_has_limits_of_its_own() {
    let mut config = Bench::config();
    config.bandwidth = None;
    let mut bench = Bench::without_a_model(MODEL, &config);
    for model in [drive(25.0, 0.4, 0.5), MODEL] {
        bench.model = model;
        bench.servo.abort();
        for _ in 0..500 {
            let _ = bench.step();
        }
        bench.servo.install(model).expect("a model");
        let limits = config.motion_limits(rough(&model)).expect("settings");
        let MotionLimits { velocity, .. } = carried_out(&config, limits, &model);
        let _ = bench.worst(1500);
        bench.servo.move_to(380.0).expect("a target");
        let mut fastest = 0.0_f32;
        for _ in 0..3000 {
            fastest = fastest.max(bench.step().0.setpoint.velocity);
        }
        assert!(
            (fastest / velocity - 1.0).abs() < 1e-3,
            "{fastest}, {velocity}"
        );
        bench.servo.move_to(20.0).expect("a target");
        let _ = bench.worst(4000);
    }
}
