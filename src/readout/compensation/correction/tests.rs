//! The correction by the equations that it solves.

use super::*;
use crate::math::matrix::{product, product_transposed};

const P: Matrix<3> = [
    [0.04, 0.01, 0.005],
    [0.01, 0.09, -0.02],
    [0.005, -0.02, 0.25],
];
const NOISE: NoiseMoments<2> = NoiseMoments {
    matrix: [[2.0, 0.3], [0.3, 1.0]],
    vector: [0.2, -0.1],
    top: 3.0,
};

/// M and m of all parameters.
fn wide(noise: &NoiseMoments<2>) -> (Matrix<3>, [f32; 3]) {
    let [[a, b], [c, d]] = noise.matrix;
    let [e, f] = noise.vector;
    ([[a, b, 0.0], [c, d, 0.0], [0.0; 3]], [e, f, 0.0])
}

/// Q and P_c.
fn read(found: &Correction<2, 3>, p: &Matrix<3>) -> (Matrix<3>, Matrix<3>) {
    let (mut gain, mut covariance) = (*p, *p);
    found.add_gain(&mut gain);
    found.add_covariance(&mut covariance);
    (gain, covariance)
}

fn close(found: f32, exact: f32, size: f32) {
    assert!((found - exact).abs() <= 2e-5 * size, "{found}, not {exact}");
}

/// Numbers in [-1, 1).
fn draws(seed: u32) -> impl FnMut() -> f32 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 8_388_608.0 - 1.0
    }
}

#[test]
fn noise_is_taken_out_of_the_normal_equations() {
    let bare = [1.0, -2.0, 0.5];
    let (matrix, vector) = wide(&NOISE);
    for level in [0.0, 0.1, 1.0, 6.0] {
        let found = Correction::of(&bare, &P, &NOISE, level, 0.99).expect("a correction");
        assert_eq!(found.share, 1.0);
        let (gain, covariance) = read(&found, &P);
        // Q (P^-1 - w M) = 1 and P_c = Q P^-1 Q, both without P^-1.
        let (seen, squared) = (
            product(&product(&gain, &matrix), &P),
            product_transposed(&product(&gain, &matrix), &gain),
        );
        let bias: [f32; 3] = core::array::from_fn(|i| level * (dot(&matrix[i], &bare) - vector[i]));
        for i in 0..3 {
            for j in 0..3 {
                let size = sqrt(gain[i][i] * gain[j][j]);
                close(gain[i][j], P[i][j] + level * seen[i][j], size);
                let size = sqrt(covariance[i][i] * covariance[j][j]);
                close(covariance[i][j], gain[i][j] + level * squared[i][j], size);
            }
            close(found.theta[i], bare[i] + dot(&gain[i], &bias), 2.0);
        }
    }
}

#[test]
fn what_a_limit_leaves_is_told() {
    let bare = [1.0, -2.0, 0.5];
    let (level, largest) = (20.0, 0.5);
    let found = Correction::of(&bare, &P, &NOISE, level, largest).expect("a correction");
    assert!(found.share > 0.1 && found.share < 0.5, "{}", found.share);
    // As much as a correction of this weight, which is allowed, takes out.
    let weight = found.share * level;
    let same = Correction::of(&bare, &P, &NOISE, 0.999 * weight, largest).expect("a correction");
    assert_eq!(same.share, 1.0);
    for i in 0..3 {
        assert!((same.theta[i] - found.theta[i]).abs() < 5e-3);
    }
    let (gain, _) = read(&found, &P);
    let (matrix, vector) = wide(&NOISE);
    let left: [f32; 3] =
        core::array::from_fn(|i| (level - weight) * (dot(&matrix[i], &found.theta) - vector[i]));
    let bias = NOISE.bias(&found.theta, &P, Some(&found), level - weight);
    for (i, bias) in bias.into_iter().enumerate() {
        close(bias, dot(&gain[i], &left), 1.0);
        assert!(bias != 0.0);
    }
    // Where nothing may be taken, nothing is, and all of it is left.
    let found = Correction::of(&bare, &P, &NOISE, level, 0.0).expect("a correction");
    assert_eq!((found.theta, found.share), (bare, 0.0));
    assert_eq!(read(&found, &P), (P, P));
}

