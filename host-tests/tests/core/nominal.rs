//! Nominal values that were set and are not right: the standard deviations say how wrong they may
//! be, whatever was known in between.

use rand::RngExt;
use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, Identifier, Structure};
use trendid_host_tests::endurance::axis::{Axis, Integrating};
use trendid_host_tests::endurance::motion::{Commands, Motion};
use trendid_host_tests::plants::servo::{REFERENCE, Servo};
use trendid_host_tests::random::Random;
use trendid_host_tests::signals::noise::{Stream, generator};

const DT: f64 = 1e-3;

/// What the axis does behind half a second of binary noise or none.
#[derive(Clone, Copy, Debug)]
struct Work {
    motion: Motion,
    begins_with_noise: bool,
}

/// Largest error of a1, a2, b0 over its standard deviation.
fn in_sigma(identifier: &Identifier<FilteredTrends<3>, 3, 5>, truth: [f64; 3]) -> f64 {
    let estimate = identifier.estimate();
    let pairs = estimate.theta().into_iter().zip(estimate.std()).zip(truth);
    pairs
        .map(|((found, std), truth)| (f64::from(found) - truth).abs() / f64::from(std))
        .fold(0.0, f64::max)
}

/// Largest error of a1, a2, b0 over its standard deviation in two minutes behind a start from
/// values that are wrong by up to 1.7 standard deviations `share`, relative to them.
fn over_sigma(seed: u64, memory: Option<f32>, share: f64, work: Work) -> f64 {
    let truth = [REFERENCE.a()[1], REFERENCE.a()[2], REFERENCE.b0()];
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, DT as f32, 20.0).unwrap();
    let mut config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4], 50.0);
    config.memory = memory;
    let mut identifier: Identifier<_, 3, 5> = Identifier::try_new(&config, trends).unwrap();
    let mut random = generator(seed, Stream::Excitation);
    let mut start = [0.0_f32; 5];
    for (start, truth) in start.iter_mut().zip(truth) {
        let off = 3.0_f64.sqrt() * (2.0 * random.random::<f64>() - 1.0);
        *start = (truth * (1.0 + share * off)) as f32;
    }
    let std = truth.map(|truth| (share * truth) as f32);
    let std = [std[0], std[1], std[2], 1e4, 0.05];
    identifier.warm_start(start, std).unwrap();
    let mut axis = Integrating::new(REFERENCE.a(), REFERENCE.b0(), DT);
    let mut commands = Commands::new(seed, 20.0, REFERENCE.c, false, DT);
    let mut noise = generator(seed, Stream::White);
    let mut over = 0.0_f64;
    for k in 0..120_000_u64 {
        let y = axis.position() + 0.01 * (noise.random::<f64>() - 0.5);
        let motion = match work.begins_with_noise && k < 500 {
            true => Motion::Binary,
            false => work.motion,
        };
        let u = commands.next(motion, k, y);
        let _ = identifier.update(u as f32, y as f32);
        axis.step(u);
        if k > 100 && k % 499 == 0 {
            over = over.max(in_sigma(&identifier, truth));
        }
    }
    over
}

