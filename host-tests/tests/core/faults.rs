//! Single samples that are wrong, and samples that are missing, in normal work.

use rand::RngExt;
use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, Identifier, Outcome, Structure};
use trendid_host_tests::plants::servo::REFERENCE;
use trendid_host_tests::signals::excitation::Excitation;
use trendid_host_tests::signals::noise::{Stream, generator};

type Servo = Identifier<FilteredTrends<3>, 3, 5>;

const DT: f64 = 1e-3;

/// Binary noise of +-0.4 with white noise of 10 um: command and measured position.
fn record(seed: u64, n: usize) -> Vec<(f32, f32)> {
    let mut noise = generator(seed, Stream::White);
    let mut plant = REFERENCE.plant(DT);
    Excitation::ABSOLUTE
        .sequence(n, DT, seed)
        .into_iter()
        .map(|u| {
            let y = plant.output() + 0.01 * (noise.random::<f64>() - 0.5);
            plant.step(&[u]);
            (u as f32, y as f32)
        })
        .collect()
}

fn servo(memory: Option<f32>) -> Servo {
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, DT as f32, 20.0).unwrap();
    let mut config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4], 50.0);
    config.memory = memory;
    Identifier::try_new(&config, trends).unwrap()
}

const MEMORIES: [Option<f32>; 4] = [Some(0.2), Some(2.0), Some(10.0), None];

/// Largest change of a1, a2, b0 in standard deviations.
fn moved(clean: &Servo, faulty: &Servo) -> f64 {
    let (theta, std) = (clean.theta(), clean.estimate().std());
    let other = faulty.theta();
    (0..3).fold(0.0, |worst: f64, j| {
        worst.max(f64::from((other[j] - theta[j]).abs() / std[j]))
    })
}

#[test]
fn one_wrong_sample_moves_nothing() {
    for memory in MEMORIES {
        let (mut spikes, mut stuck, mut missing) = (0.0_f64, 0.0_f64, 0.0_f64);
        for seed in 221_000..221_040 {
            let record = record(seed, 6000);
            let mut clean = servo(memory);
            let at = 4000 + (seed % 97) as usize * 11;
            for (u, y) in &record[..at] {
                let _ = clean.update(*u, *y);
            }
            let faults = [1.0_f32, -10.0, 1e2, 1e4, -1e6]
                .map(|size| record[at].1 + size)
                .into_iter()
                .chain([record[at - 1].1, f32::NAN])
                .map(|wrong| (wrong, clean.clone()))
                .collect::<Vec<_>>();
            let mut runs = faults;
            for (k, (u, y)) in record[at..at + 800].iter().enumerate() {
                let _ = clean.update(*u, *y);
                for (index, (wrong, faulty)) in runs.iter_mut().enumerate() {
                    let y = if k == 0 { *wrong } else { *y };
                    let outcome = faulty.update(*u, y);
                    let spike = index < 5;
                    if k == 0 && spike {
                        assert!(matches!(outcome, Outcome::Replaced { .. }), "{outcome:?}");
                        assert_eq!(faulty.replaced(), clean.replaced() + 1);
                    }
                    if k % 50 == 0 {
                        let moved = moved(&clean, faulty);
                        let worst = match index {
                            5 => &mut stuck,
                            6 => &mut missing,
                            _ => &mut spikes,
                        };
                        *worst = worst.max(moved);
                    }
                }
            }
        }
        println!(
            "memory {memory:?}: largest change by a spike {spikes:.3} sigma, by a stuck sample {stuck:.3} sigma, by a missing one {missing:.3} sigma"
        );
        assert!(
            spikes <= 0.1 && stuck <= 0.1,
            "{memory:?}: {spikes} {stuck}"
        );
    }
}

