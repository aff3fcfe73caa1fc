//! The delay of the drive found by a bank of candidates.

use trendid::identifier::{DelayBank, Refusal};
use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, ConfigError, Identifier, Outcome, Servo, Structure};
use trendid_host_tests::plants::linear::{Input, LinearPlant};
use trendid_host_tests::plants::servo::REFERENCE;
use trendid_host_tests::signals::excitation::Excitation;
use trendid_host_tests::signals::experiment::Experiment;
use trendid_host_tests::signals::noise::Condition;

type Bank = DelayBank<Servo<7>, 8>;

fn bank() -> Bank {
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, 20.0).unwrap();
    let config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4], 50.0);
    Bank::try_new(&config, trends, 0).unwrap()
}

#[test]
fn delays_of_zero_to_seven_samples() {
    for eta in [10.0, 100.0] {
        let (mut right, mut runs) = (0, 0);
        let mut least_margin = f32::INFINITY;
        for delay in 0..8 {
            let inputs = [Input::delayed(&[REFERENCE.b0()], delay)];
            let mut experiment = Experiment::reference(Condition::white(eta), 0.5);
            experiment.plant =
                LinearPlant::with_inputs(&REFERENCE.a(), &inputs, 0.0, 1e-3).unwrap();
            for seed in 0..100 {
                let mut bank = bank();
                for s in experiment
                    .record(7000 + 100 * delay as u64 + seed)
                    .samples()
                {
                    let _ = bank.update_inputs([s.u as f32], s.y as f32);
                }
                runs += 1;
                if bank.best() == Some(delay) {
                    right += 1;
                    least_margin = least_margin.min(bank.margin().unwrap());
                    let theta = bank.chosen().unwrap().theta();
                    assert!((theta[0] / 400.0 - 1.0).abs() < 0.01);
                }
            }
        }
        println!(
            "eta {eta} um, 0.5 s: right in {right} of {runs} runs, least margin {least_margin:.4}"
        );
        assert_eq!(right, runs);
    }
}

#[test]
fn refusals_and_sizes() {
    let mut bank = bank();
    assert_eq!(bank.best(), None);
    assert_eq!((bank.margin(), bank.chosen()), (None, None));
    let before = bank.clone();
    let outcome = bank.update_inputs([f32::NAN], 0.0);
    assert_eq!(outcome, Outcome::Refused(Refusal::Input(0)));
    assert_eq!(bank, before);
    assert!(bank.candidate(7).is_some() && bank.candidate(8).is_none());

    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, 20.0).unwrap();
    let config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4], 50.0);
    assert_eq!(
        Bank::try_new(&config, trends, 1).err(),
        Some(ConfigError::NoInput)
    );
}

/// A record of the reference servo whose command is `delay` samples late, also between them: the
/// plant at an eighth.
fn late(delay: f64, seed: u64, n: usize) -> (Vec<f32>, Vec<f32>) {
    let eighths = (8.0 * delay).round() as usize;
    let input = Input::delayed(&[1e6], eighths);
    let mut plant = LinearPlant::with_inputs(&[0.0, 400.0, 20.0], &[input], 0.0, 0.125e-3).unwrap();
    let u = Excitation::ABSOLUTE.sequence(n, 1e-3, seed);
    let noise = Condition::white(10.0);
    let mut truth = Vec::new();
    for u in &u {
        truth.push(plant.output());
        for _ in 0..8 {
            plant.step(&[*u]);
        }
    }
    let (y, _) = noise.measure(&truth, seed);
    let narrow = |x: &[f64]| x.iter().map(|v| *v as f32).collect();
    (narrow(&u), narrow(&y))
}

#[test]
fn half_a_sample_costs_nothing_and_the_bank_finds_it() {
    let (mut whole, mut parts, mut found) = ([0.0_f64; 2], [0.0_f64; 2], 0.0_f32);
    for (case, delay) in [2.5, 2.25, 4.625, 1.75].into_iter().enumerate() {
        let (u, y) = late(delay, 200_020 + case as u64, 1500);
        let mut bank = DelayBank::<Servo<8>, 8>::new(1e-3, 20.0, 0.4, 50.0).unwrap();
        for (u, y) in u.iter().zip(&y) {
            let _ = bank.update(*u, *y);
        }
        let refined = bank.refined().unwrap();
        found = found.max((refined - delay as f32).abs());
        let error = |samples: f32| {
            let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0).unwrap();
            let mut config = Config::new(Structure::SERVO, 20.0, [0.4], 50.0);
            config.set_delay(0, samples);
            let mut servo: Servo<8> = Identifier::try_new(&config, trends).unwrap();
            for (u, y) in u.iter().zip(&y) {
                let _ = servo.update(*u, *y);
            }
            let physical = servo.estimate().physical();
            [
                (f64::from(physical.omega0.unwrap()) / 20.0 - 1.0).abs(),
                (f64::from(physical.damping.unwrap()) / 0.5 - 1.0).abs(),
            ]
        };
        let (cut, exact) = (error((delay as f32).floor()), error(refined));
        for k in 0..2 {
            whole[k] = whole[k].max(cut[k]);
            parts[k] = parts[k].max(exact[k]);
        }
    }
    println!(
        "bank within {found:.3} samples; error of omega0, xi [%]: whole samples {:.3} {:.3}, between {:.4} {:.4}",
        100.0 * whole[0],
        100.0 * whole[1],
        100.0 * parts[0],
        100.0 * parts[1]
    );
    assert!(found < 0.1, "{found}");
    assert!(whole[0] > 0.005, "{whole:?}");
    assert!(parts[0] < 0.0005 && parts[1] < 0.001, "{parts:?}");
}
