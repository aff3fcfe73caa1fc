//! The push by numbers that are worked out by hand, on the drive of the tests of the law.

use super::*;
use crate::servo::control::law::tests::{at, near, reference};
use crate::servo::control::tests::by_hand;
use crate::servo::model::Model;
use crate::servo::motion::Motion;

#[test]
fn a_push_is_quick_to_where_friction_lets_go_and_then_grows() {
    for way in [1.0, -1.0] {
        let push = |drive: f32, at_rest: bool| {
            let r = reference(way, 0.0, 0.0);
            way * at(0.0, way * drive).break_away(&r, at_rest, 0.0)
        };
        near(push(0.0, true), 300.0 * 800.0);
        near(push(780.0, true), 300.0 * 20.0);
        // A quarter of friction times bandwidth at least, twelve times as much where a hop is due.
        near(push(790.0, true), 0.25 * 800.0 * 16.0);
        near(push(900.0, true), 0.25 * 800.0 * 16.0);
        near(push(600.0, false), 300.0 * 200.0);
        near(push(790.0, false), 3.0 * 800.0 * 16.0);
        // It grows by 0.3 per time constant for which the axis has been held, 11 ms and 687; by
        // half at most behind a moving reference, or as far as in the pause before.
        for (samples, rest, moving) in [(11, 1.0528, 1.0528), (750, 4.2976, 1.5)] {
            let mut held = at(0.0, way * 800.0);
            for _ in 0..samples {
                let _ = held.anchor.update(200.0, true);
            }
            let r = reference(way, 0.0, 0.0);
            near(way * held.break_away(&r, true, 0.0), 3200.0 * rest);
            near(way * held.break_away(&r, false, 0.0), 38_400.0 * moving);
            held.pauses();
            let most = if samples == 11 { moving } else { rest - 1.0 };
            near(way * held.break_away(&r, false, 0.0), 38_400.0 * most);
            // The next one is none that a pause has made.
            assert!(held.resumed() == (samples == 750) && !held.resumed());
            // Of ten samples no push has grown.
            held.pause = 10;
            assert!(!held.resumed());
            near(way * held.break_away(&r, false, 0.0), 38_400.0 * moving);
        }
        // From four frictions on the error counts where it asks for more: k0 error - k2 drive.
        let slid = |drive: f32, error: f32| {
            let r = reference(way * error, 0.0, 0.0);
            way * at(0.0, way * drive).break_away(&r, false, 0.0)
        };
        near(slid(3160.0, 13.0), 38_400.0);
        near(slid(3176.0, 12.0), 38_400.0);
        near(slid(3176.0, 13.0), 130_000.0 - 26.0 * 3176.0);
    }
    // What is quick is a part of the delay, where there is one.
    let mut late = at(0.0, 0.0);
    late.design.delay = 9e-3;
    near(
        late.break_away(&reference(1.0, 0.0, 0.0), true, 0.0),
        100.0 * 800.0,
    );
}

#[test]
fn a_rest_makes_the_next_push_no_quicker() {
    let r = reference(1.0, 0.0, 0.0);
    let mut held = at(0.0, 800.0);
    let pass = |held: &mut Controller, samples: u32| {
        for _ in 0..samples {
            let _ = held.anchor.update(200.0, true);
        }
        held.break_away(&r, true, 0.0)
    };
    // From where it sticks, 63 samples on, not from the motion before.
    near(pass(&mut held, 750), 3200.0 * 4.2976);
    held.rested = held.anchor.since();
    near(pass(&mut held, 0), 3200.0);
    near(pass(&mut held, 11), 3200.0 * 1.0528);
}

#[test]
fn a_rest_is_no_time_for_which_something_is_missing() {
    let mut held = by_hand::controller(Model {
        friction: 800.0,
        ..Model::linear(625.0, 20.0, 1e6)
    });
    held.place(Motion::at(200.0));
    let pass = |held: &mut Controller, samples: u32, target: f32| {
        for _ in 0..samples {
            let _ = held.update(&Setpoint::at(target), 200.0);
            held.applied(0.0);
        }
        held.anchor.since() - held.rested
    };
    assert_eq!(pass(&mut held, 5000, 200.0), 0);
    assert!(held.rest.rests());
    assert_eq!(pass(&mut held, 70, 201.0), 70);
    // It slides, and sticks elsewhere.
    let _ = held.update(&Setpoint::at(201.0), 200.5);
    for _ in 0..500 {
        let _ = held.update(&Setpoint::at(201.0), 200.5);
        held.applied(0.0);
    }
    assert!(held.sticks() && held.rested == 0);
}

#[test]
fn a_reference_that_comes_to_the_axis_is_awaited() {
    for way in [1.0, -1.0] {
        // 1.5/16 s later it is beyond the axis, or not, by more than a quarter of its way or not.
        let rate = |drive: f32, error: f32, velocity: f32, acceleration: f32| {
            let r = reference(way * error, way * velocity, way * acceleration);
            way * at(0.0, way * drive).break_away(&r, false, 0.0)
        };
        near(rate(600.0, -1.0, 40.0, 0.0), 300.0 * (640.0 - 600.0));
        near(rate(700.0, -1.0, 40.0, 0.0), 0.0);
        near(rate(600.0, -0.9, 40.0, 0.0), 300.0 * 200.0);
        // A way of 1.7578 by an acceleration alone, of which 0.4395 is not known.
        near(rate(600.0, 0.0, 0.0, 400.0), 300.0 * 200.0);
        near(rate(600.0, -1.3, 0.0, 400.0), 300.0 * 40.0);
        near(rate(600.0, -1.33, 0.0, 400.0), 0.0);
        near(rate(600.0, -0.9, 8.0, 0.0), 0.0);
        // At rest the window alone.
        let rest = |error: f32| {
            let r = reference(way * error, 0.0, 0.0);
            way * at(0.0, way * 600.0).break_away(&r, true, 0.0)
        };
        near(rest(0.045), 0.0);
        near(rest(0.055), 300.0 * 200.0);
    }
}

