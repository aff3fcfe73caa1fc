//! From a rate of the drive to a command of the valve.

use super::*;
use crate::servo::control::holding::Slip;
use crate::servo::motion::Travel;

/// The valve of [`MODEL`] is open by its command, less an offset that was learned.
fn learned(controller: &mut Controller) -> f32 {
    for flow in [0.2, -0.2].into_iter().cycle().take(12) {
        let _ = controller.null.update(flow, 0.02, 1.0);
    }
    let value = controller.null.value();
    assert!(value > 0.01, "{value}");
    value
}

#[test]
fn a_command_is_the_flow_of_the_rate_without_disturbance_and_offset() {
    // Sliding: feedback alone, at 120 per s.
    let mut controller = at(120.0, 900.0);
    let null = learned(&mut controller);
    controller.estimator.disturb(0.05);
    controller.estimator.release(1.0, 200.0, 0.0);
    let r = reference(3.0, 0.0, 0.0);
    let rate = 30_000.0 + 40.0 * 120.0 - 26.0 * 900.0;
    near(controller.law(&r, true, 0.0), (rate - 0.05e6) / 1e6 - null);
    // Braking: the same without a reference, from where the observer is then.
    for way in [1.0, -1.0] {
        let mut controller = at(way * 120.0, way * 900.0);
        let null = learned(&mut controller);
        controller.estimator.disturb(0.05);
        let command = controller.brake(200.0);
        let state = *controller.estimator.ahead();
        let rate = 26.0 * (way * 800.0 - state.drive) + 40.0 * state.velocity;
        near(command, (rate - state.disturbance) / 1e6 - null);
        assert_eq!(state.disturbance, 0.05e6, "a brake learns nothing");
    }
    near(at(30_000.0, 900.0).brake(200.0), 1.0);
}

#[test]
fn an_axis_that_is_held_is_pushed_rests_or_is_centred() {
    let held = |drive: f32, rests: bool, slipped: bool| {
        let mut controller = at(0.0, drive);
        for _ in 0..100 {
            let _ = controller.anchor.update(200.0, true);
        }
        assert!(controller.sticks());
        if rests {
            controller.rest.update(0.0, true);
        }
        if slipped {
            controller.holding.pass(1e-3, true);
            let slip = Slip {
                direction: 1.0,
                way: 8e-4,
                settled: 10.0,
            };
            let valve = controller.edges();
            controller.holding.slip(&slip, &valve);
        }
        let null = learned(&mut controller);
        let r = reference(1.0, 0.0, 0.0);
        let command = controller.law(&r, true, 0.0) + null;
        // A brake finds it standing: the valve is in its middle.
        near(controller.brake(200.0), -null);
        command
    };
    near(held(600.0, false, false), 0.06);
    near(held(600.0, true, false), 0.0);
    near(held(600.0, true, true), -300.0 * 600.0 / 1e6);
    near(held(-600.0, true, true), 300.0 * 600.0 / 1e6);
    // The middle is wide: 0.6 of the friction.
    near(held(470.0, true, true), 0.0);
    near(held(490.0, true, true), -300.0 * 490.0 / 1e6);
}

#[test]
fn a_flow_is_bounded_by_the_room_in_front_of_it_or_by_what_the_reference_takes() {
    for way in [1.0, -1.0] {
        let bounded = |velocity: f32, drive: f32, flow: f32, r: &Setpoint| {
            let mut controller = at(way * velocity, way * drive);
            // 10 to the end in front of the axis, none behind it.
            let (min, max) = if way > 0.0 {
                (200.0, 210.0)
            } else {
                (190.0, 200.0)
            };
            controller.design.estimator.travel = Travel { min, max };
            way * controller.with_room(way * flow, r)
        };
        let rest = reference(0.0, 0.0, 0.0);
        // 0.7 (10 w - v - 2 a/w) over a speed of 1600; a is what the drive is beyond friction.
        near(bounded(0.0, 0.0, 0.5, &rest), 0.7 * 250.0 / 1600.0);
        near(
            bounded(0.0, 1425.0, 0.5, &rest),
            0.7 * (250.0 - 50.0) / 1600.0,
        );
        near(
            bounded(30.0, 1425.0, 0.5, &rest),
            0.7 * (250.0 - 32.0) / 1600.0,
        );
        near(bounded(0.0, 0.0, 0.1, &rest), 0.1);
        let r = Setpoint {
            jerk: way * 1000.0,
            ..reference(0.0, way * 300.0, way * 100.0)
        };
        near(bounded(0.0, 0.0, 0.5, &r), 0.1905);
        near(bounded(0.0, 0.0, 0.15, &r), 0.15);
        // Backwards there is no room.
        near(bounded(0.0, 0.0, -0.5, &rest), 0.0);
    }
}

#[test]
fn what_the_load_takes_is_added_to_a_command_and_missing_in_its_flow() {
    for way in [1.0, -1.0] {
        let mut controller = at(way * 120.0, way * 900.0);
        controller.heading = way;
        let r = reference(way * 3.0, way * 100.0, way * 500.0);
        let free = controller.law(&r, false, 0.0);
        controller.load.tune(625.0, 3.2, 400.0, 0.0);
        controller.bear(&r);
        // The reference takes 500 + 20 100 + 800 of the drive, by 0.75 3.2 / (625 400) each.
        let passes = 1.0 - 3300.0 * 9.6e-6;
        assert!(way * free > 0.0);
        near(controller.law(&r, false, 0.0), free / passes);
        controller.applied(way * 0.2);
        near(controller.flow_in_force(), way * 0.2 * passes);
        controller.applied(-way * 0.2);
        near(controller.flow_in_force(), -way * 0.2 * (2.0 - passes));
        // What brakes or is watched bears friction and damping; what is held bears nothing.
        let _ = controller.brake(200.0);
        let passes = 1.0 - controller.steady().abs() * 9.6e-6;
        near(controller.load.passes(way), passes);
        for _ in 0..100 {
            let _ = controller.anchor.update(200.0, true);
        }
        controller.bear(&r);
        assert_eq!(controller.load.passes(way), 1.0);
    }
}
