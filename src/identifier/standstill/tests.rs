//! Bands, contradictions, and axes that stick.

use super::*;

const LIMITS: [u32; 2] = [50, 600];

/// A standard deviation of 0.18.
const NOISE: f32 = 0.032;

/// With 1 + phi' P phi = `expected`.
fn classify(standstill: &mut Standstill, y: f32, e: f32, expected: f32) -> StandstillEvidence {
    let unexplained = standstill.unexplained(y, e, NOISE).map(|sample| {
        let contradicts = !(sample[0] <= NOISE * expected) && standstill.exceeds_digits(sample);
        (sample, contradicts)
    });
    standstill.classify(y, e, LIMITS, unexplained)
}

#[test]
fn motion_and_rest_as_the_model_says_obey() {
    let mut standstill = Standstill::new();
    for k in 0..1000 {
        let y = if k < 500 { 0.3 * k as f32 } else { 150.0 };
        assert_eq!(
            classify(&mut standstill, y, 0.1, 1.0),
            StandstillEvidence::Obeys
        );
        // However wrong a model is: in motion nothing is held.
        if k < 500 && k % 3 == 0 {
            let mut other = standstill.clone();
            let found = classify(&mut other, y + 2.0, 100.0, 1.0);
            assert_eq!(found, StandstillEvidence::Obeys);
        }
    }
}

#[test]
fn what_contradicts_no_more_is_released() {
    let mut standstill = Standstill::new();
    for k in 0..5 {
        let found = classify(&mut standstill, 0.0, 30.0, 1.0);
        assert_eq!(found == StandstillEvidence::Withheld, k == 4, "{k}");
    }
    // The model has become uncertain, and its innovation is no contradiction any more.
    for k in 1..=600 {
        let found = classify(&mut standstill, 0.0, 30.0, 1e3);
        assert_eq!(found == StandstillEvidence::Obeys, k == 600, "{k}");
    }
    assert_eq!(
        classify(&mut standstill, 0.0, 30.0, 1.0),
        StandstillEvidence::Obeys
    );
}

