//! The bound of stabilised forgetting, attacked on the bare estimator, and its step against dense
//! matrices.

use rand::RngExt;
use trendid::estimation::{Estimator, StabilisedForgetting};
use trendid_host_tests::random::Random;
use trendid_host_tests::signals::noise::{Stream, generator};

/// Rows that take away what the estimator needs, or give too much.
#[derive(Clone, Copy, Debug)]
enum Rows {
    Zero,
    OneDirection,
    Collinear,
    NoiseOnly,
    Switching,
    Huge,
    Spikes,
    Tiny,
    Inconsistent,
}

const ALL: [Rows; 9] = [
    Rows::Zero,
    Rows::OneDirection,
    Rows::Collinear,
    Rows::NoiseOnly,
    Rows::Switching,
    Rows::Huge,
    Rows::Spikes,
    Rows::Tiny,
    Rows::Inconsistent,
];

impl Rows {
    fn row<const N: usize>(self, k: usize, random: &mut Random) -> ([f32; N], f32) {
        let mut number = || 2.0 * random.random::<f32>() - 1.0;
        let fit = |phi: [f32; N]| (phi, phi.iter().sum::<f32>());
        match self {
            Self::Zero => ([0.0; N], 0.0),
            Self::OneDirection => fit([0.7; N]),
            Self::Collinear => {
                let x = number();
                fit(std::array::from_fn(|_| x + 1e-7 * number()))
            }
            Self::NoiseOnly => (std::array::from_fn(|_| 1e-3 * number()), 1e-3 * number()),
            Self::Switching => {
                let size = 10.0_f32.powi((k / 700 % 10) as i32 - 6);
                let direction = k / 300 % N;
                fit(std::array::from_fn(|j| {
                    if j == direction {
                        size * number()
                    } else {
                        1e-4 * size * number()
                    }
                }))
            }
            Self::Huge => fit(std::array::from_fn(|_| 1e3 * number())),
            Self::Spikes => {
                let spike = if k.is_multiple_of(997) { 1e6 } else { 1.0 };
                fit(std::array::from_fn(|_| spike * number()))
            }
            Self::Tiny => fit(std::array::from_fn(|j| {
                1e-18 * 10.0_f32.powi(-4 * j as i32) * number()
            })),
            Self::Inconsistent => (
                std::array::from_fn(|_| 0.3),
                if (k / 50).is_multiple_of(2) {
                    1.0
                } else {
                    -1.0
                },
            ),
        }
    }
}

/// Largest P_ii over its bound.
fn attack<const N: usize>(rows: Rows, memory: f32, seed: u64, count: usize) -> f64 {
    let forgetting = 1.0 - 1.0 / memory;
    let share = 1.0 - f64::from(forgetting);
    let mut estimator = Estimator::<N>::new([0.0; N], [1e4; N], forgetting);
    let mut stabilised = StabilisedForgetting::new([0.0; N], forgetting);
    stabilised.set_nominal([0.0; N]);
    let mut random = generator(seed, Stream::White);
    let mut largest: f64 = 0.0;
    let mut energy: f64 = 0.0;
    for k in 0..count {
        let (phi, psi) = rows.row::<N>(k, &mut random);
        let _ = estimator.update(&phi, psi);
        stabilised.apply(&mut estimator);
        energy = (1.0 - share) * energy + f64::from(psi).powi(2);
        if k % 89 != 88 {
            continue;
        }
        // The observation of the newest sample may have been begun only.
        let rounds = (k / (2 * N)) as i32;
        let begun = 1.0 - f64::from(forgetting).powi(rounds * 2 * N as i32);
        for i in 0..N {
            let p = f64::from(estimator.covariance(i, i));
            largest = largest.max(p * begun / f64::from(stabilised.bound()));
            // theta is the minimum of a cost that is no larger at the nominal values.
            let theta = f64::from(estimator.theta()[i]);
            let limit = (p * energy).sqrt();
            assert!(
                theta.abs() <= 1.02 * limit + 1e-6,
                "{rows:?} {N} {memory}: {theta} {limit}"
            );
        }
        let sound = estimator
            .diagonal()
            .iter()
            .all(|d| *d > 0.0 && d.is_finite());
        assert!(sound, "{rows:?} {N} {memory}: {:?}", estimator.diagonal());
    }
    largest
}

fn all_rows<const N: usize>(memories: &[f32], count: usize) -> f64 {
    let mut worst: f64 = 0.0;
    for rows in ALL {
        for memory in memories {
            let largest = attack::<N>(rows, *memory, 220_000, count);
            assert!(
                largest < 1.01,
                "{rows:?}, N {N}, memory {memory}: {largest}"
            );
            worst = worst.max(largest);
        }
    }
    worst
}

