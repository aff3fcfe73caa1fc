//! A controller that goes over to a model of another frequency.

use crate::servo::control::tests::by_hand::{self, POLES};
use crate::servo::model::Model;

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
