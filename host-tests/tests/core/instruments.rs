//! Instruments beside the recursion: against f64 over a long record, over populations of plants, and where they are weak.

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use trendid::instruments::{self, Instrumented, Reading, Way};
use trendid::trends::{FilteredTrends, Hold, Scheme};
use trendid::{Config, Identifier, Outcome, Structure};
use trendid_host_tests::oracles::least_squares;
use trendid_host_tests::oracles::trends::{self as oracle, applied};
use trendid_host_tests::plants::linear::{Input, LinearPlant};
use trendid_host_tests::plants::polynomial::{difference_equation, power, product, scaled, sum};
use trendid_host_tests::signals::excitation::Excitation;
use trendid_host_tests::signals::experiment::{Experiment, Record};
use trendid_host_tests::signals::noise::Condition;

use crate::common::{rounded, rows};

const SERVO: Structure<3, 5, 1> = Structure::SERVO;
const ROWS: usize = instruments::rows(&SERVO);
type Servo = Instrumented<FilteredTrends<3>, 3, 5, 1, ROWS>;

fn servo(change: impl FnOnce(&mut Config<3, 5, 1>)) -> Servo {
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0).unwrap();
    let mut config = Config::new(SERVO, 20.0, [1.0], 50.0);
    change(&mut config);
    Instrumented::try_new(&config, trends).unwrap()
}

/// Theta in f64 by the equations of the module, with the auxiliary denominator of the default filter.
fn in_f64(record: &Record) -> [f64; 5] {
    let dt = record.dt;
    let f = [1064.8, 551.76, 33.0, 1.0];
    let structure = least_squares::Structure {
        m: 3,
        a: vec![1, 2],
        inputs: vec![least_squares::InputTerms {
            b: vec![0],
            delay: 0,
            hold: oracle::Hold::Zero,
        }],
        constant: true,
    };
    let decay = (1.0 - 0.0011) / (1.0 + 0.0011);
    let (u, y) = (rounded(&record.u), rounded(&record.y));
    let scheme = oracle::Scheme::Tustin;
    let (phi, psi) = rows(&structure, scheme, Some(&f), dt, &[&u], &y, Some(decay), 0);
    // s^j / A_z of u / A_f, s = 2/dt (1-q)/(1+q).
    let first = oracle::input_trend(scheme, oracle::Hold::Zero, 3, 0, dt);
    let once = applied(&first, scheme, Some(&f), dt, &u);
    let term = |j: usize| {
        let both = product(&power(&[1.0, -1.0], j), &power(&[1.0, 1.0], 2 - j));
        scaled(&both, (2.0 / dt).powi(j as i32))
    };
    let denominator = sum(
        &sum(&scaled(&term(0), 484.0), &scaled(&term(1), 30.8)),
        &term(2),
    );
    let twice: Vec<Vec<f64>> = (0..2)
        .map(|j| difference_equation(&term(j), &denominator, &once))
        .collect();
    let n = y.len();
    let solved = |z: &DMatrix<f64>| -> DVector<f64> {
        let scale = DVector::from_fn(5, |j, _| phi.column(j).norm());
        let rows = DVector::from_fn(5, |i, _| z.column(i).norm());
        let (m, r) = (z.transpose() * &phi, z.transpose() * &psi);
        let m = DMatrix::from_fn(5, 5, |i, j| m[(i, j)] / (rows[i] * scale[j]));
        let r = r.component_div(&rows);
        m.full_piv_lu().solve(&r).unwrap().component_div(&scale)
    };
    let mut theta = solved(&phi);
    for _ in 0..6 {
        let mut z = phi.clone();
        for i in 0..2 {
            z.set_column(i, &(-theta[2] * DVector::from_column_slice(&twice[i][..n])));
        }
        theta = solved(&z);
    }
    core::array::from_fn(|j| theta[j])
}

