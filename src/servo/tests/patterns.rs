//! Readings that fail in patterns, in every state.

use super::bench::{Bench, MODEL};
use super::*;
use crate::servo::motion::{Motion, Travel};

/// Readings that fail of so many, the first of them.
const PATTERNS: [[u32; 2]; 6] = [[1, 2], [2, 3], [1, 3], [2, 4], [2, 5], [1, 10]];

/// The largest distance of what is taken for the position from the axis while readings fail.
fn furthest(bench: &mut Bench, [fail, of]: [u32; 2], samples: u32) -> f32 {
    let mut worst = 0.0_f32;
    for k in 0..samples {
        bench.is_mute = k % of < fail;
        let (report, y) = bench.step();
        assert!(report.position.is_finite(), "{k}");
        worst = worst.max((report.position - y).abs());
    }
    bench.is_mute = false;
    worst
}

/// A filter as quick as it may be.
fn quick() -> Config {
    let travel = Travel {
        min: 0.0,
        max: 400.0,
    };
    let mut config = Config::new(1e-3, 100.0, travel);
    config.noise = Some(2e-4);
    config
}

#[test]
fn an_axis_that_nothing_moves_is_where_it_is_seen_however_readings_fail() {
    for pattern in PATTERNS {
        let mut idle = Bench::without_a_model(MODEL, &quick());
        let mut failed = Bench::new(MODEL);
        failed.is_mute = true;
        for _ in 0..10 {
            let _ = failed.step();
        }
        failed.is_mute = false;
        let state = failed.servo.supervisor().state();
        assert_eq!(state, State::Failed(Reason::SensorFault));
        for bench in [&mut idle, &mut failed] {
            let worst = furthest(bench, pattern, 5000);
            assert!(worst < 20.0 * bench::SCALE, "{pattern:?}: {worst}");
            let left = furthest(bench, [0, 1], 300);
            assert!(left < 2.0 * bench::SCALE, "{pattern:?}: {left}");
            let motion = bench.servo.moves.tracking.motion();
            assert!(motion.velocity.abs() < 0.1, "{pattern:?}: {motion:?}");
        }
    }
}

#[test]
fn a_commissioning_and_control_bear_what_the_share_of_gaps_leaves_them() {
    for pattern in PATTERNS {
        // Stated a bandwidth of 100 rad/s, the filter has its poles at a half per sample.
        let mut bench = Bench::without_a_model(MODEL, &quick());
        bench.servo.commission();
        let worst = furthest(&mut bench, pattern, 1000);
        assert!(worst < 2.0, "{pattern:?}: {worst}");
        let [fail, of] = pattern;
        let bears = 2 * fail < of;
        let state = bench.servo.supervisor().state();
        assert_eq!(state.is_commissioning(), bears, "{pattern:?}: {state:?}");
        let mut bench = Bench::new(MODEL);
        let _ = bench.worst(1500);
        bench.servo.move_to(300.0).expect("a target");
        let worst = furthest(&mut bench, pattern, 4000);
        assert!(worst < 1.0, "{pattern:?}: {worst}");
        let state = bench.servo.supervisor().state();
        assert_eq!(state.is_controlling(), bears, "{pattern:?}: {state:?}");
    }
}

#[test]
fn the_motion_behind_a_gap_is_the_mean_speed_over_it() {
    let config = quick();
    let mut bench = Bench::without_a_model(MODEL, &config);
    // 300 mm/s: a sample moves the axis by more than the filter bears for noise.
    for k in 0..800 {
        bench.motion = Motion::at(50.0 + 0.3 * k as f32);
        bench.is_mute = k % 50 >= 48;
        let _ = bench.step();
        if k > 80 {
            let speed = bench.servo.moves.tracking.motion().velocity;
            assert!((speed - 300.0).abs() < 1.0, "{k}: {speed}");
        }
    }
    // Behind what is too long to be bridged nothing is known of it.
    bench.is_mute = true;
    for _ in 0..20 {
        let _ = bench.step();
    }
    bench.is_mute = false;
    bench.motion = Motion::at(350.0);
    let _ = bench.step();
    let motion = bench.servo.moves.tracking.motion();
    assert!((motion.position - 350.0).abs() < 1e-3 && motion.velocity == 0.0);
}

#[test]
fn a_position_that_is_expected_lies_on_the_curve_of_an_acceleration() {
    let mut bench = Bench::without_a_model(MODEL, &quick());
    for k in 0..150 {
        let t = 1e-3 * k as f32;
        bench.motion = Motion::at(50.0 + 0.5 * 2e4 * t * t);
        bench.is_mute = k == 140;
        let (report, y) = bench.step();
        if k >= 140 {
            // Half of T^2 a is 0.01.
            let off = (report.position - y).abs();
            assert!(off < 3e-3, "{k}: {off}");
        }
    }
}

