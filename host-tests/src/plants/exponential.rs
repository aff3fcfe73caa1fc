//! Matrix exponential and the exact discretisation built on it.

use nalgebra::DMatrix;

/// Observer-form system matrix of the monic denominator `a`.
pub(crate) fn companion_matrix(a: &[f64]) -> DMatrix<f64> {
    let m = a.len();
    let mut full = DMatrix::zeros(m, m);
    for i in 0..m {
        full[(i, 0)] = -a[m - 1 - i];
        if i + 1 < m {
            full[(i, i + 1)] = 1.0;
        }
    }
    full
}

/// `exp(A dt)`, the integral of the held inputs, and that of a unit ramp over `dt`.
pub(crate) fn discretise(
    a: &DMatrix<f64>,
    b: &DMatrix<f64>,
    dt: f64,
) -> (DMatrix<f64>, DMatrix<f64>, DMatrix<f64>) {
    let (m, n) = (a.nrows(), b.ncols());
    // d/dt [x; u; r] with u' = r / dt: the ramp rises by one over the interval.
    let mut block = DMatrix::zeros(m + 2 * n, m + 2 * n);
    block.view_mut((0, 0), (m, m)).copy_from(&(a * dt));
    block.view_mut((0, m), (m, n)).copy_from(&(b * dt));
    for j in 0..n {
        block[(m + j, m + n + j)] = 1.0;
    }
    let e = exponential(&block);
    (
        e.view((0, 0), (m, m)).into_owned(),
        e.view((0, m), (m, n)).into_owned(),
        e.view((0, m + n), (m, n)).into_owned(),
    )
}

/// Matrix exponential by balancing, scaling and squaring of the Taylor series.
///
/// The states of a plant differ by powers of its bandwidth (1, 20, 400, ..), so the powers of two
/// of a diagonal similarity are taken out first; without it the norm, and with it the number of
/// squarings, is far too large.
pub fn exponential(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let n = matrix.nrows();
    let mut a = matrix.clone();
    let mut scale = vec![1.0_f64; n];
    for _ in 0..20 {
        let mut settled = true;
        for i in 0..n {
            let row: f64 = (0..n).filter(|&j| j != i).map(|j| a[(i, j)].abs()).sum();
            let column: f64 = (0..n).filter(|&j| j != i).map(|j| a[(j, i)].abs()).sum();
            if row == 0.0 || column == 0.0 {
                continue;
            }
            let factor = (0.5 * (row / column).log2()).round().exp2();
            if factor != 1.0 {
                settled = false;
                scale[i] *= factor;
                for j in 0..n {
                    a[(i, j)] /= factor;
                    a[(j, i)] *= factor;
                }
            }
        }
        if settled {
            break;
        }
    }
    let norm = (0..n)
        .map(|j| a.column(j).iter().map(|v| v.abs()).sum::<f64>())
        .fold(0.0, f64::max);
    let squarings = if norm > 0.25 {
        (norm / 0.25).log2().ceil() as i32
    } else {
        0
    };
    a *= (-f64::from(squarings)).exp2();
    // 0.25^k / k! is below 1e-20 from k = 13 on.
    let mut sum = DMatrix::identity(n, n);
    for k in (1..=16).rev() {
        sum = DMatrix::identity(n, n) + (&a * sum) / f64::from(k);
    }
    for _ in 0..squarings {
        sum = &sum * &sum;
    }
    for i in 0..n {
        for j in 0..n {
            sum[(i, j)] *= scale[i] / scale[j];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponential_of_a_rotation_and_of_a_nilpotent() {
        let w = 3.0;
        let e = exponential(&DMatrix::from_row_slice(2, 2, &[0.0, w, -w, 0.0]));
        close(e[(0, 0)], w.cos(), 1e-14);
        close(e[(0, 1)], w.sin(), 1e-13);
        let e = exponential(&DMatrix::from_row_slice(
            3,
            3,
            &[0.0, 2.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0],
        ));
        close(e[(0, 2)], 3.0, 1e-15);
    }

    #[test]
    fn badly_scaled_matrices_lose_no_digits() {
        // Companion of (s + 1000)^2 by columns: exp(A t) = e^(-1000 t) (I + (A + 1000 I) t).
        let a = companion_matrix(&[1e6, 2e3]);
        let t = 0.01;
        let shifted = &a + DMatrix::identity(2, 2) * 1e3;
        let want = (DMatrix::identity(2, 2) + shifted * t) * (-1e3 * t).exp();
        let got = exponential(&(&a * t));
        for (g, w) in got.iter().zip(want.iter()) {
            close(*g, *w, 1e-12);
        }
    }

    fn close(got: f64, want: f64, relative: f64) {
        assert!(
            (got - want).abs() <= relative * want.abs(),
            "{got} is not {want}"
        );
    }
}
