//! The delay of the drive found by a bank of candidates.

use trendid::identifier::{DelayBank, Refusal};
use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, ConfigError, Outcome, Servo, Structure};
use trendid_host_tests::plants::linear::{Input, LinearPlant};
use trendid_host_tests::plants::servo::REFERENCE;
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
