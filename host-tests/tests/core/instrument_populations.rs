//! Instruments over populations of drawn plants: what their standard deviations cover.

use rand::{RngExt, SeedableRng};
use trendid::instruments::{self, Instrumented, Way};
use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, Structure};
use trendid_host_tests::plants::linear::{Input, LinearPlant};
use trendid_host_tests::plants::polynomial::product;
use trendid_host_tests::random::Random;
use trendid_host_tests::signals::excitation::Excitation;

/// Errors of a population in standard deviations, with how often instruments were used.
#[derive(Default, Debug)]
struct Tally {
    z: Vec<f64>,
    least_squares: Vec<f64>,
    instruments: usize,
    others: usize,
}

impl Tally {
    fn within(&self, limit: f64) -> f64 {
        let inside = self.z.iter().filter(|z| z.abs() <= limit).count();
        100.0 * inside as f64 / self.z.len() as f64
    }
}

/// One drawn plant and what is to be found: order M, I inputs.
struct Drawn {
    plant: LinearPlant,
    /// The parameters of y and of the inputs.
    expected: Vec<f64>,
}

/// Sample time in s and bandwidth in rad/s.
const DT: f64 = 2e-3;
const OMEGA: f64 = 20.0;

/// Poles from half to twice the bandwidth, some of them a pair.
fn poles(rng: &mut Random, integrators: usize, order: usize) -> Vec<f64> {
    let mut a = vec![1.0];
    for _ in 0..integrators {
        a = product(&a, &[0.0, 1.0]);
    }
    let mut left = order - integrators;
    while left > 0 {
        let rate = OMEGA * 2f64.powf(rng.random_range(-1.0..1.0));
        if left >= 2 && rng.random_bool(0.6) {
            let damping = rng.random_range(0.3..0.9);
            a = product(&a, &[rate * rate, 2.0 * damping * rate, 1.0]);
            left -= 2;
        } else {
            a = product(&a, &[rate, 1.0]);
            left -= 1;
        }
    }
    a
}

/// A plant of a structure.
fn drawn<const M: usize, const N: usize, const I: usize>(
    structure: &Structure<M, N, I>,
    rng: &mut Random,
) -> Drawn {
    let integrators = structure.integrators();
    let a = poles(rng, integrators, M);
    let lowest = a[integrators];
    let inputs: Vec<Input> = structure
        .inputs()
        .map(|terms| {
            let gain = lowest * rng.random_range(0.5..2.0);
            let b: Vec<f64> = (0..terms.count())
                .map(|k| gain * rng.random_range(0.5..1.0) / (3.0 * OMEGA).powi(k as i32))
                .collect();
            Input::new(&b)
        })
        .into();
    let constant = match structure.constant() {
        true => 0.1 * lowest,
        false => 0.0,
    };
    let mut expected: Vec<f64> = a[integrators..M].to_vec();
    for input in &inputs {
        expected.extend(&input.b);
    }
    let plant = LinearPlant::with_inputs(&a[..M], &inputs, constant, DT).unwrap();
    Drawn { plant, expected }
}

/// White noise and, in half of them, a drift of a second.
fn noise(rng: &mut Random, n: usize, level: f64) -> Vec<f64> {
    let drifts = rng.random_bool(0.5);
    let mut drift = 0.0;
    (0..n)
        .map(|_| {
            drift = 0.99 * drift + 0.14 * rng.random_range(-1.7..1.7);
            level * (0.5 * rng.random_range(-1.7..1.7) + if drifts { drift } else { 0.0 })
        })
        .collect()
}

