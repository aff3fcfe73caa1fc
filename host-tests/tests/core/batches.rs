//! Standard deviations of least squares from blocks: against f64 over long records, their ring, and
//! what they cover.

use rand::{RngExt, SeedableRng};
use trendid::batches::Batched;
use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, Identifier, Outcome, Structure};
use trendid_host_tests::plants::linear::LinearPlant;
use trendid_host_tests::random::Random;
use trendid_host_tests::signals::excitation::Excitation;
use trendid_host_tests::signals::experiment::{Experiment, Record};
use trendid_host_tests::signals::noise::Condition;

use crate::common::long_experiment;
use in_f64::in_f64;

mod in_f64;

const SERVO: Structure<3, 5, 1> = Structure::SERVO;
type Servo = Batched<FilteredTrends<3>, 3, 5>;

fn config(change: impl FnOnce(&mut Config<3, 5, 1>)) -> (Config<3, 5, 1>, FilteredTrends<3>) {
    let mut config = Config::new(SERVO, 20.0, [1.0], 50.0);
    change(&mut config);
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0).unwrap();
    (config, trends)
}

fn servo(change: impl FnOnce(&mut Config<3, 5, 1>)) -> Servo {
    let (config, trends) = config(change);
    Batched::try_new(&config, trends).unwrap()
}

/// The record behind a rest without noise, whose line through the first samples is that rest.
fn behind_rest(mut record: Record) -> Record {
    for signal in [&mut record.u, &mut record.y, &mut record.y_true] {
        signal.splice(0..0, [0.0; 50]);
    }
    record
}

