//! The parts of the controller, each on signals that are known.

pub(super) mod by_hand;
mod searched;
mod seen;
mod sticking;
mod tuned;

use super::friction::StickSlip;
use super::margins::Margins;
use super::null::NullOffset;
use super::poles::Poles;
use super::rest::{RestDesign, RestWindow};
use super::transfer::Transfer;
use crate::servo::model::Model;
use crate::servo::motion::Motion;

const MODEL: Model = Model {
    friction: 800.0,
    ..Model::linear(400.0, 20.0, 1e6)
};
const STEP: f32 = 1e-3;

#[test]
fn friction_sticks_where_the_velocity_turns_and_lets_go_at_the_breakaway() {
    for sign in [1.0, -1.0] {
        let mut friction = StickSlip::new(STEP, 800.0);
        assert!(friction.sticks(), "at rest");
        friction.place(sign);
        assert!(!friction.sticks());
        // As long as it goes the same way nothing happens.
        let moving = |velocity: f32, acceleration: f32| Motion {
            position: 0.0,
            velocity: sign * velocity,
            acceleration: sign * acceleration,
        };
        let mut motion = moving(1.0, -1000.0);
        friction.stop(&mut motion);
        assert_eq!(motion, moving(1.0, -1000.0));
        // It turns under a drive of acceleration + friction: 1.2 frictions hold it.
        for (drive, sticks) in [
            (950.0, true),
            (-950.0, true),
            (970.0, false),
            (-970.0, false),
        ] {
            let mut other = friction.clone();
            let mut motion = moving(-0.1, drive - 800.0);
            other.stop(&mut motion);
            assert_eq!(other.sticks(), sticks, "{drive}");
            if sticks {
                assert_eq!(motion, moving(0.0, 0.0));
            } else {
                // Friction is against the motion that begins.
                let expected = drive - 800.0 * f32::signum(drive);
                assert!(
                    (sign * motion.acceleration - expected).abs() < 1e-3,
                    "{drive}"
                );
                assert_eq!(motion.velocity, -0.1 * sign);
            }
        }
        // Held at a drive of 500 it lets go when that reaches 960.
        let mut motion = moving(-0.1, -300.0);
        friction.stop(&mut motion);
        let mut samples = 0;
        let acceleration = loop {
            samples += 1;
            if let Some(acceleration) = friction.hold(sign * 10_000.0) {
                break acceleration;
            }
        };
        assert!((46..=47).contains(&samples), "{samples}");
        assert!((sign * acceleration - (500.0 + 10.0 * samples as f32 - 800.0)).abs() < 0.1);
        assert!(!friction.sticks());
    }
    let mut none = StickSlip::new(STEP, 0.0);
    assert!(!none.sticks());
    let mut motion = Motion {
        velocity: -1.0,
        ..Motion::default()
    };
    none.place(1.0);
    none.stop(&mut motion);
    assert_eq!(motion.velocity, -1.0);
    none.retune(5.0);
    none.place(f32::NAN);
    assert!(none.sticks());
}

const WINDOW: RestDesign = RestDesign {
    least: 0.01,
    most: 0.1,
    sticky: true,
};

#[test]
fn a_window_rests_the_axis_and_narrows_with_a_stop_at_once() {
    let fresh = RestWindow::new(&WINDOW);
    assert_eq!((fresh.window(), fresh.rests()), (0.01, false));
    // It rests where it stands within the window, and goes on where it leaves 1.3 of it.
    let mut window = fresh.clone();
    window.update(0.011, true);
    assert!(!window.rests());
    window.update(-0.0099, false);
    assert!(!window.rests(), "it moves");
    window.update(-0.0099, true);
    assert!(window.rests() && window.window() == 0.01);
    window.update(0.0129, true);
    assert!(window.rests());
    window.update(-0.0131, true);
    assert!(!window.rests());
    assert_eq!(window.window(), 0.01, "a slip from the rest is no hunt");
    // A stop at the first attempt narrows it by a fifth, but not below where it stands.
    window.overshot(0.05);
    window.overshot(0.05);
    window.wake();
    let mut wide = window.clone();
    wide.update(0.001, true);
    assert!((wide.window() - 0.8 * window.window()).abs() < 1e-6 && wide.rests());
    let mut held = window.clone();
    held.update(0.015, true);
    assert!((held.window() - 0.015).abs() < 1e-7);
    // Neither a stop behind a slip from the rest narrows it nor one behind a hunt.
    let before = wide.window();
    wide.update(0.05, true);
    wide.update(0.001, true);
    assert_eq!((wide.window(), wide.rests()), (before, true));
    window.overshot(0.05);
    let before = window.window();
    window.update(0.001, true);
    assert_eq!((window.window(), window.rests()), (before, true));
}

#[test]
fn a_window_widens_with_each_hunt() {
    // From one side beyond it to the other: the overshoot of an approach, then hunts.
    let mut window = RestWindow::new(&WINDOW);
    for (error, hunts) in [
        (0.02, 0),
        (0.03, 0),
        (-0.02, 0),
        (-0.02, 0),
        (0.02, 1),
        (-0.02, 2),
        (0.0, 2),
    ] {
        window.update(error, false);
        let expected = 0.01 * f32::powi(1.25, hunts);
        assert!(
            (window.window() - expected).abs() < 1e-6,
            "{error}: {}",
            window.window()
        );
    }
    // An axis that friction cannot hold has no other end of its approach.
    let mut free = RestWindow::new(&RestDesign {
        sticky: false,
        ..WINDOW
    });
    free.update(0.02, false);
    free.update(-0.02, false);
    assert!((free.window() - 0.0125).abs() < 1e-7);
    // Neither has it one in the next motion, where an axis that friction holds has.
    for (other, hunts) in [(&mut free, 2), (&mut window.clone(), 2)] {
        other.wake();
        other.update(0.02, false);
        other.update(-0.02, false);
        let expected = 0.01 * f32::powi(1.25, hunts);
        assert!((other.window() - expected).abs() < 1e-6);
    }
    // A reference that moves and an axis that stands begin anew; the window is kept.
    for stands in [false, true] {
        for error in [0.02, -0.02, 0.02, -0.02] {
            if stands {
                window.update(error, true);
            } else {
                window.wake();
            }
            window.update(error, false);
        }
    }
    assert!((window.window() - 0.01 * 1.25 * 1.25).abs() < 1e-6);
}

