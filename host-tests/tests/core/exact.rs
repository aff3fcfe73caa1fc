//! Slow sampling: exact trends against the plain filtered ones, without noise, and their
//! uncertainty under noise.

use rand::{RngExt, SeedableRng};
use trendid::estimation::Terms;
use trendid::trends::{AnyTrends, ExactTrends, FilteredTrends, Hold, Scheme, TrendOperator};
use trendid::{Config, Identifier, Structure};
use trendid_host_tests::plants::linear::{Input, LinearPlant};
use trendid_host_tests::random::Random;

mod scheme;

/// A plant `B(s)/A(s)` and how it is sampled.
struct Case {
    what: &'static str,
    a: &'static [f64],
    b: &'static [f64],
    dt: f64,
    /// Samples between two changes of a held command.
    every: usize,
    /// Rough bandwidth that the user gives, rad/s.
    rough: f32,
}

/// 420 rad/s sampled nine times a period; the servo of the paper at 5 ms and, three times as fast,
/// at 5 ms; a pair with a zero and a lag; a lag alone; two pairs.
const CASES: [Case; 6] = [
    Case {
        what: "oscillator, 9 samples a period",
        a: &[176_400.0, 42.0],
        b: &[176_400.0],
        dt: 1.66e-3,
        every: 5,
        rough: 300.0,
    },
    Case {
        what: "servo of 20 rad/s at 5 ms",
        a: &[0.0, 400.0, 20.0],
        b: &[1e6],
        dt: 5e-3,
        every: 10,
        rough: 30.0,
    },
    Case {
        what: "servo of 60 rad/s at 5 ms",
        a: &[0.0, 3600.0, 36.0],
        b: &[9e6],
        dt: 5e-3,
        every: 10,
        rough: 40.0,
    },
    Case {
        what: "order 3 with a zero at 10 ms",
        a: &[1.0e5, 6.0e3, 110.0],
        b: &[1.0e5, 4.0e3],
        dt: 1e-2,
        every: 7,
        rough: 40.0,
    },
    Case {
        what: "lag of 8 rad/s at 50 ms",
        a: &[8.0],
        b: &[16.0],
        dt: 5e-2,
        every: 5,
        rough: 5.0,
    },
    Case {
        what: "order 4, 60 and 150 rad/s at 5 ms",
        // (s^2 + 12 s + 3600)(s^2 + 60 s + 22500)
        a: &[8.1e7, 4.86e5, 26_820.0, 72.0],
        b: &[8.1e7],
        dt: 5e-3,
        every: 5,
        rough: 90.0,
    },
];

const SEEDS: std::ops::Range<u64> = 41_000..41_100;

/// Rounds with the numerators of the model found so far; the slowest case gains a digit in each.
const ROUNDS: usize = 6;

/// (u, y) of 1500 samples: a binary command that may change every so many samples, or white and
/// straight between samples.
fn record(case: &Case, hold: Hold, seed: u64) -> Vec<(f32, f32)> {
    let mut rng = Random::seed_from_u64(seed);
    let mut plant = LinearPlant::with_inputs(case.a, &[Input::new(case.b)], 0.0, case.dt).unwrap();
    let mut u = 0.0;
    let mut samples = Vec::new();
    let mut drawn = |k: usize, u: f64| match hold {
        Hold::First => 0.5 * u + rng.random_range(-1.0..1.0),
        Hold::Zero | Hold::Mean if k.is_multiple_of(case.every) => {
            if rng.random::<bool>() {
                1.0
            } else {
                -1.0
            }
        }
        Hold::Zero | Hold::Mean => u,
    };
    for k in 0..1500 {
        // What was held since the sample before is its mean.
        let before = u;
        if let Hold::Zero | Hold::Mean = hold {
            u = drawn(k, u);
        }
        let told = if hold == Hold::Mean { before } else { u };
        samples.push((told as f32, plant.output() as f32));
        match hold {
            Hold::Zero | Hold::Mean => {
                plant.step(&[u]);
            }
            Hold::First => {
                let next = drawn(k, u);
                plant.step_ramp(&[u], &[next]);
                u = next;
            }
        }
    }
    samples
}

