//! What is refused, and what the model says meanwhile.

use super::*;
use crate::identifier::tests::bench::{Drive, Servo3, config, identifier, trained, trends};
use crate::identifier::{Config, Identifier, Outcome};
use crate::trends::{RawTrends, Scheme};

#[test]
fn what_is_beyond_its_reach_is_refused_and_named() {
    let structure = crate::estimation::Structure::<3, 4, 2>::INTEGRATING;
    let config = Config::new(structure, 20.0, [0.4, 2.0], 50.0);
    let identifier = Identifier::<_, 3, 4, 2, 0>::try_new(&config, trends(20.0)).expect("settings");
    let plan = &identifier.plan;
    let found = |u: [f32; 2], y: f32| refused(plan, &u, y);
    for side in [1.0, -1.0] {
        assert_eq!(found([side * 3.99e5, side * 1.99e6], side * 4.99e7), None);
        assert_eq!(found([0.0; 2], side * 5.01e7), Some(Refusal::Output));
        assert_eq!(found([side * 4.01e5, 0.0], 0.0), Some(Refusal::Input(0)));
        assert_eq!(found([0.0, side * 2.01e6], 0.0), Some(Refusal::Input(1)));
    }
    assert_eq!(found([f32::NAN; 2], f32::NAN), Some(Refusal::Output));
    assert_eq!(found([f32::NAN; 2], 0.0), Some(Refusal::Input(0)));
    assert_eq!(found([0.0, f32::INFINITY], 0.0), Some(Refusal::Input(1)));
}

#[test]
fn a_refused_sample_is_a_sample_time_without_y() {
    let mut config = config();
    for memory in [None, Some(2.0)] {
        config.memory = memory;
        let (servo, drive) = trained(&config, 1000);
        let y = drive.at[0];
        // A good command acts, whatever y is.
        let (mut one, mut other) = (servo.clone(), servo.clone());
        let outcome = one.update(0.3, f32::NAN);
        assert_eq!(outcome, Outcome::Refused(Refusal::Output));
        other.state.skip(&other.plan, [0.3], &mut ());
        assert_eq!(one, other);
        // A bad one leaves the one before in force.
        let (mut one, mut other) = (servo.clone(), servo.clone());
        let outcome = one.update(f32::NAN, y);
        assert_eq!(outcome, Outcome::Refused(Refusal::Input(0)));
        other.skip(1);
        assert_eq!(one, other);
        assert_eq!(one.replaced(), 1);
    }
}

#[test]
fn the_model_goes_on_where_the_drive_goes() {
    for memory in [None, Some(20.0)] {
        let mut config = config();
        config.memory = memory;
        // Far from zero, in a motion.
        let (mut servo, mut drive) = (identifier(&config), Drive::new(1e-6));
        for k in 0..3100 {
            let [u, y] = drive.sample(k);
            let _ = servo.update(u, 3000.0 + y);
        }
        // Where it was measured last.
        let from = servo.state.signals.last;
        let theta = *servo.estimator().theta();
        for k in 1..=60 {
            let y = drive.under(drive.u);
            servo.skip(1);
            assert_eq!(servo.replaced(), k);
            let error = servo.prediction() - 3000.0 - y;
            let way = (3000.0 - servo.state.signals.reference + y - from).abs();
            assert!(error.abs() < 0.01 + 0.05 * way, "{k}: {error} of {way}");
        }
        assert!((servo.state.signals.last - from).abs() > 5.0);
        assert_eq!(*servo.estimator().theta(), theta);
        // With y it goes on: what is off by more than this noise with the second one at the latest.
        let found = [0; 3].map(|_| {
            let y = drive.under(drive.u);
            servo.update(drive.u, 3000.0 + y)
        });
        let replaced = found.map(|found| matches!(found, Outcome::Replaced { .. }));
        assert_eq!(replaced, [memory.is_some(), false, false], "{found:?}");
        let last = found[2].innovation();
        assert!(last.is_some_and(|e| e.abs() < 1.0), "{found:?}");
    }
}

