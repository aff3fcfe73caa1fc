//! Forgetting that survives rest: 20 s without excitation, then a drive that has changed.

use rand::RngExt;
use trendid::{Config, FilteredTrends, Identifier, Scheme, Structure};
use trendid_host_tests::excitation::Excitation;
use trendid_host_tests::noise::{Stream, generator};
use trendid_host_tests::reference::{REFERENCE, Servo};

const DT: f64 = 0.001;

/// Largest drift over the rest in percent, and the time in ms after which all errors stay within 5/5/10 %.
fn run(seed: u64, eta_mm: f64, pull: f32) -> (f64, f64) {
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, DT as f32, 20.0).unwrap();
    let mut config = Config::new(Structure::<3, 4, 1>::servo(), 20.0, [0.4], 50.0);
    config.memory = Some(0.2);
    config.pull = pull;
    let mut identifier: Identifier<_, 3, 4> = Identifier::try_new(&config, trends).unwrap();
    let mut noise = generator(seed, Stream::White);
    let mut eta = || (noise.random::<f64>() - 0.5) * eta_mm;

    let mut plant = REFERENCE.plant(DT);
    let moving = Excitation::ABSOLUTE.sequence(2000, DT, seed);
    for u in moving {
        let _ = identifier.update(u as f32, (plant.output() + eta()) as f32);
        plant.step(&[u]);
    }
    identifier.trust();
    let before = Servo::from_coefficients(
        f64::from(identifier.theta()[0]),
        f64::from(identifier.theta()[1]),
        f64::from(identifier.theta()[2]),
    )
    .unwrap();
    // Comes to rest, and rests.
    let mut drift: f64 = 0.0;
    for _ in 0..20_000 {
        let _ = identifier.update(0.0, (plant.output() + eta()) as f32);
        plant.step(&[0.0]);
    }
    let theta = identifier.theta().map(f64::from);
    let after = Servo::from_coefficients(theta[0], theta[1], theta[2]).unwrap();
    for e in after.error_pct(&before) {
        drift = drift.max(e.abs());
    }
    // A heavier load: w0 falls by 25 %, C and xi stay.
    let changed = Servo {
        omega0: 0.75 * REFERENCE.omega0,
        ..REFERENCE
    };
    let rest = plant.output();
    let mut plant = changed.plant(DT);
    plant.place(&[rest, 0.0, 0.0]);
    let again = Excitation::ABSOLUTE.sequence(1000, DT, seed + 1_000_000);
    let mut late = 0;
    for (k, u) in again.into_iter().enumerate() {
        let _ = identifier.update(u as f32, (plant.output() + eta()) as f32);
        plant.step(&[u]);
        let theta = identifier.theta().map(f64::from);
        let good = Servo::from_coefficients(theta[0], theta[1], theta[2]).is_some_and(|found| {
            let [c, w, x] = found.error_pct(&changed);
            c.abs() < 5.0 && w.abs() < 5.0 && x.abs() < 10.0
        });
        if !good {
            late = k + 1;
        }
    }
    (drift, late as f64)
}

#[test]
fn rest_neither_moves_nor_blinds_the_estimate() {
    for eta in [0.01, 0.02, 0.1] {
        for pull in [1e-5, 1e-4, 5e-4, 1e-3, 1e-2] {
            let seeds = 9000..9020_u64;
            let mut results: Vec<(f64, f64)> =
                seeds.clone().map(|seed| run(seed, eta, pull)).collect();
            let drift = results.iter().map(|r| r.0).fold(0.0, f64::max);
            results.sort_by(|a, b| a.1.total_cmp(&b.1));
            let median = results[results.len() / 2].1;
            let p95 = results[results.len() * 19 / 20].1;
            println!(
                "eta {eta} mm pull {pull:e}, seeds {seeds:?}: worst drift {drift:.3} %, back after {median} ms (median), {p95} ms (95 %)"
            );
        }
    }
}
