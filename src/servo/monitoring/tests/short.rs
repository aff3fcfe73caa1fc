//! The shortfall: what a sound axis may lack, and when what is lacking is an alarm.

use super::*;
use crate::servo::monitoring::shortfall::{Short, Shortfall};

/// A time of an axis that should go with `expected` and goes with `measured`: the alarm, and
/// when.
fn alarm(
    bounds: &Bounds,
    expected: impl Fn(f32) -> f32,
    measured: impl Fn(f32) -> f32,
) -> Option<(f32, Short)> {
    let mut shortfall = Shortfall::default();
    (0..20_000).find_map(|k| {
        let t = 1e-3 * k as f32;
        let found = shortfall.update(expected(t), 0.0, measured(t), bounds);
        found.map(|short| (t, short))
    })
}

#[test]
fn an_axis_may_lack_what_valve_gain_and_delay_explain() {
    let bounds = example::bounds(&MODEL);
    // 0.06 C and three tenths of the velocity.
    for speed in [300.0, 1500.0_f32] {
        for side in [1.0, -1.0] {
            let tolerance = bounds.drift + 0.3 * speed;
            let lacks = |share: f32| {
                alarm(
                    &bounds,
                    |_| side * speed,
                    move |_| side * (speed - share * tolerance),
                )
            };
            assert_eq!(lacks(0.99), None, "{speed}");
            // More than that, but moving by more than a fifth, is none of these faults.
            assert_eq!(lacks(1.05).is_none(), speed > 1000.0, "{speed}");
        }
    }
    // A command that comes later by half of its delay and a sample.
    let delay = 1e-3 * bounds.short.late_rate;
    let wave = |t: f32| 800.0 * libm::sinf(20.0 * t);
    assert_eq!(alarm(&bounds, wave, move |t| wave(t - delay)), None);
    assert_eq!(alarm(&bounds, wave, move |t| wave(t + delay)), None);
}

#[test]
fn an_axis_that_goes_the_other_way_is_noticed_by_its_distance() {
    let bounds = example::bounds(&MODEL);
    for speed in [300.0, 1500.0_f32] {
        for side in [1.0, -1.0] {
            for share in [0.5, 1.0] {
                let (t, short) =
                    alarm(&bounds, |_| side * speed, |_| -side * share * speed).expect("an alarm");
                assert_eq!(short, Short::Against);
                // The distance that it is short of, beyond what a sound axis lacks; the first
                // sample is a change of all of the velocity.
                let rate = speed * (1.0 + share) - bounds.drift - 0.3 * speed;
                let first = 1e-3 * (rate - bounds.short.late_rate * speed);
                let needed = bounds.short.level + bounds.short.ring * speed;
                let expected = needed / rate - (first / rate).min(0.0);
                assert!(
                    (t - expected).abs() < 5e-3,
                    "{speed} {share}: {t} {expected}"
                );
            }
        }
    }
    for (expected, measured, against) in [
        (2.0, -1.0, true),
        (-2.0, 1.0, true),
        (2.0, 1.0, false),
        (0.5, -1.0, false),
        (2.0, 0.0, false),
    ] {
        let slow = bounds.end_speed;
        let found = Shortfall::is_against(expected * slow, measured, &bounds);
        assert_eq!(found, against, "{expected} {measured}");
    }
}

#[test]
fn an_axis_that_stands_is_noticed_after_its_distance_and_a_while() {
    let bounds = example::bounds(&MODEL);
    let (speed, still) = (800.0, 0.0);
    let (t, short) = alarm(&bounds, |_| speed, |_| still).expect("an alarm");
    assert_eq!(short, Short::Standing);
    let rate = 0.7 * speed - bounds.drift;
    let late = bounds.short.late_rate * speed * 1e-3;
    let least = (bounds.short.level + late.min(rate * 1e-3)) / rate;
    let whole = least + 1e-3 * bounds.opposite as f32;
    assert!((t - whole).abs() < 0.02, "{t} {whole}");
    // One that swings about a place stands as well, but not where its path is a fifth of the
    // expected one.
    let swings = |path: f32| {
        alarm(
            &bounds,
            |_| speed,
            move |t| {
                let sign = if libm::fmodf(t, 0.02) < 0.01 {
                    1.0
                } else {
                    -1.0
                };
                sign * path * speed
            },
        )
    };
    assert!(swings(0.15).is_some() && swings(0.3).is_none());
}

