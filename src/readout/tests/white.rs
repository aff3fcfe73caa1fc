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
fn white_noise_is_what_the_residual_can_explain_and_none_beyond() {
    let mut parts = Parts::new(filtered(), [1e2; 4], 1.0, 400);
    // Parameters that are not of size 1.
    parts.estimator = Estimator::new([1.7, 0.4, 0.8, 0.1], [1.0; 4], 1.0);
    for k in 0..100 {
        let error = if k % 2 == 0 { 2e-3 } else { -2e-3 };
        let _ = parts.estimator.update(&[0.0; 4], error);
    }
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
        let found = compensate(&read, &read.regression(), true);
        let exact = top * top * white * all;
        let error = (found.residual.shaped - exact).abs();
        assert!(error <= 2e-3 * exact, "{share}: {error} of {exact}");
        // What white noise cannot be may be slow: 2/(omega Delta) samples count as one.
        let slow = close(found.residual.even, residual * 100.0, 1e-3);
        assert_eq!(slow, white == 0.0, "{share}");
    }
    // Before the level is known, and without a filter, nothing is.
    parts.noise = NoiseLevel::new(1.0);
    let read = parts.read();
    assert_eq!(
        compensate(&read, &read.regression(), true).residual.shaped,
        0.0
    );
    let mut parts = Parts::new(raw(), [1e2; 4], 1.0, 400);
    parts.noise = level(0.25 * all);
    let read = parts.read();
    assert_eq!(
        compensate(&read, &read.regression(), true).residual.shaped,
        0.0
    );
}

/// A recursion that has heard so much noise, and has seen nothing: its covariance is that of its
/// prior.
fn blind(error: f32, share: f32, rows: u16) -> Parts {
    blind_but([1e2; 4], error, share, rows)
}

/// The same of a prior with these deviations.
fn blind_but(std: [f32; 4], error: f32, share: f32, rows: u16) -> Parts {
    let mut parts = Parts::new(filtered(), std, 1.0, 0);
    for k in 0..rows {
        let error = if k % 2 == 0 { error } else { -error };
        let _ = parts.estimator.update(&[0.0; 4], -error);
    }
    let theta = *parts.estimator.theta();
    let residual = parts.read().residual();
    // psi - phi' theta of rows without phi.
    let (rows, free) = (f32::from(rows), std.iter().filter(|std| **std > 0.0));
    let less = rows - free.count() as f32;
    assert!(
        (residual / (error * error * rows / less) - 1.0).abs() < 1e-3,
        "{theta:?}"
    );
    parts.noise = level(share * residual / spread(&parts));
    parts
}

#[test]
fn a_residual_that_is_small_by_chance_is_as_uncertain_as_a_slow_one() {
    // Ten thousand rows are 200 independent ones: by chance a residual is up to 0.4 too small.
    for (share, lucky) in [(1.35, true), (1.6, true), (1.75, false), (9.0, false)] {
        let parts = blind(2e-3, share, 10_000);
        let read = parts.read();
        let found = compensate(&read, &read.regression(), true).residual;
        let dependent = if lucky { 2.0 / 0.02 } else { 1.0 };
        assert!(
            close(found.even, dependent * read.residual(), 1e-3),
            "{share}"
        );
        assert_eq!(found.shaped, 0.0, "{share}");
    }
}

#[test]
fn what_few_rows_leave_of_a_bias_is_uncertain() {
    let parts = blind(2e-3, 0.5, 100);
    let read = parts.read();
    let p = read.covariance();
    let found = compensate(&read, &read.regression(), true);
    let units = parts.regressor.units();
    let bare: [f32; 4] = core::array::from_fn(|j| units[j] * parts.estimator.theta()[j]);
    assert!(found.share() < 1.0, "{}", found.share());
    let (shaped, floor) = read.shaped(&p, &found);
    let covariance = read.estimate().covariance;
    for i in 0..4 {
        // A hundred rows are two that tell something new: nothing is taken out.
        assert_eq!(found.theta[i], bare[i]);
        for bias in found.biases() {
            assert!(i < 2 || bias[i] == 0.0, "{i}: {bias:?}");
        }
        assert_eq!(found.left[i] != 0.0, i < 2, "{i}: {}", found.left[i]);
        for j in 0..4 {
            let common = match (i < 3 && j < 3, i == j) {
                (false, _) => 0.0,
                (_, true) => 1.01,
                _ => 1.0,
            };
            let exact = shaped[i][j] * units[i] * units[j]
                + found.biases().map(|bias| bias[i] * bias[j]).sum::<f32>()
                + common * floor * floor * found.theta[i] * found.theta[j];
            let size = libm::sqrtf(covariance[i][i] * covariance[j][j]);
            let error = (covariance[i][j] - exact).abs();
            assert!(error < 1e-4 * size, "{i} {j}: {error} of {size}");
        }
    }
}

