//! Friction that holds an axis: at its limits, and what is given back.

use super::*;
use crate::estimation::rls::Estimator;
use crate::estimation::structure::Structure;
use crate::estimation::terms::Terms;
use crate::identifier::{Config, Identifier};
use crate::trends::{FilteredTrends, Scheme};

/// `y'' + 10 y' = b u + d - c sgn y'` in the order of theta: a1, the numerators of both inputs, d.
type Axis = Identifier<FilteredTrends<2>, 2, 4, 2, 0>;

const B: f32 = 500.0;
const D: f32 = -40.0;
const C: f32 = 100.0;

/// An axis whose friction is input `friction`, known to `std`; one row in two says nothing of it.
fn axis(friction: usize, std: f32) -> Axis {
    let structure = Structure::<2, 4, 2>::INTEGRATING_WITH_CONSTANT;
    let mut config = Config::new(structure, 20.0, [0.4, 1.0], 50.0);
    config.friction_input = Some(friction);
    config.holds[friction] = Hold::Mean;
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0).expect("a filter");
    let mut axis = Axis::try_new(&config, trends).expect("settings");
    let (mut theta, mut deviations) = ([10.0, B, B, D], [1e-3; 4]);
    theta[1 + friction] = -C;
    deviations[1 + friction] = std;
    axis.warm_start(theta, deviations).expect("an estimate");
    axis
}

/// Rows without a regressor: nothing is learnt but the noise, which is as large as expected.
fn hear(axis: &mut Axis) {
    // Of 100 rows four are taken off for the parameters.
    let size = axis.plan.noise.prior * libm::sqrtf(0.96);
    for k in 0..100 {
        let error = if k % 2 == 0 { size } else { -size };
        let _ = axis.state.estimator.update(&[0.0; 4], error);
    }
}

#[test]
fn a_command_up_to_twice_the_friction_found_may_be_held() {
    for friction in [0, 1] {
        let mut axis = axis(friction, 0.2 * C);
        let command = 1 - friction;
        let holds = |axis: &mut Axis, u: f32| {
            axis.state.signals.acting = [1e3; 2];
            axis.state.signals.acting[command] = u;
            axis.state.friction_holds(&axis.plan)
        };
        // Before the noise is known nothing is held.
        assert!(!holds(&mut axis, 0.0));
        hear(&mut axis);
        for side in [1.0, -1.0] {
            for (share, held) in [(0.0, true), (0.99, true), (1.01, false)] {
                // b u + d = 2 c at the limit.
                let u = (side * share * 2.0 * C - D) / B;
                assert_eq!(holds(&mut axis, u), held, "{friction} {side} {share}");
            }
        }
    }
}

#[test]
fn a_friction_that_is_not_known_to_a_third_holds_nothing() {
    for (share, held) in [(0.98, true), (1.02, false)] {
        for friction in [0, 1] {
            let mut axis = axis(friction, share * C / 3.0);
            hear(&mut axis);
            assert_eq!(axis.state.friction_holds(&axis.plan), held, "{share}");
        }
    }
}

#[test]
fn forces_alone_are_given_back() {
    // An input that acts on the velocity too.
    let inputs = [Terms::of(&[1]), Terms::of(&[0])];
    let structure = Structure::<2, 3, 2>::try_new(Terms::of(&[1]), inputs, false);
    let mut config = Config::new(structure.expect("a structure"), 20.0, [0.4, 1.0], 50.0);
    config.friction_input = Some(1);
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0).expect("a filter");
    let mut axis =
        Identifier::<FilteredTrends<2>, 2, 3, 2, 0>::try_new(&config, trends).expect("settings");
    axis.warm_start([10.0, B, -C], [1e-3; 3])
        .expect("an estimate");
    axis.state.estimator = Estimator::new(*axis.estimator().theta(), [1e-6; 3], 1.0);
    for _ in 0..100 {
        let _ = axis.state.estimator.update(&[0.0; 3], 1e-9);
    }
    assert!(axis.estimator().noise_variance().is_some());
    assert!(!axis.state.friction_holds(&axis.plan));
}

