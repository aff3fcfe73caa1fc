//! Noise that is an autoregression, and what it makes of an estimate.

use nalgebra::{DMatrix, DVector};

use crate::instruments::factored::Factored;

/// Covariance of the weights of `columns` in a series by least squares, by noise like what they
/// leave of it.
pub(crate) fn of_noise(
    left: &[f64],
    columns: &[DVector<f64>],
    factored: &Factored,
) -> Option<DMatrix<f64>> {
    let noise = Autoregression::of(left)?;
    let backward: Vec<DVector<f64>> = columns
        .iter()
        .map(|column| noise.inverse(column.iter().rev().copied()))
        .collect();
    noise.covariance(&backward, factored)
}

/// `v_k = sum_i c_i v_{k-i} + w_k`.
pub(super) struct Autoregression {
    coefficients: Vec<f64>,
    /// Variance of w.
    variance: f64,
}

impl Autoregression {
    /// That of a series, by Levinson and Durbin; the highest order is the usual 10 log10 N.
    pub(super) fn of(v: &[f64]) -> Option<Self> {
        let n = v.len() as f64;
        let highest = ((10.0 * n.log10()) as usize).min(v.len() / 4);
        let r = |lag: usize| v[lag..].iter().zip(v).map(|(x, y)| x * y).sum::<f64>() / n;
        let mut variance = r(0);
        if !(variance > 0.0 && variance.is_finite()) {
            return None;
        }
        let r: Vec<f64> = (0..=highest).map(r).collect();
        let mut c: Vec<f64> = Vec::new();
        let criterion = |variance: f64, order: usize| n * variance.ln() + 2.0 * order as f64;
        let mut best = (criterion(variance, 0), Vec::new(), variance);
        for order in 1..=highest {
            let ahead: f64 = c
                .iter()
                .zip(r[1..order].iter().rev())
                .map(|(c, r)| c * r)
                .sum();
            let last = (r[order] - ahead) / variance;
            let turned: Vec<f64> = c.iter().rev().copied().collect();
            c.iter_mut().zip(&turned).for_each(|(c, t)| *c -= last * t);
            c.push(last);
            variance *= 1.0 - last * last;
            if !(variance > 0.0) {
                break;
            }
            let criterion = criterion(variance, order);
            if criterion < best.0 {
                best = (criterion, c.clone(), variance);
            }
        }
        Some(Self {
            coefficients: best.1,
            variance: best.2,
        })
    }

    /// Covariance by the instruments behind `1/Phi`, backward in time.
    pub(super) fn covariance(
        &self,
        backward: &[DVector<f64>],
        factored: &Factored,
    ) -> Option<DMatrix<f64>> {
        let n = backward.len();
        let scores = DMatrix::from_fn(n, n, |i, j| {
            self.variance * backward[i.max(j)].dot(&backward[i.min(j)])
        });
        factored.sandwich(&scores)
    }

    /// `1/Phi` of a series.
    pub(super) fn inverse(&self, series: impl Iterator<Item = f64>) -> DVector<f64> {
        let mut x: Vec<f64> = Vec::new();
        for value in series {
            let fed = self.coefficients.iter().zip(x.iter().rev());
            x.push(value + fed.map(|(c, x)| c * x).sum::<f64>());
        }
        DVector::from_vec(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_autoregression_is_found_by_its_series() {
        let (mut seed, mut v) = (7_u64, vec![0.0, 0.0]);
        for k in 2..20_000 {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let w = (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
            v.push(1.2 * v[k - 1] - 0.5 * v[k - 2] + w);
        }
        let found = Autoregression::of(&v).expect("a series that moves");
        let [first, second] = [found.coefficients[0], found.coefficients[1]];
        // Three deviations of a coefficient of a series of this length.
        assert!((first - 1.2).abs() < 0.03 && (second + 0.5).abs() < 0.03);
        assert!((found.variance * 3.0 - 1.0).abs() < 0.03);
        let back = found.inverse([1.0, 0.0].into_iter());
        assert!((back[1] - first).abs() < 1e-12);
    }
}