fn config<const M: usize, const N: usize>(case: &Case, hold: Hold) -> Config<M, N, 1> {
    let first = usize::from(case.a[0] == 0.0);
    let b = [Terms::up_to(case.b.len())];
    let structure = Structure::try_new(Terms::between(first, M), b, false).unwrap();
    let gain = case.b[0] / case.a[first];
    let mut config = Config::new(structure, case.rough, [1.0], gain as f32);
    config.holds = [hold];
    config
}

/// Largest error of an existing a_i or b_i in percent.
fn worst<T: TrendOperator<M>, const M: usize, const N: usize, const D: usize>(
    case: &Case,
    identifier: &Identifier<T, M, N, 1, D>,
) -> f64 {
    let model = identifier.estimate().transfer_function();
    let off = |found: &[f32], truth: &[f64]| {
        let pairs = found.iter().zip(truth).filter(|(_, t)| **t != 0.0);
        pairs.fold(0.0_f64, |m, (f, t)| {
            m.max(100.0 * (f64::from(*f) / t - 1.0).abs())
        })
    };
    off(&model.a, case.a).max(off(&model.b[0], case.b))
}

/// One type for every operator, with the delay line of [`dense`](crate::dense): the core is
/// compiled once for each structure.
fn identified<const M: usize, const N: usize>(
    case: &Case,
    hold: Hold,
    trends: AnyTrends<M>,
    record: &[(f32, f32)],
) -> Identifier<AnyTrends<M>, M, N, 1, 8> {
    let mut identifier = Identifier::try_new(&config(case, hold), trends).unwrap();
    for (u, y) in record {
        let _ = identifier.update(*u, *y);
    }
    identifier
}