#[test]
fn a_hop_that_is_longer_than_the_swing_of_its_reference_is_worth_half_of_it() {
    let mut controller = at(0.0, 790.0);
    // A hop of 4, and a reference that swings by 1.
    controller.hop.ended(1.0, [1.0, -7.0], true);
    for (place, velocity) in [(200.0, 1.0), (200.0, -1.0), (201.0, 1.0)] {
        controller.hop.follow(place, velocity);
    }
    let rate = |error: f32, at_rest: bool| {
        controller.break_away(&reference(error, 0.0, 0.0), at_rest, 0.0)
    };
    near(rate(1.5, false), 0.0);
    near(rate(1.5, true), 3200.0);
    // What was gathered for a reference that stands now is enough.
    near(rate(2.5, false), 300.0 * 10.0);
}

#[test]
fn a_push_is_due_when_as_much_is_missing_as_a_hop_is_long() {
    for way in [1.0, -1.0] {
        // Hops of 4, of which 2 are missing.
        let rate = |velocity: f32, acceleration: f32| {
            let mut controller = at(0.0, way * 1000.0);
            controller.hop.ended(way, [way, -way * 7.0], true);
            let r = reference(way * 2.0, way * velocity, way * acceleration);
            way * controller.break_away(&r, false, 0.0)
        };
        // Until then 2.5 frictions.
        near(rate(4.0, 0.0), 2000.0 * 4.0 / 2.0);
        // With the velocity half of 1.5/16 s later: 3 more.
        near(rate(4.0, 64.0), 2000.0 * 7.0 / 2.0);
        // At once, and no faster than three frictions per 1/16 s.
        near(rate(40.0, 0.0), 3.0 * 800.0 * 16.0);
        // A reference that turns back takes it back.
        near(rate(-4.0, 0.0), -2000.0 * 4.0 / 2.0);
    }
    near(due(0.0, 1.0, 16.0), 16.0);
    near(due(-1.0, 1.0, 16.0), 16.0);
    near(due(1.0, 0.0, 16.0), 0.0);
    near(due(1e-9, -1.0, 16.0), -2.5e9);
    assert!(due(f32::NAN, 1.0, 16.0) == 16.0 && due(1.0, f32::NAN, 16.0) == 16.0);
}

#[test]
fn a_hop_is_awaited_behind_a_reference_that_moves_its_way() {
    for way in [1.0, -1.0] {
        let mut controller = at(0.0, way * 800.0);
        controller.hop.ended(way, [way, -way * 7.0], true);
        let awaited = |controller: &Controller, error: f32, velocity: f32| {
            controller.awaited(&reference(way * error, way * velocity, 0.0))
        };
        // It slides.
        near(awaited(&controller, 2.0, 4.0), 0.0);
        while !controller.sticks() {
            let _ = controller.anchor.update(200.0, true);
        }
        near(awaited(&controller, 2.0, 4.0), 4.0);
        near(awaited(&controller, 2.0, 0.0), 0.0);
        // None the other way was seen.
        near(awaited(&controller, -2.0, 4.0), 0.0);
    }
}

#[test]
fn a_hop_is_due_when_its_reference_has_gone_what_is_left() {
    near(due(2.0, 0.4, 3.0), 0.5);
    for (left, speed) in [(0.1, 0.2), (0.0, 1.0), (0.0, -1.0), (-1.0, 1.0)] {
        near(due(left, speed, 3.0), 3.0);
    }
}

#[test]
fn a_reference_goes_no_farther_than_its_goal() {
    let mut held = at(0.0, 0.0);
    for way in [1.0, -1.0] {
        for (goal, velocity, ahead, expected) in [
            (None, 5.0, 7.0, 7.0),
            (Some(8.0), 5.0, 7.0, 7.0),
            (Some(3.0), 5.0, 7.0, 3.0),
            // Its deceleration would turn it back.
            (Some(3.0), 5.0, -2.0, 3.0),
            // It comes back to a goal that it leaves.
            (Some(-3.0), 5.0, 7.0, 7.0),
            (Some(0.0), 5.0, 7.0, 0.0),
        ] {
            let r = reference(2.0, way * velocity, 0.0);
            held.head_for(goal.map(|goal: f32| r.position + way * goal));
            assert_eq!(held.until_goal(&r, way * ahead), way * expected, "{goal:?}");
        }
    }
    // So a small step is none where what it leaves is within the window.
    let window = held.rest.window();
    let r = reference(0.5 * window, 100.0 * window, 0.0);
    held.head_for(None);
    assert!(held.break_away(&r, false, 0.0) > 0.0);
    held.head_for(Some(r.position + 0.4 * window));
    assert_eq!(held.break_away(&r, false, 0.0), 0.0);
}
