//! How much an estimate varies, from the noise that its simulation leaves of the output.
//!
//! Blocks of time say nothing where all information is in one of them, as with one step: what the
//! estimate has taken of that block is all there was. But noise is of one kind over the record,
//! also where nothing moves. With v the output less its simulation, M the matrix of the equations
//! and z their instruments,
//!
//! ```text
//! sum_k z_k e_k = sum_j zeta_j v_j     e = (A/A_f) v     zeta = (A/A_f)* z, backward in time
//! Phi(q) v = w, w white of variance s^2     xi = (1/Phi)* zeta
//! P = M^-1 (s^2 sum_j xi_j xi_j') M^-T
//! ```
//!
//! Known as: asymptotic covariance of instrumental variables (Soderstrom and Stoica 1983) behind
//! noise that is an autoregression, its order by Akaike's criterion.

use nalgebra::{DMatrix, DVector};

use crate::instruments::Fit;
use crate::instruments::pass::Pass;
use crate::instruments::solve::Whole;

impl Fit<'_> {
    /// Covariance of the columns present by the noise of the output; `None` where the model has no
    /// simulation.
    pub(super) fn of_output_noise(&self, whole: &Whole) -> Option<DMatrix<f64>> {
        let problem = self.problem;
        let mut pass = Pass::of(problem, &self.setting).ok()?;
        let layout = pass.layout.clone();
        let p = layout.parameters();
        let (model, _) = self.in_s_plane(&whole.theta.as_slice()[..p])?;
        let shift = if layout.later { whole.theta[p] } else { 0.0 };
        let delay = (self.setting.delay + shift.clamp(-1.0, 1.0)).max(0.0);
        let samples = problem.samples();
        let begin = self.setting.begin(samples);
        let simulated = problem.simulate(&model, delay, begin..samples)?;
        let measured = &problem.signals.output[begin..];
        let left = measured.iter().zip(&simulated.y).enumerate();
        let left: Vec<f64> = left
            .map(|(k, (y, simulated))| problem.signals.acting(begin + k, y - simulated))
            .collect();
        let noise = Autoregression::of(&left)?;

        let (q, n) = (layout.outputs(), whole.present.len());
        let mut instruments = vec![vec![0.0_f32; samples - begin]; n];
        pass.run(problem, |k, z, phi| {
            for (column, j) in instruments.iter_mut().zip(&whole.present) {
                let value = match &whole.numerators {
                    Some(b) if *j < q => layout.combined(*j, b, |row| z[row]),
                    _ => phi[*j],
                };
                column[k - begin] = value as f32;
            }
        });
        let backward: Vec<DVector<f64>> = instruments
            .iter()
            .map(|column| {
                let mut lane = pass.design.of_output(pass.form(), 0.0);
                let zeta = column.iter().rev().map(|z| {
                    let trends = lane.output(*z);
                    let of_a = (0..q).map(|i| whole.theta[i] * trends[layout.first + i]);
                    trends[layout.order] + of_a.sum::<f64>()
                });
                noise.inverse(zeta)
            })
            .collect();
        let scores = DMatrix::from_fn(n, n, |i, j| {
            noise.variance * backward[i.max(j)].dot(&backward[i.min(j)])
        });
        let half = whole.factored.solve_columns(&scores)?;
        whole.factored.solve_columns(&half.transpose())
    }
}

/// `v_k = sum_i c_i v_{k-i} + w_k`.
struct Autoregression {
    coefficients: Vec<f64>,
    /// Variance of w.
    variance: f64,
}

impl Autoregression {
    /// That of a series, by Levinson and Durbin; the highest order is the usual 10 log10 N.
    fn of(v: &[f64]) -> Option<Self> {
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

    /// `1/Phi` of a series.
    fn inverse(&self, series: impl Iterator<Item = f64>) -> DVector<f64> {
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