#[test]
fn a_bias_is_what_the_normal_equations_without_the_noise_differ_by() {
    let (matrix, vector) = wide(&NOISE);
    let (theta, level) = ([1.0, -2.0, 0.5], 0.3);
    let score: [f32; 3] = core::array::from_fn(|i| level * (dot(&matrix[i], &theta) - vector[i]));
    let bare = NOISE.bias(&theta, &P, None, level);
    let found = Correction::of(&theta, &P, &NOISE, 1.0, 0.99).expect("a correction");
    let (gain, _) = read(&found, &P);
    let corrected = NOISE.bias(&theta, &P, Some(&found), level);
    let of = |k: usize, i: usize| dot(&gain[i], &matrix[k]);
    let sizes = [3.0, 1.0];
    // The trace of Q level M, and no more than all.
    for (level, share) in [(level, level * (of(0, 0) + of(1, 1))), (10.0, 1.0)] {
        assert!(share > 0.05 && share <= 1.0, "{share}");
        let in_doubt = found.in_doubt(&P, &NOISE, level, &sizes);
        for (k, (change, size)) in in_doubt.iter().zip(sizes).enumerate() {
            for i in 0..3 {
                close(change[i], share * size * level * of(k, i), size * level);
            }
        }
    }
    for i in 0..3 {
        close(bare[i], dot(&P[i], &score), 1.0);
        close(corrected[i], dot(&gain[i], &score), 1.0);
    }
    // 3 - 2 (0.2 + 0.2) + 2 - 1.2 + 4
    close(NOISE.spread(&theta), 7.0, 10.0);
}

#[test]
fn nothing_drawn_makes_a_covariance_smaller_or_an_estimate_infinite() {
    let mut draw = draws(1);
    for _ in 0..20_000 {
        // Any P and M with a root, over many sizes, also of fewer directions than parameters.
        let mut scale = || 10.0_f32.powf(6.0 * draw());
        let sizes: [f32; 6] = core::array::from_fn(|_| scale());
        let root: Matrix<3> = core::array::from_fn(|i| {
            core::array::from_fn(|_| sizes[i] * if draw() > -0.9 { draw() } else { 0.0 })
        });
        let p = product_transposed(&root, &root);
        let root: Matrix<2> =
            core::array::from_fn(|i| core::array::from_fn(|_| sizes[3 + i] * draw()));
        let noise = NoiseMoments {
            matrix: product_transposed(&root, &root),
            vector: [sizes[3] * draw(), sizes[4] * draw()],
            top: 0.0,
        };
        let bare = core::array::from_fn(|_| 3.0 * draw());
        let largest = 0.5 * (1.0 + draw()) * 0.999;
        let found = Correction::of(&bare, &p, &noise, sizes[5], largest).expect("a correction");
        let (gain, covariance) = read(&found, &p);
        assert!((0.0..=1.0).contains(&found.share));
        assert!(found.theta.iter().all(|value| value.is_finite()));
        // No direction grows by more than the limit says.
        let most = 1.0 / (1.0 - largest);
        for i in 0..3 {
            assert!(gain[i][i] >= p[i][i] && covariance[i][i] >= gain[i][i]);
            assert!(gain[i][i] <= 1.001 * most * p[i][i]);
            assert!(covariance[i][i] <= 1.001 * most * most * p[i][i]);
        }
    }
}

#[test]
fn what_is_no_number_corrects_nothing() {
    let nan = [[f32::NAN; 3]; 3];
    assert!(Correction::of(&[1.0; 3], &nan, &NOISE, 1.0, 0.5).is_none());
    assert!(Correction::of(&[1.0; 3], &P, &NOISE, f32::NAN, 0.5).is_none());
}