#[test]
fn behind_as_many_readings_as_stop_the_axis_nothing_is_known_of_its_motion() {
    for most in [1, 2, 3] {
        for (missing, known) in [(most - 1, true), (most, false), (most + 5, false)] {
            let mut bench = Bench::without_a_model(MODEL, &quick());
            bench.servo.sensed.errors_max = most;
            for k in 0..200 + missing {
                bench.motion = Motion::at(50.0 + 0.3 * k as f32);
                bench.is_mute = k >= 200;
                let _ = bench.step();
            }
            bench.is_mute = false;
            bench.motion = Motion::at(50.0 + 0.3 * (200 + missing) as f32);
            let (_, y) = bench.step();
            let motion = bench.servo.moves.tracking.motion();
            assert!((motion.position - y).abs() < 1e-3, "{motion:?}");
            let speed = if known { 300.0 } else { 0.0 };
            assert!(
                (motion.velocity - speed).abs() < 1.0,
                "{missing} of {most}: {motion:?}"
            );
        }
    }
}

#[test]
fn behind_a_reading_that_cannot_be_true_a_commissioning_knows_the_motion() {
    let mut bench = Bench::without_a_model(MODEL, &quick());
    for _ in 0..200 {
        let _ = bench.step();
    }
    bench.servo.commission();
    let _ = bench.step();
    assert!(bench.servo.supervisor().state().is_commissioning());
    // What the filter believes of an axis that stands is wrong by half of the gate.
    let wrong = Motion {
        velocity: 60.0,
        ..Motion::at(200.0)
    };
    bench.servo.moves.tracking.begin(wrong);
    bench.motion = Motion::at(250.0);
    let _ = bench.step();
    assert!(bench.servo.moves.gap.is_open());
    bench.motion = Motion::at(200.0);
    let _ = bench.step();
    // The mean speed over the gap, of an axis that has not moved.
    let motion = bench.servo.moves.tracking.motion();
    assert!(motion.velocity.abs() < 1.0, "{motion:?}");
}

#[test]
fn readings_that_are_good_again_let_a_commissioning_begin() {
    for outage in [10, 50, 1000] {
        let mut bench = Bench::without_a_model(MODEL, &Bench::config());
        bench.is_mute = true;
        for _ in 0..outage {
            let _ = bench.step();
        }
        bench.is_mute = false;
        for _ in 0..100 {
            let _ = bench.step();
        }
        bench.servo.commission();
        for _ in 0..100 {
            let (report, _) = bench.step();
            assert!(report.state.is_commissioning(), "{outage} {report:?}");
        }
    }
}

/// A loop that was asked for a commissioning while its sensor was lost, and what it reported.
fn asked_without_a_sensor(mut bench: Bench) -> (Bench, Report) {
    bench.is_mute = true;
    for _ in 0..100 {
        let _ = bench.step();
    }
    bench.servo.commission();
    let (report, _) = bench.step();
    (bench, report)
}

#[test]
fn a_commissioning_that_is_asked_for_without_a_sensor_does_not_wait_for_it() {
    let mut behind = Bench::new(MODEL);
    behind.servo.fail(Reason::TravelEnd);
    for bench in [Bench::without_a_model(MODEL, &Bench::config()), behind] {
        let stops = bench.servo.guard.monitors.counters().stops;
        let (mut bench, report) = asked_without_a_sensor(bench);
        assert_eq!(report.state, State::Failed(Reason::SensorFault));
        assert!(report.faults.stops > stops);
        let refused = report.faults.stops;
        bench.is_mute = false;
        for _ in 0..1000 {
            let (report, _) = bench.step();
            assert_eq!(report.state, State::Failed(Reason::SensorFault));
            assert_eq!((report.command, report.faults.stops), (0.0, refused));
        }
        bench.servo.commission();
        let _ = bench.step();
        assert!(bench.step().0.state.is_commissioning());
    }
    // One reading that fails is bridged.
    let mut bench = Bench::without_a_model(MODEL, &Bench::config());
    bench.servo.commission();
    bench.is_mute = true;
    assert!(bench.step().0.state.is_commissioning());
}

#[test]
fn a_commissioning_does_not_begin_in_the_sample_of_a_fault() {
    let mut bench = Bench::new(MODEL);
    let _ = bench.worst(1500);
    // The third reading in a row that fails.
    bench.is_mute = true;
    for _ in 0..2 {
        assert!(bench.step().0.state.is_controlling());
    }
    bench.servo.commission();
    assert_eq!(bench.step().0.state, State::Failed(Reason::SensorFault));
    bench.is_mute = false;
    assert_eq!(bench.step().0.state, State::Failed(Reason::SensorFault));
}

#[test]
fn a_target_that_is_refused_changes_nothing() {
    let mut bench = Bench::new(MODEL);
    let _ = bench.step();
    let before = bench.servo.moves.trajectory.clone();
    for target in [f32::NAN, f32::INFINITY] {
        assert!(bench.servo.move_to(target).is_err());
        assert_eq!(bench.servo.moves.trajectory, before);
    }
}