/// One interval under `command` and a constant of `one`, with the sign 0, for the trends alone.
fn interval(axis: &mut Axis, command: f32, one: f32) {
    let trends = axis.plan.trends.clone();
    let signals = &mut axis.state.signals;
    let _ = trends.input(&mut signals.inputs[0], command, axis.plan.inputs.holds[0]);
    let _ = trends.input(&mut signals.inputs[1], 0.0, axis.plan.inputs.holds[1]);
    let _ = trends.input(&mut signals.constant, one, Hold::Zero);
}

#[test]
fn what_is_given_back_was_as_if_it_had_not_acted() {
    for (std, hold, held) in [
        (0.1 * C, Hold::Zero, true),
        (10.0 * C, Hold::Zero, false),
        (0.1 * C, Hold::First, true),
    ] {
        let mut axis = axis(1, std);
        axis.plan.inputs.holds[0] = hold;
        hear(&mut axis);
        let _ = axis.update_inputs([0.1, -1.0], 0.0);
        let mut other = axis.clone();
        let u = 0.3;
        let _ = axis.state.signals.other_trends(&axis.plan, [u, 0.0]);
        axis.state.give_back(&axis.plan);
        let found = axis.state.signals.other_trends(&axis.plan, [0.2, 1.0]);
        // A command that is not held acted on its way, and is not given back.
        let command = if held && hold == Hold::Zero { 0.0 } else { u };
        interval(&mut other, command, if held { 0.0 } else { 1.0 });
        let wanted = other.state.signals.other_trends(&other.plan, [0.2, 1.0]);
        let near = |found: f32, exact: f32| {
            assert!((found / exact - 1.0).abs() < 1e-4, "{found} for {exact}");
        };
        for (found, exact) in found.inputs[0].iter().zip(wanted.inputs[0]) {
            near(*found, exact);
        }
        near(found.extra[0], wanted.extra[0]);
        assert_eq!(found.inputs[1], wanted.inputs[1]);
    }
}

#[test]
fn in_a_model_of_order_three_nothing_is_given_back() {
    let structure = Structure::<3, 5, 2>::INTEGRATING_WITH_CONSTANT;
    let mut config = Config::new(structure, 20.0, [0.4, 1.0], 50.0);
    config.friction_input = Some(1);
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 1e-3, 20.0).expect("a filter");
    let mut axis =
        Identifier::<FilteredTrends<3>, 3, 5, 2, 0>::try_new(&config, trends).expect("settings");
    let theta = [400.0, 20.0, B, -C, 0.0];
    axis.warm_start(theta, [1e-3; 5]).expect("an estimate");
    for k in 0..100 {
        let error = if k % 2 == 0 { 1e-6 } else { -1e-6 };
        let _ = axis.state.estimator.update(&[0.0; 5], error);
    }
    let _ = axis.update_inputs([0.1, 0.0], 0.0);
    assert!(axis.state.friction_holds(&axis.plan));
    let before = axis.clone();
    axis.state.give_back(&axis.plan);
    assert_eq!(axis, before);
}

#[test]
fn a_sample_whose_velocity_is_zero_gives_the_command_before_it_back() {
    for (sign, sticks) in [(0.0, true), (1.0, false)] {
        let mut axis = axis(1, 0.1 * C);
        hear(&mut axis);
        let _ = axis.update_inputs([0.3, sign], 0.0);
        let mut other = axis.clone();
        let _ = axis.update_inputs([0.2, sign], 0.0);
        if sticks {
            other.state.give_back(&other.plan);
        }
        let _ = other.state.signals.other_trends(&other.plan, [0.2, sign]);
        assert_eq!(axis.state.signals.inputs, other.state.signals.inputs);
        assert_eq!(axis.state.signals.constant, other.state.signals.constant);
    }
}
