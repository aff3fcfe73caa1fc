//! An axis that sticks, hops and slides, by the positions that are measured.

use super::*;
use crate::servo::Config;
use crate::servo::control::tests::by_hand;
use crate::servo::motion::{Setpoint, Travel};

#[test]
fn another_model_begins_without_the_offset_learned_beyond_the_one_before() {
    let travel = Travel {
        min: -200.0,
        max: 200.0,
    };
    let Ok(design) = Config::new(0.001, 20.0, travel).resolve() else {
        panic!("a setting is refused");
    };
    let model = Model::linear(400.0, 20.0, 1.0e6);
    let mut controller = Controller::new(&design, model);
    for k in 0..20_000 {
        let flow = if k % 200 < 100 { 0.2 } else { -0.2 };
        let left = 0.02 - controller.null.value();
        let _ = controller.null.update(flow, left, 0.01);
    }
    assert!((controller.null.value() - 0.02).abs() < 1e-3);
    let learned = Model {
        offset: 0.02,
        ..model
    };
    controller.begin(learned, Motion::default(), core::iter::repeat(0.0));
    assert_eq!(controller.null.value(), 0.0);
}

const MODEL: Model = Model {
    friction: 800.0,
    offset: 0.01,
    ..Model::linear(625.0, 20.0, 1e6)
};

/// A controller that stands at 200 of 400.
fn standing(model: Model) -> Controller {
    let mut controller = by_hand::controller(model);
    controller.place(Motion::at(200.0));
    controller
}

/// Measures a place until friction holds the axis there.
fn measure(controller: &mut Controller, y: f32, reference: f32) {
    controller.observe(y, reference, true);
    for _ in 0..2000 {
        if controller.sticks() {
            return;
        }
        controller.observe(y, reference, true);
        controller.estimator.applied(0.0);
    }
    panic!("it does not stick at {y}: {:?}", controller.motion());
}

#[test]
fn a_hop_past_a_reference_that_went_less_far_is_a_hunt_and_has_its_length() {
    for way in [1.0, -1.0] {
        // From 3 in front of the reference to 5 farther, while the reference goes so far.
        for (gone, still) in [
            (0.0, true),
            (0.5, true),
            (2.4, true),
            (2.6, false),
            (3.5, false),
        ] {
            let mut controller = standing(MODEL);
            measure(&mut controller, 200.0, 200.0 + way * 3.0);
            assert_eq!(controller.left[0], 0.0, "nothing is left of the stop");
            controller.hop = Hop::default();
            controller.observe(200.0 + way * 0.002, 200.0 + way * 3.0, true);
            assert!(!controller.sticks());
            let before = controller.left[0];
            assert!((before - way * 2.998).abs() < 1e-4, "{before}");
            measure(
                &mut controller,
                200.0 + way * 5.0,
                200.0 + way * (3.0 + gone),
            );
            let after = way * (gone - 2.0);
            let mut hop = Hop::default();
            hop.ended(way, [before, after], still);
            assert_eq!(controller.hop, hop, "{gone}");
            assert_eq!(controller.left[0], 0.0);
            // Beyond the reference, and not carried along by it.
            let hunts = still && way * after < 0.0;
            let window = if hunts { 0.0625 } else { 0.05 };
            assert!((controller.rest.window() - window).abs() < 1e-6, "{gone}");
        }
    }
}

#[test]
fn a_hop_behind_a_pause_of_the_reference_says_nothing_about_the_next() {
    // The hop of above behind a pause of no time, and of ten seconds.
    for (pause, learns) in [(0, true), (10_000, false)] {
        let mut controller = standing(MODEL);
        measure(&mut controller, 200.0, 203.0);
        controller.hop = Hop::default();
        controller.pause = pause;
        controller.observe(200.002, 203.0, true);
        measure(&mut controller, 205.0, 203.0);
        assert_eq!(controller.hop.length(1.0) > 0.0, learns, "{pause}");
        assert_eq!(controller.pause, 0);
    }
}

#[test]
fn a_slip_is_told_in_times_of_the_full_flow() {
    let mut controller = standing(MODEL);
    let motion = Motion {
        acceleration: 500.0,
        ..Motion::at(200.0)
    };
    controller.estimator.place(motion, core::iter::empty());
    for flow in [0.2, -0.2].into_iter().cycle().take(12) {
        let _ = controller.null.update(flow, 0.02, 1.0);
    }
    let null = controller.null.value();
    let down = controller.slip(-1.0);
    let Edges { middle, dead_zone } = controller.edges();
    assert_eq!((down.direction, dead_zone), (-1.0, 0.0));
    // From a drive of 500 to the edges of a friction of 800.
    assert!((down.way - 1.3e-3).abs() < 1e-8, "{}", down.way);
    assert!((controller.slip(1.0).way - 3e-4).abs() < 1e-8);
    // 30 time constants of the observer, behind the delay.
    assert!((down.settled - 0.375).abs() < 1e-5, "{down:?}");
    controller.design.delay = 0.1;
    assert!((controller.slip(1.0).settled - 0.475).abs() < 1e-5);
    assert!(null > 0.01 && (middle + 0.01 + null).abs() < 1e-7);
}

