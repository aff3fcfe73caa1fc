//! What a candidate is known to, by the gradients of what it means.

use super::*;
use crate::servo::tests::bench::{Bench, MODEL};

/// An identifier of the loop on a drive of 20 rad/s that moves under its command, and under a force
/// that changes with the sign of the velocity.
fn trained(force: f32) -> LoopIdentifier {
    let mut config = Config::new(STRUCTURE, 20.0, [0.4, 1.0, 1.0], 50.0);
    config.memory = Some(20.0);
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0).expect("a filter");
    let mut identifier = LoopIdentifier::try_new(&config, trends).expect("settings");
    let mut at = [0.0_f32; 3];
    let mut state = 1_u32;
    let mut draw = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 8_388_608.0 - 1.0
    };
    let mut u = 0.0;
    for k in 0..3000 {
        if k % 120 == 0 {
            u = 0.3 * draw() - 0.2 * at[0].signum();
        }
        let y = at[0] + 0.05 * draw();
        let sign = if at[1] > 0.0 { 1.0 } else { -1.0 };
        let _ = identifier.update_inputs([u, u.signum(), sign], y);
        for _ in 0..10 {
            let [y, v, a] = at;
            let jerk = 1e6 * u - 400.0 * v - 20.0 * (a + force * sign);
            at = [y + 1e-4 * v, v + 1e-4 * (a + force * sign), a + 1e-4 * jerk];
        }
    }
    identifier
}

#[test]
#[cfg_attr(miri, ignore = "many samples")]
fn relative_variances_are_those_of_gain_frequency_and_damping() {
    let identifier = trained(0.0);
    let found = candidate(&identifier, None);
    let estimate = identifier.recursion();
    let (theta, covariance) = (estimate.theta(), estimate.covariance());
    let [a1, a2, b0, ..] = theta;
    // ln(b0/a1), ln sqrt(a1) and ln(a2 / (2 sqrt(a1))) by a1, a2 and b0.
    let gradients = [
        [-1.0 / a1, 0.0, 1.0 / b0],
        [0.5 / a1, 0.0, 0.0],
        [-0.5 / a1, 1.0 / a2, 0.0],
    ];
    let variances = gradients.map(|gradient| {
        let terms = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
        terms
            .map(|(i, j)| gradient[i] * covariance[i][j] * gradient[j])
            .sum::<f32>()
    });
    let found = [
        found.gain_variance,
        found.frequency_variance,
        found.damping_variance,
    ];
    for (found, exact) in found.iter().zip(variances) {
        assert!(
            exact > 0.0 && (found / exact - 1.0).abs() < 1e-2,
            "{found} {exact}"
        );
    }
    let found = candidate(&identifier, None);
    for (i, variance) in found.variances.iter().enumerate() {
        assert_eq!(*variance, covariance[i][i]);
    }
    let [a, b, c] = [found.model.a1, found.model.a2, found.model.b0];
    assert_eq!([a, b, c], [a1, a2, b0]);
}

#[test]
#[cfg_attr(miri, ignore = "many samples")]
fn nothing_is_certain_before_the_noise_is_known() {
    let mut identifier = trained(0.0);
    identifier.reset();
    reopen(&mut identifier, &Model::linear(400.0, 20.0, 1e6), 0.1);
    let found = candidate(&identifier, None);
    assert!(
        found
            .variances
            .iter()
            .all(|variance| *variance == f32::INFINITY)
    );
    assert!(!found.has_certain_sign());
    // The model is the one that it was given.
    assert!((found.model.a1 / 400.0 - 1.0).abs() < 1e-5);
}

#[test]
#[cfg_attr(miri, ignore = "many samples")]
fn a_friction_brakes_and_is_known_from_two_deviations_on() {
    for (force, friction) in [(0.0, 0.0), (-4000.0, 4000.0), (4000.0, 0.0)] {
        let found = candidate(&trained(force), None).model.friction;
        assert!(
            (found - friction).abs() <= 0.1 * friction,
            "{force}: {found}"
        );
    }
}

#[test]
#[cfg_attr(miri, ignore = "many samples")]
fn what_the_loop_has_learnt_of_the_valve_stays() {
    let used = Model {
        dead_zone: 0.03,
        offset: -0.01,
        friction: 2000.0,
        ..MODEL
    };
    let bench = Bench::new(used);
    let identifier = trained(0.0);
    let (alone, beside) = (
        candidate(&identifier, None),
        candidate(&identifier, Some(bench.servo.controller())),
    );
    let Model { a1, a2, b0, .. } = alone.model;
    // A force that is the same velocity at another a1.
    let wanted = Model {
        friction: 2000.0 * a1 / used.a1,
        a1,
        a2,
        b0,
        ..used
    };
    assert_eq!(beside.model, wanted);
    assert_eq!(beside.variances, alone.variances);
}
