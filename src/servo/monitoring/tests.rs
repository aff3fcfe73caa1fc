//! The single monitors on motions that are known: what they bear, and what they notice.

mod behind;
mod closed;
mod exact;
mod lagging;
mod short;

use super::bounds::{Bounds, example};
use super::following::{Efforts, Following};
use super::oscillation::Oscillation;
use super::reading::{Credibility, Plausibility};
use super::response::Response;
use super::saturation::Saturation;
use super::stuck_code::StuckCode;
use super::travel::{End, TravelMonitor};
use super::twin::Twin;
use crate::servo::Config;
use crate::servo::design::{Design, MonitoringDesign};
use crate::servo::model::Model;
use crate::servo::motion::{Motion, Setpoint, Travel};
use crate::servo::supervision::state::Reason;

/// 20 rad/s, 2500 per s at the full command, dead zone and friction.
const MODEL: Model = Model {
    dead_zone: 0.02,
    friction: 800.0,
    ..Model::linear(400.0, 20.0, 1e6)
};
const TRAVEL: Travel = Travel {
    min: 0.0,
    max: 400.0,
};

fn design() -> Design {
    match Config::new(0.001, 20.0, TRAVEL).resolve() {
        Ok(design) => design,
        Err(error) => panic!("{error}"),
    }
}

fn monitoring() -> MonitoringDesign {
    design().monitoring.with_resolution(0.01)
}

#[test]
fn bounds_follow_from_the_model_in_its_own_time() {
    let design = monitoring();
    let slow = Bounds::new(&design, &MODEL);
    // Half the frequency with the same gain, damping and deflection: every time twice as long.
    let model = Model {
        friction: 200.0,
        dead_zone: 0.02,
        ..Model::linear(100.0, 10.0, 2.5e5)
    };
    let other = Bounds::new(&design, &model);
    assert_eq!((slow.gain, slow.frequency), (2500.0, 20.0));
    assert_eq!((other.gain, other.frequency), (2500.0, 10.0));
    let delay = design.delay;
    let twice = |a: f32, b: f32| assert!((b / a - 2.0).abs() < 3e-2, "{a} {b}");
    for (a, b) in [
        (slow.short.swing, other.short.swing),
        (slow.following.lag, other.following.lag),
        (slow.stuck.stopping, other.stuck.stopping),
        (1.0 / slow.share, 1.0 / other.share),
        (1.0 / slow.short.share, 1.0 / other.short.share),
        (1.0 / slow.response.share, 1.0 / other.response.share),
        (1.0 / slow.response.evidence, 1.0 / other.response.evidence),
        (1.0 / slow.stop.creep, 1.0 / other.stop.creep),
        (slow.end.half_inverse_brake, other.end.half_inverse_brake),
        (slow.end.reaction - delay, other.end.reaction - delay),
    ] {
        twice(a, b);
    }
    let samples = delay / 0.001;
    for (a, b) in [
        (slow.no_motion, other.no_motion),
        (slow.opposite, other.opposite),
        (slow.following.hundredths, other.following.hundredths),
        (slow.stop.braking, other.stop.braking),
    ] {
        twice(a as f32, b as f32);
    }
    for (a, b) in [
        (slow.stop.closing, other.stop.closing),
        (slow.end.braking, other.end.braking),
    ] {
        twice(a as f32 - samples, b as f32 - samples);
    }
    // A velocity of the same gain drifts and lacks as much; what it takes is in proportion.
    assert_eq!(
        (slow.drift, slow.response.lack, slow.end_speed),
        (other.drift, other.response.lack, other.end_speed)
    );
}

