//! Square matrices.

use crate::math::sqrt;

/// A square matrix, row by row.
pub(crate) type Matrix<const N: usize> = [[f32; N]; N];

/// A pivot of more than this share of its diagonal is clearly positive.
const CLEAR: f32 = 1e-6;

/// a' b.
pub(crate) fn dot<const N: usize>(a: &[f32; N], b: &[f32; N]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A + `weight` a a'.
#[inline(always)]
pub(crate) fn add_square<const N: usize>(sum: &mut Matrix<N>, a: &[f32; N], weight: f32) {
    for (own, row) in a.iter().zip(sum) {
        for (entry, other) in row.iter_mut().zip(a) {
            *entry += (own * other) * weight;
        }
    }
}

/// A B.
pub(crate) fn product<const N: usize>(a: &Matrix<N>, b: &Matrix<N>) -> Matrix<N> {
    core::array::from_fn(|i| product_row(&a[i], b))
}

/// A B'.
pub(crate) fn product_transposed<const N: usize>(a: &Matrix<N>, b: &Matrix<N>) -> Matrix<N> {
    core::array::from_fn(|i| product_row_transposed(&a[i], b))
}

/// A B' of two lower triangles: the same bits without what is 0.
pub(crate) fn product_of_triangles<const N: usize>(a: &Matrix<N>, b: &Matrix<N>) -> Matrix<N> {
    let upto = |i: usize, j: usize| a[i].iter().zip(&b[j]).take(i.min(j) + 1);
    core::array::from_fn(|i| core::array::from_fn(|j| upto(i, j).map(|(a, b)| a * b).sum()))
}

/// a' B.
pub(crate) fn product_row<const N: usize>(a: &[f32; N], b: &Matrix<N>) -> [f32; N] {
    core::array::from_fn(|j| (0..N).map(|k| a[k] * b[k][j]).sum())
}

/// a' B'.
pub(crate) fn product_row_transposed<const N: usize>(a: &[f32; N], b: &Matrix<N>) -> [f32; N] {
    core::array::from_fn(|j| (0..N).map(|k| a[k] * b[j][k]).sum())
}

/// Lower triangle L with L L' = `matrix`; nothing where it is not clearly positive.
pub(crate) fn cholesky<const N: usize>(matrix: &Matrix<N>) -> Option<Matrix<N>> {
    let mut l = [[0.0; N]; N];
    for (i, row) in l.iter_mut().enumerate() {
        row[..=i].copy_from_slice(&matrix[i][..=i]);
    }
    factor(&mut l).then_some(l)
}

/// Puts L with L L' = `matrix` into its lower triangle, the only one that is read; whether it is
/// clearly positive.
pub(crate) fn factor<const N: usize>(matrix: &mut Matrix<N>) -> bool {
    factor_columns(matrix, 0, N)
}

/// The same for the columns from one up to another, when those before are done.
pub(crate) fn factor_columns<const N: usize>(
    matrix: &mut Matrix<N>,
    from: usize,
    to: usize,
) -> bool {
    for j in from..to.min(N) {
        let (done, below) = matrix.split_at_mut(j + 1);
        let Some(row) = done.last_mut() else {
            return false;
        };
        let (own, rest) = row.split_at_mut(j);
        let [diagonal, ..] = rest else {
            return false;
        };
        let pivot = less(*diagonal, own, own);
        if !(pivot > CLEAR * *diagonal) {
            return false;
        }
        *diagonal = sqrt(pivot);
        for other in below {
            other[j] = less(other[j], other, own) / *diagonal;
        }
    }
    true
}

/// `x - a' b` over the length of b.
fn less(x: f32, a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).fold(x, |x, (a, b)| x - a * b)
}

/// Lower triangle L with L L' = `matrix`, which has no negative direction; a column without a
/// clearly positive pivot is 0.
pub(crate) fn root<const N: usize>(matrix: &Matrix<N>) -> Matrix<N> {
    let mut l = [[0.0; N]; N];
    for j in 0..N {
        let diagonal = matrix[j][j];
        let pivot = diagonal - dot(&l[j], &l[j]);
        if !(pivot > CLEAR * diagonal) {
            continue;
        }
        let length = sqrt(pivot);
        for i in j + 1..N {
            l[i][j] = (matrix[i][j] - dot(&l[i], &l[j])) / length;
        }
        l[j][j] = length;
    }
    l
}

/// The first `count` entries of L^-1 b for a lower triangle L, those of b behind them.
pub(crate) fn forward_to<const N: usize>(l: &Matrix<N>, b: [f32; N], count: usize) -> [f32; N] {
    let mut x = b;
    for i in 0..N {
        if i < count {
            for k in 0..i {
                x[i] -= l[i][k] * x[k];
            }
            x[i] /= l[i][i];
        }
    }
    x
}

/// L^-1 b for a lower triangle L.
pub(crate) fn forward<const N: usize>(l: &Matrix<N>, b: [f32; N]) -> [f32; N] {
    forward_to(l, b, N)
}

/// L^-T b for a lower triangle L.
pub(crate) fn backward<const N: usize>(l: &Matrix<N>, b: [f32; N]) -> [f32; N] {
    let mut x = b;
    for i in (0..N).rev() {
        for k in i + 1..N {
            x[i] -= l[k][i] * x[k];
        }
        x[i] /= l[i][i];
    }
    x
}

/// Column j.
pub(crate) fn column<const N: usize>(matrix: &Matrix<N>, j: usize) -> [f32; N] {
    core::array::from_fn(|i| matrix[i][j])
}

/// A'.
pub(crate) fn transposed<const N: usize>(matrix: &Matrix<N>) -> Matrix<N> {
    core::array::from_fn(|j| column(matrix, j))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_factor_in_parts_is_the_whole_one() {
        let matrix = [[4.0, 0.0, 0.0], [2.0, 5.0, 0.0], [0.5, 2.0, 5.0]];
        let whole = cholesky(&matrix).unwrap();
        for middle in 0..=3 {
            let mut parts = matrix;
            assert!(factor_columns(&mut parts, 0, middle) && factor_columns(&mut parts, middle, 9));
            assert_eq!(parts, whole, "{middle}");
        }
    }

    #[test]
    fn the_factors_solve() {
        let matrix = [[4.0, 2.0, 0.0], [2.0, 5.0, 2.0], [0.0, 2.0, 5.0]];
        let l = cholesky(&matrix).unwrap();
        assert_eq!(product_transposed(&l, &l), matrix);
        assert_eq!(product(&l, &transposed(&l)), matrix);
        // x = (1, 2, 3)
        assert_eq!(
            backward(&l, forward(&l, [8.0, 18.0, 19.0])),
            [1.0, 2.0, 3.0]
        );
        assert_eq!(cholesky(&[[1.0, 2.0], [2.0, 1.0]]), None);
        assert_eq!(cholesky(&[[f32::NAN]]), None);
    }

    #[test]
    fn a_root_leaves_directions_out_that_are_not_there() {
        // Of the third only what the first two say of it, and nothing of the fourth.
        let matrix = [
            [4.0, 2.0, 6.0, 0.0],
            [2.0, 5.0, 7.0, 0.0],
            [6.0, 7.0, 13.0, 0.0],
            [0.0, 0.0, 0.0, 0.0],
        ];
        let l = root(&matrix);
        assert_eq!(product_transposed(&l, &l), matrix);
        assert_eq!((l[2][2], l[3]), (0.0, [0.0; 4]));
        assert_eq!(root(&[[f32::NAN]]), [[0.0]]);
    }
}
