//! What is left of errors that a flow within the unknown part of a dead zone explains.

use super::*;
use crate::servo::motion::Motion;

/// A dead zone of 0.1, of which 0.05 may be unknown.
const MODEL: Model = Model {
    dead_zone: 0.1,
    ..Model::linear(900.0, 15.0, 9e5)
};
const BOUND: f32 = 0.05;
/// Samples of a window.
const FREE: usize = 60;

/// The flow of a window that turns after so many samples.
fn flow(turns: usize, k: usize) -> f32 {
    if (k / turns).is_multiple_of(2) {
        0.02
    } else {
        -0.3
    }
}

/// What errors of each sample and its response come to: the flow, their sums, and the responses.
fn window(turns: usize, error: impl Fn(usize, f32) -> f32) -> (UnknownFlow, Errors, [f32; FREE]) {
    let mut unknown = UnknownFlow::new(&MODEL, 1e-3);
    let mut errors = Errors::default();
    let responses = core::array::from_fn(|k| {
        let response = unknown.update(PlacedFlow::in_the_middle(flow(turns, k)));
        errors.add(error(k, response), response);
        response
    });
    (unknown, errors, responses)
}

#[test]
fn a_response_is_how_far_a_dead_zone_moves_that_is_wrong_by_one() {
    // Two axes, the dead zone of one wider by 0.01.
    for turns in [100, 30, 7] {
        let (mut model, mut axis) = (Motion::default(), Motion::default());
        let (_, _, responses) = window(turns, |_, _| 0.0);
        for (k, response) in responses.into_iter().enumerate() {
            let flow = flow(turns, k);
            MODEL.advance(&mut model, flow, 1e-3);
            MODEL.advance(&mut axis, flow - libm::copysignf(0.01, flow), 1e-3);
            let apart = model.position - axis.position;
            let exact = 0.01 * response;
            assert!((apart - exact).abs() < 1e-4 * (1.0 + exact.abs()), "{k}");
        }
    }
}

#[test]
fn without_flow_there_is_no_response_and_all_errors_are_left() {
    let mut unknown = UnknownFlow::new(&MODEL, 1e-3);
    let mut errors = Errors::default();
    for _ in 0..60 {
        let response = unknown.update(PlacedFlow::in_the_middle(0.0));
        assert_eq!(response, 0.0);
        errors.add(2.0, response);
    }
    assert_eq!(unknown.left(&errors), 240.0);
}

#[test]
fn a_dead_zone_wrong_within_the_bound_leaves_nothing_in_any_window() {
    for turns in [100, 40, 30, 7] {
        for wrong in [-BOUND, -0.02, 1e-4, 0.03, BOUND] {
            let (unknown, errors, _) = window(turns, |_, response| wrong * response);
            let left = unknown.left(&errors);
            assert!(left <= 1e-5 * errors.squares, "{turns}, {wrong}: {left}");
        }
    }
}

#[test]
fn of_more_than_the_bound_the_rest_is_left() {
    for (wrong, rest) in [(0.06, 0.01), (-0.15, 0.1), (0.3, 0.25)] {
        let (unknown, errors, _) = window(30, |_, response| wrong * response);
        let exact = rest * rest * unknown.squares;
        let left = unknown.left(&errors);
        assert!((left / exact - 1.0).abs() < 1e-3, "{wrong}: {left}");
    }
}

#[test]
fn a_narrow_dead_zone_may_be_wrong_by_more_than_its_half() {
    for (dead_zone, bound) in [(0.0, 0.04), (0.06, 0.04), (0.08, 0.04), (0.15, 0.075)] {
        let found = unknown_flow(&Model { dead_zone, ..MODEL });
        assert!((found - bound).abs() < 1e-6, "{dead_zone}: {found}");
    }
}

#[test]
fn what_is_left_is_the_least_of_all_flows_within_the_bound() {
    // Errors of any kind, drawn: never more than without a flow, never less than nothing, and less
    // than with any other flow within the bound.
    let mut draw = 1_u32;
    let mut random = || {
        draw = draw.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (draw >> 8) as f32 / 8_388_608.0 - 1.0
    };
    for turns in 1..=FREE {
        let drawn: [f32; FREE] = core::array::from_fn(|_| random());
        let (wrong, size) = (0.2 * random(), random());
        let errors_of = |k: usize, response: f32| wrong * response + size * drawn[k];
        let (unknown, errors, responses) = window(turns, errors_of);
        let left = unknown.left(&errors);
        assert!((0.0..=errors.squares).contains(&left));
        for part in -10..=10 {
            let flow = 0.1 * BOUND * part as f32;
            let with = |(k, s): (usize, &f32)| {
                let error = errors_of(k, *s) - flow * s;
                error * error
            };
            let sum: f32 = responses.iter().enumerate().map(with).sum();
            assert!(left <= sum + 1e-4 * errors.squares, "{turns}, {flow}");
        }
    }
}

#[test]
fn errors_that_are_not_finite_leave_none_that_are() {
    for error in [f32::NAN, f32::INFINITY, 1e30] {
        let (unknown, errors, _) = window(30, |_, _| error);
        assert!(!unknown.left(&errors).is_finite(), "{error}");
    }
}
