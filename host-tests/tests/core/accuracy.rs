//! The core on the reference servo: without noise, and with white noise of known width.

use crate::common::{self, core_scheme, rounded, rows};
use proptest::prelude::*;
use trendid::trends::{FilteredTrends, Form, Memory, RawTrends, TrendOperator, Window};
use trendid::{Config, Identifier};
use trendid_host_tests::oracles::least_squares::{Structure, least_squares, recursive_equivalent};
use trendid_host_tests::oracles::trends::{Hold, Scheme, input_trend, output_trend};
use trendid_host_tests::plants::polynomial::{delayed, moving_sum, power, scaled};
use trendid_host_tests::plants::servo::{REFERENCE, Servo};
use trendid_host_tests::signals::experiment::{Experiment, Record};
use trendid_host_tests::signals::noise::Condition;

/// Relative errors of C, omega0 and xi in percent after the whole record.
fn errors<T: TrendOperator<3>>(trends: T, record: &Record) -> [f64; 3] {
    let mut identifier: Identifier<T, 3, 3> = Identifier::try_new(&design(), trends).unwrap();
    for sample in record.samples() {
        let _ = identifier.update(sample.u as f32, sample.y as f32);
    }
    error_pct(&identifier.theta().map(f64::from))
}

fn design() -> Config<3, 3, 1> {
    Config::new(trendid::Structure::INTEGRATING, 20.0, [0.4], 50.0)
}

fn error_pct(theta: &[f64]) -> [f64; 3] {
    Servo::from_coefficients(theta[0], theta[1], theta[2])
        .map_or([f64::INFINITY; 3], |found| found.error_pct(&REFERENCE))
}

fn within(errors: [f64; 3], limits: [f64; 3]) -> bool {
    errors.iter().zip(&limits).all(|(e, l)| e.abs() <= *l)
}

/// Errors of batch least squares in f64 on raw trends of these samples.
fn raw_batch(scheme: Scheme, u: &[f64], y: &[f64]) -> [f64; 3] {
    let (phi, target) = rows(&Structure::servo(), scheme, None, 1e-3, &[u], y, None, 3);
    let fit = least_squares(&phi, &target, None).expect("excited");
    error_pct(fit.theta.as_slice())
}

#[test]
fn noise_free_raw_tustin_beats_goodwin_and_the_filter_beats_both() {
    let seeds = 11..111_u64;
    // Sum of squares, worst; raw Tustin and Goodwin in f64, two filters in the core.
    let mut squares = [[0.0_f64; 3]; 4];
    let mut worst = [[0.0_f64; 3]; 4];
    for seed in seeds.clone() {
        let record = Experiment::reference(Condition::CLEAN, 1.0).record(seed);
        let tustin = trendid::trends::Scheme::Tustin;
        let filter = FilteredTrends::try_new(tustin, 0.001, [25.0; 3]).unwrap();
        let default = FilteredTrends::for_bandwidth(tustin, 0.001, 20.0).unwrap();
        let each = [
            raw_batch(Scheme::Tustin, &record.u, &record.y),
            raw_batch(Scheme::Goodwin, &record.u, &record.y),
            errors(filter, &record),
            errors(default, &record),
        ];
        for (row, e) in each.iter().enumerate() {
            for i in 0..3 {
                squares[row][i] += e[i] * e[i] / 100.0;
                worst[row][i] = worst[row][i].max(e[i].abs());
            }
        }
    }
    println!("1 s of binary noise, noise-free, seeds {seeds:?}: C/omega0/xi [%], rms and worst");
    let names = [
        "raw Tustin, f64",
        "raw Goodwin, f64",
        "core, (s + 25)^3",
        "core, default filter",
    ];
    let rms = squares.map(|s| s.map(f64::sqrt));
    for (row, name) in names.iter().enumerate() {
        println!("  {name}: {:.4?}, {:.4?}", rms[row], worst[row]);
    }
    assert!(within(rms[0], [0.4, 0.1, 0.5]));
    for i in 0..3 {
        assert!(rms[1][i] > rms[0][i] && worst[1][i] > worst[0][i]);
    }
    assert!(within(worst[2], [0.02; 3]) && within(worst[3], [0.02; 3]));
}

