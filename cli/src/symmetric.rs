//! Eigenvalues of small symmetric matrices, and least squares with them.

/// Eigenvalues and unit eigenvectors of a symmetric matrix by Jacobi rotations.
pub fn eigen(matrix: &[Vec<f64>]) -> Vec<(f64, Vec<f64>)> {
    let n = matrix.len();
    let mut a = matrix.to_vec();
    let mut v: Vec<Vec<f64>> = (0..n)
        .map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect())
        .collect();
    // Convergence is quadratic: ten sweeps are more than ten by ten needs.
    for _ in 0..30 {
        let off: f64 = (0..n)
            .flat_map(|i| (0..i).map(move |j| (i, j)))
            .map(|(i, j)| a[i][j].powi(2))
            .sum();
        if off < 1e-30 {
            break;
        }
        for p in 0..n {
            for q in p + 1..n {
                if a[p][q] == 0.0 {
                    continue;
                }
                let ratio = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = ratio.signum() / (ratio.abs() + (ratio * ratio + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for row in a.iter_mut().chain(v.iter_mut()) {
                    let (x, y) = (row[p], row[q]);
                    row[p] = c * x - s * y;
                    row[q] = s * x + c * y;
                }
                for k in 0..n {
                    let (x, y) = (a[p][k], a[q][k]);
                    a[p][k] = c * x - s * y;
                    a[q][k] = s * x + c * y;
                }
            }
        }
    }
    (0..n)
        .map(|k| (a[k][k], v.iter().map(|row| row[k]).collect()))
        .collect()
}

/// The combination of `columns` nearest to `rest` in the sense of least squares;
/// directions in which the columns are nothing are left alone.
pub fn nearest(columns: &[Vec<f64>], rest: &[f64]) -> Vec<f64> {
    let n = columns.len();
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    // Columns of size one, so that "nothing" has no unit.
    let size: Vec<f64> = columns
        .iter()
        .map(|c| dot(c, c).sqrt().max(f64::MIN_POSITIVE))
        .collect();
    let normal: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            (0..n)
                .map(|j| dot(&columns[i], &columns[j]) / (size[i] * size[j]))
                .collect()
        })
        .collect();
    let modes = eigen(&normal);
    let mut found = vec![0.0; rest.len()];
    // The second pass takes back what squaring the condition lost.
    for _ in 0..2 {
        let left: Vec<f64> = rest.iter().zip(&found).map(|(r, f)| r - f).collect();
        let right: Vec<f64> = (0..n).map(|i| dot(&columns[i], &left) / size[i]).collect();
        let mut weights = vec![0.0; n];
        for (value, vector) in modes.iter().filter(|(value, _)| *value > 1e-12) {
            let share = dot(vector, &right) / value;
            for (w, v) in weights.iter_mut().zip(vector) {
                *w += share * v;
            }
        }
        for (i, column) in columns.iter().enumerate() {
            for (f, c) in found.iter_mut().zip(column) {
                *f += weights[i] / size[i] * c;
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvectors_reproduce_the_matrix() {
        let m = [
            [4.0, 1.0, -2.0, 0.5],
            [1.0, 2.0, 0.0, 3.0],
            [-2.0, 0.0, 3.0, 1.0],
            [0.5, 3.0, 1.0, -1.0],
        ];
        let modes = eigen(&m.map(|r| r.to_vec()));
        for (i, row) in m.iter().enumerate() {
            for (j, expected) in row.iter().enumerate() {
                let sum: f64 = modes.iter().map(|(value, v)| value * v[i] * v[j]).sum();
                assert!((sum - expected).abs() < 1e-12, "{i} {j}: {sum}");
            }
        }
        let trace: f64 = modes.iter().map(|m| m.0).sum();
        assert!((trace - 8.0).abs() < 1e-12);
    }

    #[test]
    fn the_nearest_combination_is_a_projection() {
        let t: Vec<f64> = (0..50).map(f64::from).collect();
        let one = vec![1.0; 50];
        let target: Vec<f64> = t.iter().map(|t| 3.0 - 0.25 * t).collect();
        let noise: Vec<f64> = (0..50)
            .map(|k| if k % 2 == 0 { 1.0 } else { -1.0 })
            .collect();
        // A column that repeats another one changes nothing.
        let columns = [t.clone(), one.clone(), t.clone(), vec![0.0; 50]];
        let found = nearest(&columns, &target);
        assert!(found.iter().zip(&target).all(|(f, t)| (f - t).abs() < 1e-9));
        let rest = nearest(&columns, &noise);
        let left: f64 = noise.iter().zip(&rest).map(|(n, r)| (n - r) * 1.0).sum();
        assert!(left.abs() < 1e-9, "{left}");
    }
}
