use super::*;

#[test]
fn a_line_by_hand() {
    // y = 1 + 2 x with weight 0 on a wild point.
    let phi = DMatrix::from_row_slice(4, 2, &[1.0, 0.0, 1.0, 1.0, 1.0, 2.0, 1.0, 3.0]);
    let target = DVector::from_column_slice(&[1.0, 3.0, 99.0, 7.0]);
    let fit = least_squares(&phi, &target, Some(&[1.0, 1.0, 0.0, 1.0])).unwrap();
    assert!((fit.theta[0] - 1.0).abs() < 1e-12 && (fit.theta[1] - 2.0).abs() < 1e-12);
    assert!(fit.loss < 1e-20);
    // Phi' W Phi = [3 4; 4 10], determinant 14.
    assert!((fit.inverse[(0, 0)] - 10.0 / 14.0).abs() < 1e-12);
    assert!((fit.inverse[(0, 1)] + 4.0 / 14.0).abs() < 1e-12);
}

#[test]
fn dependent_columns_are_refused() {
    let phi = DMatrix::from_row_slice(3, 2, &[1.0, 2.0, 2.0, 4.0, 3.0, 6.0]);
    let target = DVector::from_column_slice(&[1.0, 2.0, 3.0]);
    assert!(least_squares(&phi, &target, None).is_none());
}

#[test]
fn recursion_is_its_batch_equivalent() {
    // Textbook recursion, a few steps in f64, against the batch with prior rows and weights.
    let lambda = 0.97;
    let phi = DMatrix::from_fn(40, 2, |k, j| ((k * (j + 2)) as f64 * 0.7).sin() + j as f64);
    let target = DVector::from_fn(40, |k, _| (k as f64 * 0.3).cos());
    let (prior, sd, noise) = ([0.5, -1.0], [2.0, 0.1], 0.3);
    let mut p = DMatrix::from_diagonal(&DVector::from_fn(2, |i, _| {
        (sd[i] / noise) * (sd[i] / noise)
    }));
    let mut theta = DVector::from_column_slice(&prior);
    for k in 0..40 {
        let row = phi.row(k).transpose();
        let gain = &p * &row / (lambda + (row.transpose() * &p * &row)[0]);
        theta += &gain * (target[k] - (row.transpose() * &theta)[0]);
        p = (&p - &gain * (row.transpose() * &p)) / lambda;
    }
    let fit = recursive_equivalent(&phi, &target, lambda, &prior, &sd, noise).unwrap();
    assert!((fit.theta - theta).norm() < 1e-12);
    assert!((fit.inverse - p).norm() < 1e-10);
}