/// Runs a record and gives the identifier.
fn run(record: &Record, mut servo: Servo) -> Servo {
    for sample in record.samples() {
        let _ = servo.update(sample.u as f32, sample.y as f32);
    }
    servo
}

#[test]
fn the_sums_in_f32_are_those_of_f64_over_a_million_samples() {
    // A multisine: a drive that integrates stays where f32 has digits.
    for (duration_s, seed) in [(10.0, 200_001), (1000.0, 200_002)] {
        let mut experiment = Experiment::reference(Condition::white(500.0), duration_s);
        experiment.excitation = Excitation::Multisine {
            amplitude: 0.5,
            first_hz: 0.3,
            lines: 12,
        };
        let record = experiment.record(seed);
        let servo = run(&record, servo(|config| config.offset_significance = 0.0));
        let found = servo.estimate();
        assert_eq!(found.way, Way::Instruments);
        let oracle = in_f64(&record);
        let (theta, std) = (found.estimate.theta(), found.estimate.std());
        for j in 0..4 {
            let off = (f64::from(theta[j]) - oracle[j]).abs();
            let sigma = f64::from(std[j]);
            println!(
                "{duration_s} s, parameter {j}: f32 {} f64 {} apart {:.4} sigma, {:.1e} relative",
                theta[j],
                oracle[j],
                off / sigma,
                off / oracle[j].abs()
            );
            // The constant counts as an input: b_0 per unit.
            let rounding = match j {
                3 => 2e-8 * oracle[2].abs(),
                _ => 2e-5 * oracle[j].abs(),
            };
            assert!(off < 0.1 * sigma + rounding, "{j}: {off} {sigma}");
        }
    }
}

#[test]
fn the_recursion_inside_is_bit_for_bit_that_of_an_identifier() {
    let record = Experiment::reference(Condition::white(500.0), 2.0).record(200_003);
    for memory in [None, Some(0.5)] {
        let mut with = servo(|config| config.memory = memory);
        let mut without = {
            let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0).unwrap();
            let mut config = Config::new(SERVO, 20.0, [1.0], 50.0);
            config.memory = memory;
            Identifier::<_, 3, 5>::try_new(&config, trends).unwrap()
        };
        for (k, sample) in record.samples().enumerate() {
            let y = if k % 97 == 5 {
                f32::NAN
            } else {
                sample.y as f32
            };
            let a = with.update(sample.u as f32, y);
            let b = without.update(sample.u as f32, y);
            assert_eq!(a, b);
            if k == 1200 {
                with.skip(20);
                without.skip(20);
            }
        }
        assert!(with.identifier() == &without);
    }
}

#[test]
fn a_reading_over_samples_is_the_estimate_at_its_begin() {
    let record = Experiment::reference(Condition::white(500.0), 3.0).record(200_004);
    let mut servo = servo(|_| {});
    let (mut reading, mut steps, mut done) = (Reading::new(), 0, 0);
    let mut seen = None;
    for (k, sample) in record.samples().enumerate() {
        let _ = servo.update(sample.u as f32, sample.y as f32);
        if k < 500 {
            continue;
        }
        steps += 1;
        if steps == 17 {
            // All blocks are taken; what follows is computed from these sums.
            seen = Some(servo.estimate());
        }
        if let Some(found) = reading.step(&mut servo) {
            assert_eq!(Some(&found), seen.as_ref(), "sample {k}");
            assert!(steps <= 40, "{k}: {steps} steps");
            (steps, done) = (0, done + usize::from(found.way == Way::Instruments));
        }
    }
    assert!(done > 50, "{done}");
}

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

