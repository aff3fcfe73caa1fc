//! What stays and what changes with another filter.

use super::*;
use crate::estimation::structure::Structure;
use crate::identifier::tests::bench::{Drive, Servo3, Trends, config, trained, trends};
use crate::identifier::{Config, Outcome};
use crate::trends::{ExactTrends, Scheme};

fn near(found: f32, exact: f32, error: f32) {
    assert!((found / exact - 1.0).abs() < error, "{found} for {exact}");
}

/// Mean of |A/A_f|^2 as the documentation of `in_band` has it, by another way: the polynomials at
/// j x from their even and odd parts.
fn in_band_of(a: [f32; 3], filter: [f32; 3]) -> f32 {
    // The natural frequency of a drive that integrates: sqrt(a1).
    let natural = libm::sqrtf(a[1]);
    let square = |p: [f32; 3], x: f32| {
        let (even, odd) = (p[0] - p[2] * x * x, p[1] * x - x * x * x);
        even * even + odd * odd
    };
    let (mut sum, mut weights) = (0.0, 0.0);
    for step in 1..=25 {
        let x = 0.1 * step as f32 * natural;
        let (plant, behind) = (square(a, x), square(filter, x));
        let weight = x * x * x * x * x * x / (plant * behind);
        sum += weight * plant / behind;
        weights += weight;
    }
    sum / weights
}

/// P_ii of what an identifier hands over.
fn handed_over(servo: &Servo3, i: usize) -> f32 {
    let found = servo.read_out().handed_over();
    let beyond: f32 = found.beyond().map(|vector| vector[i] * vector[i]).sum();
    servo.estimator().covariance(i, i) + beyond
}

#[test]
fn the_model_stays_and_its_covariance_goes_with_the_noise_behind_the_filter() {
    let (mut servo, _) = trained(&config(), 3000);
    let before = servo.clone();
    servo.retune(trends(35.0), 0.0).expect("a filter");
    let old = before.read_out().trend_theta();
    let exact = before.read_out().theta();
    for (found, exact) in servo.recursion().theta().iter().zip(exact) {
        near(*found, exact, 1e-5);
    }
    let a = [0.0, old[0], old[1]];
    let bands = [20.0, 35.0].map(|omega| in_band_of(a, trends(omega).filter()));
    let scale = INFLATION * bands[0] / bands[1];
    for i in 0..3 {
        let growth = servo.estimator().covariance(i, i) / handed_over(&before, i);
        near(growth, scale, 1e-2);
    }
    // Counted anew, and from where the drive is; no column stands for where it began.
    assert_eq!(servo.state.beginning, Beginning::new(true));
    assert_eq!(servo.estimator().samples(), 0.0);
    assert!(!servo.state.signals.begun);
}

#[test]
fn with_the_same_filter_the_signals_go_on() {
    let (mut servo, mut drive) = trained(&config(), 3000);
    let before = servo.clone();
    servo.retune(trends(20.0), 0.3).expect("a filter");
    assert_eq!(servo.state.signals, before.state.signals);
    for i in 0..3 {
        let growth = servo.estimator().covariance(i, i) / handed_over(&before, i);
        near(growth, INFLATION, 1e-4);
        // What P does not know of is handed over, too.
        assert!(handed_over(&before, i) > 1.001 * before.estimator().covariance(i, i));
    }
    let [u, y] = drive.sample(3000);
    assert!(matches!(servo.update(u, y), Outcome::Estimated { .. }));
}

#[test]
fn no_variance_grows_beyond_that_of_the_prior() {
    let (mut servo, _) = trained(&config(), 40);
    let prior = servo.plan.prior.std;
    for _ in 0..40 {
        servo.retune(trends(20.0), 0.0).expect("a filter");
    }
    for (d, std) in servo.estimator().diagonal().iter().zip(prior) {
        near(*d, std * std, 1e-5);
    }
}