#[test]
fn bounds_are_those_of_their_time_constants_and_of_what_friction_holds() {
    let design = monitoring();
    let slow = Bounds::new(&design, &MODEL);
    let samples = design.delay / 0.001;
    // The filters of an interval: 1/(4 w), 1/w, 4/w; 8/w of the sums; 16/w of those that are
    // recent.
    assert!((slow.response.share - 0.02).abs() < 1e-3 && (slow.share - 0.005).abs() < 1e-4);
    assert!((slow.response.evidence - 0.04).abs() < 1e-3 && (slow.short.share - 0.08).abs() < 2e-3);
    // At a quarter of its speed all of the travel has passed.
    let saturated = 0.001 * slow.saturated as f32;
    assert!(
        (saturated - (4.0 * 400.0 / 2500.0 + 0.5)).abs() < 0.01,
        "{saturated}"
    );
    // A drive without friction has no deflection; one that is damped does not ring.
    let bare = Bounds::new(
        &design,
        &Model {
            friction: 0.0,
            ..MODEL
        },
    );
    let deflection = 2.0;
    assert!((slow.slack - bare.slack - 2.0 * deflection).abs() < 1e-3);
    assert!((slow.following.error - bare.following.error - 2.0 * deflection).abs() < 1e-3);
    assert!((slow.short.level - bare.short.level - 2.0 * deflection).abs() < 1e-3);
    assert!((bare.stuck.held - design.grain).abs() < 1e-6 && slow.stuck.held > bare.stuck.held);
    let damped = Bounds::new(&design, &Model { a2: 21.0, ..MODEL });
    assert_eq!((slow.short.ring, damped.short.ring), (0.0, 0.0));
    let light = Bounds::new(&design, &Model { a2: 4.0, ..MODEL });
    assert!((light.short.ring - 0.04).abs() < 1e-6 && (light.response.lack - 1.8).abs() < 1e-6);
    // Late by half of the delay and a sample.
    assert!((slow.short.late_rate - (0.5 * samples + 1.0)).abs() < 1e-4);
}

#[test]
fn an_axis_that_can_no_longer_stop_within_its_travel_brakes() {
    let bounds = example::bounds(&MODEL);
    let end = |y: f32, v: f32, command: f32, r: &Setpoint| {
        TravelMonitor::new(TRAVEL).update(y, v, command, r, &bounds)
    };
    let rest = Setpoint::at(200.0);
    for (side, end_at) in [(1.0, 400.0), (-1.0, 0.0)] {
        let v = 1000.0;
        // Its stopping distance: delay and force, then the full brake; the same for what an end
        // takes.
        let distance = |v: f32| v * bounds.end.reaction + v * v * bounds.end.half_inverse_brake;
        let needed = distance(v) - distance(bounds.end_speed);
        let at = |away: f32| end_at - side * (needed + away);
        assert_eq!(end(at(0.5), side * v, side, &rest), End::Free);
        assert_eq!(end(at(-0.5), side * v, side, &rest), End::Brake);
        // A loop that brakes already is left alone; one that goes inwards or slowly, too.
        assert_eq!(end(at(-0.5), side * v, -side, &rest), End::Free);
        assert_eq!(end(at(-0.5), -side * v, side, &rest), End::Free);
        assert_eq!(
            end(end_at, 0.99 * side * bounds.end_speed, side, &rest),
            End::Free
        );
        // Where the reference itself goes as far, a third faster, the axis follows it.
        let there = Setpoint {
            position: at(-0.5),
            velocity: side * v,
            ..rest
        };
        assert_eq!(end(at(-0.5), side * v, side, &there), End::Free);
        let slower = Setpoint {
            velocity: side * v * 0.5,
            ..there
        };
        assert_eq!(end(at(-0.5), side * v, side, &slower), End::Brake);
        // A brake that does not show is none.
        for (loses, lost) in [(0.0, true), (0.3, false)] {
            let mut monitor = TravelMonitor::new(TRAVEL);
            let mut found = End::Free;
            for k in 0..=bounds.end.braking {
                let speed = v * (1.0 - loses * k as f32 / bounds.end.braking as f32);
                found = monitor.update(end_at, side * speed, -side, &rest, &bounds);
                assert!(
                    k == bounds.end.braking || found == End::Free,
                    "{k}: {found:?}"
                );
            }
            assert_eq!(found == End::Lost, lost, "{loses}");
        }
    }
    let monitor = TravelMonitor::new(TRAVEL);
    for (y, is_end) in [(0.9, true), (1.1, false), (399.1, true), (398.9, false)] {
        assert_eq!(monitor.is_end(y, 1.0), is_end, "{y}");
    }
}

