//! Gains against coefficients, and poles on a drive that has changed.
#![expect(
    clippy::disallowed_types,
    reason = "an oracle must be able to disagree"
)]

use super::*;
use crate::servo::control::oracle::{Dice, Oracle};

#[test]
fn gains_place_the_poles_of_loop_and_observer() {
    let mut dice = Dice(1);
    for k in 0..200 {
        let (drive, poles) = dice.pair();
        // The pair of the loop is at its bandwidth, or at the frequency of the drive where that is
        // higher.
        let frequency = if k % 2 == 0 {
            0.5 * poles.bandwidth
        } else {
            2.0 * poles.bandwidth
        };
        let [feedback, observer] = Oracle::new(&drive, &poles, frequency).gains();
        let found = poles.feedback(drive.a1, drive.a2, frequency);
        let near = |found: f32, exact: f64| {
            let error = (f64::from(found) - exact).abs();
            assert!(
                error < 2e-5 * (1.0 + exact.abs()),
                "{drive:?} {poles:?}: {found} {exact}"
            );
        };
        for (found, exact) in found.k.into_iter().zip(feedback) {
            near(found, exact);
        }
        let correction = poles.correction(drive.a1, drive.a2);
        for (found, exact) in correction.into_iter().zip(observer) {
            near(found, exact);
        }
        // (s + c)(s^2 + z w s + w^2) at s = -c and at s = j w.
        let [p0, p1, p2] = found.p.map(f64::from);
        let [c, z] = [poles.bandwidth, poles.damping].map(f64::from);
        let w = f64::from(frequency).max(c);
        let at = -c * c * c + p2 * c * c - p1 * c + p0;
        assert!(at.abs() < 1e-5 * p0.max(1.0));
        let real = p0 - p2 * w * w;
        let imaginary = w * (p1 - w * w);
        let factor = z * w * w;
        assert!((real + factor * w).abs() < 1e-4 * factor * w, "{real}");
        assert!(
            (imaginary - factor * c).abs() < 1e-4 * factor * c,
            "{imaginary}"
        );
    }
}

#[test]
fn a_slower_drive_takes_slower_poles_and_a_faster_one_a_faster_observer() {
    let poles = Poles {
        bandwidth: 20.0,
        damping: 0.8,
        observer: 60.0,
        disturbance: 6.0,
    };
    let slower = Poles {
        bandwidth: 10.0,
        observer: 30.0,
        disturbance: 3.0,
        ..poles
    };
    assert_eq!(poles.on(0.5, 10.0, 200.0), slower);
    assert_eq!(poles.on(1.0, 20.0, 200.0), poles);
    // 1.6 times the natural frequency, where that is more and the sampling allows it.
    let observer = |w0: f32, fastest: f32| poles.on(2.0, w0, fastest).observer;
    assert_eq!(observer(30.0, 200.0), 60.0);
    assert!((observer(50.0, 200.0) - 80.0).abs() < 1e-4);
    assert_eq!(observer(50.0, 70.0), 70.0);
    assert_eq!(observer(50.0, 40.0), 60.0);
    let derated = Poles {
        bandwidth: 5.0,
        disturbance: 1.5,
        ..poles
    };
    assert_eq!(poles.derated(0.25), derated);
}