#[test]
fn nominal_values_and_debts_are_of_the_old_filter() {
    let mut config = config();
    config.memory = Some(2.0);
    let (mut servo, drive) = trained(&config, 3000);
    let theta = *servo.estimator().theta();
    servo.state.forgetting.set_nominal(theta.map(|x| 1.5 * x));
    // A rest is owed.
    let mut rested = servo.clone();
    for _ in 0..1500 {
        let _ = rested.update(0.0, drive.at[0]);
    }
    servo.retune(trends(35.0), 0.0).expect("a filter");
    let units = *servo.plan.regressor.units();
    for (j, value) in servo.state.forgetting.nominal().iter().enumerate() {
        near(*value, 1.5 * theta[j], 1e-5);
        assert!(units[j] > 0.0);
    }
    let before = handed_over(&rested, 2);
    rested.retune(trends(20.0), 0.0).expect("a filter");
    assert!(!rested.estimator().is_inflating() && rested.state.learns);
    // 2000 samples of memory, 1500 or so owed: the rest costs that share, the change five times.
    let growth = rested.estimator().covariance(2, 2) / before;
    assert!(growth > 5.5 && growth < 5.0 * libm::expf(0.75), "{growth}");
    // For five memories every sample forgets, with a row or without.
    for _ in 0..10 {
        let before = rested.estimator().covariance(2, 2);
        let _ = rested.update(0.0, drive.at[0]);
        let growth = rested.estimator().covariance(2, 2) / before;
        near(growth, 1.0005, 1e-4);
    }
}

#[test]
fn the_initial_state_becomes_uncertain_and_the_filter_settles() {
    let config = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [0.4], 50.0);
    let mut servo =
        Identifier::<Trends, 3, 5, 1, 0>::try_new(&config, trends(20.0)).expect("settings");
    let prior = servo.estimator().diagonal()[4];
    let mut drive = Drive::new(1e-4);
    for k in 0..3000 {
        let [u, y] = drive.sample(k);
        let _ = servo.update(u, y);
    }
    let before = servo.estimator().covariance(4, 4);
    assert!(before < 0.01 * prior);
    servo.retune(trends(35.0), 0.3).expect("a filter");
    let after = servo.estimator().covariance(4, 4);
    assert!(after >= prior && after < 1.1 * prior, "{after}");
    for remaining in (0..300).rev() {
        let [u, y] = drive.sample(4000 + remaining);
        let found = servo.update(u, y);
        assert_eq!(found, Outcome::WarmingUp { remaining });
    }
    let [u, y] = drive.sample(4001);
    assert!(matches!(servo.update(u, y), Outcome::Estimated { .. }));
    // Without a time the filter's own is waited for; the default filter has one, and y(0) is good
    // enough without noise.
    servo.retune(trends(20.0), 0.0).expect("a filter");
    assert_eq!(servo.update(u, y), Outcome::WarmingUp { remaining: 0 });
    servo.retune_to(50.0).expect("a filter");
    assert_eq!(servo.trends(), &trends(50.0));
    // Three time constants of a pair of 55 rad/s with a damping of 0.7.
    let Outcome::WarmingUp { remaining } = servo.update(u, y) else {
        panic!("it does not settle");
    };
    assert!((76..=77).contains(&remaining), "{remaining}");
    assert!(servo.retune_to(0.0).is_err());
    // Bandwidths that no identifier begins with.
    let before = servo.clone();
    for omega0 in [0.099, 1001.0, 1e6, 1e12, f32::INFINITY, f32::NAN, -20.0] {
        let refused = servo.retune_to(omega0).expect_err("out of range");
        let (ConfigError::OutOfRange { setting, .. } | ConfigError::NotPositive { setting, .. }) =
            refused
        else {
            panic!("{refused:?}");
        };
        assert_eq!(setting, "omega0".into());
        assert_eq!(servo, before, "{omega0}");
    }
}

#[test]
fn a_model_that_was_mapped_is_the_same_behind_other_trends() {
    // 20 ms are 0.4 rad: the denominator in the plane of the trends is another one.
    let trends = |bandwidth: f32| ExactTrends::<3>::for_bandwidth(2e-2, bandwidth).expect("trends");
    let model = [0.0, 380.0, 18.0];
    let mapped = trends(30.0).with_model(model).expect("trends");
    let mut config = config();
    config.initial = [380.0, 18.0, 9e5];
    let mut servo = Identifier::<_, 3, 3, 1, 0>::try_new(&config, trends(20.0)).expect("settings");
    for (found, exact) in servo.theta().iter().zip(config.initial) {
        near(*found, exact, 1e-4);
    }
    servo.retune(mapped, 0.0).expect("trends");
    for (found, exact) in servo.theta().iter().zip(config.initial) {
        near(*found, exact, 1e-4);
    }
    let units = servo.plan.regressor.units();
    assert!((servo.estimator().theta()[1] * units[1] / 18.0 - 1.0).abs() > 1e-2);
}

