//! Calibration of the reported standard deviations: how often the true value lies within 1 and 3 of
//! them.

use trendid_host_tests::paper::coverage::{Scored, coverage, default, exact, own};
use trendid_host_tests::signals::experiment::Experiment;
use trendid_host_tests::signals::noise::Condition;

/// Seeds that no constant of the read-out was chosen on (those were 100000 to 100999 and 300000
/// to 360599).
const SEEDS: std::ops::Range<u64> = 370_000..371_000;

/// Seeds that did not choose the conditions of the exact hold (those were 900000 to 930999).
const EXACT: std::ops::Range<u64> = 940_000..941_000;

/// The gate: 97 % within 3 sigma, 60 to 75 % within 1 sigma, for every parameter and reading.
///
/// C to 80 %: its deviation has what an offset that no record shows may do to it, which is most of
/// it within a second. Less of that would leave less than 89 % within 3 sigma where there is one.
fn calibrated([one, three]: [[f64; 6]; 2]) {
    assert!(three.iter().all(|share| *share >= 97.0), "{three:?}");
    for (i, share) in one.into_iter().enumerate() {
        let most = if i == 3 { 80.0 } else { 75.0 };
        assert!((60.0..=most).contains(&share), "{i}: {one:?}");
    }
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

/// Offsets from one that no record shows to one that every record shows; the worst lie in between,
/// where the constant is withdrawn in some records and is about as large as its own uncertainty.
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

/// Where the noise is so small that the discretisation rules, sigma must not promise more than that
/// allows.
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

/// The exact hold leaves nothing of the interpolation in the estimate: sigma is that of the noise
/// at a fifth of it.
///
/// Below stays what f32 may cost, which is an allowance and not a noise: there sigma promises less
/// than is kept.
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
