//! A controller that goes over to another model, and what it says of its friction.

use crate::servo::control::estimator::StateEstimator;
use crate::servo::control::tests::by_hand::{self, POLES};
use crate::servo::design::EstimatorDesign;
use crate::servo::model::Model;
use crate::servo::motion::{Motion, Travel};

#[test]
fn poles_follow_a_drive_that_is_slower_and_the_observer_one_that_is_faster() {
    // Found for 25 rad/s.
    let mut controller = by_hand::controller(Model::linear(625.0, 20.0, 1e6));
    for (w, poles) in [
        (12.5, [8.0, 40.0, 3.0]),
        (20.0, [12.8, 64.0, 4.8]),
        (25.0, [16.0, 80.0, 6.0]),
        (40.0, [16.0, 80.0, 6.0]),
        // An observer of 1.6 times the frequency, where the sampling allows it.
        (60.0, [16.0, 96.0, 6.0]),
        (250.0, [16.0, 300.0, 6.0]),
        (12.5, [8.0, 40.0, 3.0]),
    ] {
        controller.tune(Model::linear(w * w, 20.0, 1e6));
        let found = controller.estimator.poles();
        for (found, exact) in [found.bandwidth, found.observer, found.disturbance]
            .into_iter()
            .zip(poles)
        {
            assert!((found / exact - 1.0).abs() < 1e-4, "{w}: {found} {exact}");
        }
        assert_eq!(found.damping, POLES.damping);
        assert_eq!(controller.bandwidth(), found.bandwidth);
    }
}

#[test]
fn the_drive_of_an_axis_that_has_just_broken_away_is_unknown_for_four_observers() {
    let sticking = Model {
        friction: 800.0,
        ..Model::linear(625.0, 20.0, 1e6)
    };
    for (model, starts) in [(sticking, true), (Model::linear(625.0, 20.0, 1e6), false)] {
        let mut controller = by_hand::controller(model);
        // 4/80 s: 50 samples.
        for k in 0..60 {
            if !(49..=51).contains(&k) {
                assert_eq!(controller.starts(), starts && k < 50, "{k}");
            }
            let _ = controller.anchor.update(200.0, controller.anchor.holds());
        }
    }
}

#[test]
fn friction_takes_all_of_the_drive_at_rest_and_its_own_in_motion() {
    let model = Model {
        friction: 800.0,
        ..Model::linear(625.0, 20.0, 1e6)
    };
    for way in [1.0, -1.0] {
        let mut controller = by_hand::controller(model);
        for (velocity, drive, exact) in [(0.0, 500.0, 500.0), (40.0, 3000.0, 800.0)] {
            let friction = if velocity > 0.0 { 800.0 } else { 0.0 };
            let motion = Motion {
                position: 200.0,
                velocity: way * velocity,
                acceleration: way * (drive - 20.0 * velocity - friction),
            };
            controller.estimator.place(motion, core::iter::empty());
            controller.anchor.restart();
            for _ in 0..400 {
                let _ = controller.anchor.update(200.0, velocity == 0.0);
            }
            assert_eq!(controller.sticks(), velocity == 0.0);
            let found = way * controller.friction_force();
            assert!((found - exact).abs() < 0.01, "{way} {velocity}: {found}");
        }
    }
}

#[test]
fn a_drive_is_as_much_faster_off_the_middle_as_its_chambers_are_stiffer() {
    let model = Model::linear(625.0, 20.0, 1e6);
    let d = 0.06;
    let design = EstimatorDesign {
        sample_time: 1e-3,
        delay: 0,
        travel: Travel {
            min: 0.0,
            max: 400.0,
        },
        dead_volume: d,
        imbalance: 0.0,
    };
    let mut estimator = StateEstimator::new(&design, model, POLES);
    for share in [0.5, 0.8, 0.2, 0.0, 1.0] {
        estimator.place(Motion::at(400.0 * share), core::iter::empty());
        // Each chamber is a spring as stiff as it is short; both of half the travel are one.
        let springs = 1.0 / (d + share) + 1.0 / (d + 1.0 - share);
        let stiffer = springs * 0.5 * (d + 0.5);
        let faster = estimator.frequency_ratio();
        assert!(
            (faster * faster / stiffer - 1.0).abs() < 1e-4,
            "{share}: {faster}"
        );
        assert!(
            (estimator.step().a1 / (625.0 * stiffer) - 1.0).abs() < 1e-4,
            "{share}"
        );
    }
}
