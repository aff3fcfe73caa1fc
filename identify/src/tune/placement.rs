//! Poles of sampled state equations where they are wanted (Ackermann's formula).
//!
//! In powers of the difference `(A - 1)/step` rather than of A: at fast sampling the powers of A
//! are nearly the same matrix.

use nalgebra::{Complex, DMatrix, DVector, RowDVector};

/// K such that `A - b K` has these eigenvalues, in conjugate pairs; `None` where the input does not
/// reach all states.
pub(super) fn gains(
    a: &DMatrix<f64>,
    b: &DVector<f64>,
    poles: &[Complex<f64>],
    step: f64,
) -> Option<RowDVector<f64>> {
    let n = a.nrows();
    let one = DMatrix::<f64>::identity(n, n);
    let difference = (a - &one) / step;
    let b = b / step;
    let mut reached = DMatrix::zeros(n, n);
    let mut column = b.clone();
    for j in 0..n {
        reached.set_column(j, &column);
        column = &difference * column;
    }
    // The polynomial of the poles, at the difference; complex pairs leave nothing imaginary.
    let mut polynomial = one.map(|v| Complex::new(v, 0.0));
    let wide = difference.map(|v| Complex::new(v, 0.0));
    for pole in poles {
        let shift = (pole - 1.0) / step;
        let factor = DMatrix::from_fn(n, n, |i, j| match i == j {
            true => wide[(i, j)] - shift,
            false => wide[(i, j)],
        });
        polynomial *= factor;
    }
    let last = RowDVector::from_fn(n, |_, j| if j + 1 == n { 1.0 } else { 0.0 });
    let inverse = reached.try_inverse()?;
    let k = last * inverse * polynomial.map(|v| v.re);
    k.iter().all(|v| v.is_finite()).then_some(k)
}

/// Poles of the s plane on the circle of radius `rate`, damping 0.7 for pairs, as poles of the
/// samples.
pub(super) fn circle(order: usize, rate: f64, dt: f64) -> Vec<Complex<f64>> {
    let mut poles = Vec::new();
    for _ in 0..order / 2 {
        let im = rate * (1.0 - 0.49_f64).sqrt();
        for im in [im, -im] {
            poles.push((Complex::new(-0.7 * rate, im) * dt).exp());
        }
    }
    if order % 2 == 1 {
        poles.push(Complex::new((-rate * dt).exp(), 0.0));
    }
    poles
}

/// Equal real poles of the s plane as poles of the samples.
pub(super) fn equal(order: usize, rate: f64, dt: f64) -> Vec<Complex<f64>> {
    vec![Complex::new((-rate * dt).exp(), 0.0); order]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_poles_are_where_they_are_wanted() {
        // Two integrators at 1 ms.
        let a = DMatrix::from_row_slice(2, 2, &[1.0, 1e-3, 0.0, 1.0]);
        let b = DVector::from_column_slice(&[0.5e-6, 1e-3]);
        let poles = circle(2, 20.0, 1e-3);
        let k = gains(&a, &b, &poles, 1e-3).expect("gains");
        let closed = &a - &b * &k;
        let mut found: Vec<_> = closed.complex_eigenvalues().iter().copied().collect();
        found.sort_by(|x, y| y.im.total_cmp(&x.im));
        for (found, wanted) in found.iter().zip(&poles) {
            assert!((found - wanted).norm() < 1e-9, "{found} {wanted}");
        }
        // About W^2 and 2 x 0.7 W.
        assert!((k[0] / 400.0 - 1.0).abs() < 0.03 && (k[1] / 28.0 - 1.0).abs() < 0.03);
    }
}