#[test]
fn time_at_rest_is_counted_while_friction_holds_and_the_valve_rests() {
    for (sticks, rests) in [(true, true), (true, false), (false, true), (false, false)] {
        let mut controller = standing(MODEL);
        if sticks {
            measure(&mut controller, 200.0, 200.0);
        }
        if rests {
            controller.rest.update(0.0, true);
        }
        for _ in 0..3 {
            controller.observe(200.0, 200.0, true);
        }
        let (slip, valve) = (controller.slip(1.0), controller.edges());
        controller.holding.slip(&slip, &valve);
        assert_eq!(controller.holding.has_slipped(), sticks && rests);
    }
}

#[test]
fn what_the_offset_learns_is_taken_from_the_disturbance() {
    let mut controller = standing(Model::linear(625.0, 20.0, 1e6));
    controller.estimator.disturb(0.03);
    for k in 0..1500 {
        controller
            .estimator
            .applied(if k % 2 == 0 { 0.2 } else { -0.2 });
        controller.learn_null();
        let sum = controller.disturbance() + controller.null.value();
        assert!((sum - 0.03).abs() < 1e-5, "{k}: {sum}");
    }
    assert!(
        controller.null.value() > 3e-3,
        "{}",
        controller.null.value()
    );
    // Within the blend of the dead zone a flow shows nothing.
    let mut controller = standing(Model::linear(625.0, 20.0, 1e6));
    controller.estimator.disturb(0.03);
    let least = 0.9 * controller.design.blend;
    for k in 0..1500 {
        controller
            .estimator
            .applied(if k % 2 == 0 { least } else { -least });
        controller.learn_null();
    }
    assert_eq!(controller.null.value(), 0.0);
}

#[test]
fn an_observer_settles_within_six_of_its_time_constants() {
    // Of 12.5 ms each.
    let samples = standing(MODEL).settling();
    assert!((75..=76).contains(&samples), "{samples}");
}

#[test]
fn the_window_follows_from_friction_or_from_the_valve() {
    let most = |model: Model| {
        let mut controller = standing(model);
        for _ in 0..60 {
            controller.rest.overshot(1e9);
        }
        controller.rest.window()
    };
    let near = |found: f32, exact: f32| assert!((found / exact - 1.0).abs() < 1e-4, "{found}");
    // The deflection of 1.28 where the dead zone has room, a fifth of it where it has none.
    let wide = Model {
        dead_zone: 0.02,
        ..MODEL
    };
    near(most(wide), 1.28);
    near(most(MODEL), 0.256);
    for (dead_zone, window) in [(0.0055, 1.28), (0.0045, 0.256)] {
        near(most(Model { dead_zone, ..MODEL }), window);
    }
    // 2 (0.3 0.02 + 0.2 0.01) b0 / (a1 wc).
    let free = Model {
        friction: 0.0,
        ..wide
    };
    near(most(free), 1.6);
    // A friction that the sensor does not see is none: from 10 codes and noises on it holds.
    assert!(
        standing(Model {
            friction: 2.6,
            ..MODEL
        })
        .rest
        .sticky()
    );
    assert!(
        !standing(Model {
            friction: 2.4,
            ..MODEL
        })
        .rest
        .sticky()
    );
}

#[test]
fn a_place_is_no_longer_held_once_nothing_can_hold_it() {
    let mut controller = standing(MODEL);
    measure(&mut controller, 200.0, 200.0);
    controller.tune(Model {
        friction: 700.0,
        ..MODEL
    });
    assert!(controller.sticks());
    controller.tune(Model {
        friction: 0.0,
        ..MODEL
    });
    assert!(!controller.sticks());
}

#[test]
fn a_valve_rests_within_the_window_and_the_disturbance_within_one_and_a_half() {
    for (error, rests, frozen) in [
        (0.045, true, true),
        (0.07, false, true),
        (0.08, false, false),
    ] {
        for way in [1.0, -1.0] {
            let mut controller = standing(MODEL);
            let target = Setpoint::at(200.0 + way * error);
            let _ = controller.update(&target, 200.0 + 3e-4);
            controller.applied(0.0);
            assert_eq!(controller.disturbance() == 0.0, frozen, "{error}");
            for _ in 0..100 {
                let _ = controller.update(&target, 200.0);
                controller.applied(0.0);
            }
            assert!(controller.sticks());
            assert_eq!(controller.rest.rests(), rests, "{error}");
        }
    }
}

#[test]
fn an_observer_follows_while_somebody_else_controls_and_control_begins_where_it_is() {
    let model = Model {
        friction: 0.0,
        offset: 0.0,
        ..MODEL
    };
    for way in [1.0, -1.0_f32] {
        let mut controller = standing(model);
        let slowest = controller.design.anchor.band * by_hand::POLES.observer;
        assert_eq!(controller.standing(), slowest);
        // 1e6 / 625 per unit of the command.
        let (speed, command) = (way * 30.0, way * 30.0 / 1600.0);
        for k in 0..2000 {
            controller.watch(200.0 + 1e-3 * speed * k as f32, command);
        }
        let seen = controller.motion();
        assert!((seen.velocity / speed - 1.0).abs() < 0.01, "{seen:?}");
        assert!((seen.position - 200.0 - 1.999 * speed).abs() < 0.01);
        controller.heading = 0.0;
        controller.engage();
        assert_eq!(controller.heading, way);
    }
}
