use super::*;

/// Rows that excite three parameters: a deterministic mixture, then fitted without noise by theta =
/// (2, -1, 0.5).
fn row(k: usize) -> ([f32; 3], f32) {
    let wave = |period: usize| (k % period) as f32 / period as f32 - 0.5;
    let phi = [wave(7), wave(11), wave(5)];
    (phi, 2.0 * phi[0] - phi[1] + 0.5 * phi[2])
}

fn moved(forgetting: f32, rows: usize) -> Estimator<3> {
    let mut estimator = Estimator::new([0.0; 3], [100.0; 3], forgetting);
    for k in 0..rows {
        let (phi, psi) = row(k);
        let _ = estimator.update(&phi, psi);
    }
    estimator
}

#[test]
fn rows_without_noise_give_their_parameters() {
    let estimator = moved(1.0, 200);
    for (found, truth) in estimator.theta().iter().zip([2.0, -1.0, 0.5]) {
        assert!((found - truth).abs() < 1e-4);
    }
}

#[test]
fn noise_variance_of_a_known_residual() {
    // One parameter, psi = 3 phi +- 0.2 with phi = 1: the estimate is 3, the variance 0.04 n/(n
    // - 1).
    let mut estimator = Estimator::<1>::new([0.0], [1e3], 1.0);
    assert_eq!(estimator.noise_variance(), None);
    for k in 0..1000 {
        let error = if k % 2 == 0 { 0.2 } else { -0.2 };
        let _ = estimator.update(&[1.0], 3.0 + error);
    }
    let variance = estimator.noise_variance().unwrap();
    assert!((variance / (0.04 * 1000.0 / 999.0) - 1.0).abs() < 1e-3);
    assert_eq!(estimator.samples(), 1000.0);
}

#[test]
fn a_known_parameter_costs_no_degree_of_freedom() {
    let mut alone = Estimator::<1>::new([0.0], [1e3], 0.99);
    let mut beside = Estimator::<3>::new([0.0, 0.0, 2.0], [0.0, 1e3, 0.0], 0.99);
    for k in 0..500 {
        let x = (k % 11) as f32 - 4.0;
        let psi = 3.0 * x + (k % 7) as f32;
        let _ = alone.update(&[x], psi);
        let _ = beside.update(&[(k % 5) as f32, x, 0.25], psi + 0.5);
        assert_eq!(beside.noise_variance(), alone.noise_variance());
        assert_eq!(beside.theta()[1], alone.theta()[0]);
        assert_eq!(beside.covariance(1, 1), alone.covariance(0, 0));
    }
}

#[test]
fn a_correction_along_the_row_is_least_squares() {
    let mut estimator = moved(0.99, 50);
    let mut other = estimator.clone();
    let (phi, psi) = row(50);
    let innovation = estimator.update(&phi, psi + 1.0);
    other.correct(&phi, innovation);
    assert_eq!(estimator, other);
    assert_ne!(estimator, moved(0.99, 50));
}

#[test]
fn variances_are_those_of_the_covariance_also_while_it_is_inflated() {
    let mut estimator = moved(0.99, 50);
    let phi = [0.5, -1.0, 2.0];
    let stored = |estimator: &Estimator<3>| estimator.factors.spread(phi);
    for growth in [1.0, 8.0] {
        if growth > 1.0 {
            let weight = estimator.samples();
            estimator.begin_inflation(growth, [1e3; 3]);
            // What was learnt counts for so much less.
            assert_eq!(estimator.samples(), weight / growth);
        }
        let spread = estimator.spread(phi);
        assert!(spread > 0.0 && (spread / (growth * stored(&estimator)) - 1.0).abs() < 1e-6);
        let variances = estimator.variances();
        for (i, variance) in variances.iter().enumerate() {
            assert_eq!(*variance, estimator.covariance(i, i));
            assert_eq!(*variance, estimator.covariances()[i][i]);
        }
    }
}

#[test]
fn it_goes_on_from_another_estimate_with_more_of_its_covariance() {
    let mut estimator = moved(0.99, 50);
    let before = estimator.clone();
    assert!(estimator.noise_variance().is_some());
    estimator.resume([1.0, 2.0, 3.0], 4.0, &[1e9; 3]);
    assert_eq!(estimator.theta(), &[1.0, 2.0, 3.0]);
    for i in 0..3 {
        assert_eq!(estimator.covariance(i, i), 4.0 * before.covariance(i, i));
    }
    assert_eq!(
        (estimator.samples(), estimator.noise_variance()),
        (0.0, None)
    );
}

#[test]
fn an_expected_noise_has_the_weight_of_one_row() {
    let mut estimator = moved(0.99, 50);
    estimator.resume([1.0, 2.0, 3.0], 4.0, &[1e9; 3]);
    estimator.expect_noise(0.5);
    assert_eq!(estimator.noise_variance(), Some(0.5));
    for _ in 0..200 {
        let psi = estimator.theta()[0];
        let _ = estimator.update(&[1.0, 0.0, 0.0], psi);
    }
    // Rows without noise.
    assert!(estimator.noise_variance().is_some_and(|v| v < 0.01));
}

