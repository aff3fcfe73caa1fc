//! What a memory costs a record that is hardly longer than it.

use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, Identifier, Structure};
use trendid_host_tests::plants::servo::{REFERENCE, Servo};
use trendid_host_tests::signals::experiment::{Experiment, Record};
use trendid_host_tests::signals::noise::{Condition, rms};

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
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
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
