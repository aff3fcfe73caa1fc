//! Axes that stay behind: codes, errors and expectations.

use super::*;
use crate::servo::monitoring::gaps::Gaps;

#[test]
fn a_code_that_stays_while_motion_is_expected_is_stuck() {
    let bounds = example::bounds(&MODEL);
    let design = monitoring();
    // Noise below a code: what can hold the axis back counts.
    let coarse = MonitoringDesign {
        noise: 0.0,
        ..design
    };
    let until = |monitor: &mut StuckCode, velocity: f32, swing: f32| {
        (1..100_000_u32).find(|_| monitor.update(true, velocity, swing, &bounds))
    };
    for (velocity, swing) in [(200.0_f32, 0.0_f32), (-200.0, 0.0), (200.0, 30.0)] {
        let mut monitor = StuckCode::new(&coarse);
        assert!(!monitor.update(false, velocity, 0.0, &bounds));
        let found = until(&mut monitor, velocity, swing).expect("stuck");
        let needed = |t: f32| {
            let stops = velocity.abs() * bounds.stuck.stopping;
            design.many_codes + bounds.stuck.held + t * bounds.drift + stops.max(swing)
        };
        let t = 0.001 * found as f32;
        assert!(
            200.0 * t > needed(t) - 0.3 && 200.0 * (t - 0.002) < needed(t),
            "{t}"
        );
        assert_eq!(monitor.run(), found);
        monitor.restart();
        assert_eq!(monitor.run(), 0);
    }
    // An expectation within the drift that a wrong flow may make is never enough.
    let mut monitor = StuckCode::new(&coarse);
    assert_eq!(until(&mut monitor, 0.9 * bounds.drift, 0.0), None);
    // Noise of more than a code changes it: runs of two are known, and eight of them are stuck.
    let fine = MonitoringDesign {
        noise: 0.02,
        ..design
    };
    let mut monitor = StuckCode::new(&fine);
    for k in 0..900 {
        assert!(!monitor.update(k % 3 != 0, 5.0, 0.0, &bounds));
    }
    let found = until(&mut monitor, 200.0, 0.0).expect("stuck");
    let run = found + 2;
    let enough = (design.many_codes / 0.2) as u32;
    let least = design.least_run.max(16).max(enough);
    assert!((least..least + 5).contains(&run), "{run} of {least}");
    // Before its runs are known it is as one without noise.
    let mut monitor = StuckCode::new(&fine);
    for k in 0..300 {
        assert!(!monitor.update(k % 3 != 0, 5.0, 0.0, &bounds));
    }
    assert!(until(&mut monitor, 200.0, 0.0).is_some_and(|other| other > 2 * found));
}

#[test]
fn a_drive_of_the_model_shows_what_it_is_commanded() {
    let model = Model {
        dead_zone: 0.0,
        friction: 0.0,
        a2: 12.0,
        ..MODEL
    };
    let bounds = example::bounds(&model);
    let (mut motion, mut response) = (Motion::default(), Response::default());
    let mut shown = 0.0_f32;
    for k in 0..4000 {
        let flow = 0.2 * libm::sinf(0.01 * k as f32);
        model.advance(&mut motion, flow, 1e-3);
        response.update(flow, motion.velocity, 1.0, &bounds);
        shown = shown.max(response.commanded().abs());
    }
    // Through w^2/(s + w)^2 at 10 rad/s: four fifths of C times 0.2.
    assert!((shown / (0.8 * 500.0) - 1.0).abs() < 0.03, "{shown}");
    // All of its energy is explained by itself, none by the opposite.
    assert!(!response.is_faint() && response.mirrored() < 0.05);
    // Nine tenths of it slower than commanded is too little; a quarter is none.
    for (share, faint) in [(0.15, true), (0.25, false)] {
        let (mut motion, mut response) = (Motion::default(), Response::default());
        for k in 0..4000 {
            let flow = 0.2 * libm::sinf(0.01 * k as f32);
            model.advance(&mut motion, share * flow, 1e-3);
            response.update(flow, motion.velocity, 1.0, &bounds);
        }
        assert_eq!(response.is_faint(), faint, "{share}");
    }
}