/// What the 24 bits of an f32 position leave of raw trends: the core's arithmetic adds nothing to
/// it.
#[test]
fn raw_estimate_is_that_of_f64_on_the_same_samples() {
    println!("raw trends of f32 positions: errors of C/omega0/xi [%], core and f64 batch");
    for scheme in [Scheme::Tustin, Scheme::Goodwin] {
        for seed in [11, 12, 13] {
            let record = Experiment::reference(Condition::CLEAN, 1.0).record(seed);
            let (u, y) = (rounded(&record.u), rounded(&record.y));
            let config = design();
            let trends = RawTrends::try_new(core_scheme(scheme), 0.001).unwrap();
            let mut identifier: Identifier<_, 3, 3> = Identifier::try_new(&config, trends).unwrap();
            for (u, y) in u.iter().zip(&y) {
                let _ = identifier.update(*u as f32, *y as f32);
            }
            let core = identifier.recursion().theta().map(f64::from);
            let dt = f64::from(0.001_f32);
            let (phi, target) = rows(&Structure::servo(), scheme, None, dt, &[&u], &y, None, 3);
            let sd = common::design_units(&config).map(|unit| 10.0 * unit);
            let noise = output_trend(scheme, 3, 3, dt)[0] * 0.05;
            let batch = recursive_equivalent(&phi, &target, 1.0, &[0.0; 3], &sd, noise).unwrap();
            let gap = (0..3).fold(0.0_f64, |g, i| {
                g.max((core[i] / batch.theta[i] - 1.0).abs())
            });
            let (ours, oracle) = (error_pct(&core), error_pct(batch.theta.as_slice()));
            println!(
                "{scheme:?}, seed {seed}: {ours:.4?}, {oracle:.4?}, relative difference {gap:.1e}"
            );
            assert!(gap < 1e-5, "{scheme:?} {seed}: {gap}");
        }
    }
}

/// Largest error of a raw trend of the core, in roundings (2^-24) of its gross size.
///
/// The gross size is the trend of the magnitudes with every difference 1 - q^-1 taken as the sum
/// 1 + q^-1: the largest number that the nested differences and means can meet on the way.
fn roundings(operator: &[f64], nested: &[f64], x: &[f64], got: &[f32]) -> f64 {
    let exact = moving_sum(operator, x);
    let sizes: Vec<f64> = x.iter().map(|v| v.abs()).collect();
    let gross = moving_sum(nested, &sizes);
    let mut worst = 0.0_f64;
    for k in 0..x.len() {
        let error = (f64::from(got[k]) - exact[k]).abs();
        if gross[k] > 0.0 {
            worst = worst.max(error / gross[k] * 2_f64.powi(24));
        } else {
            assert_eq!(error, 0.0);
        }
    }
    worst
}

/// All trends of one order against the products of (4) and (8): worst roundings of the output and
/// of the inputs.
fn raw_trends<const M: usize>(scheme: Scheme, dt: f32, x: &[f32]) -> f64 {
    let trends = RawTrends::<M>::try_new(core_scheme(scheme), dt).unwrap();
    let wide: Vec<f64> = x.iter().map(|v| f64::from(*v)).collect();
    let step = f64::from(dt);
    // The core divides (4) by Delta^m and (8) by (2 Delta)^m.
    let unit = match scheme {
        Scheme::Goodwin => step.powi(-(M as i32)),
        Scheme::Tustin => (2.0 * step).powi(-(M as i32)),
    };
    let mut worst = 0.0_f64;
    let mut memory = Window::output_at_rest(trends.design(), Form::Position, 0.0);
    let output = |y: &f32| trends.output(&mut memory, *y, Form::Position);
    let all: Vec<_> = x.iter().map(output).collect();
    for i in 0..=M {
        let got: Vec<f32> = all
            .iter()
            .map(|t| if i < M { t.lower[i] } else { t.top })
            .collect();
        let operator = scaled(&output_trend(scheme, M, i, step), unit);
        let nested = all_sums(scheme, M, i, &operator);
        worst = worst.max(roundings(&operator, &nested, &wide, &got));
    }
    for (hold, core_hold) in [
        (Hold::Zero, trendid::trends::Hold::Zero),
        (Hold::First, trendid::trends::Hold::First),
    ] {
        let mut memory = Window::input_at_rest(trends.design(), core_hold, 0.0);
        let all: Vec<_> = x
            .iter()
            .map(|u| trends.input(&mut memory, *u, core_hold))
            .collect();
        for i in 0..M {
            let got: Vec<f32> = all.iter().map(|t| t[i]).collect();
            let operator = scaled(&input_trend(scheme, hold, M, i, step), unit);
            let factors = match hold {
                Hold::Zero => M - 1,
                Hold::First => M,
            };
            let nested = all_sums(scheme, factors, i, &operator);
            worst = worst.max(roundings(&operator, &nested, &wide, &got));
        }
    }
    worst
}