#[test]
fn a_blocked_axis_is_held_and_the_motion_after_it_too_for_a_while() {
    let mut standstill = Standstill::new();
    let mut classify = |y: f32, e: f32| classify(&mut standstill, y, e, 1.0);
    for k in 1..200 {
        let expected = match k {
            ..5 => StandstillEvidence::Obeys,
            5..54 => StandstillEvidence::Withheld,
            _ => StandstillEvidence::Stands,
        };
        assert_eq!(classify(0.0, 30.0), expected, "{k}");
    }
    for k in 0..700 {
        let expected = match k {
            0 => StandstillEvidence::Freed,
            1..=600 => StandstillEvidence::Withheld,
            _ => StandstillEvidence::Obeys,
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
        let mut within =
            |share: f32| standstill.unexplained(10.0 + side * share * 6.0 * sigma, 1.0, NOISE);
        assert!(within(0.99).is_some_and(|[size, far]| {
            size == 0.0 && (far / (0.99 * 0.99 * NOISE) - 1.0).abs() < 1e-4
        }));
        assert_eq!(within(1.01), None);
        let sample = standstill.unexplained(10.0, 1.0 + side * 12.0 * sigma, NOISE);
        assert!(sample.is_some_and(|[size, _]| (size / NOISE - 1.0).abs() < 1e-4));
    }
    // As long as the noise is not known there is no outside.
    assert!(standstill.unexplained(1e9, 1.0, f32::INFINITY).is_some());
}

/// A sensor of digits of `digit` whose newest step was one of them, the noise far below.
fn coarse(digit: f32) -> Standstill {
    let mut standstill = Standstill::new();
    for y in [
        7.0 * digit,
        5.0 * digit,
        2.0 * digit,
        3.0 * digit,
        9.0 * digit,
    ] {
        assert_eq!(
            classify(&mut standstill, y, 0.0, 1.0),
            StandstillEvidence::Obeys
        );
    }
    standstill
}

/// How many samples of the innovation `e` pass before the estimate is held, none of 1000 if never.
fn passed(standstill: &Standstill, y: f32, e: f32) -> Option<usize> {
    let mut standstill = standstill.clone();
    (0..1000).find(|_| classify(&mut standstill, y, e, 1.0) == StandstillEvidence::Withheld)
}

#[test]
fn digits_explain_two_of_them_for_ever_and_ten_for_a_while() {
    for digit in [20.0_f32, 300.0] {
        let standstill = coarse(digit);
        let certain = LIMITS[0] as usize;
        for (digits, expected) in [
            (1.99, None),
            (2.01, Some(certain - 1)),
            (9.99, Some(certain - 1)),
            (10.01, Some(4)),
            (1e6, Some(4)),
            (f32::INFINITY, Some(4)),
            (f32::NAN, Some(4)),
        ] {
            let found = passed(&standstill, 9.0 * digit, digits * digit);
            assert_eq!(found, expected, "{digits} digits of {digit}");
        }
        // What contradicts no more is no standstill; what does again begins anew.
        let mut standstill = standstill;
        for k in 0..2000 {
            let e = if k % 49 == 48 { 0.0 } else { 5.0 * digit };
            let found = classify(&mut standstill, 9.0 * digit, e, 1.0);
            assert_eq!(found, StandstillEvidence::Obeys, "{k}");
        }
    }
}

#[test]
fn a_digit_is_the_least_difference_and_noise_below_it_leaves_nothing() {
    let mut standstill = coarse(20.0);
    // Samples that nothing contradicts, and those at y_0, tell nothing.
    for y in [180.0, 180.5, 179.5] {
        assert_eq!(
            classify(&mut standstill, y, 0.0, 1.0),
            StandstillEvidence::Obeys
        );
    }
    assert_eq!(passed(&standstill, 180.0, 39.0), None);
    // One that does, and differs, is of a sensor that is as fine.
    assert_eq!(
        classify(&mut standstill, 180.5, 39.0, 1.0),
        StandstillEvidence::Obeys
    );
    assert_eq!(passed(&standstill, 180.0, 39.0), Some(4));
    // 12 deviations of the noise, 2.2, are more than 2 of these digits, and fewer than 10.
    assert_eq!(passed(&standstill, 180.0, 2.1), None);
    assert_eq!(
        passed(&standstill, 180.0, 2.3),
        Some(LIMITS[0] as usize - 1)
    );
    // The digit is of the sensor: it outlasts a friction.
    let _ = standstill.sticks(180.0, 1);
    assert_eq!(
        passed(&standstill, 180.0, 2.3),
        Some(LIMITS[0] as usize - 1)
    );
}

#[test]
fn as_long_as_no_step_is_known_digits_explain_nothing() {
    let standstill = Standstill::new();
    assert_eq!(passed(&standstill, 0.0, 3.0), Some(4));
    // The first that differs makes one known.
    assert_eq!(passed(&standstill, 0.5, 6.0), Some(5));
}

#[test]
fn a_contradiction_as_long_as_the_pause_that_is_left_begins_another_one() {
    let mut freed = Standstill::new();
    for _ in 0..200 {
        let _ = classify(&mut freed, 0.0, 30.0, 1.0);
    }
    let mut y = 0.0;
    for _ in 0..580 {
        y += 10.0;
        let _ = classify(&mut freed, y, 30.0, 1.0);
    }
    // Less of the pause is left than contradictions may follow.
    let mut as_long = 0;
    for samples in 1..40 {
        let mut standstill = freed.clone();
        for _ in 0..samples {
            let _ = classify(&mut standstill, y, 1e5, 1.0);
        }
        as_long += u32::from(standstill.contradicted == standstill.pause);
        let moves = classify(&mut standstill, y + 10.0, 30.0, 1.0);
        assert_eq!(moves, StandstillEvidence::Withheld, "{samples}");
    }
    assert_eq!(as_long, 1);
}
