//! Trends that begin anew in motion.

use rand::{RngExt, SeedableRng};
use trendid::instruments::Way;
use trendid_host_tests::plants::linear::{Input, LinearPlant};
use trendid_host_tests::random::Random;
use trendid_host_tests::signals::experiment::Experiment;
use trendid_host_tests::signals::noise::Condition;

use super::servo;

/// Readings of 40 records with a short memory, before the trends begin anew in motion and behind
/// it: how many there are, and how many of them err by more than four deviations.
fn readings_about_a_restart(memory: f32) -> [u32; 2] {
    let (mut readings, mut far) = (0, 0);
    for seed in 200_101..200_141 {
        let record = Experiment::reference(Condition::white(10.0), 8.0).record(seed);
        let mut servo = servo(|config| config.memory = Some(memory));
        for (k, sample) in record.samples().enumerate() {
            let _ = servo.update(sample.u as f32, sample.y as f32);
            if k == 4000 {
                servo.restart_trends();
            }
            if ![3999, 4500, 5000, 5500, 6000, 7000, 7999].contains(&k) {
                continue;
            }
            let estimate = servo.estimate().estimate;
            let (theta, std) = (estimate.theta(), estimate.std());
            assert!(std.iter().all(|std| *std > 0.0), "{seed} {k}: {std:?}");
            let errors = [400.0, 20.0, 1e6].iter().zip(theta).zip(std);
            let worst = errors.map(|((truth, value), std)| (value - truth).abs() / std);
            readings += 1;
            far += u32::from(worst.fold(0.0_f32, f32::max) > 4.0);
        }
    }
    [readings, far]
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn behind_a_restart_the_initial_state_of_before_is_none() {
    for memory in [0.15, 0.3, 0.5, 1.0] {
        let [readings, far] = readings_about_a_restart(memory);
        println!("memory {memory} s: {far} of {readings} beyond four deviations");
        assert_eq!(far, 0, "{memory}: of {readings}");
    }
}

#[test]
fn from_a_warm_start_on_only_the_new_drive_counts() {
    let truth = [100.0, 20.0, 2e5, 0.0, 0.0_f32];
    let before = Experiment::reference(Condition::white(10.0), 4.0).record(200_150);
    let mut servo = servo(|_| {});
    for sample in before.samples() {
        let _ = servo.update(sample.u as f32, sample.y as f32);
    }
    assert_eq!(servo.estimate().way, Way::Instruments);

    // The drive is exchanged at rest: a slower one, of which little is known.
    servo.restart_trends();
    let refused = servo.warm_start([f32::NAN; 5], [1.0; 5]);
    assert!(refused.is_err() && servo.estimate().way == Way::Instruments);
    servo
        .warm_start([400.0, 20.0, 1e6, 0.0, 0.0], [400.0, 20.0, 1e6, 1e5, 1e5])
        .unwrap();
    let found = servo.estimate();
    assert_eq!(found.way, Way::TooFewBlocks);
    assert_eq!(found.estimate, servo.identifier().estimate());

    let input = Input::delayed(&[2e5], 0);
    let mut plant = LinearPlant::with_inputs(&[0.0, 100.0, 20.0], &[input], 0.0, 1e-3).unwrap();
    let mut rng = Random::seed_from_u64(200_151);
    for u in &before.u {
        let noise = 0.02 * rng.random_range(-1.0..1.0);
        let _ = servo.update(*u as f32, (plant.output() + noise) as f32);
        plant.step(&[*u]);
    }
    let found = servo.estimate();
    assert_eq!(found.way, Way::Instruments);
    let errors = (found.estimate.theta().into_iter().zip(found.estimate.std())).zip(truth);
    for ((value, std), truth) in errors.take(3) {
        assert!(
            (value - truth).abs() < 4.0 * std,
            "{value} +- {std}: {truth}"
        );
        assert!(std < 0.02 * truth, "{std} of {truth}");
    }
}
