//! The width that is found, and what the deviations say until it is.

use super::*;
use crate::estimation::structure::Structure;
use crate::identifier::Refusal;
use crate::identifier::servo::ValveServo;
use crate::trends::Scheme;

mod bias;

const DT: f32 = 1e-3;

fn servo(largest: f32) -> ValveServo {
    let valve = DeadZone::new(0.0, largest, 300);
    ValveServo::new(DT, 20.0, 0.4, 50.0, 0.7, valve).unwrap()
}

/// `jerk = -20 a - 400 v + 2e5 flow` behind a valve of this half width.
struct Drive {
    half: f32,
    state: [f32; 3],
    k: u32,
}

impl Drive {
    const fn new(half: f32) -> Self {
        Self {
            half,
            state: [0.0; 3],
            k: 0,
        }
    }

    /// The position, with some noise, before the command is taken.
    fn position(&self) -> f32 {
        self.state[0] + ((self.k * 7919) % 13) as f32 * 1e-4
    }

    fn take(&mut self, u: f32) {
        let flow = u - self.half.min(u.abs()) * u.signum();
        let [y, v, a] = &mut self.state;
        for _ in 0..10 {
            let jerk = 2e5 * flow - 400.0 * *v - 20.0 * *a;
            (*y, *v, *a) = (*y + 1e-4 * *v, *v + 1e-4 * *a, *a + 1e-4 * jerk);
        }
        self.k += 1;
    }
}

/// Steps of five sizes from `smallest` to 0.4 that lead the position back.
fn identified(half: f32, smallest: f32, largest: f32, samples: u32) -> ValveServo {
    let mut servo = servo(largest);
    moved(&mut servo, half, smallest, samples, 1, |_| {});
    servo
}

/// The same from a seed, and what is looked at after every sample.
fn moved(
    servo: &mut ValveServo,
    half: f32,
    smallest: f32,
    samples: u32,
    seed: u32,
    mut look: impl FnMut(&ValveServo),
) {
    let mut drive = Drive::new(half);
    let mut state = seed;
    for k in 0..samples {
        if k % 170 == 0 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        }
        let size = smallest + (0.4 - smallest) * ((state >> 16) % 5) as f32 / 4.0;
        let y = drive.position();
        let u = if y > 0.0 { -size } else { size };
        let _ = servo.update(u, y);
        drive.take(u);
        look(servo);
    }
}

#[test]
fn a_width_is_found_with_its_deviation() {
    for half in [0.02, 0.04] {
        let servo = identified(half, 0.05, 0.1, 6000);
        let valve = servo.dead_zone();
        assert!((valve.delta() - half).abs() < 0.003, "{valve:?}");
        assert!(valve.std() > 0.0 && valve.std() < 0.003, "{valve:?}");
        assert!(
            half < valve.upper() && valve.inputs(half)[0] > 0.0,
            "{valve:?}"
        );
    }
}

/// Whatever its place among the commands and the widths that are possible at first.
#[test]
fn the_true_width_stays_possible() {
    for seed in 1..60 {
        let half = 0.005 * seed as f32;
        for largest in [half + 0.01, 0.31, 0.5] {
            let mut servo = servo(largest);
            moved(&mut servo, half, 0.02, 4000, 7919 * seed, |servo| {
                let upper = servo.dead_zone().upper();
                assert!(upper > 0.999 * half, "{seed} {largest}: {upper} of {half}");
            });
        }
    }
}

/// Where no command exceeds the largest width that is possible, the drive may have been moved by
/// any part of it.
#[test]
fn commands_that_may_all_be_inside_say_nothing_for_certain() {
    let servo = identified(0.02, 0.05, 10.0, 299);
    let estimate = servo.estimate();
    let std = estimate.std();
    assert!(std[2].is_infinite() && std[3].is_infinite(), "{std:?}");
    assert!(servo.dead_zone().std().is_infinite());
    // The identifier inside takes its inputs as they are.
    let alone = servo.identifier().estimate();
    assert_eq!(alone.theta(), estimate.theta());
    assert!(alone.std()[2].is_finite(), "{alone:?}");
}

#[test]
fn a_deviation_is_never_less_than_by_noise_alone() {
    for samples in [500, 1500, 4000] {
        let servo = identified(0.03, 0.05, 0.1, samples);
        let (both, noise) = (servo.estimate().std(), servo.identifier().estimate().std());
        for (both, noise) in both.into_iter().zip(noise) {
            assert!(both >= noise, "{both} {noise}");
        }
    }
}

#[test]
fn a_command_that_is_no_number_is_refused() {
    let mut servo = identified(0.03, 0.05, 0.1, 2000);
    for u in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let outcome = servo.update(u, 0.0);
        assert_eq!(outcome, Outcome::Refused(Refusal::Input(0)));
    }
    assert!(servo.estimate().std().iter().all(|std| std.is_finite()));
}

#[test]
fn a_reset_leads_back_to_the_construction() {
    let fresh = servo(0.1);
    let mut used = identified(0.03, 0.05, 0.1, 2000);
    assert_ne!(used, fresh);
    used.reset();
    assert_eq!(used, fresh);
}