/// One drawn plant of a structure: order M, I inputs, numerators up to `zeros`.
fn drawn<const M: usize, const N: usize, const I: usize, const R: usize>(
    structure: Structure<M, N, I>,
    seed: u64,
    tally: &mut Tally,
) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (dt, omega) = (2e-3, 20.0);
    // Poles from half to twice the bandwidth, some of them a pair.
    let mut a = vec![1.0];
    let integrators = structure.integrators();
    for _ in 0..integrators {
        a = product(&a, &[0.0, 1.0]);
    }
    let mut left = M - integrators;
    while left > 0 {
        let rate = omega * 2f64.powf(rng.random_range(-1.0..1.0));
        if left >= 2 && rng.random_bool(0.6) {
            let damping = rng.random_range(0.3..0.9);
            a = product(&a, &[rate * rate, 2.0 * damping * rate, 1.0]);
            left -= 2;
        } else {
            a = product(&a, &[rate, 1.0]);
            left -= 1;
        }
    }
    let lowest = a[integrators];
    let inputs: Vec<Input> = structure
        .inputs()
        .map(|terms| {
            let gain = lowest * rng.random_range(0.5..2.0);
            let b: Vec<f64> = (0..terms.count())
                .map(|k| gain * rng.random_range(0.5..1.0) / (3.0 * omega).powi(k as i32))
                .collect();
            Input::new(&b)
        })
        .into();
    let constant = match structure.constant() {
        true => 0.1 * lowest,
        false => 0.0,
    };
    let mut plant = LinearPlant::with_inputs(&a[..M], &inputs, constant, dt).unwrap();
    let n = 8000;
    let u: Vec<Vec<f64>> = (0..I)
        .map(|c| {
            let hold_s = [0.06, 0.1][c % 2];
            let excitation = Excitation::Prbs {
                amplitude: 1.0,
                hold_s,
                bits: 11,
            };
            excitation.sequence(n, dt, seed + 7919 * c as u64)
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
    // White noise and, in half of them, a drift of a second.
    let drifts = rng.random_bool(0.5);
    let level = 0.05 * size.min(0.3);
    let mut drift = 0.0;
    let noise: Vec<f64> = (0..n)
        .map(|_| {
            drift = 0.99 * drift + 0.14 * rng.random_range(-1.7..1.7);
            level * (0.5 * rng.random_range(-1.7..1.7) + if drifts { drift } else { 0.0 })
        })
        .collect();
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, dt as f32, omega as f32).unwrap();
    let mut config = Config::new(structure, omega as f32, [1.0; I], size as f32);
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
    let mut expected: Vec<f64> = (integrators..M).map(|i| a[i]).collect();
    for input in &inputs {
        expected.extend(&input.b);
    }
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
            drawn::<$m, $n, $i, R>(STRUCTURE, seed, &mut tally);
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

#[test]
fn a_memory_follows_a_change() {
    let mut servo = servo(|config| config.memory = Some(0.8));
    let (dt, n) = (1e-3, 9000);
    let u = Excitation::ABSOLUTE.sequence(n, dt, 200_005);
    let mut rng = ChaCha8Rng::seed_from_u64(200_006);
    let mut slow = LinearPlant::new(&[0.0, 400.0, 20.0], &[1e6], dt).unwrap();
    let mut fast = LinearPlant::new(&[0.0, 625.0, 25.0], &[1e6], dt).unwrap();
    let mut found = Vec::new();
    for (k, u) in u.iter().enumerate() {
        if k == 4000 {
            let kept: Vec<f64> = (0..3).map(|i| slow.derivative(i)).collect();
            fast.place(&kept);
        }
        let plant = if k < 4000 { &mut slow } else { &mut fast };
        let y = plant.output() + 0.2 * rng.random_range(-1.0..1.0);
        plant.step(&[*u]);
        let _ = servo.update(*u as f32, y as f32);
        if k == 3999 || k == 8999 {
            let now = servo.estimate();
            assert_eq!(now.way, Way::Instruments);
            found.push((now.estimate.theta(), now.estimate.std()));
        }
    }
    for ((theta, std), truth) in found
        .iter()
        .zip([[400.0, 20.0, 1e6], [625.0, 25.0, 1e6_f32]])
    {
        for j in 0..3 {
            let off = (theta[j] - truth[j]).abs();
            assert!(
                off < 4.0 * std[j] && off < 0.03 * truth[j],
                "{j}: {off} {}",
                std[j]
            );
        }
    }
}

#[test]
fn weak_instruments_and_few_blocks_are_said() {
    let mut servo = servo(|_| {});
    assert_eq!(servo.estimate().way, Way::TooFewBlocks); // nothing at all
    let mut rng = ChaCha8Rng::seed_from_u64(200_007);
    for _ in 0..40 {
        let _ = servo.update(0.4, 0.01 * rng.random_range(-1.0..1.0_f32));
    }
    assert!(servo.estimate().way != Way::Instruments);
    // Noise alone under a command that does not move anything.
    for k in 0..4000 {
        let u = if k % 100 < 50 { 0.4 } else { -0.4 };
        let _ = servo.update(u, rng.random_range(-1.0..1.0_f32));
    }
    let found = servo.estimate();
    assert_eq!(found.way, Way::WeakInstruments);
    assert_eq!(found.estimate, servo.identifier().estimate());
    servo.reset();
    assert!(servo == self::servo(|_| {}));
}

#[test]
fn a_delay_a_ramp_hold_gaps_and_unusable_readings() {
    let (dt, n, delay) = (1e-3, 6000, 4);
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, dt as f32, 20.0).unwrap();
    for (hold, seed) in [(Hold::Zero, 200_010), (Hold::First, 200_011)] {
        let mut config = Config::new(SERVO, 20.0, [1.0], 50.0);
        config.holds = [hold];
        config.delays = [if hold == Hold::Zero { delay } else { 0 }];
        let mut servo: Instrumented<_, 3, 5, 1, ROWS, 8> =
            Instrumented::try_new(&config, trends.clone()).unwrap();
        let u = Excitation::Multisine {
            amplitude: 0.6,
            first_hz: 0.4,
            lines: 10,
        }
        .sequence(n, dt, seed);
        let lag = config.delays[0];
        let input = Input::delayed(&[1e6], lag);
        let mut plant = LinearPlant::with_inputs(&[0.0, 400.0, 20.0], &[input], 0.0, dt).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut refused = 0;
        for k in 0..n {
            let y = plant.output() + 0.1 * rng.random_range(-1.0..1.0);
            let now = u[k];
            match hold {
                Hold::Zero | Hold::Mean => plant.step(&[now]),
                Hold::First => plant.step_ramp(&[now], &[u[(k + 1).min(n - 1)]]),
            };
            let y = if k % 50 == 7 { f32::NAN } else { y as f32 };
            if (3000..3020).contains(&k) {
                servo.skip(1);
            } else if let Outcome::Refused(_) = servo.update(now as f32, y) {
                refused += 1;
            }
        }
        assert!(refused > 100);
        let found = servo.estimate();
        assert_eq!(found.way, Way::Instruments);
        for (j, truth) in [400.0, 20.0, 1e6_f32].into_iter().enumerate() {
            let off = (found.estimate.theta()[j] - truth).abs() / truth;
            assert!(off < 0.02, "{hold:?} {j}: {off}");
        }
    }
}

#[test]
fn what_cannot_be_is_refused() {
    use trendid::ConfigError;
    use trendid::trends::RawTrends;
    let config = Config::new(SERVO, 20.0, [1.0], 50.0);
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0).unwrap();
    let wrong: Result<Instrumented<_, 3, 5, 1, 4>, _> = Instrumented::try_new(&config, trends);
    assert_eq!(
        wrong.unwrap_err(),
        ConfigError::ParameterCount {
            found: 5,
            expected: 4
        }
    );
    let raw = RawTrends::<3>::try_new(Scheme::Tustin, 1e-3).unwrap();
    let wrong: Result<Instrumented<_, 3, 5, 1, ROWS>, _> = Instrumented::try_new(&config, raw);
    assert!(matches!(wrong, Err(ConfigError::Unstable { .. })));
}
