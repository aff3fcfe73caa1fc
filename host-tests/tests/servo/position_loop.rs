//! The adaptive loop: limits under fuzzing, changes of gains, refusals, bit-exact return of the old gains.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use trendid::hardware::{Axis, Scale};
use trendid::servo::{self, Controller, Motion, ServoLoop, Setpoint, Travel};
use trendid_host_tests::servo::rig::{SimulatedSensor, SimulatedValve, TRAVEL};
use trendid_host_tests::servo::run::{Options, run, run_with_shadow};
use trendid_host_tests::servo::scenario::Scenario;
use trendid_host_tests::servo::shadow::FailingSensor;

#[test]
fn the_command_keeps_range_and_rate_in_a_million_wild_samples() {
    let mut random = ChaCha8Rng::seed_from_u64(77);
    let mut config = servo::Config::new(1e-3, 25.0, TRAVEL);
    config.range = 0.8;
    config.rate = 150.0;
    let axis = Axis {
        scale: Scale::new(0.01).expect("scale"),
        reference: 0,
    };
    let mut servo = ServoLoop::try_new(
        &config,
        axis,
        SimulatedSensor { code: Some(20_000) },
        SimulatedValve,
    )
    .expect("settings");
    let (mut last, mut moved) = (0.0_f32, 0_u32);
    for k in 0..1_000_000 {
        match random.random_range(0..400_u32) {
            0 => servo.commission(),
            1 => servo.abort(),
            2 => servo.move_to(random.random_range(-1e3..1e3_f32)),
            3 => servo.move_to(f32::NAN),
            4 => servo.oscillate(60.0, random.random_range(0.1..5.0_f32)),
            5 => {
                let model = servo::Model {
                    dead_zone: random.random_range(0.0..0.1_f32),
                    friction: random.random_range(0.0..9e3_f32),
                    ..servo::Model::linear(
                        random.random_range(50.0..4e3_f32),
                        random.random_range(1.0..80.0_f32),
                        random.random_range(1e5..5e6_f32),
                    )
                };
                servo.install(model).expect("a stable model");
            }
            _ => {}
        }
        servo.sensor_mut().code = match random.random_range(0..1000_u32) {
            0 => None,
            1 => Some(random.random::<i32>()),
            _ => Some(20_000 + random.random_range(-3000..3000_i32)),
        };
        let u = servo.update().command;
        assert!(u.abs() <= 0.8, "sample {k}: command {u}");
        // One rounding of the sum of step and last command.
        let step = (u - last).abs();
        assert!(step <= 0.15 + 1e-7, "sample {k}: step {step}");
        moved += u32::from(u != last);
        last = u;
    }
    assert!(moved > 100_000, "the fuzzing moved the valve {moved} times");
}

#[test]
fn a_change_of_gains_steps_the_command_by_at_most_one_percent() {
    let mut random = ChaCha8Rng::seed_from_u64(78);
    let mut worst = 0.0_f32;
    for case in 0..2000 {
        let mut model = || servo::Model {
            dead_zone: random.random_range(0.0..0.06_f32),
            offset: random.random_range(-0.02..0.02_f32),
            friction: if case % 2 == 0 { 0.0 } else { 3000.0 },
            ..servo::Model::linear(
                random.random_range(200.0..1500.0_f32),
                random.random_range(5.0..40.0_f32),
                random.random_range(3e5..3e6_f32),
            )
        };
        let (plant, first, second) = (model(), model(), model());
        let mut config = servo::Config::new(1e-3, 24.0, TRAVEL);
        // No rest and no friction seen: the change of gains alone.
        config.controller.bandwidth = Some(60.0);
        config.controller.rest_window = Some(0.0);
        config.controller.breakaway_distance = Some(f32::MAX);
        config.controller.catch_up = Some(f32::MAX);
        config.controller.stiction_velocity = Some(0.0);
        let mut kept = Controller::new(&config.resolve().expect("settings"), first);
        let mut motion = Motion::default();
        let start = random.random_range(50..400);
        let noise: Vec<f32> = (0..400).map(|_| random.random_range(-0.01..0.01)).collect();
        for k in 0..=start {
            let r = Setpoint {
                velocity: 100.0,
                ..Setpoint::at(0.1 * k as f32)
            };
            let y = motion.position + noise[k % 400];
            let mut changed = kept.clone();
            let u = kept.update(&r, y);
            if k == start {
                changed.retune(second);
                let other = changed.update(&r, y);
                worst = worst.max((other.clamp(-1.0, 1.0) - u.clamp(-1.0, 1.0)).abs());
            }
            let u = u.clamp(-1.0, 1.0);
            kept.applied(u);
            plant.advance(&mut motion, plant.flow(u), 1e-3);
        }
    }
    assert!(
        worst <= 0.01,
        "a change of gains stepped the command by {worst}"
    );
}