/// Identifies one drawn plant of a structure.
fn identified<const M: usize, const N: usize, const I: usize, const R: usize>(
    structure: Structure<M, N, I>,
    seed: u64,
    tally: &mut Tally,
) {
    let mut rng = Random::seed_from_u64(seed);
    let Drawn {
        mut plant,
        expected,
    } = drawn(&structure, &mut rng);
    let n = 8000;
    let u: Vec<Vec<f64>> = (0..I)
        .map(|c| {
            let hold_s = [0.06, 0.1][c % 2];
            let excitation = Excitation::Prbs {
                amplitude: 1.0,
                hold_s,
                bits: 11,
            };
            excitation.sequence(n, DT, seed + 7919 * c as u64)
        })
        .collect();
    let mut truth = Vec::with_capacity(n);
    for k in 0..n {
        truth.push(plant.output());
        let now: Vec<f64> = u.iter().map(|u| u[k]).collect();
        plant.step(&now);
    }
    let mean = truth.iter().sum::<f64>() / n as f64;
    let size = (truth.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / n as f64).sqrt();
    let noise = noise(&mut rng, n, 0.05 * size.min(0.3));
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, DT as f32, OMEGA as f32).unwrap();
    let mut config = Config::new(structure, OMEGA as f32, [1.0; I], size as f32);
    config.offset_significance = 0.0;
    if seed.is_multiple_of(2) {
        config.memory = Some(4.0);
    }
    let mut found: Instrumented<_, M, N, I, R> = Instrumented::try_new(&config, trends).unwrap();
    for k in 0..n {
        let now: [f32; I] = core::array::from_fn(|c| u[c][k] as f32);
        let _ = found.update_inputs(now, (truth[k] + noise[k]) as f32);
    }
    let recursion = found.identifier().estimate();
    let found = found.estimate();
    if found.way != Way::Instruments {
        tally.others += 1;
        return;
    }
    tally.instruments += 1;
    for (j, truth) in expected.iter().enumerate() {
        let z = |theta: f32, std: f32| (f64::from(theta) - truth) / f64::from(std);
        tally
            .z
            .push(z(found.estimate.theta()[j], found.estimate.std()[j]));
        tally
            .least_squares
            .push(z(recursion.theta()[j], recursion.std()[j]));
    }
}

/// A population of a structure; the constants of a call are those of the type.
macro_rules! population {
    ($m:literal, $n:literal, $i:literal, $structure:expr, $seeds:expr) => {{
        const STRUCTURE: Structure<$m, $n, $i> = $structure;
        const R: usize = instruments::rows(&STRUCTURE);
        let mut tally = Tally::default();
        for seed in $seeds {
            identified::<$m, $n, $i, R>(STRUCTURE, seed, &mut tally);
        }
        let rms = |z: &[f64]| (z.iter().map(|z| z * z).sum::<f64>() / z.len() as f64).sqrt();
        println!(
            "order {} parameters {} inputs {}: {} of {} by instruments, within 1, 3 sigma {:.0}, {:.1} %, rms z {:.2} (recursion {:.2})",
            $m, $n, $i, tally.instruments, tally.instruments + tally.others,
            tally.within(1.0), tally.within(3.0), rms(&tally.z), rms(&tally.least_squares),
        );
        tally
    }};
}

#[test]
fn populations_of_every_order_are_covered_by_their_standard_deviations() {
    let mut all = Tally::default();
    let mut add = |tally: Tally| {
        all.z.extend(tally.z);
        all.least_squares.extend(tally.least_squares);
        all.instruments += tally.instruments;
        all.others += tally.others;
    };
    add(population!(1, 2, 1, Structure::FULL, 210_000..210_030));
    add(population!(
        2,
        3,
        1,
        Structure::INTEGRATING_WITH_INITIAL_STATE,
        220_000..220_030
    ));
    add(population!(3, 5, 1, Structure::SERVO, 230_000..230_030));
    add(population!(3, 6, 2, Structure::SERVO, 240_000..240_030));
    add(population!(2, 4, 1, Structure::FULL, 250_000..250_030));
    add(population!(
        4,
        4,
        1,
        Structure::INTEGRATING,
        260_000..260_030
    ));
    let [one, three] = [all.within(1.0), all.within(3.0)];
    println!(
        "all: {one:.1} % within 1, {three:.1} % within 3 sigma, {} by instruments, {} not",
        all.instruments, all.others
    );
    assert!(all.instruments * 10 > 9 * (all.instruments + all.others));
    assert!((62.0..80.0).contains(&one) && three > 98.0, "{one} {three}");
}
