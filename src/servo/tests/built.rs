//! The loop behind a commissioning, built in parts, beside one that is built at once.

use super::bench::{Bench, Code, Loop, MODEL, Spool, axis};
use super::*;
use crate::servo::building::{carried_out, tuned};
use crate::servo::commissioning::Found;
use crate::servo::monitoring::Monitors;
use crate::servo::motion::alpha_beta_gamma::AlphaBetaGamma;
use crate::servo::motion::trajectory::Trajectory;
use crate::servo::servo_loop::drive::Drive;

/// Nothing of it is what the settings of the bench say.
const FOUND: Found = Found {
    model: Model {
        a2: 30.0,
        dead_zone: 0.03,
        offset: 0.01,
        friction: 200.0,
        ..Model::linear(2500.0, 30.0, 3e6)
    },
    delay: 1e-3,
    sign: -1.0,
    noise: 1e-3,
    dead_volume: 0.1,
    imbalance: 0.1,
};

/// What the settings make of what was found, at once.
fn at_once(config: &Config) -> Loop {
    let config = tuned(config, &FOUND);
    Loop::try_new(&config, axis(), Code(2_000_000), Spool(0.0)).expect("settings")
}

/// A loop that has adapted on another model, in motion, and has built so many parts since.
fn built(config: &Config, parts: u32) -> Bench {
    let mut bench = Bench::adaptive(MODEL);
    bench.servo.config = config.clone();
    bench.servo.oscillate(30.0, 1.0).expect("a sine");
    let _ = bench.worst(2000);
    for part in 1..=parts {
        let is_last = bench.servo.build(&FOUND).expect("numbers that can work");
        assert_eq!(is_last, part == 8, "{part}");
    }
    bench
}

#[test]
fn a_loop_that_is_built_in_parts_is_the_one_that_its_settings_make_at_once() {
    let config = Bench::untold();
    let (bench, other) = (built(&config, 8), at_once(&config));
    let servo = &bench.servo;
    assert_eq!(servo.identifier, other.identifier);
    assert_eq!(servo.learning, other.learning);
    assert_eq!(servo.drive, Drive::of(&FOUND));
    assert_eq!(*servo.controller.model(), FOUND.model);
    assert_eq!(
        servo.controller.tuning_design(),
        other.controller.tuning_design()
    );
    assert_eq!(servo.moves.run_out_rate, other.moves.run_out_rate);
    // On from the motion that was measured, and the reference from its place.
    let motion = servo.moves.tracking.motion();
    assert!(motion.velocity.abs() > 1.0, "{motion:?}");
    let design = tuned(&config, &FOUND).resolve().expect("settings");
    let mut tracking = AlphaBetaGamma::new(design.tracking_rate, design.sample_time);
    tracking.begin(motion);
    assert_eq!(servo.moves.tracking, tracking);
    let limits = carried_out(&config, design.motion, &FOUND.model);
    let mut trajectory = Trajectory::new(limits, design.travel, design.sample_time);
    trajectory.hold(motion.position);
    assert_eq!(servo.moves.trajectory, trajectory);
    let supervision = design.supervision.clone();
    assert_eq!(
        servo.supervisor.design,
        supervision.with_resolution(axis().resolution())
    );
    let monitors = Monitors::new(
        &design.monitoring.with_resolution(axis().resolution()),
        &design.supervision.validation.observer,
        FOUND.model,
    );
    assert_eq!(servo.guard.monitors, monitors);
    assert!(servo.takeover.building.is_none());
}

#[test]
fn an_identifier_that_was_built_in_part_begins_anew() {
    let config = Bench::untold();
    for parts in 0..8 {
        let mut bench = built(&config, parts);
        let before = bench.servo.identifier.clone();
        bench.servo.stop_building();
        assert!(bench.servo.takeover.building.is_none());
        let other = match parts {
            0..=2 => before,
            _ => at_once(&config).identifier,
        };
        assert_eq!(bench.servo.identifier, other, "{parts}");
    }
}
