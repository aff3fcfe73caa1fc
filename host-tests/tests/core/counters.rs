//! Sums and counts over more samples than f32 can count.

use trendid::estimation::{Estimator, NoiseLevel};
use trendid::model::PredictionError;

/// Six times what a count in f32 reaches, and 28 hours at 1 kHz; a billion by the environment
/// variable.
fn samples() -> u32 {
    std::env::var("TRENDID_SAMPLES").map_or(100_000_000, |n| n.parse().expect("a number"))
}

#[test]
fn sums_of_errors_are_exact() {
    let n = samples();
    let mut errors = PredictionError::new();
    for k in 0..n {
        errors.update(if k % 3 == 0 { -0.003 } else { 0.001 });
    }
    let (many, few) = (f64::from(n - n / 3 - 1), f64::from(n / 3 + 1));
    let [large, small] = [0.003_f32, 0.001].map(f64::from);
    let (ise, iae) = (
        few * large * large + many * small * small,
        few * large + many * small,
    );
    println!(
        "{n} samples: ISE {} of {ise}, IAE {} of {iae}",
        errors.ise(),
        errors.iae()
    );
    assert_eq!(errors.samples(), n);
    assert!((f64::from(errors.ise()) / ise - 1.0).abs() < 3e-7);
    assert!((f64::from(errors.iae()) / iae - 1.0).abs() < 3e-7);
}

#[test]
fn a_noise_level_without_forgetting_neither_stagnates_nor_drifts() {
    let mut level = NoiseLevel::new(1.0);
    let mut state = 1_u32;
    for _ in 0..samples() {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        level.update(state as f32 * (0.01 / 4_294_967_296.0));
    }
    let std = level.variance().unwrap().sqrt();
    println!("white noise of 0.01 in width: {std}");
    // Of the newest 2^17 samples at least.
    assert!((std / (0.01 / 12.0_f32.sqrt()) - 1.0).abs() < 0.01);
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn an_estimate_without_forgetting_holds_beyond_what_f32_counts() {
    let mut estimator = Estimator::<2>::new([0.0; 2], [1e3; 2], 1.0);
    let mut state = 1_u32;
    for k in 0..samples() {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let noise = state as f32 * (0.02 / 4_294_967_296.0) - 0.01;
        let phi = [
            if k % 2 == 0 { 1.0 } else { -1.0 },
            if k % 3 == 0 { 0.5 } else { -0.5 },
        ];
        let _ = estimator.update(&phi, 2.0 * phi[0] - phi[1] + noise);
    }
    let theta = estimator.theta();
    let n = estimator.samples();
    let information = n * estimator.covariance(0, 0);
    println!("theta {theta:?}, {n} samples, n P_00 {information}");
    assert!((theta[0] - 2.0).abs() < 1e-5 && (theta[1] + 1.0).abs() < 1e-5);
    // Count and P stop together: what multiplies them stays right.
    assert!(information > 0.25 && information < 4.0);
    let noise = estimator.noise_variance().unwrap().sqrt();
    assert!((noise / (0.02 / 12.0_f32.sqrt()) - 1.0).abs() < 0.01);
}
