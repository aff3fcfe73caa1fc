//! Spikes, steps and wrong models in front of the gate.

use super::*;

/// Variance of y with a memory, and a third difference far beyond it.
const NOISE: [f32; 2] = [0.25, 0.0];
const FAR: f32 = 1e3;

fn gate() -> Gate<u8> {
    Gate::new(0)
}

#[test]
fn what_is_implausible_is_so_in_its_innovation_and_in_its_third_difference() {
    // Four deviations of 0.5, and 1.2 sqrt(20) of them.
    let third = 1.2 * libm::sqrtf(20.0) * 0.5;
    for sign in [1.0, -1.0] {
        for (innovation, difference, implausible) in [
            (2.01, FAR, true),
            (1.99, FAR, false),
            (FAR, 1.001 * third, true),
            (FAR, 0.999 * third, false),
            (2.01, 1.001 * third, true),
        ] {
            let found = gate().classify(sign * innovation, -sign * difference, NOISE, 9);
            let expected = match implausible {
                true => SampleKind::Implausible,
                false => SampleKind::Plausible,
            };
            assert_eq!(found, expected, "{innovation} {difference}");
        }
    }
}

#[test]
fn an_innovation_is_measured_from_its_mean() {
    let mut gate = gate();
    let mut mean = 0.0;
    for _ in 0..200 {
        assert_eq!(gate.classify(5.0, 0.0, NOISE, 9), SampleKind::Plausible);
        mean += 0.125 * (5.0 - mean);
        assert!((gate.mean - mean).abs() < 1e-5);
    }
    // A model that is wrong by 5 all the time: 3 is as far from it as 7.
    for (innovation, found) in [
        (3.1, SampleKind::Plausible),
        (6.9, SampleKind::Plausible),
        (2.9, SampleKind::Implausible),
        (7.1, SampleKind::Implausible),
    ] {
        let mut other = gate.clone();
        assert_eq!(
            other.classify(innovation, FAR, NOISE, 9),
            found,
            "{innovation}"
        );
    }
    // What is no number is not remembered.
    gate.open = 1;
    let _ = gate.classify(f32::INFINITY, FAR, NOISE, 9);
    assert_eq!(gate.mean, 0.0);
}

#[test]
fn a_second_implausible_sample_is_a_lasting_change_and_opens_the_gate() {
    let mut gate = gate();
    assert_eq!(gate.classify(FAR, FAR, NOISE, 3), SampleKind::Implausible);
    gate.aside = Some((1.0, 7));
    assert_eq!(gate.classify(FAR, FAR, NOISE, 3), SampleKind::Lasting);
    gate.aside = None;
    for _ in 0..3 {
        assert_eq!(gate.classify(FAR, FAR, NOISE, 3), SampleKind::Plausible);
        gate.mean = 0.0;
    }
    assert_eq!(gate.classify(FAR, FAR, NOISE, 3), SampleKind::Implausible);
    // One spike alone: the next sample closes the case.
    gate.aside = Some((1.0, 7));
    assert_eq!(gate.classify(0.0, FAR, NOISE, 3), SampleKind::Plausible);
    assert_eq!(gate.aside, None);
    // Open for the longer of two times.
    gate.keep_open(5);
    gate.keep_open(2);
    assert_eq!(gate.open, 5);
}

#[test]
fn without_a_memory_the_limits_are_wider_and_what_is_expected_is_allowed() {
    // Four times 2 and five times 0.5 together, squared.
    let limit = 4.0 * libm::sqrtf(4.0 + 25.0 * 0.25);
    for (innovation, found) in [
        (0.999 * limit, SampleKind::Plausible),
        (1.001 * limit, SampleKind::Implausible),
    ] {
        let mut gate = gate();
        assert_eq!(gate.classify(innovation, FAR, [0.25, 4.0], 9), found);
    }
    assert_eq!(
        gate().classify(2.01, FAR, NOISE, 9),
        SampleKind::Implausible
    );
}
