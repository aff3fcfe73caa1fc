//! How much of the residual is white noise of y.

use super::*;
use crate::readout::compensation::compensate;
use crate::trends::{Form, Memory};

/// Variance of the residual under white noise of variance 1 on y: the sum of its squares behind a
/// single 1.
fn spread(parts: &Parts) -> f32 {
    let trends = FilteredTrends::<3>::for_bandwidth(Scheme::Tustin, 1e-3, BANDWIDTH);
    let trends = trends.expect("a filter");
    let mut memory = Memory::output_at_rest(trends.design(), Form::Position, 0.0);
    (0..10_000).fold(0.0, |sum, k| {
        let y = if k == 0 { 1.0 } else { 0.0 };
        let output = trends.output(&mut memory, y, Form::Position);
        let (phi, psi) = (parts.regressor).assemble(&output, &[[0.0; 3]], &[0.0; 2]);
        let residual = parts.estimator.innovation(&phi, psi);
        sum + residual * residual
    })
}

/// A level of this variance.
fn level(variance: f32) -> NoiseLevel {
    let mut level = NoiseLevel::new(1.0);
    // The variance of +-a reads 3.2 a^2.
    let size = libm::sqrtf(variance / 3.2);
    for k in 0..30_000 {
        level.update(if k % 2 == 0 { size } else { -size });
    }
    level
}

#[test]
#[cfg_attr(miri, ignore = "many samples")]
fn white_noise_is_what_the_residual_can_explain_and_none_beyond() {
    let mut parts = Parts::new(filtered(), [1e2; 4], 1.0, 400);
    let residual = parts.read().residual();
    // What would make all of the residual.
    let all = residual / spread(&parts);
    let top = parts.regressor.top_scale();
    for (share, white) in [
        (0.25, 0.25),
        (0.98, 0.98),
        (1.02, 1.0),
        (1.28, 1.0),
        (1.32, 0.0),
        (9.0, 0.0),
    ] {
        parts.noise = level(share * all);
        let read = parts.read();
        let found = compensate(&read, &read.covariance());
        let exact = top * top * white * all;
        let error = (found.residual.shaped - exact).abs();
        assert!(error <= 2e-3 * exact, "{share}: {error} of {exact}");
        assert_eq!(found.residual.even == residual, white == 0.0, "{share}");
    }
    // Before the level is known, and without a filter, nothing is.
    parts.noise = NoiseLevel::new(1.0);
    let read = parts.read();
    assert_eq!(compensate(&read, &read.covariance()).residual.shaped, 0.0);
    let mut parts = Parts::new(raw(), [1e2; 4], 1.0, 400);
    parts.noise = level(0.25 * all);
    let read = parts.read();
    assert_eq!(compensate(&read, &read.covariance()).residual.shaped, 0.0);
}