/// The operator with every difference taken as a sum; `factors` of (8) are differences or means,
/// `i` of (4).
fn all_sums(scheme: Scheme, factors: usize, i: usize, operator: &[f64]) -> Vec<f64> {
    let (first, c) = operator
        .iter()
        .enumerate()
        .find(|(_, c)| **c != 0.0)
        .expect("an operator is not zero");
    let count = match scheme {
        Scheme::Goodwin => i,
        Scheme::Tustin => factors,
    };
    delayed(&scaled(&power(&[1.0, 1.0], count), c.abs()), first)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]

    /// A difference costs three roundings (subtraction, factor 1/Delta and its own rounding), an
    /// average one.
    #[test]
    fn raw_trends_are_the_polynomial_products(
        x in prop::collection::vec(-100.0_f32..100.0, 1..40),
        dt in prop::sample::select(vec![0.001_f32, 0.005, 0.0016384, 0.25]),
    ) {
        for scheme in [Scheme::Goodwin, Scheme::Tustin] {
            let worst = [
                raw_trends::<1>(scheme, dt, &x),
                raw_trends::<2>(scheme, dt, &x),
                raw_trends::<3>(scheme, dt, &x),
                raw_trends::<4>(scheme, dt, &x),
            ];
            for (m, worst) in (1..).zip(worst) {
                prop_assert!(worst <= 3.0 * f64::from(m) + 1e-3, "{scheme:?} m {m}: {worst}");
            }
        }
    }
}

#[test]
fn roundings_of_raw_trends() {
    // The positions of a moving servo, neighbours close together.
    let record = Experiment::reference(Condition::CLEAN, 1.0).record(11);
    let x: Vec<f32> = record.y.iter().map(|y| *y as f32).collect();
    for scheme in [Scheme::Goodwin, Scheme::Tustin] {
        let worst = [
            raw_trends::<1>(scheme, 0.001, &x),
            raw_trends::<2>(scheme, 0.001, &x),
            raw_trends::<3>(scheme, 0.001, &x),
            raw_trends::<4>(scheme, 0.001, &x),
        ];
        println!("{scheme:?}: worst roundings of 2^-24 for order 1..4: {worst:.2?}");
        for (m, worst) in (1..).zip(worst) {
            assert!(worst <= 3.0 * f64::from(m) + 1e-3);
        }
    }
}

#[test]
fn white_noise_absolute_half_a_second() {
    for (eta, limit) in [(10.0, 0.05), (100.0, 0.2), (500.0, 0.6)] {
        let seeds = 5000..5100_u64;
        let mut squares = [0.0; 3];
        for seed in seeds.clone() {
            let record = Experiment::reference(Condition::white(eta), 0.5).record(seed);
            let trends =
                FilteredTrends::try_new(trendid::trends::Scheme::Tustin, 0.001, [25.0; 3]).unwrap();
            for (sum, e) in squares.iter_mut().zip(errors(trends, &record)) {
                *sum += e * e / 100.0;
            }
        }
        let rms = squares.map(f64::sqrt);
        println!("eta {eta} um, seeds {seeds:?}: rms error of C/omega0/xi {rms:.3?} %");
        assert!(
            within(rms, [limit; 3]),
            "eta {eta}: {rms:?} above {limit} %"
        );
    }
}
