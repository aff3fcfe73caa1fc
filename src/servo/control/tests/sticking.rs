//! Places that friction holds, what makes the axis slip from them, and how stiff it is there.

use super::*;
use crate::servo::control::anchor::{Anchor, Hold};
use crate::servo::control::holding::Holding;
use crate::servo::control::place::{Place, dead_volume as volume_of, stiffening};
use crate::servo::design::AnchorDesign;
use crate::servo::motion::Travel;

const TRAVEL: Travel = Travel {
    min: 0.0,
    max: 400.0,
};

/// An anchor with a band of 0.01, tuned to an observer.
fn anchor(observer: f32) -> Anchor {
    let mut anchor = Anchor::new(&AnchorDesign {
        band: 0.01,
        time: 0.0,
        sample_time: STEP,
    });
    anchor.tune(observer);
    anchor
}

#[test]
#[cfg_attr(miri, ignore = "many samples")]
fn a_place_is_held_after_five_times_of_the_observer_and_left_with_the_mean_of_the_latest() {
    for (observer, time) in [(100.0, 0.05), (2000.0, 0.006)] {
        let mut fresh = anchor(observer);
        let mut samples = 0;
        while fresh.update(5.0, true) != Hold::Stuck {
            assert!(!fresh.holds());
            samples += 1;
        }
        assert!((samples as f32 * STEP - time).abs() < 1.5e-3, "{samples}");
        assert!(fresh.holds() && fresh.since() == 0);
        assert_eq!(fresh.update(5.0, false), Hold::Sticking);
        assert_eq!(fresh.since(), 1);
        for direction in [1.0, -1.0] {
            // One sample beyond the band.
            let mut other = fresh.clone();
            assert_eq!(
                other.update(5.0 + 0.011 * direction, true),
                Hold::Left(direction)
            );
            assert_eq!((other.holds(), other.since()), (false, 0));
            // Where its place is known for good,
            // half of the band in the mean of the latest: 0.3, 0.51, 0.657 of 0.008.
            if samples < 40 {
                continue;
            }
            let mut other = fresh.clone();
            let found: [Hold; 3] =
                core::array::from_fn(|_| other.update(5.0 + 0.008 * direction, true));
            assert_eq!(
                found,
                [Hold::Sticking, Hold::Sticking, Hold::Left(direction)]
            );
        }
    }
    // Not while the observer sees a velocity, and anew with each place.
    let mut moving = anchor(100.0);
    for k in 0..500 {
        assert_eq!(moving.update(0.011 * k as f32, true), Hold::Sliding);
        assert_eq!(moving.since(), k + 1);
    }
    let mut slides = anchor(100.0);
    for _ in 0..500 {
        assert_eq!(slides.update(5.0, false), Hold::Sliding);
    }
    assert_eq!(slides.update(5.0, true), Hold::Stuck);
    slides.restart();
    assert!(!slides.holds() && slides.since() == 0);
    assert_eq!(slides.update(5.0, true), Hold::Sliding);
}

#[test]
#[cfg_attr(miri, ignore = "many samples")]
fn a_place_is_the_mean_of_its_first_forty_samples() {
    let mut anchor = anchor(100.0);
    let noise = |k: u32| 0.002 * if k.is_multiple_of(3) { 2.0 } else { -1.0 };
    let mut sum = 0.0;
    for k in 0..200 {
        let y = 1000.0 + noise(k);
        let _ = anchor.update(y, true);
        if k < 40 {
            sum += y - 1000.0;
            let mean = 1000.0 + sum / (k + 1) as f32;
            assert!((anchor.place() - mean).abs() < 1.3e-4, "{k}");
        } else {
            assert!((anchor.place() - 1000.0 - sum / 40.0).abs() < 1.3e-4, "{k}");
        }
    }
}

#[test]
#[cfg_attr(miri, ignore = "many samples")]
fn a_slip_tells_a_flow_by_its_time_and_its_direction() {
    let mut holding = Holding::NONE;
    holding.slip(1.0, 0.01);
    assert!(
        !holding.has_slipped() && holding.flow() == 0.0,
        "it was not held"
    );
    let held = |holding: &mut Holding, seconds: f32| {
        for _ in 0..(seconds / STEP) as u32 {
            holding.pass(STEP, true);
        }
    };
    // 0.004/s over 10 s of it: 4e-4, half as much again as the first trust of a half.
    held(&mut holding, 10.0);
    holding.slip(1.0, 0.004);
    assert!((holding.flow() + 0.75 * 4e-4).abs() < 2e-6, "{holding:?}");
    // Again the same way: half as much again; the other way: half.
    held(&mut holding, 10.0);
    holding.slip(1.0, 0.004);
    assert!((holding.flow() + (0.75 + 1.125) * 4e-4).abs() < 4e-6);
    held(&mut holding, 10.0);
    holding.slip(-1.0, 0.004);
    let left = (0.75 + 1.125 - 0.5625) * 4e-4;
    assert!((holding.flow() + left).abs() < 6e-6);
    // A wake in between begins its time anew; an early slip shows 0.002 at most.
    held(&mut holding, 10.0);
    holding.pass(STEP, false);
    held(&mut holding, 0.1);
    holding.slip(-1.0, 0.004);
    assert!(
        (holding.flow() + left - 0.5625 * 1.5 * 0.002).abs() < 1e-5,
        "{holding:?}"
    );
    // No trust beyond four, none below a tenth, no flow beyond 0.05.
    for _ in 0..100 {
        held(&mut holding, 0.1);
        holding.slip(-1.0, 0.004);
    }
    assert_eq!(holding.flow(), 0.05);
    let before = holding.flow();
    held(&mut holding, 0.1);
    holding.slip(1.0, 0.004);
    assert!(
        (before - holding.flow() - 2.0 * 0.002).abs() < 1e-6,
        "half of four"
    );
    for k in 0..20 {
        held(&mut holding, 0.1);
        holding.slip(if k % 2 == 0 { -1.0 } else { 1.0 }, 0.004);
    }
    let before = holding.flow();
    held(&mut holding, 0.1);
    holding.slip(-1.0, 0.004);
    assert!(
        (holding.flow() - before - 0.1 * 0.002).abs() < 1e-6,
        "a tenth"
    );
}

#[test]
#[cfg_attr(miri, ignore = "many samples")]
fn a_place_is_as_stiff_as_its_chambers_are_short() {
    for dead_volume in [0.06_f32, 0.3] {
        let mut place = Place::new(TRAVEL, dead_volume);
        for share in [0.05, 0.3, 0.5, 0.8, 1.0_f32] {
            place.jump(400.0 * share);
            let [one, other] = [dead_volume + share, dead_volume + 1.0 - share];
            let exact = 0.5 * (dead_volume + 0.5) * (1.0 / one + 1.0 / other);
            assert!((place.stiffness() / exact - 1.0).abs() < 1e-4, "{share}");
            assert!(
                (place.frequency() / libm::sqrtf(exact) - 1.0).abs() < 1e-4,
                "{share}"
            );
            // Step by step the root follows.
            for _ in 0..5 {
                place.go(400.0 * share + 1.0);
            }
            let root = libm::sqrtf(place.stiffness());
            assert!((place.frequency() / root - 1.0).abs() < 1e-5);
        }
        // Beyond an end it is as stiff as there.
        place.jump(400.0);
        let end = place.stiffness();
        place.jump(500.0);
        assert_eq!(place.stiffness(), end);
        let e = stiffening(dead_volume);
        let back = volume_of(e);
        assert!((back - dead_volume).abs() < 1e-5);
    }
    assert_eq!(volume_of(0.0), f32::INFINITY);
}
