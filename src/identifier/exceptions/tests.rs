//! Changes of the drive, axes that stand, and forgetting that is called in.

use super::*;
use crate::estimation::Structure;
use crate::estimation::rls::Estimator;
use crate::identifier::tests::bench::{Drive, Servo3, Trends, config, identifier, trained, trends};
use crate::identifier::{Config, Identifier, Outcome};

mod at_rest;

/// How often the trends began and the covariance was changed.
#[derive(Default)]
struct Seen {
    begun: u32,
    widened: u32,
}

impl<const N: usize> Witness<3, N, 1> for Seen {
    fn begin(&mut self) {
        self.begun += 1;
    }
    fn inputs(&mut self, _: &[[f32; 3]; 1], _: &[f32; 1]) {}
    fn row(&mut self, _: &[f32; N], _: f32, _: &Estimator<N>, _: bool) {}
    fn widened(&mut self) {
        self.widened += 1;
    }
}

fn near(found: f32, exact: f32, error: f32) {
    assert!((found / exact - 1.0).abs() < error, "{found} for {exact}");
}

fn following() -> Config<3, 3, 1> {
    let mut config = config();
    (config.memory, config.follow_changes) = (Some(2.0), true);
    config
}

#[test]
fn a_change_of_the_drive_is_found_once_and_its_onset_left_out() {
    let (mut servo, mut drive) = trained(&following(), 4000);
    assert_eq!(servo.changes(), 0);
    drive.gain = 2.0;
    let (mut seen, mut k) = (Seen::default(), 4000);
    while servo.changes() == 0 {
        assert!(k < 4500, "not found");
        let [u, y] = drive.sample(k);
        let found = servo.update_seen([u], y, &mut seen);
        assert!(servo.changes() == 0 || matches!(found, Outcome::Held { .. }));
        k += 1;
    }
    assert_eq!(seen.widened, 1);
    // Of what was learnt the values are left, each known as a nominal one is without data.
    let (theta, left) = (*servo.estimator().theta(), servo.state.forgetting.left());
    assert_eq!(servo.estimator().samples(), 0.0);
    for _ in 0..servo.plan.times.change_settling {
        for i in 0..3 {
            for j in 0..3 {
                let variance = if i == j { left[i] } else { 0.0 };
                assert_eq!(servo.estimator().covariance(i, j), variance);
            }
        }
        let [u, y] = drive.sample(k);
        let found = servo.update_seen([u], y, &mut seen);
        assert!(matches!(found, Outcome::Held { .. }));
        k += 1;
    }
    assert_eq!(*servo.estimator().theta(), theta);
    assert_eq!((servo.changes(), seen.widened), (1, 2));
    let [u, y] = drive.sample(k);
    assert!(matches!(servo.update(u, y), Outcome::Estimated { .. }));
    for _ in 0..2000 {
        k += 1;
        let [u, y] = drive.sample(k);
        let _ = servo.update(u, y);
    }
    near(servo.theta()[2], 2e6, 0.05);
    assert_eq!(servo.changes(), 1);
}

#[test]
fn who_does_not_ask_for_changes_finds_none() {
    let mut config = following();
    config.follow_changes = false;
    let (mut servo, mut drive) = trained(&config, 4000);
    drive.gain = 2.0;
    for k in 4000..4600 {
        let [u, y] = drive.sample(k);
        let _ = servo.update(u, y);
    }
    assert_eq!(servo.changes(), 0);
}

#[test]
fn behind_a_change_the_initial_state_is_as_uncertain_as_at_the_start() {
    let mut config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4], 50.0);
    (config.memory, config.follow_changes) = (Some(2.0), true);
    let mut servo =
        Identifier::<Trends, 3, 5, 1, 0>::try_new(&config, trends(20.0)).expect("settings");
    let prior = servo.plan.prior.std[4];
    let mut drive = Drive::new(1e-4);
    let mut found = None;
    for k in 0..6000 {
        drive.gain = if k < 4000 { 1.0 } else { 2.0 };
        let [u, y] = drive.sample(k);
        let _ = servo.update(u, y);
        assert!(k >= 4000 || servo.changes() == 0);
        if servo.changes() > 0 && servo.state.change.settling == 0 {
            found = Some(servo.estimator().diagonal()[4]);
            break;
        }
    }
    near(found.expect("a change"), prior * prior, 1e-4);
    assert_eq!(servo.state.signals.initial, 1.0);
}