#[test]
fn a_weight_that_counts_for_nothing_becomes_zero() {
    let mut estimator = Estimator::<1>::new([0.0], [1.0], 0.5);
    let _ = estimator.update(&[1.0], 1.0);
    for k in 0..70 {
        let weight = estimator.samples();
        estimator.flush_sums();
        assert_eq!(estimator.samples() == 0.0, weight < 1e-18, "{k}");
        estimator.pass();
    }
}

#[test]
fn an_observation_of_a_parameter_says_what_was_known_of_it() {
    let mut estimator = moved(0.99, 50);
    assert_eq!(estimator.forgets_for(), 0.99);
    for index in 0..3 {
        let before = estimator.covariance(index, index);
        assert!(before > 0.0 && before != 1.0);
        let variance = 1.0 / 1024.0;
        assert_eq!(
            estimator.observe_parameter(index, 1.0, variance, 0.0),
            before
        );
        let after = estimator.covariance(index, index);
        let expected = before * variance / (before + variance);
        assert!((after / expected - 1.0).abs() < 1e-4, "{index}: {after}");
    }
    // Below what was asked for nothing happens.
    let before = estimator.clone();
    let known = estimator.observe_parameter(0, 9.0, 1.0, 1.0);
    assert_eq!(known, estimator.covariance(0, 0));
    assert_eq!(estimator, before);
}

#[test]
fn memory_is_that_of_the_forgetting() {
    let estimator = moved(0.99, 5000);
    assert!((estimator.samples() - 100.0).abs() < 0.1);
}

#[test]
fn an_innovation_is_expected_to_be_as_large_as_noise_and_what_is_not_known_make_it() {
    let lambda = 0.98;
    let mut before = Estimator::<3>::new([0.0; 3], [2.0; 3], lambda);
    for k in 0..300 {
        let (phi, psi) = row(k);
        // A row five times as large, now and then: it brings as much as its noise.
        let size = if k % 3 == 0 { 5.0 } else { 0.3 };
        let (phi, psi) = (phi.map(|x| size * x), psi + 0.1 * ((k % 13) as f32 - 6.0));
        let error = psi
            - phi
                .iter()
                .zip(before.theta())
                .map(|(a, b)| a * b)
                .sum::<f32>();
        let expected: f32 = (0..3)
            .flat_map(|i| (0..3).map(move |j| (i, j)))
            .map(|(i, j)| phi[i] * before.covariance(i, j) * phi[j])
            .sum();
        let mut after = before.clone();
        let spread = after.fold(&phi, error);
        assert!(
            (spread - expected).abs() < 1e-3 * (1e-3 + expected),
            "{k}: {spread} {expected}"
        );
        let [square, mean] = after.surprise(error, spread);
        let exact = error * error / (lambda + expected);
        assert!(
            (square - exact).abs() < 2e-3 * exact + 1e-6,
            "{k}: {square} {exact}"
        );
        // The mean of the rows before, each parameter a degree of freedom less.
        let freedom = lambda * before.residual.samples() - 3.0;
        if freedom > 0.01 {
            let exact = lambda * before.residual.squares() / freedom;
            assert!((mean / exact - 1.0).abs() < 2e-2, "{k}: {mean} {exact}");
        } else {
            assert!(freedom > -0.01 || mean == -1.0, "{k}: {mean}");
        }
        before = after;
    }
}

#[test]
fn as_many_rows_as_parameters_say_nothing_of_the_noise() {
    let mut estimator = Estimator::<2>::new([0.0; 2], [1e2; 2], 1.0);
    for phi in [[1.0, 0.5], [0.5, -1.0]] {
        let _ = estimator.update(&phi, 1.0);
        assert_eq!(estimator.noise_variance(), None);
    }
    // The newest row says nothing of those before it.
    let spread = estimator.fold(&[1.0, 1.0], 2.0);
    assert_eq!(estimator.surprise(2.0, spread)[1], -1.0);
    let spread = estimator.fold(&[1.0, 1.0], 1.0);
    assert!(estimator.surprise(1.0, spread)[1] > 0.0);
    assert!(
        estimator
            .noise_variance()
            .is_some_and(|variance| variance > 0.0)
    );
}

#[test]
fn a_sample_without_a_row_takes_its_share_of_what_is_known() {
    let mut estimator = moved(0.99, 1000);
    let before = estimator.clone();
    estimator.pass();
    assert_eq!(estimator.theta(), before.theta());
    assert_eq!(estimator.samples(), 0.99 * before.samples());
    assert_eq!(estimator.noise_variance(), before.noise_variance());
    for i in 0..3 {
        let growth = estimator.covariance(i, i) / before.covariance(i, i);
        assert!((growth * 0.99 - 1.0).abs() < 1e-5, "{growth}");
    }
}
