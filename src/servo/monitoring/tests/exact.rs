//! Monitors at their limits.

use super::*;
use crate::servo::monitoring::gaps::Gaps;

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
        let found = places.map(|y| monitor.update(&Setpoint::at(0.0), way * y));
        assert_eq!(
            found,
            [false, false, false, false, false, false, false, true]
        );
        // By less than the band it is none.
        let mut monitor = Oscillation::new(&design);
        for k in 0..40 {
            let y = [2.0, 2.9][k % 2];
            assert!(!monitor.update(&Setpoint::at(0.0), way * y));
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
