//! Estimates that are given, and those that are trusted.

use crate::estimation::Structure;
use crate::identifier::Identifier;
use crate::identifier::tests::bench::{Drive, config, identifier, trained, trends};

fn near(found: f32, exact: f32) {
    assert!((found / exact - 1.0).abs() < 1e-4, "{found} for {exact}");
}

#[test]
fn a_warm_start_begins_from_what_it_is_given() {
    for adapts in [true, false] {
        let mut config = config();
        config.memory = Some(2.0);
        let (mut servo, _) = trained(&config, 2000);
        servo.adapt(adapts);
        let (theta, std) = ([390.0, 18.0, 9e5], [40.0, 3.0, 2e4]);
        servo.warm_start(theta, std).expect("an estimate");
        let found = servo.recursion();
        for j in 0..3 {
            near(found.theta()[j], theta[j]);
            near(found.std()[j], std[j]);
        }
        let units = servo.plan.regressor.units();
        let state = &servo.state;
        for j in 0..3 {
            near(state.forgetting.nominal()[j] * units[j], theta[j]);
            let relative = std[j] / (units[j] * servo.plan.noise.prior);
            let (unsupported, variance) = state.forgetting.own_variances()[j];
            assert!(unsupported);
            near(variance, relative * relative);
        }
        assert_eq!(state.estimator.samples(), 0.0);
        assert_eq!((state.learns, state.postponed.is_owed()), (adapts, false));
        // And returns to that when data that supported it are forgotten.
        servo.state.forgetting.set_nominal_std(&[0.0; 3]);
        for j in 0..3 {
            let relative = std[j] / (units[j] * servo.plan.noise.prior);
            let (unsupported, variance) = servo.state.forgetting.own_variances()[j];
            assert!(!unsupported);
            near(variance, relative * relative);
        }
    }
}

#[test]
fn an_estimate_that_is_none_changes_nothing() {
    let mut servo = identifier(&config());
    let before = servo.clone();
    for (theta, std) in [
        ([1.0, f32::NAN, 1.0], [1.0; 3]),
        ([1.0; 3], [1.0, -1.0, 1.0]),
        ([1.0; 3], [f32::NAN; 3]),
        ([1e30; 3], [1.0; 3]),
    ] {
        assert!(servo.warm_start(theta, std).is_err());
        assert_eq!(servo, before);
    }
}

#[test]
fn a_nominal_value_is_as_well_known_as_the_estimate_was() {
    let mut config = config();
    config.memory = Some(2.0);
    let (mut servo, mut drive) = trained(&config, 3000);
    let mut noise = Drive::new(1e-4);
    for k in 3000..9000 {
        let [u, y] = drive.sample(k);
        let _ = servo.update(u, y + 0.1 * noise.draw());
    }
    let variances = servo.estimator().variances();
    let measured = servo.estimator().noise_variance().expect("noise");
    servo.set_nominal();
    let expected = servo.plan.noise.prior;
    for j in 0..3 {
        let (unsupported, variance) = servo.state.forgetting.own_variances()[j];
        assert!(!unsupported);
        near(variance, variances[j] * measured / (expected * expected));
    }
    assert_eq!(servo.state.forgetting.nominal(), servo.estimator().theta());
    // All of these were shown.
    let known = servo.state.forgetting.own_variances();
    servo.set_nominal_as_shown();
    for (known, shown) in known.iter().zip(servo.state.forgetting.own_variances()) {
        near(known.1, shown.1);
    }
    // Without a memory of the noise it is that which is expected.
    let mut fresh = identifier(&config);
    fresh.set_nominal();
    let own = fresh.state.forgetting.own_variances();
    near(own[0].1, fresh.plan.prior.std[0] * fresh.plan.prior.std[0]);
}

#[test]
fn no_begin_says_what_the_initial_state_of_the_next_one_is() {
    let base = config();
    let mut config = base.with_structure(Structure::<3, 5, 1>::SERVO);
    config.memory = Some(0.2);
    let warm = |servo: &mut Identifier<_, 3, 5, 1, 0>, set: bool| {
        let theta = [400.0, 20.0, 1e6, 0.0, 0.0];
        let std = [1.0, 0.1, 1e3, 1e2, 1.0];
        match set {
            true => servo.set_nominal(),
            false => servo.warm_start(theta, std).expect("a start"),
        }
    };
    for set in [false, true] {
        let fresh = Identifier::<_, 3, 5, 1, 0>::try_new(&config, trends(20.0));
        let (mut servo, mut drive) = (fresh.expect("settings"), Drive::new(1e-4));
        for k in 0..3000 {
            if k == 2000 {
                warm(&mut servo, set);
            }
            let [u, y] = drive.sample(k);
            let _ = servo.update(u, y);
        }
        let before = *servo.state.forgetting.nominal();
        // The trends begin anew in a motion, which is another initial state.
        servo.restart_trends();
        for k in 3000..5000 {
            let [u, y] = drive.sample(k);
            let _ = servo.update(u, y);
        }
        let (nominal, theta) = (servo.state.forgetting.nominal(), servo.estimator().theta());
        assert_eq!(nominal[..4], before[..4], "{set}");
        assert!((before[4] - theta[4]).abs() > 1e-2, "{set}: {theta:?}");
        assert!(
            (nominal[4] / theta[4] - 1.0).abs() < 0.01,
            "{set}: {nominal:?}"
        );
        let own = servo.state.forgetting.own_variances();
        assert!(own[0].1 > 0.0 && own[4] == (false, 0.0), "{set}: {own:?}");
    }
}
