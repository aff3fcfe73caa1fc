//! Whether the reported standard deviations tell the truth: how often the true value lies within 1 and 3 of them.

use trendid::estimation::NoiseLevel;
use trendid::trends::{FilteredTrends, Scheme, TrendOperator};
use trendid::{Config, Identifier, Structure};
use trendid_host_tests::paper::iterations::own_numerators;
use trendid_host_tests::signals::experiment::{Experiment, Record};
use trendid_host_tests::signals::noise::Condition;

/// a1, a2, b0, C, omega0, xi of the reference servo.
const TRUTH: [f64; 6] = [400.0, 20.0, 1e6, 2500.0, 20.0, 0.5];

/// The range of u and of y that the user gives.
type Range = (f32, f32);

/// The scores of one record.
type Scored = fn(&Record, Range) -> [f64; 6];

fn design(range: Range) -> Config<3, 5, 1> {
    Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [range.0], range.1)
}

/// Of the default of the core.
fn default(record: &Record, range: Range) -> [f64; 6] {
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, 20.0).unwrap();
    let mut identifier = Identifier::try_new(&design(range), trends).unwrap();
    for s in record.samples() {
        let _ = identifier.update(s.u as f32, s.y as f32);
    }
    scores(&identifier)
}

/// Of the exact hold with the filter for a model.
fn exact(record: &Record, range: Range) -> [f64; 6] {
    scores(&own_numerators(&design(range), record, 1).unwrap())
}

/// Of the exact hold with the model of the record itself.
fn own(record: &Record, range: Range) -> [f64; 6] {
    scores(&own_numerators(&design(range), record, 2).unwrap())
}

/// Errors over reported standard deviations of a1, a2, b0, C, omega0, xi.
fn scores<T: TrendOperator<3>>(identifier: &Identifier<T, 3, 5>) -> [f64; 6] {
    let estimate = identifier.estimate();
    let theta = estimate.theta();
    let std = estimate.std();
    let reading = estimate.physical();
    let physical = [reading.gain, reading.omega0, reading.damping].map(|v| v.unwrap_or(f32::NAN));
    let physical_std = estimate.physical_std().unwrap_or([f32::NAN; 3]);
    let found = [
        theta[0],
        theta[1],
        theta[2],
        physical[0],
        physical[1],
        physical[2],
    ];
    let sigma = [
        std[0],
        std[1],
        std[2],
        physical_std[0],
        physical_std[1],
        physical_std[2],
    ];
    core::array::from_fn(|i| (f64::from(found[i]) - TRUTH[i]) / f64::from(sigma[i]))
}

/// Share of the runs within 1 and within 3 sigma \[%\].
fn coverage(
    name: &str,
    scored: Scored,
    experiment: &Experiment,
    range: Range,
    seeds: std::ops::Range<u64>,
) -> [[f64; 6]; 2] {
    let mut inside = [[0.0; 6]; 2];
    let share = 100.0 / seeds.clone().count() as f64;
    for seed in seeds.clone() {
        let z = scored(&experiment.record(seed), range);
        for i in 0..6 {
            // A score that is no number is outside.
            inside[0][i] += if z[i].abs() <= 1.0 { share } else { 0.0 };
            inside[1][i] += if z[i].abs() <= 3.0 { share } else { 0.0 };
        }
    }
    println!(
        "{name}, seeds {seeds:?}: within 1 sigma {:.1?}, 3 sigma {:.1?} %",
        inside[0], inside[1]
    );
    inside
}

/// Seeds that no constant of the read-out was chosen on (those were 100000 to 100999 and 300000 to 360599).
const SEEDS: std::ops::Range<u64> = 370_000..371_000;

/// Seeds that did not choose the conditions of the exact hold (those were 900000 to 930999).
const EXACT: std::ops::Range<u64> = 940_000..941_000;

/// The gate: 97 % within 3 sigma, 60 to 75 % within 1 sigma, for every parameter and reading.
fn calibrated([one, three]: [[f64; 6]; 2]) {
    assert!(three.iter().all(|share| *share >= 97.0), "{three:?}");
    assert!(
        one.iter().all(|share| (60.0..=75.0).contains(share)),
        "{one:?}"
    );
}

#[test]
#[ignore = "long: cargo xtask statistics"]
fn open_loop() {
    println!("shares for a1, a2, b0, C, omega0, xi");
    for duration in [1.0, 3.0] {
        for ns in [1.04, 8.35, 41.78] {
            let experiment = Experiment::reference(Condition::white_relative(ns), duration);
            let name = format!("open loop, {duration} s, N/S {ns} %");
            calibrated(coverage(&name, default, &experiment, (1.0, 50.0), SEEDS));
        }
    }
}

