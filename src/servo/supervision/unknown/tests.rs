//! What is left of errors that an unknown dead zone and an unknown friction explain.

use super::*;
use crate::servo::config::Config;
use crate::servo::motion::Travel;

/// A dead zone of 0.1, of which 0.05 may be unknown, and a friction of which the half.
const MODEL: Model = Model {
    dead_zone: 0.1,
    friction: 4000.0,
    ..Model::linear(900.0, 15.0, 9e5)
};
const FLOW: f32 = 0.05;
const FRICTION: f32 = 2000.0;
/// Observed samples, and free ones of a window.
const OBSERVED: usize = 40;
const FREE: usize = 100;

/// The model in use, whose friction acts on no response.
fn used() -> Observer {
    let travel = Travel {
        min: 0.0,
        max: 400.0,
    };
    let design = Config::new(1e-3, 30.0, travel).resolve().expect("settings");
    let free = Model {
        friction: 0.0,
        ..MODEL
    };
    Observer::new(&design.supervision.validation.observer, free)
}

/// The flow and the direction of a window, each of which turns after so many samples.
fn drive([flow, axis]: [usize; 2], k: usize) -> (f32, f32) {
    let even = |turns: usize| (k / turns).is_multiple_of(2);
    let flow = if even(flow) { 0.02 } else { -0.3 };
    (flow, if even(axis) { 50.0 } else { -120.0 })
}

/// What errors of each sample and its responses come to: their sums, and the responses.
fn window(
    turns: [usize; 2],
    error: impl Fn(usize, Responses) -> f32,
) -> (Unknown, Errors, [Responses; FREE]) {
    let used = used();
    let mut unknown = Unknown::new(&MODEL);
    let mut errors = Errors::default();
    for k in 0..OBSERVED {
        let (flow, velocity) = drive(turns, k);
        unknown.observe(&used, PlacedFlow::in_the_middle(flow), velocity);
    }
    let responses = core::array::from_fn(|k| {
        let (flow, velocity) = drive(turns, OBSERVED + k);
        let responses = unknown.update(&used, PlacedFlow::in_the_middle(flow), velocity);
        errors.add(error(k, responses), responses);
        responses
    });
    (unknown, errors, responses)
}

/// Turns of flow and axis: seldom, often, and not at all.
const TURNS: [[usize; 2]; 5] = [[1000, 1000], [100, 60], [40, 95], [30, 30], [7, 1000]];

/// Errors of a flow and a friction.
fn of(flow: f32, friction: f32) -> impl Fn(usize, Responses) -> f32 {
    move |_, responses| flow * responses.flow + friction * responses.friction
}

#[test]
fn responses_are_how_far_a_dead_zone_and_a_friction_move_that_are_wrong_by_one() {
    // Two axes: the dead zone of one wider by 0.01, and its friction by 100.
    for turns in TURNS {
        let (mut model, mut axis) = (Motion::default(), Motion::default());
        let (_, _, responses) = window(turns, of(0.0, 0.0));
        let mut direction = 0.0;
        let mut gone = |axis: &mut Motion, k: usize| {
            let (_, velocity) = drive(turns, k);
            if direction != 0.0 {
                axis.acceleration -= 100.0 * (velocity.signum() - direction);
            }
            direction = velocity.signum();
        };
        let observer = used();
        for k in 0..OBSERVED {
            let (flow, _) = drive(turns, k);
            observer.deviate_observed(&mut axis, -libm::copysignf(0.01, flow));
            gone(&mut axis, k);
        }
        for (k, responses) in responses.into_iter().enumerate() {
            let (flow, _) = drive(turns, OBSERVED + k);
            MODEL.advance(&mut model, flow, 1e-3);
            MODEL.advance(&mut axis, flow - libm::copysignf(0.01, flow), 1e-3);
            gone(&mut axis, OBSERVED + k);
            let apart = axis.position - model.position;
            let exact = 100.0 * responses.friction - 0.01 * responses.flow;
            assert!((apart - exact).abs() < 1e-4 * (1.0 + exact.abs()), "{k}");
        }
    }
}

