use super::*;

/// Rows that excite three parameters: a deterministic mixture.
fn row(k: usize) -> [f32; 3] {
    let wave = |period: usize| (k % period) as f32 / period as f32 - 0.5;
    [wave(7), wave(11), wave(5)]
}

fn folded(forgetting: f32, rows: usize) -> Factors<3> {
    let mut factors = Factors::independent(&[100.0; 3]);
    for k in 0..rows {
        let _ = factors.fold(&row(k), forgetting, 1.0 / forgetting);
    }
    factors
}

#[test]
fn all_of_the_covariance_at_once_has_the_same_bits() {
    for rows in [0, 3, 200] {
        let factors = folded(0.99, rows);
        let all = factors.covariances();
        for (i, row) in all.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                assert_eq!(entry.to_bits(), factors.covariance(i, j).to_bits());
            }
        }
    }
}

#[test]
fn covariance_is_the_inverse_of_the_information() {
    let factors = folded(1.0, 200);
    let mut information = [[0.0_f32; 3]; 3];
    for i in 0..3 {
        information[i][i] = 1e-4;
    }
    for k in 0..200 {
        let phi = row(k);
        for i in 0..3 {
            for j in 0..3 {
                information[i][j] += phi[i] * phi[j];
            }
        }
    }
    for i in 0..3 {
        for j in 0..3 {
            let product: f32 = (0..3)
                .map(|k| information[i][k] * factors.covariance(k, j))
                .sum();
            let unit = if i == j { 1.0 } else { 0.0 };
            assert!((product - unit).abs() < 1e-4, "{i} {j}: {product}");
        }
    }
}

#[test]
fn widening_adds_to_the_last_variance_only() {
    let before = folded(0.99, 100);
    let mut after = before;
    after.widen_last(3.0);
    for i in 0..3 {
        for j in 0..3 {
            let added = after.covariance(i, j) - before.covariance(i, j);
            let wanted = if (i, j) == (2, 2) { 3.0 } else { 0.0 };
            assert!((added - wanted).abs() < 1e-5, "{i} {j}: {added}");
        }
    }
}
