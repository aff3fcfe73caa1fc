//! What is withdrawn of a constant, and what that leaves of the covariance.

use super::*;

const COLUMNS: [Parameter; 2] = [Parameter::Input { input: 0, power: 0 }, Parameter::Constant];
const P: Matrix<2> = [[2.0, 1.0], [1.0, 1.0]];

/// A gain of which no deviation is more than a hundredth.
const KNOWN: f32 = 1e3;

fn of(theta: [f32; 2], p: Matrix<2>, units: [f32; 2], residual: f32) -> Option<Withdrawal<2>> {
    let row_of = |i: usize| p.get(i).copied();
    Withdrawal::of(&COLUMNS, &theta, row_of, &units, residual, 2.0)
}

fn withdrawal(constant: f32) -> Option<Withdrawal<2>> {
    of([KNOWN, constant], P, [1.0; 2], 4.0)
}

#[test]
fn a_constant_within_its_uncertainty_goes_and_one_beyond_stays() {
    // sigma_c = 2: all is withdrawn up to 4, nothing from 8 on, half of it at 6.
    for (constant, gain, left) in [(3.0, -3.0, 0.0), (-4.0, 4.0, 0.0), (6.0, -3.0, 3.0)] {
        let mut theta = [KNOWN, constant];
        withdrawal(constant).unwrap().apply(&mut theta);
        assert_eq!(theta, [KNOWN + gain, left]);
    }
    assert!(withdrawal(8.0).is_none() && withdrawal(f32::NAN).is_none());
}

#[test]
fn a_known_constant_stays() {
    let known = [[2.0, 0.0], [0.0, 0.0]];
    assert!(of([KNOWN, 0.1], known, [1.0; 2], 4.0).is_none());
    assert!(of([KNOWN, 0.0], P, [1.0; 2], 0.0).is_none());
}

#[test]
fn a_constant_beside_a_gain_that_may_be_none_stays() {
    // sigma_b = 2.
    let p: Matrix<2> = [[1.0, 0.5], [0.5, 1.0]];
    for (gain, share) in [
        (0.06, 0.0),
        (-0.2, 0.0),
        (0.3, 0.5),
        (-0.35, 0.75),
        (0.4, 1.0),
        (20.0, 1.0),
    ] {
        let found = of([gain, 0.0], p, [1.0; 2], 4.0);
        let found = found.map_or(0.0, |found| found.share());
        assert!((found - share).abs() < 1e-5, "{gain}: {found}");
    }
    // A constant of 2 takes 1 of it; in other units it is the same.
    for units in [[1.0; 2], [30.0, 5.0]] {
        let theta = [1.15 * units[0], 2.0 * units[1]];
        assert!(of(theta, p, units, 4.0).is_none());
        let theta = [1.3 * units[0], 2.0 * units[1]];
        let share = of(theta, p, units, 4.0).unwrap().share();
        assert!((share - 0.5).abs() < 1e-5, "{share}");
    }
    // A gain that is known has no deviation.
    let known: Matrix<2> = [[0.0, 0.0], [0.0, 1.0]];
    assert_eq!(of([1.0, 0.0], known, [1.0; 2], 4.0).unwrap().share(), 1.0);
}

#[test]
fn without_a_gain_of_the_command_a_constant_goes_alone() {
    let columns = [Parameter::Output { power: 1 }, Parameter::Constant];
    let row_of = |i: usize| P.get(i).copied();
    let found = Withdrawal::of(&columns, &[1.0, 0.0], row_of, &[1.0; 2], 4.0, 2.0).unwrap();
    assert_eq!(found.share(), 1.0);
    // Nobody knows how large it may be.
    let mut covariance = P;
    found.apply_to_covariance(&mut covariance);
    assert_eq!(covariance, P);
}

#[test]
fn the_limit_grows_with_the_root_of_residual_and_variance() {
    let p: Matrix<2> = [[2.0, 0.1], [0.1, 0.25]];
    // sigma_c = 1: nothing is withdrawn from 4 on.
    for (constant, goes) in [(3.9, true), (4.1, false)] {
        let found = of([KNOWN, constant], p, [1.0; 2], 4.0);
        assert_eq!(found.is_some(), goes, "{constant}");
    }
}

