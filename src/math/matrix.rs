//! Square matrices.

use crate::math::sqrt;

/// A square matrix, row by row.
pub(crate) type Matrix<const N: usize> = [[f32; N]; N];

/// A B.
pub(crate) fn product<const N: usize>(a: &Matrix<N>, b: &Matrix<N>) -> Matrix<N> {
    core::array::from_fn(|i| core::array::from_fn(|j| (0..N).map(|k| a[i][k] * b[k][j]).sum()))
}

/// A B'.
pub(crate) fn product_transposed<const N: usize>(a: &Matrix<N>, b: &Matrix<N>) -> Matrix<N> {
    core::array::from_fn(|i| core::array::from_fn(|j| (0..N).map(|k| a[i][k] * b[j][k]).sum()))
}

/// Lower triangle L with L L' = `matrix`; nothing where it is not clearly positive.
pub(crate) fn cholesky<const N: usize>(matrix: &Matrix<N>) -> Option<Matrix<N>> {
    let mut l = [[0.0; N]; N];
    for j in 0..N {
        let mut pivot = matrix[j][j];
        for k in 0..j {
            pivot -= l[j][k] * l[j][k];
        }
        if !(pivot > 1e-6 * matrix[j][j]) {
            return None;
        }
        l[j][j] = sqrt(pivot);
        for i in j + 1..N {
            let mut sum = matrix[i][j];
            for k in 0..j {
                sum -= l[i][k] * l[j][k];
            }
            l[i][j] = sum / l[j][j];
        }
    }
    Some(l)
}
