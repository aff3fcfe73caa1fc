//! What a memory costs a record that is hardly longer than it, and what time at rest costs.

use std::time::Instant;

use rand::RngExt;
use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, Identifier, Structure};
use trendid_host_tests::plants::servo::{REFERENCE, Servo};
use trendid_host_tests::signals::excitation::Excitation;
use trendid_host_tests::signals::experiment::{Experiment, Record};
use trendid_host_tests::signals::noise::{Condition, Stream, generator, rms};

fn identifier(range: f32, memory: Option<f32>, dt: f32) -> Identifier<FilteredTrends<3>, 3, 5> {
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, dt, 20.0).unwrap();
    let mut config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [range], 50.0);
    config.memory = memory;
    Identifier::try_new(&config, trends).unwrap()
}

/// Errors of C, omega0, xi in percent at the end of a record.
fn errors(record: &Record, range: f32, memory: Option<f32>) -> [f64; 3] {
    let mut identifier = identifier(range, memory, record.dt as f32);
    for sample in record.samples() {
        let _ = identifier.update(sample.u as f32, sample.y as f32);
    }
    let [a1, a2, b0, ..] = identifier.theta().map(f64::from);
    Servo::from_coefficients(a1, a2, b0)
        .map_or([f64::INFINITY; 3], |found| found.error_pct(&REFERENCE))
}

/// The same records with a memory and without one: white noise of six levels, 400 records each.
#[test]
fn two_seconds_of_memory_cost_three_seconds_little() {
    for (name, condition, range) in [
        ("10 um", Condition::white(10.0), 0.4),
        ("100 um", Condition::white(100.0), 0.4),
        ("1000 um", Condition::white(1000.0), 0.4),
        ("N/S 1.2 %", Condition::white_relative(1.2), 1.0),
        ("N/S 10 %", Condition::white_relative(10.0), 1.0),
        ("N/S 40 %", Condition::white_relative(40.0), 1.0),
    ] {
        let experiment = Experiment::reference(condition, 3.0);
        let [short, long, none] = {
            let records: Vec<_> = (291_000..291_400)
                .map(|seed| experiment.record(seed))
                .collect();
            [Some(2.0), Some(10.0), None].map(|memory| {
                let all: Vec<_> = records.iter().map(|r| errors(r, range, memory)).collect();
                let of = |all: &[[f64; 3]]| -> [f64; 3] {
                    std::array::from_fn(|i| rms(&all.iter().map(|e| e[i]).collect::<Vec<_>>()))
                };
                let blocks: Vec<_> = all.chunks(40).map(of).collect();
                let [least, most] = [f64::min, f64::max].map(|pick| -> [f64; 3] {
                    std::array::from_fn(|i| blocks.iter().map(|b| b[i]).reduce(pick).unwrap())
                });
                println!(
                    "{name}, memory {memory:?}: rms of C/omega0/xi {:.4?} %, of forty records {least:.4?} to {most:.4?} %",
                    of(&all)
                );
                of(&all)
            })
        };
        for (with, without) in short.iter().zip(none) {
            assert!(*with <= 1.12 * without, "{name}: {with} {without}");
        }
        for (with, without) in long.iter().zip(none) {
            assert!(*with <= 1.06 * without, "{name}: {with} {without}");
        }
    }
}

/// Seconds of the quickest of many pieces of a run: what else the machine does lengthens most, not
/// all of them.
fn quickest(identifier: &mut Identifier<FilteredTrends<3>, 3, 5>, samples: &[(f32, f32)]) -> f64 {
    samples
        .chunks_exact(500)
        .map(|piece| {
            let start = Instant::now();
            for (u, y) in piece {
                let _ = std::hint::black_box(identifier.update(*u, *y));
            }
            start.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min)
}

/// At rest every signal of a filter decays; a subnormal number would make each operation with it
/// many times as long.
#[test]
fn an_update_at_rest_takes_no_longer_than_one_in_motion() {
    for memory in [Some(0.2), Some(2.0), None] {
        for noise in [0.0, 0.01] {
            let mut random = generator(291_500, Stream::White);
            let mut plant = REFERENCE.plant(1e-3);
            let mut identifier = identifier(0.4, memory, 1e-3);
            let commands = Excitation::ABSOLUTE.sequence(100_000, 1e-3, 291_500);
            let all: Vec<(f32, f32)> = (0..600_000)
                .map(|k| {
                    let u = commands.get(k).copied().unwrap_or(0.0);
                    let y = plant.output() + noise * (random.random::<f64>() - 0.5);
                    // Its own state would be subnormal in the end: it is left where it stands.
                    if k < 120_000 {
                        plant.step(&[u]);
                    }
                    (u as f32, y as f32)
                })
                .collect();
            let motion = quickest(&mut identifier, &all[..100_000]);
            for (u, y) in &all[100_000..500_000] {
                let _ = identifier.update(*u, *y);
            }
            let rest = quickest(&mut identifier, &all[500_000..]);
            println!(
                "memory {memory:?}, noise {noise} mm: an update in motion {:.0} ns, behind 400 s of rest {:.0} ns, ratio {:.2}",
                2e6 * motion,
                2e6 * rest,
                rest / motion
            );
            assert!(rest <= 1.2 * motion, "{rest} {motion}");
        }
    }
}