#[test]
fn a_bias_that_is_left_is_that_of_the_noise_in_the_rows_and_of_drift() {
    for share in [0.999_f32, 0.5] {
        let parts = blind(2e-3, share, 100);
        let read = parts.read();
        let p = read.covariance();
        let found = compensate(&read, &read.regression(), true);
        assert!(found.share() < 1e-4, "nothing is taken out");
        let white = parts.noise.variance().expect("a level");
        // n s / (1 + 4/nu) of a hundred rows, two of which tell something new.
        let level = 100.0 * white * 2.0 / (2.0 + 4.0);
        let (theta, units) = (parts.estimator.theta(), parts.regressor.units());
        // Q (M theta - m) of a parameter, and t - 2 theta' m + theta' M theta.
        let of = |(matrix, vector, top): (Matrix<3>, [f32; 3], f32)| {
            let along = |i: usize| (0..3).map(|j| matrix[i][j] * theta[j]).sum::<f32>();
            let bias = core::array::from_fn::<_, 2, _>(|i| p[i][i] * (along(i) - vector[i]));
            let spread = (0..3).fold(top, |sum, i| sum + theta[i] * (along(i) - 2.0 * vector[i]));
            (bias, spread)
        };
        let gain = &parts.design.noise_gain;
        let (bias, _) = of(parts.regressor.noise_moments::<0>(gain));
        let (drift, spread) = of(parts.regressor.noise_moments::<1>(gain));
        let chance = 4.0 * libm::sqrtf(2.0 / 100.0);
        let rest = (1.0 - share * (1.0 + chance)).max(0.0) * read.residual();
        for i in 0..2 {
            let exact = units[i] * (level * bias[i] + 100.0 * rest / spread * drift[i]);
            let error = (found.left[i] - exact).abs();
            assert!(
                error <= 3e-3 * exact.abs(),
                "{share} {i}: {error} of {exact}"
            );
            // All of the noise is in doubt, of a drive of three times the bandwidth: a_1 and a_2.
            let off = [8.0, 2.0, 0.0];
            let (matrix, ..) = parts.regressor.noise_moments::<0>(gain);
            let share = (0..2).map(|k| p[k][k] * level * matrix[k][k]).sum::<f32>();
            assert!(share > 0.0);
            for (k, bias) in found.in_doubt.iter().enumerate() {
                let of =
                    |moment: f32| share.min(1.0) * units[i] * p[i][i] * level * off[k] * moment;
                let size = of(libm::sqrtf(matrix[i][i] * matrix[k][k]));
                let error = (bias[i] - of(matrix[i][k])).abs();
                assert!(error <= 3e-3 * size, "{i} {k}: {error} of {size}");
            }
        }
    }
}

#[test]
fn white_noise_counts_by_its_spectrum_behind_the_filter_and_rounding_in_the_band() {
    // All of the residual is white, and hardly anything is left but rounding. An initial state acts
    // below the slow pole of the filter: many rows tell that from what acts at all frequencies. A
    // parameter that is known stands apart.
    let initial = Structure::INTEGRATING_WITH_INITIAL_STATE;
    let (free, known) = ([1e2; 4], [1e2, 0.0, 1e2, 1e2]);
    for (structure, std, error, share, rows) in [
        (SERVO, free, 2e-3, 0.999, 100),
        (SERVO, free, 1e-8, 9.0, 100),
        (SERVO, known, 2e-3, 0.999, 100),
        (initial, free, 2e-3, 0.999, 4000),
    ] {
        let parts = blind_but(std, error, share, rows);
        let rows = f32::from(rows);
        let read = parts.read_as(&structure);
        let p = read.covariance();
        let found = compensate(&read, &read.regression(), true);
        let (covariance, _) = read.shaped(&p, &found);
        let [a1, a2, ..] = found.theta;
        let natural = libm::sqrtf(a1);
        let parameters = structure.parameters();
        let spectrum = ResidualSpectrum {
            parameters,
            units: parts.regressor.units(),
            theta: &found.theta,
            denominator: [0.0, a1, a2],
            filter: [1064.8, 551.76, 33.0],
            natural,
            // Samples of 1 ms, and the slow pole of the filter.
            duration: 1e-3 * rows,
            slowest: 2.2,
        };
        let (r, s) = spectrum.sums();
        let t = transform(r, s, std.map(|std| std > 0.0)).expect("a spectrum");
        let own = found.covariance(&p);
        let in_band = sandwich(&t, &own, &parameters);
        let angle = natural * 1e-3;
        // A quarter of the last digit in each of them, over the angle of a sample.
        let rounding = 0.25 * f32::EPSILON / angle;
        let even = found.residual.even + rows * rounding * rounding;
        for i in 0..4 {
            for j in 0..4 {
                let exact = found.residual.shaped * in_band[i][j] + even * own[i][j];
                let size = libm::sqrtf(covariance[i][i] * covariance[j][j]);
                let error = (covariance[i][j] - exact).abs();
                assert!(error <= 1e-2 * size, "{share} {i} {j}: {error} of {size}");
            }
        }
        assert_eq!(found.residual.shaped > 0.0, share < 1.0);
    }
}
