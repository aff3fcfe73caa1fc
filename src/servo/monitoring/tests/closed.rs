//! The reason of an axis whose valve closes, where what it shows before and behind differs.

use super::*;
use crate::servo::monitoring::closing::Closing;

/// What a drive has shown whose valve opens the other way, and is off by so much.
fn shown(offset: f32, bounds: &Bounds) -> Response {
    let drive = Model::linear(MODEL.a1, MODEL.a2, MODEL.b0);
    let (mut motion, mut response) = (Motion::default(), Response::default());
    for k in 0..4000 {
        let flow = 0.2 * libm::sinf(0.01 * k as f32);
        drive.advance(&mut motion, offset - flow, 1e-3);
        // Of less weight nothing is forgotten.
        response.update(flow, motion.velocity, 0.5, bounds);
    }
    response
}

/// The verdict on an axis that stops, by what it has shown before and until the end.
fn verdict(before: &Response, until_then: &Response, bounds: &Bounds) -> Reason {
    let mut closing = Closing::default();
    closing.begin(100.0, before, bounds);
    (0..10_000)
        .find_map(|_| closing.update(0.0, until_then))
        .expect("a reason")
}

#[test]
fn what_is_shown_behind_the_closed_valve_has_half_the_weight() {
    let bounds = example::bounds(&MODEL);
    // From a wrong sign alone to a stuck spool alone: -1 to 1.
    let mut marks = [0.0_f32; 21];
    let responses: [Response; 21] = core::array::from_fn(|k| shown(0.025 * k as f32, &bounds));
    for (mark, response) in marks.iter_mut().zip(&responses) {
        assert!(!response.is_faint());
        *mark = response.mirrored();
    }
    let most = marks.iter().copied().fold(-1.0_f32, f32::max);
    let least = marks.iter().copied().fold(1.0_f32, f32::min);
    assert!(most > 0.9 && least < -0.5, "{least} {most}");
    let mut found = [0_u32; 2];
    for (before, first) in marks.iter().zip(&responses) {
        for (behind, second) in marks.iter().zip(&responses) {
            let sum = before + 0.5 * behind;
            if sum.abs() < 1e-3 {
                continue;
            }
            let expected = if sum > 0.0 {
                Reason::WrongSign
            } else {
                Reason::ValveStuck
            };
            let reason = verdict(first, second, &bounds);
            assert_eq!(reason, expected, "{before} {behind}");
            // Those that one of both would have decided otherwise.
            found[0] += u32::from(before * sum < 0.0);
            found[1] += u32::from(behind * sum < 0.0);
        }
    }
    assert!(found[0] > 20 && found[1] > 20, "{found:?}");
}

#[test]
fn an_axis_that_was_commanded_nothing_has_obeyed_no_wrong_sign() {
    let bounds = example::bounds(&MODEL);
    let mut response = Response::default();
    for _ in 0..1000 {
        response.update(0.0, 300.0, 1.0, &bounds);
    }
    assert_eq!((response.is_faint(), response.mirrored()), (false, 0.0));
    assert_eq!(verdict(&response, &response, &bounds), Reason::ValveStuck);
}