#[test]
fn four_reversals_beyond_the_band_within_their_pause_are_an_oscillation() {
    let design = monitoring();
    // Sines about a reference at rest: reversals up to the first notice.
    let noticed = |amplitude: f32, half: u32| {
        let mut monitor = Oscillation::new(&design);
        let found = (0..60 * half).find(|k| {
            let phase = core::f32::consts::PI * *k as f32 / half as f32;
            let y = 200.0 + amplitude * libm::sinf(phase);
            monitor.update(&Setpoint::at(200.0), y, false)
        });
        found.map(|k| (k.saturating_sub(design.cycle_settling)) / half)
    };
    let band = design.cycle;
    // From its middle an amplitude of the band begins to count.
    assert_eq!(noticed(0.9 * band, 50), None);
    assert!(noticed(1.05 * band, 50).is_some_and(|halves| (3..=6).contains(&halves)));
    assert!(noticed(5.0 * band, 300).is_some_and(|halves| (3..=6).contains(&halves)));
    assert_eq!(
        noticed(5.0 * band, design.cycle_pause + 50),
        None,
        "too slow"
    );
    // A reference that moves begins anew, and so does the count behind a notice.
    let mut monitor = Oscillation::new(&design);
    let moves = Setpoint {
        velocity: 1.0,
        ..Setpoint::at(200.0)
    };
    let mut notices = 0;
    for k in 0..20_000_u32 {
        let y = 200.0
            + if (k / 40).is_multiple_of(2) {
                band
            } else {
                -band
            };
        let r = if k < 10_000 {
            &Setpoint::at(200.0)
        } else {
            &moves
        };
        notices += u32::from(monitor.update(r, y, false));
    }
    let halves = (10_000 - design.cycle_settling) / 40;
    assert!(notices.abs_diff(halves / 4) <= 1, "{notices} of {halves}");
}

#[test]
fn a_reading_is_as_far_as_the_axis_can_have_moved() {
    let design = monitoring();
    let motion = Motion {
        position: 100.0,
        velocity: -200.0,
        acceleration: 0.0,
    };
    for (acceleration, missed) in [(0.0, 0), (1e4, 0), (1e4, 2)] {
        let mut readings = Plausibility::new(&design);
        readings.tune(acceleration);
        // 8 sigma, 3 codes, two slots; what the force does in the time and in the lag.
        let late = 0.001 * (missed as f32 + 3.0);
        let gate = 8.0 * design.noise
            + 0.03
            + 2.0 * 200.0 * 0.001
            + acceleration * (0.5 * late * late + design.tracking_lag);
        let next = 100.0 - 0.2;
        for side in [1.0, -1.0] {
            let classify = |share: f32| {
                let y = next + side * share * gate;
                readings.clone().classify(y, &motion, missed)
            };
            assert_eq!(classify(0.99), Credibility::Good, "{acceleration} {missed}");
            assert_eq!(
                classify(1.01),
                Credibility::Bridge,
                "{acceleration} {missed}"
            );
        }
    }
    // What is usual opens the gate by its own size: 1.25 of the mean residual is a deviation.
    let still = Motion::at(100.0);
    let mut readings = Plausibility::new(&design);
    readings.tune(0.0);
    let usual = 4.0 * design.noise;
    for k in 0..20_000 {
        let y = 100.0 + if k % 2 == 0 { usual } else { -usual };
        assert_eq!(readings.classify(y, &still, 0), Credibility::Good, "{k}");
    }
    let gate = 8.0 * 1.25 * usual + 0.03;
    for (share, found) in [(0.98, Credibility::Good), (1.02, Credibility::Bridge)] {
        let mut other = readings.clone();
        assert_eq!(other.classify(100.0 + share * gate, &still, 0), found);
    }
    // Those that last are a jump after as many as the design says.
    let mut found = Credibility::Good;
    for k in 1..=design.jump {
        found = readings.classify(300.0 + k as f32, &still, 0);
        assert_eq!(found == Credibility::Bridge, k < design.jump, "{k}");
    }
    assert_eq!(found, Credibility::Lasting(Reason::Implausible));
}
