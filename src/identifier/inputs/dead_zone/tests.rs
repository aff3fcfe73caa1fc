//! Widths that are found, and those that are refused.

use super::*;
use crate::identifier::servo::ValveServo;

#[test]
fn inputs_at_the_edge() {
    assert_eq!(dead_zone(0.03, 0.03), [0.0, 0.0]);
    assert_eq!(dead_zone(-0.03, 0.03), [0.0, 0.0]);
    assert_eq!(dead_zone(f32::NAN, 0.03), [0.0, 0.0]);
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
        assert!(!valve.correct(numerators, 0.0));
        assert_eq!(valve.delta(), 0.02);
    }
    assert_eq!(DeadZone::new(f32::NAN, 0.1, 1).delta(), 0.0);
    assert_eq!(DeadZone::new(0.2, 0.1, 1).delta(), 0.0);
    assert_eq!(DeadZone::new(0.2, f32::NAN, 1).delta(), 0.0);
    let mut valve = DeadZone::new(0.02, 0.1, 0);
    let servo = ValveServo::new(0.001, 20.0, 1.0, 50.0, 0.7).unwrap();
    for _ in 0..10 {
        assert!(!valve.update(&servo));
    }
    assert_eq!(valve.delta(), 0.02);
}

#[test]
fn a_block_has_as_many_samples_as_it_says() {
    let mut valve = DeadZone::new(0.02, 0.1, 3);
    let servo = ValveServo::new(0.001, 20.0, 1.0, 50.0, 0.7).unwrap();
    for k in 1..=9 {
        let _ = valve.update(&servo);
        assert_eq!(valve.count, k % 3);
    }
}

#[test]
fn the_inputs_are_made_with_a_width_that_is_not_too_large() {
    let mut valve = DeadZone::new(0.02, 0.1, 1);
    assert_eq!((valve.std(), valve.inputs(0.02)), (f32::INFINITY, [0.0; 2]));
    assert!(valve.correct([1.0, -0.0625], 0.015625));
    assert_eq!((valve.delta(), valve.std()), (0.0625, 0.015625));
    assert_eq!(valve.inputs(0.03125), [0.0; 2]);
    assert_eq!(valve.inputs(0.032), [0.032, 1.0]);
    // A quotient that is no width says that the one before was wrong by its deviation, too.
    assert!(!valve.correct([1.0, 0.0625], 0.05));
    assert_eq!((valve.delta(), valve.inputs(0.001)), (0.0625, [0.001, 1.0]));
    for std in [f32::NAN, f32::INFINITY, -1.0] {
        assert!(valve.correct([1.0, -0.05], std));
        assert_eq!(
            (valve.delta(), valve.inputs(-0.001)),
            (0.05, [-0.001, -1.0])
        );
    }
}

/// A valve of this half width in front of `y'' = -20 y' + 2000 (flow + 0.02)`, exactly between
/// samples; steps of three sizes.
fn valve_servo(half: f32) -> (ValveServo, DeadZone, u32) {
    let mut servo = ValveServo::new(1e-3, 20.0, 0.4, 50.0, 0.7).unwrap();
    let mut valve = DeadZone::new(0.0, 0.1, 300);
    let (mut y, mut v, mut a, mut corrected) = (0.0_f32, 0.0_f32, 0.0_f32, 0);
    let mut state = 1_u32;
    for k in 0..6000 {
        if k % 170 == 0 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        }
        let size = 0.05 + 0.35 * ((state >> 16) % 5) as f32 / 4.0;
        let u = if y > 0.0 { -size } else { size };
        let noise = ((k * 7919) % 13) as f32 * 1e-4;
        let _ = servo.update_inputs(valve.inputs(u), y + noise);
        corrected += u32::from(valve.update(&servo));
        let flow = u - half.min(u.abs()) * u.signum();
        for _ in 0..10 {
            let jerk = 2e5 * flow - 400.0 * v - 20.0 * a;
            (y, v, a) = (y + 1e-4 * v, v + 1e-4 * a, a + 1e-4 * jerk);
        }
    }
    (servo, valve, corrected)
}

#[test]
fn a_width_is_found_once_per_block_with_its_deviation() {
    for half in [0.02, 0.04] {
        let (servo, valve, corrected) = valve_servo(half);
        // 6000 samples are 20 blocks; the first ones may show none.
        assert!((15..=20).contains(&corrected), "{corrected}");
        assert!((valve.delta() - half).abs() < 0.003, "{valve:?}");
        assert!(valve.std() > 0.0 && valve.std() < 0.003, "{valve:?}");
        // The quotient of the numerators, and its deviation by small changes of both.
        let estimate = servo.estimate();
        let ([linear, sign], std) = numerators(&estimate).expect("two inputs");
        let (theta, covariance) = (estimate.theta(), estimate.covariance());
        let at = |value: f32| theta.iter().position(|t| *t == value).expect("a parameter");
        let (i, j) = (at(linear), at(sign));
        let slope = [-sign / (linear * linear), 1.0 / linear];
        let variance = slope[0] * slope[0] * covariance[i][i]
            + slope[1] * slope[1] * covariance[j][j]
            + 2.0 * slope[0] * slope[1] * covariance[i][j];
        assert!(
            (std * std / variance - 1.0).abs() < 1e-2,
            "{std} {variance}"
        );
        let mut other = valve;
        assert!(other.correct([linear, sign], std));
        assert!((other.delta() + sign / linear).abs() < 1e-6 && other.std() == std);
    }
}