/// Worst errors in percent over all seeds: plain, exact with the filter for a model, exact with its
/// own model for a model.
fn compare<const M: usize, const N: usize>(case: &Case, hold: Hold) -> [f64; 3] {
    let mut errors = [0.0_f64; 3];
    let plain =
        FilteredTrends::<M>::for_bandwidth(Scheme::Tustin, case.dt as f32, case.rough).unwrap();
    let plain = AnyTrends::Filtered(plain);
    let exact = ExactTrends::<M>::for_bandwidth(case.dt as f32, case.rough).unwrap();
    for seed in SEEDS {
        let record = record(case, hold, seed);
        let identifier = identified::<M, N>(case, hold, plain.clone(), &record);
        errors[0] = errors[0].max(worst(case, &identifier));
        let known = AnyTrends::Exact(exact.clone());
        let mut identifier = identified::<M, N>(case, hold, known, &record);
        errors[1] = errors[1].max(worst(case, &identifier));
        for _ in 0..ROUNDS {
            let own = exact
                .with_model(identifier.estimate().transfer_function().a)
                .unwrap();
            identifier = identified(case, hold, AnyTrends::Exact(own), &record);
        }
        errors[2] = errors[2].max(worst(case, &identifier));
    }
    println!(
        "{}, {hold:?}, seeds {SEEDS:?}: worst error of a parameter {:.3} % plain, {:.4} % exact numerators of the filter, {:.5} % of the model",
        case.what, errors[0], errors[1], errors[2]
    );
    errors
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn slow_sampling_costs_nothing() {
    for hold in [Hold::Zero, Hold::First, Hold::Mean] {
        let errors = [
            compare::<2, 3>(&CASES[0], hold),
            compare::<3, 3>(&CASES[1], hold),
            compare::<3, 3>(&CASES[2], hold),
            compare::<3, 5>(&CASES[3], hold),
            compare::<1, 2>(&CASES[4], hold),
            compare::<4, 5>(&CASES[5], hold),
        ];
        for (case, [plain, _, model]) in CASES.iter().zip(errors) {
            assert!(model < 0.05, "{}: {model} %", case.what);
            assert!(plain > 5.0 * model, "{}: {plain} % {model} %", case.what);
        }
    }
}

/// On line: the model goes into the numerators on the way, and nothing jumps there.
#[test]
fn retuning_takes_the_model_over() {
    let case = &CASES[0];
    let exact = ExactTrends::<2>::for_bandwidth(case.dt as f32, case.rough).unwrap();
    let (mut before, mut after) = (0.0_f64, 0.0_f64);
    for seed in SEEDS {
        let record: Vec<_> = (0..3)
            .flat_map(|_| record(case, Hold::Zero, seed))
            .collect();
        let mut config = config(case, Hold::Zero);
        config.memory = Some(0.5);
        let mut identifier: Identifier<_, 2, 3> =
            Identifier::try_new(&config, exact.clone()).unwrap();
        for (k, (u, y)) in record.iter().enumerate() {
            let _ = identifier.update(*u, *y);
            if k == 1000 {
                before = before.max(worst(case, &identifier));
            }
            if k % 1000 == 0 && k > 0 {
                let theta = identifier.theta();
                let own = exact.with_model(identifier.estimate().transfer_function().a);
                identifier.retune(own.unwrap(), 0.3).unwrap();
                for (b, a) in theta.iter().zip(identifier.theta()) {
                    assert!((b - a).abs() <= 1e-5 * b.abs(), "{theta:?}");
                }
            }
        }
        after = after.max(worst(case, &identifier));
    }
    println!(
        "retuned at 1000, 2000, .. of 4500 samples, seeds {SEEDS:?}: worst {before:.2} % -> {after:.4} %"
    );
    assert!(before > 3.0 && after < 0.1);
}

/// White noise: the truth lies where the standard deviations say, at nine samples a period.
#[test]
fn the_uncertainty_is_that_of_the_noise() {
    let (case, seeds) = (&CASES[0], 42_000..42_200_u64);
    let exact = ExactTrends::<2>::for_bandwidth(case.dt as f32, case.rough).unwrap();
    let truth = [case.a[0], case.a[1], case.b[0]];
    let (mut one, mut three, mut count) = (0, 0, 0);
    let mut rms = [0.0_f64; 3];
    for seed in seeds.clone() {
        let mut rng = Random::seed_from_u64(seed + 1_000_000);
        let mut noisy = record(case, Hold::Zero, seed);
        for (_, y) in &mut noisy {
            // Uniform, 0.05 of a step in full width.
            *y += rng.random_range(-0.025..0.025_f32);
        }
        let mut identifier =
            identified::<2, 3>(case, Hold::Zero, AnyTrends::Exact(exact.clone()), &noisy);
        for _ in 0..ROUNDS {
            let a = identifier.estimate().transfer_function().a;
            let own = ExactTrends::from_polynomial(case.dt as f32, a).unwrap();
            identifier = identified(case, Hold::Zero, AnyTrends::Exact(own), &noisy);
        }
        let estimate = identifier.estimate();
        let (theta, std) = (estimate.theta(), estimate.std());
        for i in 0..3 {
            let error = f64::from(theta[i]) - truth[i];
            rms[i] += (error / truth[i]).powi(2) / seeds.clone().count() as f64;
            count += 1;
            one += usize::from(error.abs() < f64::from(std[i]));
            three += usize::from(error.abs() < 3.0 * f64::from(std[i]));
        }
    }
    println!(
        "seeds {seeds:?}: {one} within 1 and {three} within 3 standard deviations of {count}; rms {:.3?} %",
        rms.map(|r| 100.0 * r.sqrt())
    );
    assert!(three * 100 >= 97 * count);
    assert!(one * 100 >= 60 * count && one * 100 <= 85 * count);
}
