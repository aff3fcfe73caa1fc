//! Monitors at their limits.

use super::*;
use crate::servo::monitoring::gaps::Gaps;
use crate::servo::monitoring::monitors::{Alarm, Monitors, Seen};
use crate::servo::monitoring::obedience::{Conduct, Obedience};

#[test]
fn half_of_the_readings_may_be_missing() {
    let half = MonitoringDesign {
        gap_share: 0.5,
        ..monitoring()
    };
    let mut gaps = Gaps::new(&half);
    assert!(!gaps.update(true), "exactly a half");
    assert!(gaps.update(true));
}

#[test]
fn readings_that_fail_are_counted_and_most_of_them_are_too_many() {
    let observer = design().supervision.validation.observer;
    let mut monitors = Monitors::new(&monitoring(), &observer, MODEL);
    // Every other one may fail for ever; what is missing alone has not failed.
    for k in 0..200 {
        assert!(!monitors.count_reading(k % 2 == 0, k % 2 == 0));
    }
    assert_eq!(monitors.counters().failed_readings, 100);
    let many = (0..200).find(|_| monitors.count_reading(false, true));
    assert!(many.is_some_and(|many| many < 50), "{many:?}");
    assert_eq!(monitors.counters().failed_readings, 100);
}

#[test]
fn an_end_is_nearer_than_a_grain() {
    let monitor = TravelMonitor::new(TRAVEL);
    for (y, end) in [
        (0.25, true),
        (0.5, false),
        (200.0, false),
        (399.5, false),
        (399.75, true),
    ] {
        assert_eq!(monitor.is_end(y, 0.5), end, "{y}");
    }
}

#[test]
fn four_reversals_are_an_oscillation_whichever_way_it_begins() {
    let design = MonitoringDesign {
        cycle: 1.0,
        cycle_pause: 100,
        cycle_settling: 1,
        ..monitoring()
    };
    for way in [1.0, -1.0] {
        let mut monitor = Oscillation::new(&design);
        // Away in steps that are no reversals, then to and fro by more than the band.
        let places = [0.0, 2.0, 3.5, 5.0, 3.5, 5.0, 3.5, 5.0];
        let found = places.map(|y| monitor.update(&Setpoint::at(0.0), way * y, false));
        assert_eq!(
            found,
            [false, false, false, false, false, false, false, true]
        );
        // By less than the band it is none.
        let mut monitor = Oscillation::new(&design);
        for k in 0..40 {
            let y = [2.0, 2.9][k % 2];
            assert!(!monitor.update(&Setpoint::at(0.0), way * y, false));
        }
        // Nor where friction holds the axis at one of the ends and the window can widen.
        let mut monitor = Oscillation::new(&design);
        for k in 0..40 {
            let y = [0.0, 3.0][k % 2];
            assert!(!monitor.update(&Setpoint::at(0.0), way * y, k % 3 == 2));
        }
    }
}

#[test]
fn what_a_valve_was_moved_by_fades_within_a_window() {
    let bounds = Bounds::new(&monitoring(), &MODEL);
    let moved = |samples: u32| {
        let observer = &design().supervision.validation.observer;
        let mut twin = Twin::new(&monitoring(), observer, MODEL);
        twin.place(Motion::at(200.0), 0.0);
        let still = twin.slack(&bounds);
        for _ in 0..samples {
            twin.update(200.0, 0.1, &bounds);
        }
        twin.slack(&bounds) - still
    };
    let first = moved(1);
    assert!(first > 0.0);
    for samples in [2, 20, 200] {
        let exact = first * libm::powf(1.0 - bounds.share, (samples - 1) as f32);
        assert!((moved(samples) / exact - 1.0).abs() < 2e-2, "{samples}");
    }
}

#[test]
fn a_valve_is_open_by_itself_beyond_three_expectations_and_twice_the_slack() {
    let observer = &design().supervision.validation.observer;
    let model = Model::linear(400.0, 20.0, 1e6);
    let bounds = Bounds::new(&monitoring(), &model);
    let open = Conduct::Disobeys(Reason::ValveStuck);
    for command in [0.3_f32, -0.3] {
        // What a steady motion displaces within the window that forgets.
        let expected = 1e-3 * bounds.gain * command.abs() / bounds.share;
        for (share, found) in [(0.9, Conduct::Nothing), (1.1, open)] {
            let faster = 3.0 + share * 2.0 * bounds.slack / expected;
            let mut twin = Twin::new(&monitoring(), observer, model);
            twin.place(Motion::at(0.0), 0.0);
            let (mut obedience, mut y) = (Obedience::default(), 0.0);
            let ends = (0..3000).find_map(|_| {
                twin.update(y, command, &bounds);
                let velocity = faster * twin.velocity();
                y += 1e-3 * velocity;
                let found = obedience.update(&twin, velocity, false, &bounds);
                (found != Conduct::Nothing).then_some(found)
            });
            assert_eq!(ends.unwrap_or(Conduct::Nothing), found, "{command} {share}");
        }
    }
}

#[test]
fn a_motion_is_expected_to_be_as_much_quicker_one_way_as_the_drive_is() {
    let observer = &design().supervision.validation.observer;
    let model = Model::linear(400.0, 20.0, 1e6);
    let bounds = Bounds::new(&monitoring(), &model);
    for (imbalance, command, arrives) in [(0.2, 0.5, 0.4), (0.2, -0.5, -0.6), (0.0, -0.5, -0.5)] {
        let design = MonitoringDesign {
            imbalance,
            ..monitoring()
        };
        let mut twin = Twin::new(&design, observer, model);
        twin.place(Motion::at(0.0), 0.0);
        for _ in 0..2000 {
            twin.update(0.0, command, &bounds);
        }
        let [expected, flow] = [twin.velocity() / bounds.gain, twin.flow()];
        assert!((expected - arrives).abs() < 1e-3, "{command}: {expected}");
        assert!((flow - arrives).abs() < 1e-6, "{command}: {flow}");
    }
}

#[test]
fn an_axis_that_runs_towards_an_end_brakes_and_is_no_fault() {
    let observer = design().supervision.validation.observer;
    let alarm = |y: f32, velocity: f32| {
        let mut monitors = Monitors::new(&monitoring(), &observer, MODEL);
        let motion = Motion {
            velocity,
            ..Motion::at(y)
        };
        monitors.begin(MODEL, motion, 0.5);
        monitors.update(&Seen {
            setpoint: &Setpoint::at(200.0),
            y,
            velocity,
            command: 0.5,
            same_code: false,
            efforts: Efforts::default(),
            hunts: false,
        })
    };
    assert_eq!(alarm(398.0, 1000.0), Some(Alarm::Brake));
    assert_eq!(alarm(200.0, 1000.0), None);
    assert_eq!(alarm(398.0, 0.0), None);
}