/// Told five samples earlier that it is five samples late, a command acts the same.
#[test]
fn what_a_width_would_miss_follows_the_command_as_it_acts() {
    let command = |k: usize| match k {
        0..5 => 0.0,
        _ => [0.2, -0.1, 0.05, -0.15][k / 150 % 4],
    };
    let run = |delay: usize| {
        let mut config = Config::new(Structure::SERVO, 20.0, [0.4, 1.0], 50.0);
        config.memory = Some(0.7);
        config.delays = [delay; 2];
        let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, DT, 20.0).unwrap();
        let valve = DeadZone::new(0.0, 0.3, 100_000);
        let mut servo: Valved<_, 3, 6, 2, 7> = Valved::try_new(&config, trends, valve).unwrap();
        let mut drive = Drive::new(0.02);
        for k in 0..1500 {
            let _ = servo.update(command(k + delay), drive.position());
            drive.take(command(k));
        }
        *servo.error.scores()
    };
    let scores = run(0);
    assert!(scores.iter().all(|sum| sum.abs() > 0.01), "{scores:?}");
    assert_eq!(scores, run(5));
}

/// Minutes at rest, with commands inside the dead zone and without any.
#[test]
fn no_sum_becomes_subnormal() {
    let mut servo = identified(0.03, 0.05, 0.1, 3000);
    for k in 0..60_000 {
        let u = if k < 5000 { 0.01 } else { 0.0 };
        let _ = servo.update(u, 1.0);
        assert!(servo.error.is_normal(), "{k} {:?}", servo.error);
    }
}

/// Calls in any order, with any numbers: nothing that is none comes out.
#[test]
fn any_calls_leave_numbers() {
    let numbers = [
        0.0,
        1e-30,
        0.01,
        -0.2,
        0.4,
        3.0,
        -1e6,
        1e30,
        f32::NAN,
        f32::INFINITY,
    ];
    for seed in 1..60_u32 {
        let mut state = seed;
        let mut any = |below: usize| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as usize % below
        };
        let valve = DeadZone::new(0.0, numbers[2 + any(4)], 1 + any(50) as u32);
        let mut servo = ValveServo::new(DT, 20.0, 0.4, 50.0, 0.1 + any(3) as f32, valve).unwrap();
        let mut drive = Drive::new(0.02);
        for _ in 0..400 {
            match any(40) {
                0 => servo.skip(any(1000) as u32),
                1 => servo.restart_trends(),
                2 => servo.adapt(any(2) == 0),
                3 => servo.set_nominal(),
                4 => _ = servo.retune_to(numbers[any(numbers.len())]),
                5 => _ = servo.warm_start([numbers[any(numbers.len())]; 6], [1.0; 6]),
                6 => servo.reset(),
                7 => _ = servo.update(numbers[any(numbers.len())], numbers[any(numbers.len())]),
                _ => {
                    let u = 0.1 * any(9) as f32 - 0.4;
                    for _ in 0..10 {
                        let _ = servo.update(u, drive.position());
                        drive.take(u);
                    }
                }
            }
            let (valve, estimate) = (servo.dead_zone(), servo.estimate());
            assert!(valve.std() >= 0.0 && valve.delta() >= 0.0, "{valve:?}");
            assert!(servo.error.scores().iter().all(|sum| sum.is_finite()));
            assert!(estimate.theta().iter().all(|value| value.is_finite()));
            assert!(estimate.std().iter().all(|std| *std >= 0.0), "{estimate:?}");
            if let Some(std) = estimate.physical_std() {
                assert!(std.iter().all(|std| *std >= 0.0), "{std:?}");
            }
        }
    }
}

#[test]
fn calls_reach_the_identifier() {
    let mut servo = identified(0.03, 0.05, 0.1, 2000);
    servo.adapt(false);
    // The observation that was begun is finished with the next sample.
    let _ = servo.update(0.2, 0.0);
    let held = *servo.identifier().estimator().theta();
    for k in 0..500 {
        let _ = servo.update(0.2, k as f32);
    }
    assert_eq!(*servo.identifier().estimator().theta(), held);
    servo.adapt(true);
    let replaced = servo.identifier().replaced();
    servo.skip(3);
    assert_eq!(servo.identifier().replaced(), replaced + 3);
    let filter = servo.identifier().trends().filter();
    servo.retune_to(30.0).unwrap();
    assert_ne!(servo.identifier().trends().filter(), filter);
    assert!(servo.retune_to(0.0).is_err());
    // Other settings in the same place: as if made with them.
    let valve = DeadZone::new(0.0, 0.2, 100);
    let mut config = Config::new(Structure::SERVO, 10.0, [0.2, 1.0], 20.0);
    config.memory = Some(2.0);
    let trends = || FilteredTrends::for_bandwidth(Scheme::Tustin, DT, 10.0).unwrap();
    servo.reconfigure(&config, trends(), valve).unwrap();
    let made: ValveServo = Valved::try_new(&config, trends(), valve).unwrap();
    assert_eq!(servo.dead_zone(), made.dead_zone());
    assert_eq!(servo.error, made.error);
    assert_eq!(servo.identifier().trends(), made.identifier().trends());
}
