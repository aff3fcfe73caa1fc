//! The control law by numbers that are worked out by hand: 25 rad/s, a deflection of 1.28 that
//! friction holds, a bandwidth of 16.
//!
//! ```text
//! p0 = 16 25^2 = 10000   p1 = 25^2 + 1.2 25 16 = 1105   p2 = 16 + 1.2 25 = 46
//! k0 = p0                k2 = p2 - a2 = 26              k1 = p1 - a1 - a2 k2 = -40
//! ```

mod commands;

use super::*;
use crate::servo::control::tests::by_hand;
use crate::servo::model::Model;
use crate::servo::motion::Motion;

const MODEL: Model = Model {
    friction: 800.0,
    ..Model::linear(625.0, 20.0, 1e6)
};

/// A controller that sees the axis at 200 of 400 with a velocity and a drive.
fn seeing(model: Model, velocity: f32, drive: f32) -> Controller {
    let mut controller = by_hand::controller(model);
    let friction = model.friction * sign(velocity);
    let motion = Motion {
        position: 200.0,
        velocity,
        acceleration: drive - model.a2 * velocity - friction,
    };
    controller.estimator.place(motion, core::iter::empty());
    controller
}

pub(crate) fn at(velocity: f32, drive: f32) -> Controller {
    seeing(MODEL, velocity, drive)
}

/// A reference so far from the axis, with a velocity and an acceleration.
pub(crate) fn reference(error: f32, velocity: f32, acceleration: f32) -> Setpoint {
    Setpoint {
        position: 200.0 + error,
        velocity,
        acceleration,
        jerk: 0.0,
    }
}

pub(crate) fn near(found: f32, exact: f32) {
    let most = 2e-4 * exact.abs().max(1.0);
    assert!((found - exact).abs() < most, "{found}, not {exact}");
}

#[test]
fn friction_stops_a_slow_axis_near_its_target() {
    for way in [1.0, -1.0] {
        let rate = |velocity: f32, drive: f32, error: f32, at_rest: bool| {
            let controller = at(way * velocity, way * drive);
            way * controller.slide(&reference(way * error, 0.0, 0.0), at_rest, 0.0)
        };
        // v^2 / (2 error) less than friction, and a1 v that the velocity takes.
        near(
            rate(40.0, 300.0, 2.0, true),
            300.0 * (400.0 - 300.0) + 25_000.0,
        );
        // Less than 0.15 of it is left to friction; more than 3 of it are none.
        near(rate(10.0, 300.0, 2.0, true), 300.0 * 500.0 + 6250.0);
        near(rate(40.0, 300.0, 0.2, true), 300.0 * -1900.0 + 25_000.0);
        near(rate(40.0, 300.0, -1.0, true), 300.0 * -1900.0 + 25_000.0);
        // Of a velocity that may be none the sign is noise: 1.2 of friction towards the target,
        // less within the window, and as much of the other as it is of the largest at rest.
        near(rate(0.0, 300.0, 1.0, true), 300.0 * (960.0 - 300.0));
        near(rate(0.0, 300.0, -1.0, true), 300.0 * (-960.0 - 300.0));
        near(rate(0.0, 300.0, 0.03, true), 300.0 * (480.0 - 300.0));
        let standing = at(0.0, 0.0).standing();
        for (share, exact) in [(0.25, 920.0), (0.75, 840.0), (1.5, 800.0), (-1.5, 1600.0)] {
            let velocity = share * standing;
            near(
                rate(velocity, 300.0, 1.0, true),
                300.0 * (exact - 300.0) + 625.0 * velocity,
            );
        }
        // Too fast, too far, or behind a reference that moves: the feedback.
        let fed = |v: f32, e: f32| 10_000.0 * e + 40.0 * v - 26.0 * 300.0;
        near(rate(51.0, 300.0, 2.0, true), fed(51.0, 2.0));
        near(rate(40.0, 300.0, 4.0, true), fed(40.0, 4.0));
        near(rate(40.0, 300.0, 2.0, false), fed(40.0, 2.0));
    }
}

#[test]
fn an_axis_that_slides_is_led_by_its_reference_and_fed_back() {
    let mut controller = at(51.0, 300.0);
    controller.heading = 0.5;
    let r = Setpoint {
        jerk: 5000.0,
        ..reference(2.0, 30.0, 200.0)
    };
    let led = 5000.0 + 20.0 * 200.0 + 625.0 * 30.0 + 800.0 * 3.0;
    let drive = 26.0 * (200.0 + 20.0 * 30.0 + 0.5 * 800.0 - 300.0);
    let velocity = -40.0 * (30.0 - 51.0);
    near(
        controller.slide(&r, false, 3.0),
        led + drive + velocity + 20_000.0,
    );
    // An error is worked off at 0.3 of the largest speed, 1600.
    let far = Setpoint {
        position: 400.0,
        ..r
    };
    near(
        controller.slide(&far, false, 3.0),
        led + drive + velocity + 1105.0 * 0.3 * 1600.0,
    );
}

#[test]
fn the_direction_of_a_reference_is_foreseen_by_the_observer() {
    let mut controller = at(0.0, 0.0);
    // In 1/80 s it goes upward; half of that rate is the filter's.
    near(controller.head(&reference(0.0, -1.0, 100.0)), 40.0);
    near(controller.heading, 0.04);
    near(controller.head(&reference(0.0, 0.0, 0.0)), -1.6);
    near(controller.heading, 0.0384);
    near(
        controller.head(&reference(0.0, -1.0, 79.0)),
        40.0 * (-1.0 - 0.0384),
    );
}

#[test]
fn a_steady_motion_takes_its_damping_and_friction() {
    for velocity in [40.0, -3.0] {
        near(
            at(velocity, 0.0).steady(),
            20.0 * velocity + sign(velocity) * 800.0,
        );
    }
}

#[test]
fn friction_brakes_with_what_the_way_needs_up_to_three_of_it() {
    // v^2 / (2 distance) of a friction of 2: beyond 5, and 6 at most.
    for way in [1.0, -1.0] {
        for (square, need) in [(11.0_f32, 5.5), (13.0, 6.0), (0.5, 0.0), (0.7, 0.35)] {
            let velocity = way * libm::sqrtf(square);
            near(stopping_drive(way, velocity, 2.0), way * (2.0 - need));
        }
    }
}