#[test]
fn before_there_is_a_model_the_position_stays() {
    let mut config = config();
    config.settling = 0.05;
    let mut servo = identifier(&config);
    // Before the first sample there is nothing to go on.
    let before = servo.clone();
    servo.skip(3);
    assert_eq!(servo, before);
    let mut drive = Drive::new(1e-4);
    for k in 0..20 {
        let [u, y] = drive.sample(k);
        let _ = servo.update(u, 7.0 + y);
    }
    let [u, y] = drive.sample(20);
    assert_eq!(
        servo.update(u, 7.0 + y),
        Outcome::WarmingUp { remaining: 29 }
    );
    assert_eq!(servo.prediction(), 7.0 + y);
    // The trends settle meanwhile, but nothing is known yet.
    servo.skip(1);
    assert_eq!(servo.prediction(), 7.0 + y);
    let [u, y] = drive.sample(22);
    assert_eq!(
        servo.update(u, 7.0 + y),
        Outcome::WarmingUp { remaining: 27 }
    );
    // Trends without a filter have no noise gain and no prediction that could be relied on.
    let raw = RawTrends::<3>::try_new(Scheme::Tustin, 1e-3).expect("trends");
    let mut servo = Identifier::<_, 3, 3, 1, 0>::try_new(&config, raw).expect("settings");
    let mut drive = Drive::new(1e-4);
    let mut last = 0.0;
    for k in 0..200 {
        let [u, y] = drive.sample(k);
        let _ = servo.update(u, y);
        last = y;
    }
    servo.skip(1);
    assert!((servo.prediction() - last).abs() < 1e-6);
}

#[test]
fn a_model_that_is_not_known_bridges_nothing() {
    let waits = |samples: u32, gap: u32| {
        let (mut servo, drive) = trained(&config(), samples);
        let y = drive.at[0];
        let last = servo.state.signals.last;
        servo.skip(gap);
        let stayed = servo.prediction() == servo.state.signals.reference + last;
        match servo.update(drive.u, y) {
            Outcome::WarmingUp { remaining } => (remaining, stayed),
            _ => (0, stayed),
        }
    };
    // Three parameters in 50 samples each; the motion of one sample in any case.
    let longest = trained(&config(), 1).0.plan.times.unknown_gap;
    assert_eq!(longest, 1);
    assert_eq!(waits(120, longest), (0, true));
    let (remaining, _) = waits(120, longest + 1);
    // The slow pole of 2.2 rad/s, e^-7 < 1/1000.
    assert!((remaining as f32 - 7.0 / 2.2e-3).abs() < 8.0, "{remaining}");
    assert_eq!(waits(160, 2 * longest), (0, false));
}

#[test]
fn behind_a_gap_the_initial_state_is_another_one() {
    let config = Config::new(
        crate::estimation::Structure::<3, 5, 1>::SERVO,
        20.0,
        [0.4],
        50.0,
    );
    let mut servo = Identifier::<_, 3, 5, 1, 0>::try_new(&config, trends(20.0)).expect("settings");
    let prior = servo.estimator().diagonal()[4];
    let mut drive = Drive::new(1e-4);
    for k in 0..1000 {
        let [u, y] = drive.sample(k);
        let _ = servo.update(u, y);
    }
    let known = servo.estimator().diagonal()[4];
    assert!(known < 0.01 * prior);
    servo.skip(servo.plan.times.longest_gap + 1);
    // e^-7 < 1/1000 of a pair of 15.4 rad/s.
    let settling = servo.plan.times.anew;
    assert!((settling as f32 - 7.0 / 15.4e-3).abs() < 2.0);
    assert_eq!(
        servo.update(drive.u, drive.at[0]),
        Outcome::WarmingUp {
            remaining: settling - 1
        }
    );
    assert!((servo.estimator().diagonal()[4] / prior - 1.0).abs() < 1e-5);
}

#[test]
fn a_prediction_beyond_its_reach_is_none() {
    let (mut servo, drive) = trained(&config(), 500);
    let y = servo.prediction();
    servo.plan.output_limit = 0.5 * drive.at[0].abs();
    let last = servo.state.signals.last;
    servo.skip(1);
    assert_eq!(servo.state.signals.last, last);
    assert!((servo.prediction() - y).abs() < 1.0);
}