#[test]
fn without_flow_and_reversal_there_is_no_response_and_all_errors_are_left() {
    let used = used();
    let mut unknown = Unknown::new(&MODEL);
    let mut errors = Errors::default();
    for _ in 0..60 {
        let responses = unknown.update(&used, PlacedFlow::in_the_middle(0.0), 30.0);
        assert_eq!(responses, Responses::default());
        errors.add(2.0, responses);
    }
    assert_eq!(unknown.left(&errors), 240.0);
}

#[test]
fn what_is_wrong_within_the_bounds_leaves_nothing_in_any_window() {
    for turns in TURNS {
        for flow in [-FLOW, -0.02, 0.0, 0.03, FLOW] {
            for friction in [-FRICTION, 0.0, 300.0, FRICTION] {
                let (unknown, errors, _) = window(turns, of(flow, friction));
                let left = unknown.left(&errors);
                let all = errors.squares + 1e-9;
                assert!(left <= 3e-5 * all, "{turns:?}, {flow}, {friction}: {left}");
            }
        }
    }
}

#[test]
fn of_more_than_the_bounds_the_rest_is_left() {
    for (wrong, rest) in [(0.06, 0.01), (-0.15, 0.1), (0.3, 0.25)] {
        // No reversal.
        let (unknown, errors, _) = window([30, 1000], of(wrong, 0.0));
        let exact = rest * rest * unknown.squares.flow;
        let left = unknown.left(&errors);
        assert!((left / exact - 1.0).abs() < 1e-3, "{wrong}: {left}");
    }
}

#[test]
fn a_narrow_dead_zone_may_be_wrong_by_more_than_its_half() {
    for (dead_zone, bound) in [(0.0, 0.03), (0.04, 0.03), (0.06, 0.03), (0.15, 0.075)] {
        let found = unknown_flow(&Model { dead_zone, ..MODEL });
        assert!((found - bound).abs() < 1e-6, "{dead_zone}: {found}");
    }
}

#[test]
fn what_is_left_is_the_least_of_all_within_the_bounds() {
    // Errors of any kind, drawn: never more than all, never less than nothing, and no more than
    // with any flow and friction within the bounds.
    let mut draw = 1_u32;
    let mut random = || {
        draw = draw.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (draw >> 8) as f32 / 8_388_608.0 - 1.0
    };
    for k in 1..=FREE {
        let turns = [k, 10 + 3 * (k % 17)];
        let drawn: [f32; FREE] = core::array::from_fn(|_| random());
        let (flow, friction, size) = (0.2 * random(), 3.0 * FRICTION * random(), random());
        let errors_of =
            |k: usize, r: Responses| flow * r.flow + friction * r.friction + size * drawn[k];
        let (unknown, errors, responses) = window(turns, errors_of);
        let left = unknown.left(&errors);
        let rounding = 1e-4 * errors.squares;
        assert!((-rounding..=errors.squares).contains(&left));
        for part in 0..21 * 21 {
            let c = 0.1 * FLOW * ((part % 21) as f32 - 10.0);
            let d = 0.1 * FRICTION * ((part / 21) as f32 - 10.0);
            let with = |(k, r): (usize, &Responses)| {
                let error = errors_of(k, *r) - c * r.flow - d * r.friction;
                error * error
            };
            let sum: f32 = responses.iter().enumerate().map(with).sum();
            assert!(left <= sum + rounding, "{turns:?}, {c}, {d}: {left} {sum}");
        }
    }
}

#[test]
fn errors_that_are_not_finite_leave_none_that_are() {
    for error in [f32::NAN, f32::INFINITY, 1e30] {
        let (unknown, errors, _) = window([30, 60], |_, _| error);
        assert!(!unknown.left(&errors).is_finite(), "{error}");
    }
}
