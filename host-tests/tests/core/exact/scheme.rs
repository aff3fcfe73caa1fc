//! Deviations without any noise: they hold what differences in place of derivatives do.

use rand::{RngExt, SeedableRng};
use trendid::trends::{ExactTrends, FilteredTrends, Hold, RawTrends, Scheme, TrendOperator};
use trendid::{Config, Identifier, Structure};
use trendid_host_tests::plants::linear::{Input, LinearPlant};
use trendid_host_tests::random::Random;

use super::{Case, config, record};

/// Largest error of an existing a_i or b_i over its standard deviation.
fn deviations<T: TrendOperator<M>, const M: usize, const N: usize>(
    case: &Case,
    trends: T,
    seed: u64,
) -> f64 {
    let hold = Hold::Zero;
    let mut identifier: Identifier<T, M, N, 1, 0> =
        Identifier::try_new(&config(case, hold), trends).unwrap();
    for (u, y) in record(case, hold, seed) {
        let _ = identifier.update(u, y);
    }
    let estimate = identifier.estimate();
    let truth = case.a.iter().filter(|a| **a != 0.0).chain(case.b);
    let found = estimate.theta().into_iter().zip(estimate.std());
    let errors = found
        .zip(truth)
        .map(|((value, std), truth)| (f64::from(value) - truth).abs() / f64::from(std));
    errors.fold(0.0, f64::max)
}

/// A held command that reaches a lag between two samples: its mean stands for it there, and the
/// error of that is in the deviations.
#[test]
fn a_command_between_samples_is_in_the_deviations_of_a_lag() {
    const PARTS: usize = 4;
    let mut worst = 0.0_f32;
    for (dt, late) in [(0.05, 1), (0.1, 2), (0.2, 2), (0.5, 1), (0.5, 3)] {
        let input = Input::delayed(&[2.0], 2 * PARTS + late);
        let step = dt / PARTS as f64;
        let mut plant = LinearPlant::with_inputs(&[1.0], &[input], 0.0, step).unwrap();
        let trends = ExactTrends::<1>::for_bandwidth(dt as f32, 1.0).unwrap();
        let mut config = Config::new(Structure::<1, 2, 1>::FULL, 1.0, [1.0], 2.0);
        config.set_delay(0, 2.0 + late as f32 / PARTS as f32);
        let mut lag: Identifier<_, 1, 2, 1, 4> = Identifier::try_new(&config, trends).unwrap();
        let (mut rng, mut u) = (Random::seed_from_u64(42_010), 0.0);
        for k in 0..3000 {
            if k % (1.5 / dt) as usize == 0 {
                u = rng.random_range(-1.0..1.0);
            }
            let _ = lag.update(u as f32, plant.output() as f32);
            (0..PARTS).for_each(|_| {
                plant.step(&[u]);
            });
        }
        let estimate = lag.estimate();
        let found = estimate.theta().into_iter().zip(estimate.std());
        for ((value, std), truth) in found.zip([1.0, 2.0]) {
            worst = worst.max((value - truth).abs() / std);
        }
    }
    println!("{worst:.2} deviations");
    assert!(worst < 2.0, "{worst}");
}

/// What differences in place of derivatives do is in the deviations, without any noise that could
/// hide it: of Goodwin's scheme, and of trends without a filter.
#[test]
fn what_the_scheme_does_is_in_the_deviations() {
    // A lag, a well damped oscillator, a servo, two pairs.
    let cases = [
        (&[20.0][..], &[40.0][..]),
        (&[400.0, 20.0], &[1200.0]),
        (&[0.0, 400.0, 20.0], &[1e6]),
        (&[160_000.0, 24_000.0, 1_600.0, 60.0], &[160_000.0]),
    ];
    let mut worst = [0.0_f64; 3];
    for dt in [1e-3, 2e-3, 5e-3] {
        for (a, b) in cases {
            let case = Case {
                what: "",
                a,
                b,
                dt,
                every: (0.1 / dt) as usize,
                rough: 20.0,
            };
            for seed in 42_000..42_005 {
                let (time, rough) = (dt as f32, case.rough);
                macro_rules! of {
                    ($m:literal, $n:literal) => {{
                        let filtered =
                            FilteredTrends::<$m>::for_bandwidth(Scheme::Goodwin, time, rough);
                        let found = deviations::<_, $m, $n>(&case, filtered.unwrap(), seed);
                        worst[0] = worst[0].max(found);
                        for (k, scheme) in [Scheme::Goodwin, Scheme::Tustin].iter().enumerate() {
                            if $m > 2 {
                                continue; // f32 has no digits for three differences
                            }
                            let raw = RawTrends::<$m>::try_new(*scheme, time).unwrap();
                            let found = deviations::<_, $m, $n>(&case, raw, seed);
                            worst[k + 1] = worst[k + 1].max(found);
                        }
                    }};
                }
                match a.len() {
                    1 => of!(1, 2),
                    2 => of!(2, 3),
                    3 => of!(3, 3),
                    _ => of!(4, 5),
                }
            }
        }
    }
    println!("Goodwin filtered, raw, Tustin raw: {worst:.2?} deviations");
    assert!(worst.iter().all(|worst| *worst < 4.0), "{worst:?}");
}
