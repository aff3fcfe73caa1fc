//! Delays that are known, found again.

use super::*;
use crate::estimation::structure::Structure;
use crate::identifier::tests::bench::{Drive, Trends, config, trends};

type Bank = DelayBank<Identifier<Trends, 3, 3, 1, 3>, 4>;

fn bank() -> Bank {
    Bank::try_new(&config(), trends(20.0), 0).expect("settings")
}

/// A bank that has seen a drive whose command acts late: by whole samples, and by a part of one.
fn late(whole: usize, part: f32) -> Bank {
    let (mut bank, mut drive) = (bank(), Drive::new(1e-4));
    let mut past = [0.0; 6];
    for k in 0..2500 {
        let u = drive.command(k);
        past.rotate_right(1);
        past[0] = u;
        let y = drive.under((1.0 - part) * past[whole] + part * past[whole + 1]);
        let _ = bank.update_inputs([u], y);
    }
    bank
}

#[test]
fn candidates_have_whole_delays_whatever_the_settings_say() {
    let mut config = config();
    config.set_delay(0, 3.75);
    assert_eq!(Bank::try_new(&config, trends(20.0), 0), Ok(bank()));
    let none = Bank::try_new(&config, trends(20.0), 1);
    assert_eq!(none, Err(ConfigError::NoInput));
}

#[test]
fn the_delay_is_that_of_the_smallest_error() {
    for delay in 0..4 {
        let bank = late(delay, 0.0);
        let errors = bank.errors();
        for (at, error) in errors.iter().enumerate() {
            let candidate = bank.candidate(at).expect("a candidate");
            assert_eq!(*error, candidate.noise_std());
            assert_eq!(candidate.plan.inputs.delays, [at]);
        }
        assert_eq!(bank.best(), Some(delay), "{errors:?}");
        assert_eq!(bank.chosen(), bank.candidate(delay));
        let error = errors[delay].expect("an error");
        let others = errors.iter().flatten().filter(|other| **other != error);
        let next = others.fold(f32::INFINITY, |least, other| least.min(*other));
        assert_eq!(bank.margin(), Some(next / error));
        assert!(next > 2.0 * error, "{errors:?}");
    }
    assert_eq!(bank().candidate(4), None);
}

#[test]
fn a_choice_among_nothing_has_no_margin() {
    let mut bank = bank();
    for _ in 0..500 {
        let _ = bank.update_inputs([0.0], 0.0);
    }
    assert_eq!(bank.errors(), [Some(0.0); 4]);
    assert_eq!(bank.margin(), None);
    let alone = DelayBank::<Identifier<Trends, 3, 3, 1, 3>, 1>::try_new(&config(), trends(20.0), 0);
    let (mut alone, mut drive) = (alone.expect("settings"), Drive::new(1e-4));
    for k in 0..2500 {
        let [u, y] = drive.sample(k);
        let _ = alone.update_inputs([u], y);
    }
    assert_eq!((alone.best(), alone.margin()), (Some(0), None));
}

#[test]
fn a_delay_between_samples_is_the_lowest_point_of_a_parabola() {
    for part in [0.3, 0.5, 0.7] {
        let bank = late(1, part);
        let best = bank.best().expect("a delay");
        let refined = bank.refined().expect("a delay");
        assert!((refined - 1.0 - part).abs() < 0.1, "{part}: {refined}");
        let [before, at, after] = [best - 1, best, best + 1].map(|delay| {
            let error = bank.errors()[delay].expect("an error");
            error * error
        });
        // Lagrange's form of it: as high on either side of its lowest point.
        let height = |x: f32| {
            0.5 * x * (x - 1.0) * before + (1.0 - x * x) * at + 0.5 * x * (x + 1.0) * after
        };
        let low = refined - best as f32;
        let sides = [0.2, -0.2].map(|step| height(low + step) - height(low));
        assert!((sides[0] / sides[1] - 1.0).abs() < 1e-2, "{sides:?}");
        assert!(low.abs() <= 0.5 && sides[0] > 0.0);
    }
    // Beyond the first and the last candidate there is nothing to compare with.
    assert_eq!(late(0, 0.0).refined(), Some(0.0));
    assert_eq!(late(3, 0.0).refined(), Some(3.0));
}

#[test]
fn nothing_is_said_before_all_can_be_compared() {
    let mut bank = bank();
    for k in 0..3 {
        assert_eq!(bank.errors()[3], None, "{k}");
        assert_eq!(bank.best(), None);
        assert_eq!(bank.refined(), None);
        assert_eq!(bank.margin(), None);
        assert_eq!(bank.chosen(), None);
        let _ = bank.update_inputs([0.0], 0.0);
    }
    // Where y began is found meanwhile.
    for _ in 3..10 {
        let _ = bank.update_inputs([0.0], 0.0);
    }
    for _ in 0..5 {
        let outcome = bank.update_inputs([0.0], 0.0);
        assert_eq!(outcome, Outcome::Estimated { innovation: 0.0 });
    }
    // At rest they are all alike: the shortest.
    assert_eq!(bank.errors(), [Some(0.0); 4]);
    assert_eq!((bank.best(), bank.refined()), (Some(0), Some(0.0)));
}

#[test]
fn the_outcome_is_that_of_the_candidate_without_delay() {
    let mut bank = bank();
    let mut first = bank.candidate(0).expect("a candidate").clone();
    let mut drive = Drive::new(1e-4);
    for k in 0..300 {
        let [u, y] = drive.sample(k);
        assert_eq!(bank.update_inputs([u], y), first.update(u, y));
    }
    assert_eq!(bank.candidate(0), Some(&first));
    let refused = bank.update_inputs([f32::NAN], 0.0);
    assert!(matches!(refused, Outcome::Refused(_)));
}

#[test]
fn an_input_that_does_not_exist_has_no_delay() {
    let found = Bank::try_new(&config(), trends(20.0), 1);
    assert_eq!(found.err(), Some(ConfigError::NoInput));
    let structure = Structure::<3, 4, 2>::INTEGRATING;
    let config = Config::new(structure, 20.0, [0.4; 2], 50.0);
    let bank = DelayBank::<Identifier<Trends, 3, 4, 2, 1>, 2>::try_new(&config, trends(20.0), 1);
    let bank = bank.expect("settings");
    assert_eq!(bank.candidates[1].plan.inputs.delays, [0, 1]);
}

#[test]
#[should_panic(expected = "shorter than the longest candidate")]
fn a_line_holds_the_longest_candidate() {
    assert_bank(3, 4);
    assert_bank(3, 5);
}

#[test]
#[should_panic(expected = "at least one candidate")]
fn a_bank_is_not_empty() {
    assert_bank(3, 0);
}
