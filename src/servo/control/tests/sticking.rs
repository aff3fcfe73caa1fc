//! Places that friction holds, what makes the axis slip from them, and how stiff it is there.

use super::*;
use crate::servo::control::anchor::{Anchor, Stiction};
use crate::servo::control::holding::{Edges, Holding, Slip};
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
fn a_place_is_held_after_five_times_of_the_observer_and_left_with_the_mean_of_the_latest() {
    for (observer, time) in [(100.0, 0.05), (300.0, 0.0167)] {
        let mut fresh = anchor(observer);
        let mut samples = 0;
        while fresh.update(5.0, true) != Stiction::Stuck {
            assert!(!fresh.holds());
            samples += 1;
        }
        assert!((samples as f32 * STEP - time).abs() < 1.5e-3, "{samples}");
        assert!(fresh.holds() && fresh.since() == 0);
        assert_eq!(fresh.update(5.0, false), Stiction::Sticking);
        assert_eq!(fresh.since(), 1);
        for direction in [1.0, -1.0] {
            // One sample beyond the band.
            let mut other = fresh.clone();
            assert_eq!(
                other.update(5.0 + 0.011 * direction, true),
                Stiction::Left(direction)
            );
            assert_eq!((other.holds(), other.since()), (false, 0));
            // Where its place is known for good,
            // half of the band in the mean of the latest: 0.3, 0.51, 0.657 of 0.008.
            if samples < 40 {
                continue;
            }
            let mut other = fresh.clone();
            let found: [Stiction; 3] =
                core::array::from_fn(|_| other.update(5.0 + 0.008 * direction, true));
            assert_eq!(
                found,
                [
                    Stiction::Sticking,
                    Stiction::Sticking,
                    Stiction::Left(direction)
                ]
            );
        }
    }
    // Not while the observer sees a velocity, and anew with each place.
    let mut moving = anchor(100.0);
    for k in 0..500 {
        assert_eq!(moving.update(0.011 * k as f32, true), Stiction::Sliding);
        assert_eq!(moving.since(), k + 1);
    }
    let mut slides = anchor(100.0);
    for _ in 0..500 {
        assert_eq!(slides.update(5.0, false), Stiction::Sliding);
    }
    assert_eq!(slides.update(5.0, true), Stiction::Stuck);
    slides.restart();
    assert!(!slides.holds() && slides.since() == 0);
    assert_eq!(slides.update(5.0, true), Stiction::Sliding);
}

#[test]
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

/// A slip of an axis whose drive has come from the middle to the edge of what friction holds, for
/// which the full flow takes 0.004 s; the valve has its middle at 0.01 and a dead zone of 0.05.
fn slip(direction: f32) -> Slip {
    Slip {
        direction,
        way: 0.004,
        settled: 0.05,
    }
}

const VALVE: Edges = Edges {
    middle: 0.01,
    dead_zone: 0.05,
};

/// The command after a slip that ends so many seconds of rest.
fn after(holding: &mut Holding, seconds: f32, slip: &Slip) -> f32 {
    behind(&VALVE, holding, seconds, slip)
}

/// The same behind another valve.
fn behind(valve: &Edges, holding: &mut Holding, seconds: f32, slip: &Slip) -> f32 {
    for _ in 0..(seconds / STEP) as u32 {
        holding.pass(STEP, true);
    }
    holding.slip(slip, valve);
    holding.command().unwrap_or(valve.middle)
}

#[test]
fn a_slip_deep_in_the_dead_zone_sends_the_search_to_its_edge() {
    let mut holding = Holding::NONE;
    holding.slip(&slip(1.0), &VALVE);
    assert_eq!(holding, Holding::NONE, "it was not held");
    // 0.02 within the edge of the dead zone, the other way.
    let command = after(&mut holding, 10.0, &slip(1.0));
    assert!((command - (0.01 - 0.03)).abs() < 1e-6, "{command}");
    // Near the edge by the flow that the rest shows: 0.004/s over 1 s, half as much again the same
    // way.
    let next = after(&mut holding, 1.0, &slip(1.0));
    assert!((command - next - 1.5 * 0.004).abs() < 1e-5, "{next}");
    let third = after(&mut holding, 1.0, &slip(1.0));
    assert!((next - third - 2.25 * 0.004).abs() < 1e-5, "{third}");
    // Never farther than 0.05 beyond the dead zone, and by no more than 0.02 times 4 at once.
    let mut last = third;
    for _ in 0..20 {
        let next = after(&mut holding, 0.1, &slip(1.0));
        assert!(last - next <= 0.0801 && next >= 0.01 - 0.1 - 1e-6);
        last = next;
    }
    assert!((last - (0.01 - 0.1)).abs() < 1e-6);
    // Where the middle has moved to within 0.02 of the command, it is deep in the dead zone again.
    for (middle, edge) in [
        (-0.005, true),
        (-0.035, true),
        (0.005, false),
        (-0.045, false),
    ] {
        let mut holding = Holding::NONE;
        let _ = after(&mut holding, 10.0, &slip(1.0));
        let other = Edges { middle, ..VALVE };
        let next = behind(&other, &mut holding, 1.0, &slip(1.0));
        let exact = if edge {
            middle - 0.03
        } else {
            -0.02 - 1.5 * 0.004
        };
        assert!((next - exact).abs() < 1e-5, "{middle}: {next}");
    }
}

#[test]
fn commands_that_slipped_both_ways_are_bisected() {
    let mut holding = Holding::NONE;
    let low = after(&mut holding, 10.0, &slip(1.0));
    let half = after(&mut holding, 10.0, &slip(-1.0));
    assert!((half - 0.5 * (low + 0.01)).abs() < 1e-6, "{half}");
    let quarter = after(&mut holding, 10.0, &slip(1.0));
    assert!((quarter - 0.5 * (low + half)).abs() < 1e-6, "{quarter}");
    // A bracket that is narrower than 0.004 is none: what should hold has changed.
    let eighth = after(&mut holding, 10.0, &slip(-1.0));
    let last = after(&mut holding, 10.0, &slip(-1.0));
    assert!((eighth - 0.5 * (quarter + half)).abs() < 1e-6);
    assert!(last > eighth, "{last}");
}

#[test]
fn rests_count_once_they_outlast_what_came_before_them() {
    // Slips after 20 ms of rest each, where 50 ms still act on the drive.
    let mut holding = Holding::NONE;
    for k in 1..=3 {
        let command = after(&mut holding, 0.0205, &slip(1.0));
        assert_eq!(command == 0.01, k < 3, "{k}");
    }
    // One the other way begins anew.
    let mut holding = Holding::NONE;
    for k in 0..10 {
        let direction = if k % 4 < 2 { 1.0 } else { -1.0 };
        assert_eq!(after(&mut holding, 0.0205, &slip(direction)), 0.01);
    }
    assert!(holding.has_slipped());
}

#[test]
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
