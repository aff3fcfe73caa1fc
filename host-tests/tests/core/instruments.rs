//! Instruments beside the recursion: against f64 over a long record, and where they are weak.

use rand::{RngExt, SeedableRng};
use trendid::instruments::{self, Instrumented, Reading, Way};
use trendid::trends::{FilteredTrends, Hold, Scheme, TrendOperator};
use trendid::{Config, Identifier, Outcome, Structure};
use trendid_host_tests::plants::linear::{Input, LinearPlant};
use trendid_host_tests::random::Random;
use trendid_host_tests::signals::excitation::Excitation;
use trendid_host_tests::signals::experiment::{Experiment, Record};
use trendid_host_tests::signals::noise::Condition;

use crate::common::long_experiment;
use crate::dense::in_s_plane;

use in_f64::in_f64;

mod in_f64;
mod restart;

const SERVO: Structure<3, 5, 1> = Structure::SERVO;
const ROWS: usize = instruments::rows(&SERVO);
type Servo = Instrumented<FilteredTrends<3>, 3, 5, 1, ROWS>;

fn servo(change: impl FnOnce(&mut Config<3, 5, 1>)) -> Servo {
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0).unwrap();
    let mut config = Config::new(SERVO, 20.0, [1.0], 50.0);
    change(&mut config);
    Instrumented::try_new(&config, trends).unwrap()
}

/// Runs a record and gives the identifier.
fn run(record: &Record, mut servo: Servo) -> Servo {
    for sample in record.samples() {
        let _ = servo.update(sample.u as f32, sample.y as f32);
    }
    servo
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn the_sums_in_f32_are_those_of_f64_over_a_million_samples() {
    for (duration_s, seed) in [(10.0, 200_001), (1000.0, 200_002)] {
        let record = long_experiment(Condition::white(500.0), duration_s).record(seed);
        let servo = run(&record, servo(|config| config.offset_significance = 0.0));
        let found = servo.estimate();
        assert_eq!(found.way, Way::Instruments);
        let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0).unwrap();
        let oracle = in_s_plane(&in_f64(&record), &SERVO, trends.design());
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

#[test]
fn a_memory_follows_a_change() {
    let mut servo = servo(|config| config.memory = Some(0.8));
    let (dt, n) = (1e-3, 9000);
    let u = Excitation::ABSOLUTE.sequence(n, dt, 200_005);
    let mut rng = Random::seed_from_u64(200_006);
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

/// Largest relative error of a1, a2, b0 a second behind a change, by instruments and by least
/// squares.
fn behind_a_change(seed: u64) -> [f32; 2] {
    let mut servo = servo(|config| (config.memory, config.follow_changes) = (Some(2.0), true));
    let dt = 1e-3;
    let mut rng = Random::seed_from_u64(seed);
    let mut light = LinearPlant::new(&[0.0, 400.0, 20.0], &[1e6], dt).unwrap();
    let mut heavy = LinearPlant::new(&[0.0, 225.0, 15.0], &[562_500.0], dt).unwrap();
    for (k, u) in Excitation::ABSOLUTE
        .sequence(7000, dt, seed)
        .iter()
        .enumerate()
    {
        if k == 6000 {
            let kept: Vec<f64> = (0..3).map(|i| light.derivative(i)).collect();
            heavy.place(&kept);
        }
        let plant = if k < 6000 { &mut light } else { &mut heavy };
        let y = plant.output() + 0.005 * rng.random_range(-1.0..1.0);
        plant.step(&[*u]);
        let _ = servo.update(*u as f32, y as f32);
    }
    assert_eq!(servo.identifier().changes(), 1, "seed {seed}");
    let found = servo.estimate();
    assert_eq!(found.way, Way::Instruments, "seed {seed}");
    [found.estimate, servo.identifier().estimate()].map(|estimate| {
        let pairs = estimate.theta().into_iter().zip([225.0, 15.0, 562_500.0]);
        pairs.fold(0.0_f32, |worst, (value, truth)| {
            worst.max((value / truth - 1.0).abs())
        })
    })
}

#[test]
fn a_change_that_is_found_begins_the_sums_anew() {
    let (mut worst, mut worst_recursion) = (0.0_f32, 0.0_f32);
    for seed in 200_020..200_040 {
        let [instruments, recursion] = behind_a_change(seed);
        worst = worst.max(instruments);
        worst_recursion = worst_recursion.max(recursion);
    }
    println!(
        "a second behind a change: instruments {:.2} %, least squares {:.2} % at worst",
        100.0 * worst,
        100.0 * worst_recursion
    );
    assert!(worst < 0.05, "{worst}");
}

#[test]
fn weak_instruments_and_few_blocks_are_said() {
    let mut servo = servo(|_| {});
    assert_eq!(servo.estimate().way, Way::TooFewBlocks); // nothing at all
    let mut rng = Random::seed_from_u64(200_007);
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
        let mut rng = Random::seed_from_u64(seed);
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
