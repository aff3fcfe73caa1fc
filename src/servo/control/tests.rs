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