#[test]
fn a_swing_is_five_times_the_smaller_speed_of_both_directions() {
    let bounds = example::bounds(&MODEL);
    let mut shortfall = Shortfall::default();
    let _ = shortfall.update(300.0, 0.0, 300.0, &bounds);
    let alone = shortfall.swing();
    assert!(
        (alone - bounds.short.ring * 300.0).abs() < 1e-3,
        "one direction is no swing"
    );
    let _ = shortfall.update(-200.0, 0.0, -200.0, &bounds);
    let both = shortfall.swing();
    assert!(
        (both - bounds.short.swing * 200.0).abs() < 0.02 * both,
        "{both}"
    );
    // Either of expectation and measurement alone.
    let mut expected = Shortfall::default();
    let _ = expected.update(300.0, 0.0, 0.0, &bounds);
    let _ = expected.update(-200.0, 0.0, 0.0, &bounds);
    assert!((expected.swing() - both).abs() < 0.02 * both);
    let mut measured = Shortfall::default();
    let _ = measured.update(0.0, 0.0, -200.0, &bounds);
    let _ = measured.update(0.0, 0.0, 300.0, &bounds);
    assert!((measured.swing() - both).abs() < 0.02 * both);
    // It fades as that of a heavy load does: 0.58 of the rate of the displacements.
    let samples = (1.0 / (0.58 * bounds.share)) as u32;
    for _ in 0..samples {
        let _ = shortfall.update(0.0, 0.0, 0.0, &bounds);
    }
    let left = shortfall.swing() / both;
    assert!((left - libm::expf(-1.0)).abs() < 0.02, "{left}");
}

#[test]
fn a_light_drive_rings_after_its_fastest_motion() {
    let light = Model {
        a2: 4.0,
        friction: 0.0,
        ..MODEL
    };
    let bounds = example::bounds(&light);
    assert!(bounds.short.ring > 0.0);
    let mut shortfall = Shortfall::default();
    for _ in 0..10 {
        let _ = shortfall.update(500.0, 0.0, 500.0, &bounds);
    }
    let ring = bounds.short.ring * 500.0;
    assert!((shortfall.swing() - ring).abs() < 1e-2 * ring);
    // With a memory of four windows.
    for _ in 0..(4.0 / bounds.share) as u32 {
        let _ = shortfall.update(0.0, 0.0, 0.0, &bounds);
    }
    assert!((shortfall.swing() / ring - libm::expf(-1.0)).abs() < 0.02);
    // A motion that is short is no excuse for itself.
    let mut short = Shortfall::default();
    for k in 0..200 {
        let _ = short.update(500.0, 0.0, if k < 5 { 0.0 } else { -3000.0 }, &bounds);
    }
    assert!(short.swing() < 1.01 * ring, "{}", short.swing());
    // While friction holds the expectation the commanded direction counts.
    let mut held = Shortfall::default();
    for _ in 0..50 {
        assert_eq!(held.update(0.0, -1.0, -20.0, &bounds), None);
    }
}

#[test]
fn a_velocity_that_changes_may_be_late_by_as_many_of_its_changes_as_samples() {
    let bounds = example::bounds(&MODEL);
    // It changes by 400 per sample: half of the delay of 2 ms and a sample are 2 of them.
    let tolerance = bounds.drift + 0.3 * 600.0 + 2.0 * 400.0;
    for side in [1.0, -1.0] {
        let lacks = |share: f32| {
            let expected = |t: f32| {
                let sample = (1e3 * t + 0.5) as u32;
                side * if sample.is_multiple_of(2) {
                    800.0
                } else {
                    400.0
                }
            };
            let measured = side * (600.0 - share * tolerance);
            alarm(&bounds, expected, move |_| measured).map(|(_, short)| short)
        };
        assert_eq!(lacks(0.99), None);
        // So much of it is a motion the other way.
        assert_eq!(lacks(1.05), Some(Short::Against));
    }
}