#[test]
fn the_covariance_stays_below_its_bound_whatever_comes() {
    let memories = [100.0, 200.0, 2000.0, 10_000.0, 100_000.0];
    let count = 40_000;
    let worst = [
        all_rows::<1>(&memories, count),
        all_rows::<2>(&memories, count),
        all_rows::<3>(&memories, count),
        all_rows::<4>(&memories, count),
        all_rows::<5>(&memories, count),
        all_rows::<6>(&memories, count),
        all_rows::<7>(&memories, count),
        all_rows::<8>(&memories, count),
    ];
    println!("largest P_ii over its bound for N = 1 to 8: {worst:.4?}");
    // The bound is no idle one: zero rows come near.
    assert!(worst.iter().all(|share| *share > 0.8));
}

#[test]
fn one_observation_is_that_of_dense_matrices() {
    let mut random = generator(220_001, Stream::White);
    let mut estimator = Estimator::<5>::new([0.3; 5], [30.0; 5], 0.999);
    for k in 0..300 {
        let (phi, psi) = Rows::Huge.row::<5>(k, &mut random);
        let _ = estimator.update(&phi.map(|x| 1e-4 * x), 1e-4 * psi);
    }
    for index in 0..5 {
        let before = estimator.clone();
        let dense = |i, j| f64::from(before.covariance(i, j));
        let value = 0.7;
        let returned = estimator.observe_parameter(index, value as f32, 8.0, 0.0);
        let scale = 8.0 + dense(index, index);
        assert!((f64::from(returned) / dense(index, index) - 1.0).abs() < 1e-5);
        for i in 0..5 {
            let step = dense(i, index) / scale * (value - f64::from(before.theta()[index]));
            let theta = f64::from(before.theta()[i]) + step;
            assert!((f64::from(estimator.theta()[i]) - theta).abs() < 1e-4);
            for j in 0..5 {
                let expected = dense(i, j) - dense(i, index) * dense(index, j) / scale;
                let size = (dense(i, i) * dense(j, j)).sqrt();
                let found = f64::from(estimator.covariance(i, j));
                assert!(
                    (found - expected).abs() < 1e-4 * size,
                    "{index}: {i} {j} {found} {expected}"
                );
            }
        }
    }
}

/// Both estimators to the last bit.
fn same<const N: usize>(found: &Estimator<N>, wanted: &Estimator<N>, what: &str) {
    let bits = |estimator: &Estimator<N>| {
        let p = |k: usize| estimator.covariance(k / N, k % N).to_bits();
        let all: Vec<_> = (0..N * N).map(p).collect();
        (estimator.theta().map(f32::to_bits), all)
    };
    assert_eq!(bits(found), bits(wanted), "{what}");
}

type Step = fn(&mut Estimator<5>);

/// The variance of an observation and the P_ii below which it is left out, as in the core.
const VARIANCE: f32 = 16_384.0;
const CERTAIN: f32 = 2e-6 * VARIANCE;

#[test]
fn an_observation_in_two_parts_is_the_whole_one_for_whatever_comes_next() {
    let mut random = generator(220_002, Stream::White);
    let forgetting = 0.995;
    let mut parts = Estimator::<5>::new([0.3; 5], [100.0; 5], forgetting);
    let mut whole = parts.clone();
    let mut stabilised = StabilisedForgetting::new([0.2; 5], forgetting);
    stabilised.set_nominal([0.2; 5]);
    let mut halves = 0;
    for k in 0..4000 {
        let rows = if k % 1000 < 500 {
            Rows::NoiseOnly
        } else {
            Rows::OneDirection
        };
        let (phi, psi) = rows.row::<5>(k, &mut random);
        let (found, wanted) = (parts.update(&phi, psi), whole.update(&phi, psi));
        assert_eq!(found.to_bits(), wanted.to_bits(), "{k}");
        same(&parts, &whole, "after a row");
        stabilised.apply(&mut parts);
        if k % 2 == 1 {
            let _ = whole.observe_parameter(k / 2 % 5, 0.2, VARIANCE, CERTAIN);
        }
        if parts.theta() == whole.theta() {
            continue;
        }
        // Begun, not finished: every way on finishes it first.
        halves += 1;
        let next: [(&str, Step); 5] = [
            ("correct", |estimator| estimator.correct(&[0.1; 5], 0.1)),
            ("pass", Estimator::pass),
            ("inflate_last", |estimator| estimator.inflate_last(2.0)),
            ("resume", |estimator| {
                estimator.resume([0.5; 5], 3.0, &[1e4; 5])
            }),
            ("observe_parameter", |estimator| {
                let _ = estimator.observe_parameter(1, 0.7, 64.0, 0.0);
            }),
        ];
        for (what, step) in next {
            let (mut parts, mut whole) = (parts.clone(), whole.clone());
            step(&mut parts);
            step(&mut whole);
            same(&parts, &whole, what);
        }
    }
    assert!(halves > 1000, "{halves}");
}