#[test]
fn time_that_passes_is_owed_by_who_forgets_and_adapts() {
    for (memory, adapts, owes) in [
        (Some(2.0), true, true),
        (Some(2.0), false, false),
        (None, true, false),
    ] {
        let mut config = config();
        config.memory = memory;
        let (mut servo, _) = trained(&config, 1000);
        servo.adapt(adapts);
        let before = servo.state.postponed.clone();
        servo.skip(1);
        assert_eq!(servo.state.postponed != before, owes, "{memory:?} {adapts}");
    }
}

#[test]
fn a_model_that_is_wrong_goes_on_as_wrong_as_it_was() {
    let mut config = config();
    config.memory = Some(20.0);
    let (mut servo, mut drive) = trained(&config, 3000);
    servo.adapt(false);
    drive.gain = 1.5;
    for k in 3000..3040 {
        let [u, y] = drive.sample(k);
        let _ = servo.update(u, y);
    }
    let mean = servo.state.signals.gate.mean;
    let y = drive.under(drive.u);
    servo.skip(1);
    let error = servo.prediction() - y;
    assert!(
        mean.abs() > 1e-3 && error.abs() < mean.abs(),
        "{error} {mean}"
    );
}

#[test]
fn behind_a_gap_one_reading_is_believed_no_more_than_within_a_motion() {
    let mut config = config();
    config.memory = Some(2.0);
    for gap in [0, 1, 2, 20] {
        for stays in [false, true] {
            let (mut servo, mut drive): (Servo3, _) = trained(&config, 3000);
            for _ in 0..gap {
                let _ = drive.under(drive.u);
            }
            servo.skip(gap);
            let theta = *servo.estimator().theta();
            let found = [5.0, if stays { 5.0 } else { 0.0 }].map(|off| {
                let y = drive.under(drive.u);
                servo.update(drive.u, y + off)
            });
            assert!(matches!(found[0], Outcome::Replaced { .. }), "{found:?}");
            // What stays is where the axis is, and both are taken as they were measured.
            let held = matches!(found[1], Outcome::Held { .. });
            assert_eq!(held, stays, "{gap}: {found:?}");
            let last = servo.state.signals.last + servo.state.signals.reference;
            let exact = drive.at[0] + if stays { 5.0 } else { 0.0 };
            assert!((last - exact).abs() < 0.1, "{gap} {stays}: {last} {exact}");
            let moved = (0..3).map(|j| (servo.estimator().theta()[j] / theta[j] - 1.0).abs());
            assert!(moved.fold(0.0, f32::max) < 1e-3, "{gap} {stays}");
        }
    }
}

/// What is known of no motion predicts none.
#[test]
fn before_a_model_is_known_what_comes_behind_a_gap_is_taken_as_it_is() {
    let (mut servo, mut drive): (Servo3, _) = (identifier(&config()), Drive::new(1e-3));
    for k in 0..30 {
        let [u, y] = drive.sample(k);
        let _ = servo.update(u, y);
    }
    servo.skip(1);
    let y = drive.under(drive.u);
    let _ = drive.under(drive.u);
    let found = servo.update(drive.u, y + 5.0);
    assert!(!matches!(found, Outcome::Replaced { .. }), "{found:?}");
}

#[test]
fn a_wrong_reading_behind_a_gap_is_left_out_where_the_prediction_was_off_too() {
    let mut config = config();
    config.memory = Some(2.0);
    let (mut servo, mut drive): (Servo3, _) = trained(&config, 3000);
    servo.skip(20);
    // The drive has gone further than the model knows.
    drive.gain = 1.3;
    for _ in 0..20 {
        let _ = drive.under(drive.u);
    }
    drive.gain = 1.0;
    let before = servo.replaced();
    let theta = *servo.estimator().theta();
    let y = drive.under(drive.u);
    let _ = servo.update(drive.u, y + 1e4);
    let y = drive.under(drive.u);
    let found = servo.update(drive.u, y);
    assert!(matches!(found, Outcome::Held { .. }), "{found:?}");
    assert_eq!(servo.replaced(), before + 1);
    for k in 0..200 {
        let [u, y] = drive.sample(k);
        let _ = servo.update(u, y);
    }
    for (now, before) in servo.estimator().theta().iter().zip(theta) {
        assert!((now / before - 1.0).abs() < 0.5, "{now} {before}");
    }
}
