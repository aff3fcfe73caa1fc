//! What a candidate is known to, by the gradients of what it means.

use super::*;
use crate::servo::tests::bench::MODEL;

/// An identifier of the loop on a drive of 20 rad/s that moves under its command and brakes by its
/// friction.
fn trained() -> LoopIdentifier {
    let force = -USED.friction;
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
        let _ = identifier.update_inputs([u, u.signum(), USED.friction * sign], y);
        for _ in 0..10 {
            let [y, v, a] = at;
            let jerk = 1e6 * u - 400.0 * v - 20.0 * (a + force * sign);
            at = [y + 1e-4 * v, v + 1e-4 * (a + force * sign), a + 1e-4 * jerk];
        }
    }
    identifier
}

/// The drive of [`trained`], as a model in use.
const USED: Model = Model {
    dead_zone: 0.03,
    offset: -0.01,
    friction: 2000.0,
    ..MODEL
};

#[test]
fn relative_variances_are_those_of_gain_frequency_and_damping() {
    let identifier = trained();
    let found = candidate(&look(&identifier), &USED, 1.0);
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
    let known = [
        found.gain_variance,
        found.frequency_variance,
        found.damping_variance,
    ];
    // What the samples know well the ties hardly change.
    for (known, exact) in known.iter().zip(variances) {
        assert!(
            exact > 0.0 && (known / exact - 1.0).abs() < 2e-2,
            "{known} {exact}"
        );
    }
    for (i, variance) in found.variances.iter().enumerate() {
        assert!((variance / covariance[i][i] - 1.0).abs() < 2e-2, "{i}");
    }
    let Model { a1, a2, b0, .. } = found.model;
    for (is, was) in [a1, a2, b0].iter().zip(theta) {
        assert!((is / was - 1.0).abs() < 2e-3, "{is} {was}");
    }
}

#[test]
fn nothing_is_certain_before_the_noise_is_known() {
    let mut identifier = trained();
    identifier.reset();
    reopen(&mut identifier, &USED, 0.1, 1.0);
    let found = candidate(&look(&identifier), &USED, 1.0);
    assert!(found.variances.iter().all(|variance| !variance.is_finite()));
    assert!(!found.has_certain_sign());
    // The model is the one that it was given.
    assert!((found.model.a1 / USED.a1 - 1.0).abs() < 1e-5);
}

#[test]
fn a_candidate_is_of_the_middle_wherever_the_identifier_has_learnt() {
    let mut identifier = trained();
    for stiffness in [1.0, 1.7, 3.0] {
        // The same samples, of an axis that is so much softer in the middle.
        let found = candidate(&look(&identifier), &USED, 1.0);
        let (a1, b0) = (USED.a1 / stiffness, USED.b0 / stiffness);
        let friction = USED.friction / stiffness;
        let softer = Model {
            a1,
            b0,
            friction,
            ..USED
        };
        let there = candidate(&look(&identifier), &softer, stiffness);
        let ratios = [
            there.model.a1 * stiffness / found.model.a1,
            there.model.a2 / found.model.a2,
            there.model.b0 * stiffness / found.model.b0,
            there.frequency_variance / found.frequency_variance,
        ];
        for ratio in ratios {
            assert!((ratio - 1.0).abs() < 2e-2, "{stiffness}: {ratios:?}");
        }
    }
    for stiffness in [1.0, 1.7, 3.0] {
        reopen(&mut identifier, &USED, 0.1, stiffness);
        let model = candidate(&look(&identifier), &USED, stiffness).model;
        let pairs = model.parameters().into_iter().zip(USED.parameters());
        for (is, was) in pairs {
            assert!(
                (is - was).abs() <= 1e-5 * was.abs(),
                "{stiffness}: {is} {was}"
            );
        }
    }
}

#[test]
fn an_identification_goes_on_from_a_model_that_is_known_to_a_share() {
    let mut identifier = trained();
    reopen(&mut identifier, &USED, 0.1, 1.0);
    let found = identifier.recursion();
    let Model { a1, a2, b0, .. } = USED;
    let theta = [a1, a2, b0, 0.0, -1.0, 0.0];
    let std = [0.1 * a1, 0.1 * a2, 0.1 * b0, 0.0, 0.1, 0.0];
    for j in 0..6 {
        let size = 1e-4 * theta[j].abs();
        assert!((found.theta()[j] - theta[j]).abs() <= size, "{j}");
        assert!((found.std()[j] - std[j]).abs() <= size, "{j}");
    }
}

#[test]
fn what_the_loop_has_learnt_of_the_valve_stays_and_friction_follows_the_mass() {
    let used = Model {
        a1: 1200.0,
        b0: 0.7 * USED.b0,
        ..USED
    };
    let found = candidate(&look(&trained()), &used, 1.0).model;
    assert!((found.b0 / USED.b0 - 1.0).abs() < 0.1, "{}", found.b0);
    // A force that is the same deflection at another a1.
    let wanted = Model {
        friction: 2000.0 * found.a1 / 1200.0,
        a1: found.a1,
        a2: found.a2,
        b0: found.b0,
        ..used
    };
    assert!((found.friction / wanted.friction - 1.0).abs() < 1e-6);
    assert_eq!(
        Model {
            friction: wanted.friction,
            ..found
        },
        wanted
    );
}

#[test]
fn a_tie_is_an_observation_of_a_difference() {
    // By hand: variances 4 and 1, difference 3 observed as 0 with 2: gain (-4, 0.. 1) / 9.
    let (mut x, mut p) = ([2.0, 5.0, 1.0, 7.0], [[0.0; 4]; 4]);
    (p[0][0], p[1][1], p[2][2]) = (4.0, 1.0, 9.0);
    tie::<1>(&mut x, &mut p, 1.0);
    let off = |is: f32, should: f32| (is - should).abs() < 1e-6;
    assert!(
        off(x[0], 2.0 + 4.0 / 3.0) && off(x[1], 5.0 - 1.0 / 3.0),
        "{x:?}"
    );
    assert_eq!((x[2], x[3]), (1.0, 7.0));
    assert!(off(p[0][0], 4.0 - 16.0 / 9.0) && off(p[1][1], 1.0 - 1.0 / 9.0));
    assert!(off(p[0][1], 4.0 / 9.0) && off(p[1][0], 4.0 / 9.0));
    assert_eq!((p[2][2], p[2][0]), (9.0, 0.0));
}

#[test]
fn what_is_certain_or_not_known_at_all_is_not_changed_by_a_tie() {
    let certain = [2.0, 5.0, 1.0, 7.0];
    for (variance, std) in [
        (0.0, 1.0),
        (0.0, 0.0),
        (f32::INFINITY, 1.0),
        (1.0, f32::NAN),
    ] {
        let mut p = [[0.0; 4]; 4];
        (p[0][0], p[1][1]) = (variance, variance);
        let mut x = certain;
        let before = p;
        tie::<1>(&mut x, &mut p, std);
        assert_eq!((x, p), (certain, before), "{variance} {std}");
    }
}