#[test]
fn what_cannot_be_changes_nothing_and_a_reset_leads_back() {
    let (mut servo, _) = trained(&config(), 300);
    let before = servo.clone();
    for (trends, settling) in [
        (Trends::for_bandwidth(Scheme::Tustin, 2e-3, 20.0), 0.0),
        (Trends::for_bandwidth(Scheme::Tustin, 1e-3, 35.0), -1e-3),
        (Trends::for_bandwidth(Scheme::Tustin, 1e-3, 35.0), f32::NAN),
    ] {
        assert!(servo.retune(trends.expect("a filter"), settling).is_err());
        assert_eq!(servo, before);
    }
    servo.retune(trends(35.0), 0.0).expect("a filter");
    assert_ne!(servo, before);
    servo.reset();
    assert_eq!(servo, trained(&config(), 0).0);
    // Other settings in the place of the old ones, and those that cannot be.
    let (mut servo, _) = trained(&config(), 300);
    let (before, mut other) = (servo.clone(), config());
    other.memory = Some(-1.0);
    assert!(servo.reconfigure(&other, trends(35.0)).is_err());
    assert!(servo.replan(&other, trends(35.0)).is_err());
    assert_eq!(servo, before);
    (other.memory, other.output_noise) = (Some(2.0), 0.1);
    let wanted = Servo3::try_new(&other, trends(35.0)).expect("settings");
    servo.reconfigure(&other, trends(35.0)).expect("settings");
    assert_eq!(servo, wanted);
    // In pieces it is the same.
    let (mut servo, _) = trained(&config(), 300);
    servo.replan(&other, trends(35.0)).expect("settings");
    servo.expect_noise(&other).expect("settings");
    servo.reset();
    assert_eq!(servo, wanted);
    assert_eq!(servo.forgetting(), 1.0 - 1e-3 / 2.0);
}

#[test]
fn without_an_initial_state_the_slow_pole_is_waited_for() {
    let (mut servo, drive) = trained(&config(), 3000);
    servo.retune(trends(35.0), 0.1).expect("a filter");
    let Outcome::WarmingUp { remaining } = servo.update(drive.u, drive.at[0]) else {
        panic!("rows at once");
    };
    // e^-7 < 1/1000 of the pole of 3.85 rad/s.
    assert!(
        (remaining as f32 - 7.0 / 3.85e-3).abs() < 10.0,
        "{remaining}"
    );
}

#[test]
fn a_drive_that_does_not_integrate_goes_on_where_it_is() {
    let structure = Structure::<2, 4, 1>::FULL;
    let mut config = Config::new(structure, 20.0, [0.4], 50.0);
    config.initial_input = [0.1];
    let filter = |omega| {
        crate::trends::FilteredTrends::<2>::for_bandwidth(Scheme::Tustin, 1e-3, omega)
            .expect("a filter")
    };
    let mut lag = crate::identifier::Identifier::<_, 2, 4, 1, 0>::try_new(&config, filter(20.0))
        .expect("settings");
    for _ in 0..2000 {
        let _ = lag.update(0.3, 40.0);
    }
    lag.retune(filter(25.0), 0.0).expect("a filter");
    let _ = lag.update(0.3, 40.0);
    let trend =
        |lag: &crate::identifier::Identifier<crate::trends::FilteredTrends<2>, 2, 4, 1, 0>| {
            let mut memory = lag.state.signals.inputs[0];
            lag.plan
                .trends
                .input(&mut memory, 0.3, crate::trends::Hold::Zero)[0]
        };
    let settled = trend(&lag);
    for _ in 0..500 {
        let _ = lag.update(0.3, 40.0);
    }
    near(trend(&lag), settled, 1e-4);
}