#[test]
fn a_lasting_change_is_followed() {
    // The sensor is shifted by 3 mm for good: a step that no model explains, yet the samples after
    // it are right.
    let record = record(222_000, 12_000);
    let mut identifier = servo(Some(2.0));
    let mut replaced = 0;
    for (k, (u, y)) in record.iter().enumerate() {
        let shift = if k < 5000 { 0.0 } else { 3.0 };
        let outcome = identifier.update(*u, y + shift);
        if k >= 5000 && matches!(outcome, Outcome::Replaced { .. }) {
            replaced += 1;
        }
    }
    println!("after a lasting shift {replaced} samples were called implausible");
    assert!(replaced <= 5, "{replaced}");
    // Three memories later nothing is left of it.
    let found = identifier.estimate().physical();
    let (gain, omega0) = (found.gain.unwrap(), found.omega0.unwrap());
    assert!((gain / 2500.0 - 1.0).abs() < 1e-3, "{gain}");
    assert!((omega0 / 20.0 - 1.0).abs() < 1e-3, "{omega0}");
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn missing_samples_cost_little() {
    for (missing, limit) in [(1, 0.05), (3, 0.2), (20, 0.5)] {
        for memory in MEMORIES {
            let mut worst: f64 = 0.0;
            for seed in 223_000..223_040 {
                let record = record(seed, 6000);
                let mut whole = servo(memory);
                let at = 4000 + (seed % 97) as usize * 11;
                for (u, y) in &record[..at] {
                    let _ = whole.update(*u, *y);
                }
                let mut gap = whole.clone();
                for (k, (u, y)) in record[at..at + 800].iter().enumerate() {
                    let _ = whole.update(*u, *y);
                    if k < missing {
                        let _ = gap.update(*u, f32::NAN);
                    } else {
                        let _ = gap.update(*u, *y);
                    }
                    let (a, b) = (whole.theta(), gap.theta());
                    for j in 0..3 {
                        worst = worst.max(f64::from(100.0 * (b[j] / a[j] - 1.0).abs()));
                    }
                }
            }
            println!("{missing} missing, memory {memory:?}: largest change {worst:.4} %");
            assert!(worst <= limit, "{missing} {memory:?}: {worst} %");
        }
    }
}

/// Samples that are missing before anything is known: the largest error in standard deviations, of
/// those of a1, a2 and b0, from a second on.
fn off_after_an_early_gap<const N: usize>(structure: Structure<3, N, 1>, seed: u64) -> f64 {
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, DT as f32, 20.0).unwrap();
    let config = Config::new(structure, 20.0, [0.4], 50.0);
    let mut identifier: Identifier<_, 3, N> = Identifier::try_new(&config, trends).unwrap();
    let [_, a1, a2] = REFERENCE.a();
    let exact = [a1, a2, REFERENCE.b0()];
    let from = 20 + (seed % 20) as usize;
    let mut worst = 0.0_f64;
    for (k, (u, y)) in record(seed, 8000).into_iter().enumerate() {
        let missing = (from..from + 60).contains(&k);
        let _ = identifier.update(u, if missing { f32::NAN } else { y });
        if k % 1000 == 999 {
            let estimate = identifier.estimate();
            let found = estimate.theta().into_iter().zip(estimate.std()).zip(exact);
            for ((theta, std), exact) in found {
                worst = worst.max((f64::from(theta) - exact).abs() / f64::from(std));
            }
        }
    }
    worst
}

#[test]
fn a_gap_before_the_model_is_known_is_in_the_standard_deviations() {
    let worst = |of: &dyn Fn(u64) -> f64| (224_000..224_030).map(of).fold(0.0, f64::max);
    let servo = worst(&|seed| off_after_an_early_gap(Structure::<3, 5, 1>::SERVO, seed));
    let other = worst(&|seed| off_after_an_early_gap(Structure::<3, 3, 1>::INTEGRATING, seed));
    println!("60 samples missing from 20 to 40 ms on: at most {servo:.1} and {other:.1} sigma");
    // Bridged by what a few rows leave: 15 and 10.
    assert!(servo < 8.0 && other < 4.0, "{servo} {other}");
}