#[test]
fn a_hop_past_the_target_is_a_hunt_within_the_limits_of_the_window() {
    let mut hopped = RestWindow::new(&WINDOW);
    // A hop past the target is a hunt where it is beyond the window.
    hopped.overshot(0.009);
    assert_eq!(hopped.window(), 0.01);
    hopped.overshot(-0.011);
    assert!((hopped.window() - 0.0125).abs() < 1e-7);
    assert!(hopped.can_widen());
    for _ in 0..50 {
        hopped.overshot(1.0);
    }
    assert!(!hopped.can_widen());
    assert_eq!(hopped.window(), 0.1);
    // With another model half of it is kept, and never less than the least.
    let mut forgotten = hopped.clone();
    for kept in [0.05, 0.025, 0.0125, 0.01] {
        forgotten.forget();
        assert_eq!(forgotten.window(), kept);
    }
    hopped.redesign(&RestDesign {
        most: 0.05,
        ..WINDOW
    });
    assert_eq!(hopped.window(), 0.05);
    hopped.redesign(&RestDesign {
        least: 0.2,
        most: 0.3,
        sticky: true,
    });
    assert_eq!(hopped.window(), 0.2);
}

#[test]
fn an_offset_is_half_of_what_both_ways_show() {
    // A dead zone that is wrong by 0.03, an offset that is wrong by 0.02.
    let mut null = NullOffset::default();
    let share = 0.01;
    let mut given = 0.0;
    for k in 0..40_000 {
        let flow = if k % 100 < 50 { 0.2 } else { -0.2 };
        let way = if flow > 0.0 { -0.03 } else { 0.03 };
        let found = null.update(flow, 0.02 + way - null.value(), share);
        // Each way has to be seen for three times 1/wd: 300 samples of its own.
        assert!(k >= 549 || found.is_none(), "{k}");
        assert!(k < 650 || found.is_some(), "{k}");
        given += found.unwrap_or(0.0);
    }
    assert!((null.value() - 0.02).abs() < 2e-4, "{null:?}");
    assert!(
        (given - null.value()).abs() < 1e-5,
        "what it takes is what it gives"
    );
    // With the time constant of a third of wd.
    let mut quick = NullOffset::default();
    let mut samples = 0;
    while quick.value() < 0.02 * (1.0 - libm::expf(-1.0)) {
        let flow = if samples % 100 < 50 { 0.2 } else { -0.2 };
        let _ = quick.update(flow, 0.02 - quick.value(), share);
        samples += 1;
    }
    let time = (samples - 600) as f32 * share;
    assert!((time - 1.0 / 0.3).abs() < 0.8, "{time}");
    // A large flow shows nothing, and no more than 0.08 is believed.
    assert_eq!(NullOffset::default().update(0.51, 1.0, 10.0), None);
    let mut much = NullOffset::default();
    for k in 0..100_000 {
        let flow = if k % 2 == 0 { 0.5 } else { -0.5 };
        let _ = much.update(flow, -1.0, share);
    }
    assert_eq!(much.value(), -0.08);
}

#[test]
fn a_change_of_gains_fades_and_takes_no_step() {
    let mut transfer = Transfer::default();
    assert!(transfer.take().is_none());
    let poles = Poles {
        bandwidth: 20.0,
        damping: 0.8,
        observer: 60.0,
        disturbance: 6.0,
    };
    transfer.model(MODEL);
    transfer.poles(poles, Some(Margins::NONE));
    transfer.factor(0.7);
    let arrived = transfer.take().expect("a change");
    assert_eq!((arrived.model, arrived.factor), (Some(MODEL), Some(0.7)));
    assert_eq!(arrived.poles, Some((poles, Some(Margins::NONE))));
    assert!(transfer.take().is_none(), "once");
    for part in 0..3 {
        match part {
            0 => transfer.model(MODEL),
            1 => transfer.poles(poles, None),
            _ => transfer.factor(0.5),
        }
        assert!(transfer.take().is_some(), "{part}");
    }
    transfer.model(MODEL);
    transfer.forget_model();
    assert!(transfer.take().is_none());
    // The command is that of before, within the full one, and the difference fades.
    assert_eq!(transfer.keep(0.5, 0.2), 0.5);
    assert!((transfer.fade(0.1, 1.0) - 0.27).abs() < 1e-6);
    assert!((transfer.fade(0.1, 0.01) - 0.26).abs() < 1e-6);
    assert_eq!(transfer.keep(1.7, 0.4), 1.0);
    assert_eq!(transfer.keep(-1.7, 0.4), -1.0);
    assert!((transfer.fade(0.5, 0.01) + 1.39).abs() < 1e-6);
    transfer.settle();
    assert_eq!(transfer.fade(0.5, 1.0), 0.0);
}
