//! Numerators of a sampled plant, `s^j/A(s)` behind a hold, in f64.
//!
//! Those of `trendid::trends` are in f32: what is zero at rest, all but the first of them, is a
//! last digit there, which a coefficient b_j far larger than b_0 brings into b_0. The reasons for
//! the equations stand there, too:
//!
//! ```text
//! X  the state matrix of A, in units of 2/h       G = tanh X
//! N(gamma) = adj(gamma - G) w       w = (tanh X / X) e_m of what is held, (tanh X / X)^2 e_m of
//!                                   what goes straight, which has the feedthrough
//!                                   d = ((tanh X / X) - 1) / X e_m, too
//! adj(gamma - G) = sum_i gamma^i M_i       M_(m-1) = 1       M_(i-1) = G M_i + c_i
//!                                          c_i = -tr(G M_i) / (m - i)
//! ```
//!
//! with c_i the coefficients of the denominator in gamma. Known as: the method of Faddeev and
//! LeVerrier.

use nalgebra::{DMatrix, DVector};
use trendid::trends::Hold;

/// Trends 0 .. m-1 and the top one, then zeros.
pub(crate) type Values = [f64; 5];

/// Terms of `tanh(x)/x`, of which each is about `4/pi^2` of the one before for |x| = 1: the next
/// one is below the last digit.
const TERMS: usize = 45;

/// Weights of the trends of an input.
#[derive(Debug, Clone)]
pub(super) struct Numerators {
    held: DMatrix<f64>,
    straight: DMatrix<f64>,
    /// Feedthrough of what goes straight.
    direct: DVector<f64>,
}

/// Coefficients of `tanh(x)/x = sum c_k x^2k`.
fn coefficients() -> [f64; TERMS] {
    // tanh' = 1 - tanh^2
    let mut c = [0.0; TERMS];
    c[0] = 1.0;
    for k in 1..TERMS {
        let square: f64 = (0..k).map(|i| c[i] * c[k - 1 - i]).sum();
        c[k] = -square / (2 * k + 1) as f64;
    }
    c
}

impl Numerators {
    /// For the plant with denominator `model` in s behind a filter in gamma, both from the lowest
    /// coefficient on; h the sample time \[s\] as it is, and as the trends round it. Every pole is
    /// below 2/h.
    pub(super) fn of(model: &[f64], filter: &[f64], (h, rounded): (f64, f64)) -> Self {
        let m = model.len();
        let scale = |i: usize, h: f64| (0.5 * h).powi((m - i) as i32);
        let x = DMatrix::from_fn(m, m, |i, j| match i + 1 == m {
            true => -model[j] * scale(j, h),
            false => f64::from(u8::from(j == i + 1)),
        });
        let last = DVector::from_fn(m, |i, _| f64::from(u8::from(i + 1 == m)));
        let (square, c) = (&x * &x, coefficients());
        let (mut ratio, mut odd) = (DMatrix::zeros(m, m), DVector::zeros(m));
        // Horner: the ratio, and ((tanh x / x) - 1)/x = c_1 x + c_2 x^3 + ..
        for c in c.iter().rev() {
            odd = &x * (&ratio * &last);
            ratio = &square * ratio + DMatrix::identity(m, m) * *c;
        }
        let tanh = &ratio * &x;
        let mut adjugate = vec![DMatrix::identity(m, m); m];
        let mut image = vec![0.0; m];
        for i in (0..m).rev() {
            let next = &tanh * &adjugate[i];
            image[i] = -next.trace() / (m - i) as f64;
            if i > 0 {
                adjugate[i - 1] = next + DMatrix::identity(m, m) * image[i];
            }
        }
        // Back from units of 2/h.
        let seconds = |j: usize| scale(0, h) / scale(0, rounded) * (0.5 * h).powi(-(j as i32));
        let rows = |w: &DVector<f64>, direct: Option<&DVector<f64>>| {
            DMatrix::from_fn(m, m, |j, i| {
                let through =
                    direct.map_or(0.0, |d| d[j] * (image[i] - filter[i] * scale(i, rounded)));
                let weight = (adjugate[i].row(j) * w)[0] + through;
                weight * seconds(j) * (0.5 * rounded).powi(i as i32)
            })
        };
        let held = &ratio * &last;
        let straight = &ratio * &held;
        Self {
            held: rows(&held, None),
            straight: rows(&straight, Some(&odd)),
            direct: DVector::from_fn(m, |j, _| odd[j] * seconds(j) * scale(0, rounded)),
        }
    }

    /// `N_0` at rest: the b_0 that plain trends would give, over the true one.
    pub(super) fn at_rest(&self) -> f64 {
        self.held[(0, 0)]
    }

    /// The numerators of an input `u` over the filter, from its trends.
    pub(super) fn apply(&self, trends: &[f32], u: f32, hold: Hold) -> Values {
        let mut values = Values::default();
        let straight = hold == Hold::First;
        let rows = if straight { &self.straight } else { &self.held };
        let direct = if straight { f64::from(u) } else { 0.0 };
        for (j, value) in values.iter_mut().take(trends.len()).enumerate() {
            *value = self.direct[j] * direct;
            for (i, trend) in trends.iter().enumerate() {
                *value += rows[(j, i)] * f64::from(*trend);
            }
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polynomials::from_roots;

    #[test]
    fn the_numerators_of_a_lag_are_those_of_its_hold() {
        let (h, p) = (0.01, -30.0_f64);
        let found = Numerators::of(&[-p], &[20.0], (h, h));
        // phi = gamma_p / p, of what goes straight phi^2 beside the feedthrough (phi - 1)/p.
        let phi = 2.0 / h * (0.5 * p * h).tanh() / p;
        let direct = (phi - 1.0) / p;
        assert!((found.held[(0, 0)] / phi - 1.0).abs() < 1e-14);
        assert!((found.direct[0] / direct - 1.0).abs() < 1e-12);
        let straight = phi * phi + direct * (-phi * p - 20.0);
        assert!((found.straight[(0, 0)] / straight - 1.0).abs() < 1e-14);
    }

    #[test]
    fn derivatives_are_zero_at_rest() {
        let model = from_roots(&[(-3.0, 0.0), (-5.0, 40.0), (-5.0, -40.0), (-90.0, 0.0)]);
        let found = Numerators::of(&model, &[1.0; 4], (0.01, 0.01));
        // One b_j in units of the fastest rate brings no last digit of f32 into b_0.
        for (j, rate) in [(1, 90.0_f64), (2, 90.0), (3, 90.0)] {
            let share = found.held[(j, 0)] / (found.at_rest() * rate.powi(j as i32));
            assert!(share.abs() < 1e-9, "{j}: {share}");
        }
    }
}