#[test]
fn what_is_expected_of_a_model_is_no_contradiction() {
    // A row of which the prior leaves three times the variance of the noise; and no model before it
    // is known.
    for (share, known_rows, obeys) in [(0.98, 0.0, true), (1.02, 0.0, false), (1.02, 1.0, true)] {
        let mut servo = identifier(&config());
        servo.state.known_rows = known_rows;
        let std = servo.plan.prior.std[0];
        let noise = Noise {
            known: 0.25,
            allowed: 0.25,
        };
        let row = Row {
            phi: [libm::sqrtf(3.0) / std, 0.0, 0.0],
            psi: 0.0,
            error: 0.0,
            // Twelve deviations of 0.5, times the root of 1 + 3.
            innovation: share * 12.0 * 0.5 * 2.0,
        };
        let others = Others {
            inputs: [[0.0; 3]],
            extra: [0.0; 2],
            acting: [0.0],
        };
        for _ in 0..4 {
            assert!((servo.state).obeys(&servo.plan, &row, &others, 0.0, noise, &mut ()));
        }
        let fifth = (servo.state).obeys(&servo.plan, &row, &others, 0.0, noise, &mut ());
        assert_eq!(fifth, obeys, "{share} {known_rows}");
    }
}

#[test]
fn a_contradiction_is_one_of_a_drive_that_moves() {
    let mut config = config();
    config.memory = Some(2.0);
    let (mut servo, _) = trained(&config, 3000);
    let y = servo.state.signals.last;
    assert!(servo.state.standstill.has_left(y));
    for (error, y, stands, contradicted) in [
        (1e3, y, true, true),
        (0.0, y, true, false),
        (1e3, y + 1.0, true, false),
        (1e3, y + 1.0, false, true),
        (0.0, y + 1.0, false, false),
    ] {
        servo.plan.can_stand = stands;
        // The row that asks is one of those that are counted.
        let mut state = servo.state.clone();
        let spread = state.estimator.fold(&[0.0; 3], error);
        let found = state.contradicted(&servo.plan, error, spread, y);
        assert_eq!(found, contradicted, "{error} {stands}");
    }
}

/// A drive that was at rest for most of a memory, and is three times as strong then.
fn rested() -> (Servo3, Drive, f32) {
    let mut config = config();
    config.memory = Some(2.0);
    let (mut servo, mut drive) = trained(&config, 4000);
    drive.u = 0.0;
    for _ in 0..4000 {
        let y = drive.under(0.0);
        let _ = servo.update(0.0, y);
    }
    let debt = servo.estimator().samples();
    drive.gain = 3.0;
    (servo, drive, debt)
}

#[test]
fn a_row_that_contradicts_calls_the_debt_in_one_parameter_per_sample() {
    let (mut servo, mut drive, weight) = rested();
    assert!(servo.state.postponed.is_owed() && servo.state.learns);
    let mut samples = 0;
    while servo.state.learns {
        let y = drive.under(0.3);
        let _ = servo.update(0.3, y);
        samples += 1;
        assert!(samples < 200, "not called in");
    }
    assert!(!servo.estimator().is_inflating());
    let mut at_once = servo.clone();
    at_once.state.estimator.finish_observation();
    at_once.state.call_in();
    assert!(at_once.state.learns && !at_once.state.postponed.is_owed());
    for part in 1..=3 {
        let y = drive.under(0.3);
        let found = servo.update(0.3, y);
        assert!(matches!(found, Outcome::Held { .. }));
        assert_eq!(servo.state.learns, part == 3);
        // Asked to adapt meanwhile, it waits for the rest.
        servo.adapt(true);
        assert_eq!(servo.state.learns, part == 3);
    }
    let (found, wanted) = (
        servo.estimator().variances(),
        at_once.estimator().variances(),
    );
    for (found, wanted) in found.iter().zip(wanted) {
        near(*found, wanted, 1e-3);
    }
    assert!(servo.estimator().samples() < 0.5 * weight);
    let y = drive.under(0.3);
    assert!(matches!(servo.update(0.3, y), Outcome::Estimated { .. }));
}

#[test]
fn while_the_estimate_is_held_nothing_is_learnt_and_nothing_forgotten() {
    for memory in [None, Some(2.0)] {
        let mut config = config();
        config.memory = memory;
        let (mut servo, mut drive) = trained(&config, 2000);
        servo.state.estimator.finish_observation();
        servo.adapt(false);
        let before = servo.estimator().clone();
        for k in 2000..2300 {
            let [u, y] = drive.sample(k);
            assert!(matches!(servo.update(u, y), Outcome::Held { .. }));
        }
        assert_eq!(servo.estimator().theta(), before.theta());
        assert_eq!(servo.estimator().samples(), before.samples());
        servo.adapt(true);
        let [u, y] = drive.sample(2300);
        assert!(matches!(servo.update(u, y), Outcome::Estimated { .. }));
        assert_ne!(servo.estimator().samples(), before.samples());
    }
}