#[test]
fn the_covariance_is_that_without_the_constant_and_a_part_of_it() {
    let mut covariance = P;
    withdrawal(3.0)
        .unwrap()
        .apply_to_covariance(&mut covariance);
    // Without the constant the variance of the gain is 2 - 1/1; 3 is three quarters of the
    // limit, and a deviation of 1 a hundredth of the offsets of such a gain.
    let left = 9.0 * 0.6 * 0.75 * 1.75 + 1.0 / (0.1 * (KNOWN - 3.0));
    assert!((covariance[0][0] - (1.0 + left)).abs() < 1e-5);
    assert!((covariance[1][1] - left).abs() < 1e-5);
}

#[test]
fn what_is_withdrawn_in_part_takes_that_part_of_the_covariance_along() {
    let p: Matrix<2> = [[2.0, 0.8], [0.8, 1.0]];
    let mut covariance = p;
    of([KNOWN, 6.0], p, [1.0; 2], 4.0)
        .unwrap()
        .apply_to_covariance(&mut covariance);
    // Half of 6, which is one and a half times the limit: g = (0.8, 1) / 2, and the variance
    // of the constant with 0.6 (1 + 1) 36 and its share of offsets.
    let left = 1.0 + 1.2 * 36.0 + 1.0 / (0.1 * (KNOWN - 4.8));
    let wanted = [
        [2.0 + left * 0.16 - 0.64, 0.8 + left * 0.2 - 0.8],
        [0.8 + left * 0.2 - 0.8, 1.0 + left * 0.25 - 1.0],
    ];
    for (found, wanted) in covariance.iter().flatten().zip(wanted.iter().flatten()) {
        assert!((found - wanted).abs() < 1e-4, "{covariance:?} {wanted}");
    }
}

#[test]
fn what_was_taken_out_can_be_put_back() {
    // In the user's units the constant is 5 times, the gain 30 times the normalised one.
    let (units, before) = ([30.0, 5.0], [30.0 * KNOWN, 12.0]);
    let found = of(before, P, units, 4.0).unwrap();
    let mut theta = before;
    found.apply(&mut theta);
    // All of it: within 20. The gain follows by P_gc/P_cc = 1 in its units.
    assert!((theta[0] - (before[0] - 12.0 * 6.0)).abs() < 1e-2 && theta[1].abs() < 1e-5);
    found.undo(&mut theta);
    assert!((theta[0] - before[0]).abs() < 1e-2 && (theta[1] - 12.0).abs() < 1e-4);
}

#[test]
fn a_constant_that_may_be_an_offset_stays_in_the_covariance() {
    // A variance of 1 in a gain that follows by 1, of which offsets are as large as this.
    for (offset, left) in [(0.5, 1.0), (1.0, 1.0), (4.0, 0.25)] {
        let mut covariance = P;
        let found = of([offset / OFFSETS, 0.0], P, [1.0; 2], 1e-4).unwrap();
        found.apply_to_covariance(&mut covariance);
        assert!((covariance[0][0] - (2.0 - 1.0 + left)).abs() < 1e-6);
        // The constant keeps its own.
        assert_eq!(covariance[1][1], 1.0);
    }
    // Beside a second input it is none.
    let second = Parameter::Input { input: 1, power: 0 };
    let columns = [COLUMNS[0], second, COLUMNS[1]];
    // One that is known is no input: an offset of 1 leaves all of a variance of 1.
    for (own, left) in [(1.0, 1.0), (0.0, 2.0)] {
        let p: Matrix<3> = [[2.0, 0.0, 1.0], [0.0, own, 0.0], [1.0, 0.0, 1.0]];
        let (theta, row_of) = ([10.0, 1.0, 0.0], |i: usize| p.get(i).copied());
        let found = Withdrawal::of(&columns, &theta, row_of, &[1.0; 3], 1e-4, 2.0);
        let mut covariance = p;
        found.unwrap().apply_to_covariance(&mut covariance);
        assert_eq!((covariance[0][0], covariance[2][2]), (left, 1.0));
    }
}