/// Runs a record and gives the identifier, and how many samples gave no row.
fn run(record: &Record, mut servo: Servo) -> (Servo, usize) {
    let mut without = 0;
    for sample in record.samples() {
        let outcome = servo.update(sample.u as f32, sample.y as f32);
        without += usize::from(matches!(outcome, Outcome::WarmingUp { .. }));
    }
    (servo, without)
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn the_scores_of_the_recursion_are_those_of_f64_over_a_million_samples() {
    for (duration_s, seed) in [
        (1.0_f64, 200_101),
        (3.0, 200_102),
        (10.0, 200_103),
        (1000.0, 200_104),
    ] {
        let noise = Condition::white(500.0 * duration_s.sqrt());
        let record = behind_rest(long_experiment(noise, duration_s).record(seed));
        let (servo, without) = run(&record, servo(|config| config.offset_significance = 0.0));
        let found = servo.estimate();
        let (oracle, blocks) = in_f64(&record, without);
        assert!(found.by_blocks && (f64::from(found.effective_blocks) - blocks).abs() < 0.1);
        let (theta, std) = (found.estimate.theta(), found.estimate.std());
        for j in 0..3 {
            let (ours, theirs) = (f64::from(std[j]), oracle[j]);
            // The allowance for trends in place of derivatives: 0.2 (omega Delta)^2 of a parameter
            // at most.
            let floor = 1.1e-4 * f64::from(theta[j]).abs();
            println!(
                "{duration_s} s, parameter {j}: f32 {ours:.6e} f64 {theirs:.6e} allowance {floor:.1e}"
            );
            assert!(ours > 0.97 * theirs, "{duration_s} {j}: {ours} {theirs}");
            assert!(
                ours < 1.03 * theirs.hypot(floor),
                "{duration_s} {j}: {ours} {theirs}"
            );
        }
    }
}

#[test]
fn the_estimate_is_bit_for_bit_that_of_an_identifier() {
    let record = Experiment::reference(Condition::white(500.0), 2.0).record(200_110);
    for memory in [None, Some(0.5)] {
        let mut with = servo(|config| config.memory = memory);
        let (config, trends) = config(|config| config.memory = memory);
        let mut without = Identifier::<_, 3, 5>::try_new(&config, trends).unwrap();
        for (k, sample) in record.samples().enumerate() {
            let y = match k % 97 {
                5 => f32::NAN,
                _ => sample.y as f32,
            };
            assert_eq!(
                with.update(sample.u as f32, y),
                without.update(sample.u as f32, y)
            );
            if k == 1200 {
                with.skip(20);
                without.skip(20);
            }
            if k % 100 == 0 {
                let (ours, plain) = (with.estimate(), without.estimate());
                assert_eq!(ours.estimate.theta(), plain.theta(), "sample {k}");
                if !ours.by_blocks {
                    assert_eq!(ours.estimate, plain);
                }
                assert!(ours.estimate.std().iter().all(|std| *std > 0.0));
            }
        }
        assert!(with.identifier() == &without);
        assert!(with.estimate().by_blocks);
        with.reset();
        assert!(with == servo(|config| config.memory = memory));
    }
}

/// A drive that takes steps, each sample with white noise of the width `noise`.
struct Drive {
    plant: LinearPlant,
    rng: Random,
}

impl Drive {
    fn new(seed: u64) -> Self {
        Self {
            plant: LinearPlant::new(&[0.0, 400.0, 20.0], &[1e6], 1e-3).unwrap(),
            rng: Random::seed_from_u64(seed),
        }
    }

    fn sample(&mut self, u: f64, noise: f64) -> f32 {
        let y = self.plant.output() + noise * self.rng.random_range(-0.5..0.5);
        self.plant.step(&[u]);
        y as f32
    }
}

#[test]
fn there_are_eight_to_sixteen_blocks_whatever_the_length_and_the_memory() {
    for memory in [None, Some(0.2), Some(1.0), Some(30.0)] {
        let mut servo = servo(|config| config.memory = memory);
        let mut drive = Drive::new(200_120);
        let u = Excitation::ABSOLUTE.sequence(70_000, 1e-3, 200_121);
        let (mut least, mut most) = (f32::INFINITY, 0.0_f32);
        for (k, u) in u.iter().enumerate() {
            let y = drive.sample(*u, 2.0);
            let _ = servo.update(*u as f32, y);
            // A memory weighs the newest more: after two of them there are always enough.
            let begun = 200 + (2000.0 * memory.unwrap_or(0.0)) as usize;
            if k > begun && k % 37 == 0 {
                let found = servo.estimate();
                assert!(
                    found.by_blocks,
                    "{memory:?} {k}: {}",
                    found.effective_blocks
                );
                least = least.min(found.effective_blocks);
                most = most.max(found.effective_blocks);
            }
        }
        println!("memory {memory:?}: {least:.1} to {most:.1} blocks");
        assert!(least >= 8.0 && most <= 16.01);
    }
}

#[test]
fn too_few_blocks_are_said_and_the_identifiers_own_deviations_stand_in() {
    let mut servo = servo(|config| {
        config.memory = Some(1.0);
        config.follow_changes = true;
    });
    let found = servo.estimate();
    assert!(!found.by_blocks && found.effective_blocks == 0.0);
    assert_eq!(found.estimate, servo.identifier().estimate());
    let mut drive = Drive::new(200_130);
    let u = Excitation::ABSOLUTE.sequence(12_000, 1e-3, 200_131);
    let mut fast = LinearPlant::new(&[0.0, 900.0, 30.0], &[1e6], 1e-3).unwrap();
    let (mut changed, mut anew) = (None, false);
    for (k, u) in u.iter().enumerate() {
        if k == 6000 {
            let kept: Vec<f64> = (0..3).map(|i| drive.plant.derivative(i)).collect();
            fast.place(&kept);
            drive.plant = fast.clone();
        }
        let y = drive.sample(*u, 0.2);
        let _ = servo.update(*u as f32, y);
        if servo.identifier().changes() > 0 && changed.is_none() {
            assert!(k > 6000);
            changed = Some(k);
        }
        // What was learnt before a change is one block.
        anew |= changed.is_some_and(|at| k < at + 400) && !servo.estimate().by_blocks;
    }
    assert!(changed.is_some() && anew);
    let found = servo.estimate();
    assert!(found.by_blocks);
    for (j, truth) in [900.0, 30.0, 1e6_f32].into_iter().enumerate() {
        let off = (found.estimate.theta()[j] - truth).abs();
        assert!(off < 4.0 * found.estimate.std()[j], "{j}: {off}");
    }
}

#[test]
fn whatever_comes_no_deviation_is_nan_or_zero() {
    for seed in 200_140..200_160 {
        let mut rng = Random::seed_from_u64(seed);
        let memory = [None, Some(0.1), Some(3.0)][(seed % 3) as usize];
        let mut servo = servo(|config| config.memory = memory);
        let sizes: [f32; 4] = [1.0, 1e3, 1e6, 1e9];
        for k in 0..3000 {
            let size = sizes[rng.random_range(0..4)];
            let (u, y) = match rng.random_range(0..20) {
                0 => (f32::INFINITY, 0.0),
                1 => (0.0, f32::NAN),
                2..6 => (0.0, 0.0),
                _ => (rng.random_range(-size..size), rng.random_range(-size..size)),
            };
            let _: Outcome = servo.update(u, y);
            if k % 50 == 0 {
                let std = servo.estimate().estimate.std();
                assert!(std.iter().all(|std| *std > 0.0), "{seed} {k}: {std:?}");
            }
        }
    }
}

/// What no sample shows is as uncertain as it was given.
#[test]
fn what_is_not_excited_keeps_the_deviation_of_its_prior() {
    for memory in [None, Some(0.5)] {
        let mut servo = servo(|config| config.memory = memory);
        servo
            .warm_start([400.0, 20.0, 1e6, 0.0, 0.0], [4.0, 0.2, 1e4, 1e3, 1.0])
            .unwrap();
        let mut rng = Random::seed_from_u64(200_170);
        for _ in 0..4000 {
            let _ = servo.update(0.0, 0.01 * rng.random_range(-1.0..1.0_f32));
        }
        let found = servo.estimate();
        let (blocks, own) = (found.estimate.std(), servo.identifier().estimate().std());
        println!(
            "{memory:?}: by blocks {} {blocks:?} own {own:?}",
            found.by_blocks
        );
        for (j, given) in [4.0, 0.2, 1e4].into_iter().enumerate() {
            assert!(
                (0.5..2.0).contains(&(blocks[j] / given)),
                "{j}: {}",
                blocks[j]
            );
        }
    }
}

/// Coloured noise of one size on one excitation: the deviations are those about the limit of least
/// squares, not about the truth.
#[test]
fn under_coloured_noise_the_deviations_are_those_about_the_own_mean() {
    let (seeds, n) = (200_200..200_300, 10_000);
    let u = Excitation::RELATIVE.sequence(n, 1e-3, 200_199);
    let (mut errors, mut variances) = (Vec::new(), [[0.0_f64; 3]; 2]);
    for seed in seeds.clone() {
        let mut servo = servo(|config| config.offset_significance = 0.0);
        let mut plant = LinearPlant::new(&[0.0, 400.0, 20.0], &[1e6], 1e-3).unwrap();
        let mut rng = Random::seed_from_u64(seed);
        let mut lagged = 0.0;
        for u in &u {
            lagged += 0.05 * (rng.random_range(-3.0..3.0) - lagged);
            let _ = servo.update(*u as f32, (plant.output() + lagged) as f32);
            plant.step(&[*u]);
        }
        let found = servo.estimate();
        assert!(found.by_blocks);
        let both = [found.estimate.std(), servo.identifier().estimate().std()];
        for (sums, std) in variances.iter_mut().zip(both) {
            for (sum, std) in sums.iter_mut().zip(std) {
                *sum += f64::from(std).powi(2);
            }
        }
        errors.push(found.estimate.theta().map(f64::from));
    }
    let count = errors.len() as f64;
    for j in 0..3 {
        let mean = errors.iter().map(|e| e[j]).sum::<f64>() / count;
        let spread =
            (errors.iter().map(|e| (e[j] - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt();
        let [blocks, own] = variances.map(|v| (v[j] / count).sqrt());
        println!(
            "parameter {j}: mean {mean:.4e}, spread {spread:.3e}, by blocks {blocks:.3e}, own {own:.3e}"
        );
        assert!(
            (0.8..1.5).contains(&(blocks / spread)),
            "{j}: {blocks} {spread}"
        );
    }
}