#[test]
#[ignore = "long: cargo xtask statistics"]
fn closed_loop() {
    println!("shares for a1, a2, b0, C, omega0, xi");
    for (duration, eta) in [(2.0, 500.0), (2.0, 5000.0), (4.0, 500.0), (4.0, 5000.0)] {
        let experiment = Experiment::closed_loop(Condition::white(eta), duration);
        let name = format!("closed loop, {duration} s, eta {eta} um");
        calibrated(coverage(&name, default, &experiment, (0.4, 50.0), SEEDS));
    }
}

/// Offsets from one that no record shows to one that every record shows; the worst lie in between, where the constant is
/// withdrawn in some records and is about as large as its own uncertainty.
#[test]
#[ignore = "long: cargo xtask statistics"]
fn open_loop_with_an_offset() {
    println!("shares for a1, a2, b0, C, omega0, xi");
    for (ns, duration) in [
        (1.04, 1.0),
        (8.35, 1.0),
        (41.78, 1.0),
        (1.04, 3.0),
        (8.35, 3.0),
        (41.78, 3.0),
    ] {
        for offset in [0.001, 0.005, 0.01, 0.02, 0.05, 0.1] {
            let mut experiment = Experiment::reference(Condition::white_relative(ns), duration);
            experiment.valve.offset = offset;
            let name = format!(
                "open loop, {duration} s, N/S {ns} %, offset {} %",
                100.0 * offset
            );
            let seeds = 380_000..380_600;
            let [_, three] = coverage(&name, default, &experiment, (1.0, 50.0), seeds);
            assert!(three.iter().all(|share| *share >= 89.0), "{three:?}");
        }
    }
}

/// Where the noise is so small that the discretisation rules, sigma must not promise more than that allows.
#[test]
#[ignore = "long: cargo xtask statistics"]
fn little_noise() {
    for eta in [1.0, 20.0, 100.0] {
        for duration in [1.0, 3.0] {
            let experiment = Experiment::reference(Condition::white(eta), duration);
            let name = format!("open loop, {duration} s, eta {eta} um");
            let seeds = SEEDS.start..SEEDS.start + 200;
            let [_, three] = coverage(&name, default, &experiment, (0.4, 50.0), seeds);
            assert!(three.iter().all(|share| *share >= 97.0), "{three:?}");
        }
    }
}

/// The exact hold leaves nothing of the interpolation in the estimate: sigma is that of the noise at a fifth of it.
///
/// Below stays what f32 may cost, which is an allowance and not a noise: there sigma promises less than is kept.
#[test]
#[ignore = "long: cargo xtask statistics"]
fn little_noise_with_the_exact_hold() {
    let open = |duration, eta| Experiment::reference(Condition::white(eta), duration);
    let closed = |duration, eta| Experiment::closed_loop(Condition::white(eta), duration);
    let cases = [
        ("open", 1.0, 100.0, open(1.0, 100.0)),
        ("open", 1.0, 500.0, open(1.0, 500.0)),
        ("open", 3.0, 500.0, open(3.0, 500.0)),
        ("closed", 2.0, 100.0, closed(2.0, 100.0)),
        ("closed", 4.0, 100.0, closed(4.0, 100.0)),
    ];
    for (kind, duration, eta, experiment) in cases {
        let name = format!("{kind} loop, {duration} s, eta {eta} um, own numerators");
        calibrated(coverage(&name, own, &experiment, (0.4, 50.0), EXACT));
    }
    for (duration, eta) in [(1.0, 20.0), (3.0, 20.0), (3.0, 100.0)] {
        for (kind, scored) in [("filter's", exact as Scored), ("own", own)] {
            let name = format!("open loop, {duration} s, eta {eta} um, {kind} numerators");
            let seeds = EXACT.start..EXACT.start + 200;
            let experiment = open(duration, eta);
            let [_, three] = coverage(&name, scored, &experiment, (0.4, 50.0), seeds);
            assert!(three.iter().all(|share| *share >= 97.0), "{three:?}");
        }
    }
}

/// The level that all of it rests on: the third difference measures white noise and does not see the drive.
#[test]
#[ignore = "long: cargo xtask statistics"]
fn noise_level_is_unbiased() {
    for ns in [1.04, 8.35, 41.78] {
        let experiment = Experiment::reference(Condition::white_relative(ns), 1.0);
        let mut ratios = Vec::new();
        for seed in SEEDS.start..SEEDS.start + 200 {
            let record = experiment.record(seed);
            let mut level = NoiseLevel::new(1.0);
            for y in &record.y {
                level.update(*y as f32);
            }
            let noise = record.noise();
            let power = noise.iter().map(|v| v * v).sum::<f64>() / noise.len() as f64;
            ratios.push(f64::from(level.variance().unwrap()) / power);
        }
        let mean = ratios.iter().sum::<f64>() / 200.0;
        let spread = (ratios.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / 200.0).sqrt();
        println!("N/S {ns} %: level over noise {mean:.4}, one run scatters by {spread:.4}");
        // 200 runs: the mean is known to a fourteenth of the scatter of one.
        assert!((mean - 1.0).abs() < 0.01 && spread < 0.1);
    }
}
