//! Bands, contradictions, and axes that stick.

use super::*;

const LIMITS: [u32; 2] = [50, 600];

/// A standard deviation of 0.18.
const NOISE: f32 = 0.032;

/// With 1 + phi' P phi = `expected`.
fn classify(standstill: &mut Standstill, y: f32, e: f32, expected: f32) -> Motion {
    let size = standstill.unexplained(y, e, NOISE);
    let contradicts = size.map(|size| size / expected > NOISE);
    standstill.classify(y, e, LIMITS, contradicts)
}

#[test]
fn motion_and_rest_as_the_model_says_obey() {
    let mut standstill = Standstill::new();
    for k in 0..1000 {
        let y = if k < 500 { 0.3 * k as f32 } else { 150.0 };
        assert_eq!(classify(&mut standstill, y, 0.1, 1.0), Motion::Obeys);
        // However wrong a model is: in motion nothing is held.
        if k < 500 && k % 3 == 0 {
            let mut other = standstill.clone();
            let found = classify(&mut other, y + 2.0, 100.0, 1.0);
            assert_eq!(found, Motion::Obeys);
        }
    }
}

#[test]
fn what_contradicts_no_more_is_released() {
    let mut standstill = Standstill::new();
    for k in 0..5 {
        let found = classify(&mut standstill, 0.0, 30.0, 1.0);
        assert_eq!(found == Motion::Withheld, k == 4, "{k}");
    }
    // The model has become uncertain, and its innovation is no contradiction any more.
    for k in 1..=600 {
        let found = classify(&mut standstill, 0.0, 30.0, 1e3);
        assert_eq!(found == Motion::Obeys, k == 600, "{k}");
    }
    assert_eq!(classify(&mut standstill, 0.0, 30.0, 1.0), Motion::Obeys);
}

#[test]
fn a_blocked_axis_is_held_and_the_motion_after_it_too_for_a_while() {
    let mut standstill = Standstill::new();
    let mut classify = |y: f32, e: f32| classify(&mut standstill, y, e, 1.0);
    for k in 1..200 {
        let expected = match k {
            ..5 => Motion::Obeys,
            5..54 => Motion::Withheld,
            _ => Motion::Stands,
        };
        assert_eq!(classify(0.0, 30.0), expected, "{k}");
    }
    for k in 0..700 {
        let expected = match k {
            0 => Motion::Freed,
            1..=600 => Motion::Withheld,
            _ => Motion::Obeys,
        };
        assert_eq!(classify(10.0 * (k + 1) as f32, 30.0), expected, "{k}");
    }
}

#[test]
fn an_axis_that_sticks_stands_at_the_mean_of_what_was_measured() {
    let mut standstill = Standstill::new();
    let (mut sum, least) = (0.0, 10);
    for k in 1..=40_u32 {
        let y = 7.0 + if k % 3 == 0 { 0.5 } else { -0.1 };
        sum += y;
        let found = standstill.sticks(y, least);
        assert_eq!(found.is_some(), k >= least, "{k}");
        let mean = sum / k as f32;
        assert!(
            found.is_none_or(|found| (found - mean).abs() < 1e-5),
            "{k}: {found:?} {mean}"
        );
        // Too short for a rest, it is left out with four times its length.
        assert_eq!(standstill.pause, if k < least { 4 * k } else { 0 }, "{k}");
        assert!(standstill.has_left(y) && !standstill.has_left(y + 1.0));
    }
    // Beyond 64 samples the newest counts for a 64th.
    for _ in 0..100 {
        let _ = standstill.sticks(7.0, least);
    }
    let before = standstill.mean;
    let found = standstill.sticks(7.0 + 64.0, least);
    assert!(
        found.is_some_and(|found| (found - before - 1.0).abs() < 0.01),
        "{found:?}"
    );
}

#[test]
fn a_band_is_six_deviations_and_a_contradiction_twelve() {
    let mut standstill = Standstill::new();
    standstill.entered = [10.0, 1.0];
    let sigma = libm::sqrtf(NOISE);
    for side in [1.0, -1.0] {
        let within =
            |share: f32| standstill.unexplained(10.0 + side * share * 6.0 * sigma, 1.0, NOISE);
        assert_eq!(within(0.99), Some(0.0));
        assert_eq!(within(1.01), None);
        let size = standstill.unexplained(10.0, 1.0 + side * 12.0 * sigma, NOISE);
        assert!(size.is_some_and(|size| (size / NOISE - 1.0).abs() < 1e-4));
    }
    // As long as the noise is not known there is no outside.
    assert!(standstill.unexplained(1e9, 1.0, f32::INFINITY).is_some());
}