#[test]
fn the_expectation_is_that_of_the_drive_and_its_slack_that_of_its_commands() {
    let design = design();
    let observer = design.supervision.validation.observer;
    let model = Model {
        friction: 0.0,
        ..MODEL
    };
    let bounds = Bounds::new(&design.monitoring, &model);
    let mut twin = Twin::new(&design.monitoring, &observer, model);
    twin.tune(model, 20.0);
    twin.place(Motion::at(100.0), 0.0);
    let mut real = Motion::at(100.0);
    let delay = design.monitoring.delay_samples;
    assert!(delay > 0);
    let mut commands = [0.0; 64];
    let command = |k: usize| {
        if (k / 200).is_multiple_of(2) {
            0.3
        } else {
            -0.2
        }
    };
    for k in 0..3000 {
        // The command of so many samples ago takes effect now.
        let delayed = if k < delay { 0.0 } else { command(k - delay) };
        commands.rotate_right(1);
        commands[0] = delayed;
        model.advance(&mut real, model.valve_flow(delayed), 1e-3);
        twin.update(real.position, command(k), &bounds);
        assert!((twin.velocity() - real.velocity).abs() < 1.0, "{k}");
        assert!(
            (twin.flow() - model.valve_flow(delayed)).abs() < 1e-6,
            "{k}"
        );
        // Both through the same high-pass: a sound axis is within the slack, far within.
        let apart = (twin.expected() - twin.measured()).abs();
        assert!(apart < 0.2 * twin.slack(&bounds), "{k}: {apart}");
    }
    assert!(twin.measured().abs() > 10.0);
    // A change of the command that takes effect half a delay sooner or later.
    let quiet = twin.slack(&bounds);
    twin.update(real.position, command(2999) + 0.5, &bounds);
    let late = 0.5 * design.monitoring.delay + 1e-3;
    let added = twin.slack(&bounds) - quiet * (1.0 - bounds.share) - bounds.share * bounds.slack;
    assert!(
        (added / (2500.0 * late * 0.5) - 1.0).abs() < 0.02,
        "{added}"
    );
    // Placed anew it expects nothing.
    twin.place(Motion::at(7.0), 0.1);
    assert_eq!((twin.expected(), twin.measured()), (0.0, 0.0));
    assert!((twin.slack(&bounds) - bounds.slack).abs() < 1e-6);
}

#[test]
fn a_full_command_ends_within_the_time_of_its_travel() {
    let bounds = example::bounds(&MODEL);
    for side in [1.0, -1.0] {
        let mut saturation = Saturation::default();
        let found = (0..).position(|_| saturation.update(side * 0.98, 0.98, &bounds));
        assert_eq!(found, Some(bounds.saturated as usize + 1));
        assert!(saturation.is_full());
        // The other way, or a little less, begins anew.
        assert!(!saturation.update(-side, 0.98, &bounds) && saturation.is_full());
        assert!(!saturation.update(side, 0.98, &bounds));
        assert!(!saturation.update(side * 0.97, 0.98, &bounds) && !saturation.is_full());
        let again = (0..).position(|_| saturation.update(side * 0.98, 0.98, &bounds));
        assert_eq!(again, found);
    }
}

#[test]
fn more_than_half_of_the_readings_may_not_be_missing() {
    let design = monitoring();
    let last = |pattern: fn(u32) -> bool| {
        let mut gaps = Gaps::new(&design);
        (0..5000).any(|k| gaps.update(pattern(k)))
    };
    assert!(!last(|k| k % 5 < 2) && !last(|k| k % 10 < 4));
    assert!(last(|k| k % 3 != 0) && last(|_| true));
    // Begun again it knows of none; and half of all are missing after 0.69 of its time.
    let mut gaps = Gaps::new(&design);
    let first = (0..).position(|_| gaps.update(true)).unwrap_or(0) as f32;
    let time = 1.0 / design.gap_share;
    assert!(
        (first / (core::f32::consts::LN_2 * time) - 1.0).abs() < 0.05,
        "{first}"
    );
    gaps.restart();
    let again = (0..).position(|_| gaps.update(true)).unwrap_or(0) as f32;
    assert_eq!(again, first);
}
