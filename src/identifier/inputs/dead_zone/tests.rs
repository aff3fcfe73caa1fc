//! Widths that are found, and those that are refused.

use super::*;
use crate::estimation::structure::Structure;
use crate::estimation::terms::Terms;

#[test]
fn inputs_at_the_edge() {
    assert_eq!(dead_zone(0.03, 0.03), [0.0, 0.0]);
    assert_eq!(dead_zone(-0.03, 0.03), [0.0, 0.0]);
    assert_eq!(dead_zone(f32::NAN, 0.03), [0.0, 0.0]);
}

fn found(delta: f32, noise: f32, bias: f32) -> Quotient {
    Quotient { delta, noise, bias }
}

/// The quotient of numerators with these variances, not correlated, with these biases.
fn quotient([linear, sign]: [f32; 2], variances: [f32; 2], bias: [f32; 2]) -> Quotient {
    let estimate = Estimate::<1, 3, 2> {
        structure: structure(),
        theta: [2.0, linear, sign],
        covariance: [[0.0; 3], [0.0, variances[0], 0.0], [0.0, 0.0, variances[1]]],
    };
    Quotient::of(&estimate, &[7.0, bias[0], bias[1]]).expect("two inputs")
}

/// a_0 and b_0 of two inputs.
fn structure() -> Structure<1, 3, 2> {
    let of = Terms::of(&[0]);
    Structure::try_new(of, [of; 2], false).expect("three parameters")
}

#[test]
fn a_dead_zone_refuses_nonsense() {
    let fresh = DeadZone::new(0.02, 0.1, 1);
    for numerators in [
        [0.0, 0.0],
        [f32::NAN, -0.1],
        [1.0, f32::INFINITY],
        [1.0, 0.05],
        [1.0, -0.2],
        [0.0, -0.1],
    ] {
        let mut valve = fresh;
        assert!(!valve.correct(quotient(numerators, [0.0; 2], [0.0; 2])));
        assert_eq!(valve.delta(), 0.02);
        assert!(valve.std() >= 0.0 && valve.cautious >= 0.0 && valve.upper <= 0.1);
    }
    assert_eq!(DeadZone::new(f32::NAN, 0.1, 1).delta(), 0.0);
    assert_eq!(DeadZone::new(0.2, 0.1, 1).delta(), 0.0);
    assert_eq!(DeadZone::new(0.2, f32::NAN, 1).delta(), 0.0);
}

#[test]
fn a_block_has_as_many_samples_as_it_says() {
    let mut valve = DeadZone::new(0.02, 0.1, 3);
    for k in 1..=9 {
        assert_eq!(valve.count_sample(), k % 3 == 0);
    }
    let mut never = DeadZone::new(0.02, 0.1, 0);
    assert!((0..9).all(|_| !never.count_sample()));
}

#[test]
fn the_inputs_are_made_with_a_width_that_is_not_too_large() {
    let mut valve = DeadZone::new(0.02, 0.1, 1);
    assert_eq!((valve.std(), valve.inputs(0.02)), (f32::INFINITY, [0.0; 2]));
    assert!(valve.correct(found(0.0625, 0.015625, 0.0)));
    assert_eq!((valve.delta(), valve.std()), (0.0625, 0.015625));
    assert_eq!(valve.inputs(0.03125), [0.0; 2]);
    assert_eq!(valve.inputs(0.032), [0.032, 1.0]);
    assert_eq!([valve.cautious, valve.upper], [0.03125, 0.09375]);
    // A quotient that is no width says that the one before was wrong by its deviation, too.
    assert!(!valve.correct(found(-0.0625, 0.05, 0.0)));
    assert_eq!((valve.delta(), valve.inputs(0.001)), (0.0625, [0.001, 1.0]));
    for std in [f32::NAN, f32::INFINITY, -1.0] {
        assert!(valve.correct(found(0.05, std, 0.0)));
        assert_eq!(
            (valve.delta(), valve.inputs(-0.001)),
            (0.05, [-0.001, -1.0])
        );
        assert_eq!((valve.std(), valve.upper()), (f32::INFINITY, 0.1));
    }
}

#[test]
fn a_bias_makes_the_largest_width_larger_and_leaves_the_inputs() {
    let mut valve = DeadZone::new(0.0, 0.1, 1);
    assert!(valve.correct(found(0.05, 0.003, 0.004)));
    assert!((valve.std() - 0.005).abs() < 1e-8);
    assert!((valve.cautious - 0.044).abs() < 1e-7 && (valve.upper - 0.06).abs() < 1e-7);
    // Never beyond what was told.
    assert!(valve.correct(found(0.095, 0.003, 0.004)));
    assert_eq!(valve.upper(), 0.1);
    // Of a bias that may be anything only the largest width is a bound.
    for bias in [f32::INFINITY, f32::NAN] {
        assert!(valve.correct(found(0.05, 0.003, bias)));
        assert_eq!((valve.std(), valve.upper()), (f32::INFINITY, 0.1));
        assert!((valve.cautious - 0.044).abs() < 1e-7);
    }
}

/// To first order far from 0, wider near it, and without bound where the denominator may be 0.
#[test]
fn a_quotient_has_no_deviation_where_its_denominator_may_be_zero() {
    let of = |variances| quotient([100.0, -5.0], variances, [0.0; 2]);
    let first = |[linear, sign]: [f32; 2]| (sign + 0.05 * 0.05 * linear).sqrt() / 100.0;
    let far = of([1e-4, 1e-6]);
    assert!((far.delta - 0.05).abs() < 1e-7);
    assert!((far.noise / first([1e-4, 1e-6]) - 1.0).abs() < 1e-4);
    let near = [400.0, 0.01];
    assert!((of(near).noise / first(near) * (1.0 - 0.36) - 1.0).abs() < 1e-4);
    for deviation in [34.0_f32, 1000.0] {
        assert_eq!(of([deviation * deviation, 0.01]).noise, f32::INFINITY);
    }
}

#[test]
fn the_bias_of_a_quotient_is_that_of_both_numerators() {
    let of = |bias| quotient([100.0, -5.0], [1.0, 1.0], bias).bias;
    // In step with each other the quotient stays.
    assert!(of([10.0, -0.5]) < 1e-8);
    assert!((of([10.0, 0.0]) - 0.005).abs() < 1e-8);
    assert!((of([0.0, 1.0]) - 0.01).abs() < 1e-8);
}
