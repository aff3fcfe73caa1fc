use super::*;

/// Rows that excite three parameters: a deterministic mixture, then fitted without noise by theta = (2, -1, 0.5).
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
    // One parameter, psi = 3 phi +- 0.2 with phi = 1: the estimate is 3, the variance 0.04 n/(n - 1).
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
fn memory_is_that_of_the_forgetting() {
    let estimator = moved(0.99, 5000);
    assert!((estimator.samples() - 100.0).abs() < 0.1);
}