#[test]
fn faults_are_refused_for_the_right_reason_and_the_gains_are_kept() {
    for scenario in Scenario::ALL.into_iter().filter(|s| s.expected().is_some()) {
        let figures = run(scenario, &Options::adaptive(4001), &mut |_, _| {});
        let name = scenario.name();
        assert!(figures.refused_rightly(), "{name}: {}", figures.state);
        assert_eq!(figures.gains_kept, Some(true), "{name}");
    }
}

#[test]
fn the_axis_commissions_itself_and_follows() {
    for seed in 1..=5 {
        let f = run(Scenario::Nominal, &Options::adaptive(seed), &mut |_, _| {});
        assert!(f.verified_at_s.is_some_and(|t| t <= 0.5), "seed {seed}");
        let missed = f.outside();
        assert!(missed.is_empty(), "seed {seed}: {missed:?}");
    }
}

#[test]
fn changes_in_motion_are_survived() {
    for scenario in Scenario::ALL.into_iter().filter(|s| s.is_change()) {
        let f = run(scenario, &Options::adaptive(3001), &mut |_, _| {});
        // Never unstable: it stands where it should in the end, and follows.
        assert!(f.state.is_controlling(), "{}", scenario.name());
        assert!(f.steady_state_mm.is_some_and(|x| x < 5.0));
        assert!(f.tracking_1hz_mm.is_some_and(|x| x < 10.0));
    }
}

#[test]
fn readings_that_fail_now_and_then_are_bridged() {
    for seed in 2001..=2002 {
        let mut sensor = FailingSensor::new(20);
        let f = run_with_shadow(
            Scenario::Nominal,
            &Options::adaptive(seed),
            &mut sensor,
            &mut |_, _| {},
        );
        assert!(sensor.failed > 500);
        assert!(f.verified_at_s.is_some_and(|t| t < 0.5), "seed {seed}");
        let sine = f.tracking_0p5hz_mm.unwrap_or(f64::INFINITY);
        assert!(sine < 1.05, "seed {seed}: 0.5 Hz {sine} mm");
    }
}

#[test]
fn sixty_seconds_at_rest_move_neither_gains_nor_axis() {
    let f = run(Scenario::Rest, &Options::adaptive(1), &mut |_, _| {});
    assert_eq!(f.gains_kept, Some(true));
    assert!(f.rest_range_mm.is_some_and(|range| range < 0.1));
}

#[test]
fn a_unit_too_small_for_the_accelerations_is_refused() {
    // The same axis in micrometres.
    let travel = Travel {
        min: 0.0,
        max: 400e3,
    };
    let axis = Axis {
        scale: Scale::new(10.0).expect("scale"),
        reference: 0,
    };
    let config = servo::Config::new(1e-3, 25.0, travel);
    let refused = ServoLoop::try_new(&config, axis, SimulatedSensor::default(), SimulatedValve);
    assert!(matches!(refused, Err(servo::Error::Unit { acceleration }) if acceleration == 2.5e8));
}
