//! The sums against the same sums in double precision.
#![expect(
    clippy::disallowed_types,
    reason = "an oracle must be able to disagree"
)]

use super::*;
use crate::math::matrix::cholesky;
use crate::servo::commissioning::oracle::Dice;

const SCALE: [f32; PARAMETERS] = [4.0, 0.5, 9.0, 0.05, 0.05, 1.5, 0.01, 3.0, 1.0, 2.0];

/// Sums of points whose slopes stand still for two, and whose errors are alike by `share`.
fn summed(seed: u32, share: f32) -> (Sums, [[f64; PARAMETERS]; PARAMETERS], [f64; 3]) {
    let mut dice = Dice::new(seed);
    let mut sums = NO_SUMS;
    let mut normal = [[0.0; PARAMETERS]; PARAMETERS];
    let (mut error, mut exact) = (0.0_f32, [0.0; 3]);
    let mut slope = [0.0; PARAMETERS];
    for k in 0..400 {
        if k % 2 == 0 {
            slope = SCALE.map(|scale| dice.roll() / scale);
        }
        let last = f64::from(error);
        error = share * error + dice.roll();
        sums.add(&slope, error);
        let wide = slope.map(f64::from);
        for (row, a) in normal.iter_mut().zip(wide) {
            for (sum, b) in row.iter_mut().zip(wide) {
                *sum += a * b;
            }
        }
        let e = f64::from(error);
        exact[0] += e * e;
        exact[1] += e * last;
        exact[2] += wide[4] * e;
    }
    (sums, normal, exact)
}

#[test]
fn sums_are_those_of_all_points() {
    let (sums, normal, [cost, lagged, gradient]) = summed(1, 0.5);
    assert_eq!(sums.count, 400);
    let near = |found: f32, exact: f64, size: f64| (f64::from(found) - exact).abs() < 1e-4 * size;
    assert!(near(sums.cost, cost, cost) && near(sums.lagged, lagged, cost));
    assert!(near(sums.gradient[4], gradient, gradient.abs()));
    for i in 0..PARAMETERS {
        for j in 0..=i {
            let size = (normal[i][i] * normal[j][j]).sqrt();
            assert!(near(sums.normal[i][j], normal[i][j], size), "{i} {j}");
        }
        for j in i + 1..PARAMETERS {
            assert_eq!(sums.normal[i][j], 0.0, "only the lower triangle");
        }
    }
}

#[test]
fn errors_that_are_alike_count_for_less() {
    for (share, expected) in [(0.0, 1.0), (0.5, 3.0), (0.98, 9.0), (-0.6, 1.0)] {
        let (sums, _, [cost, lagged, _]) = summed(2, share);
        let correlation = (lagged / cost).clamp(0.0, 0.8);
        let factor = (1.0 + correlation) / (1.0 - correlation);
        let exact = factor * cost / 401.0;
        assert!((f64::from(sums.variance()) / exact - 1.0).abs() < 1e-4);
        // (1 + r)/(1 - r): what the mean of such a row is more uncertain by.
        assert!((factor / expected - 1.0).abs() < 0.3, "{share}: {factor}");
    }
}

/// The inverse, by elimination.
fn inverse(matrix: &[[f64; PARAMETERS]; PARAMETERS]) -> [[f64; PARAMETERS]; PARAMETERS] {
    let mut left = *matrix;
    let mut right = [[0.0; PARAMETERS]; PARAMETERS];
    for k in 0..PARAMETERS {
        right[k][k] = 1.0;
    }
    for k in 0..PARAMETERS {
        let pivot = left[k][k];
        for j in 0..PARAMETERS {
            left[k][j] /= pivot;
            right[k][j] /= pivot;
        }
        for i in (0..PARAMETERS).filter(|i| *i != k) {
            let factor = left[i][k];
            for j in 0..PARAMETERS {
                left[i][j] -= factor * left[k][j];
                right[i][j] -= factor * right[k][j];
            }
        }
    }
    right
}

#[test]
fn deviations_are_those_of_the_inverse() {
    for seed in 3..20 {
        let (sums, mut normal, _) = summed(seed, 0.4);
        let variance = f64::from(sums.variance());
        for (j, prior) in sums.prior(&SCALE).into_iter().enumerate() {
            // The prior is that of a known deviation.
            let known = f64::from(PRIOR[j]) * f64::from(SCALE[j]);
            let exact = variance / (known * known);
            assert!((f64::from(prior) / exact - 1.0).abs() < 1e-4);
            normal[j][j] += exact;
        }
        let covariance = inverse(&normal);
        let [a1, a2, b0, dead_zone, ..] = SCALE.map(f64::from);
        let of = |i: usize, j: usize, scale: f64| covariance[i][j] / scale;
        let exact = [
            of(0, 0, a1 * a1),
            of(1, 1, a2 * a2),
            of(2, 2, b0 * b0) - 2.0 * of(2, 0, b0 * a1) + of(0, 0, a1 * a1),
            of(3, 3, dead_zone * dead_zone),
        ];
        let factor = cholesky(&sums.reversed(&SCALE)).unwrap();
        for (found, exact) in sums.std(&factor, &SCALE).into_iter().zip(exact) {
            let exact = (variance * exact).sqrt();
            assert!(
                (f64::from(found) / exact - 1.0).abs() < 1e-3,
                "{seed}: {found} {exact}"
            );
        }
    }
}