/// What does not hold: an axis that runs at constant speed from the first sample on, with a prior
/// of a hundredth. Nothing ever tells its parameters apart, and the noise of so many regressors
/// passes for information; that row is printed only.
fn not_taken_for_more(seeds: &std::ops::Range<u64>) {
    for motion in [
        Motion::Rest,
        Motion::Speed(0.4),
        Motion::Sine {
            amplitude: 0.1,
            hz: 0.5,
        },
    ] {
        for begins_with_noise in [false, true] {
            let work = Work {
                motion,
                begins_with_noise,
            };
            let mut line = String::new();
            let mut worst = 0.0_f64;
            for memory in [None, Some(0.2), Some(2.0), Some(10.0)] {
                for share in [0.1, 0.01, 0.001] {
                    let found = seeds
                        .clone()
                        .map(|seed| over_sigma(seed, memory, share, work))
                        .fold(0.0_f64, f64::max);
                    line += &format!(" {found:.1}");
                    worst = worst.max(found);
                }
            }
            println!("{work:?}: errors over sigma, memory none/0.2/2/10 s, std 10/1/0.1 %:{line}");
            let excited = begins_with_noise || !matches!(motion, Motion::Speed(_));
            assert!(worst <= 4.0 || !excited, "{work:?}: {worst}");
        }
    }
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn nominal_values_are_not_taken_for_more_than_they_were_said_to_be() {
    not_taken_for_more(&(292_000..292_002));
}

#[test]
#[ignore = "long: cargo xtask statistics"]
fn six_starts_of_nominal_values_are_not_taken_for_more() {
    not_taken_for_more(&(292_000..292_006));
}

/// Motions that show little.
fn weak(random: &mut Random) -> Motion {
    let mut between = |low: f64, high: f64| low * (high / low).powf(random.random::<f64>());
    let (amplitude, hz) = (between(0.005, 0.1), between(0.05, 2.0));
    match between(1.0, 4.0) as usize {
        1 => Motion::Rest,
        2 => Motion::Speed(amplitude),
        _ => Motion::Sine { amplitude, hz },
    }
}

/// Largest error of a1, a2, b0 over its standard deviation, of an estimate that was made nominal
/// before anything had been seen: behind 5 s of binary noise, in 20 s of motion that shows little.
fn behind_a_rash_call(seed: u64) -> f64 {
    let mut random = generator(seed, Stream::Excitation);
    let omega0 = 5.0 * 20.0_f64.powf(random.random::<f64>());
    let xi = 0.1 + random.random::<f64>();
    let servo = Servo {
        omega0,
        xi,
        ..REFERENCE
    };
    let truth = [servo.a()[1], servo.a()[2], servo.b0()];
    let bandwidth = omega0 as f32;
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, DT as f32, bandwidth).unwrap();
    let structure = Structure::<3, 5, 1>::SERVO;
    let mut config = Config::new(structure, bandwidth, [0.4], 1000.0 / bandwidth);
    config.memory = Some([0.2, 0.5, 2.0][random.random_range(0..3)]);
    let spread = [0.0, 0.001, 0.01][random.random_range(0..3)];
    let mut identifier: Identifier<_, 3, 5> = Identifier::try_new(&config, trends).unwrap();
    let mut axis = Integrating::new(servo.a(), servo.b0(), DT);
    let mut commands = Commands::new(seed, omega0, servo.c, false, DT);
    let mut noise = generator(seed, Stream::White);
    let mut over = 0.0_f64;
    for part in 0..4 {
        let (motion, samples) = match part {
            0 => (weak(&mut random), 2_000),
            1 => (Motion::Binary, 5_000),
            _ => (weak(&mut random), 10_000),
        };
        if part == 1 {
            identifier.set_nominal();
        }
        for k in 0..samples {
            let y = axis.position() + spread * (noise.random::<f64>() - 0.5);
            let u = commands.next(motion, k, y);
            let _ = identifier.update(u as f32, y as f32);
            axis.step(u);
            if part > 1 && k % 499 == 0 {
                over = over.max(in_sigma(&identifier, truth));
            }
        }
    }
    over
}

/// Of two hundred axes, each with its memory, noise and motions.
///
/// A value that only a prior told is as uncertain behind the call as before it. With P alone, as if
/// the noise of the data had told it, one in ten of these was beyond twenty standard deviations.
#[test]
fn what_was_made_nominal_before_anything_was_seen_stays_uncertain() {
    let mut over: Vec<f64> = (293_000..293_200).map(behind_a_rash_call).collect();
    over.sort_by(f64::total_cmp);
    let found = [100, 180, 197, 199].map(|rank| over[rank]);
    println!("errors over sigma, 50 %, 90 %, 99 %, largest: {found:.1?}");
    assert!(found[2] <= 4.0 && found[3] <= 10.0, "{found:.1?}");
}
