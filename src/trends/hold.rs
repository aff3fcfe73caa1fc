//! Numerators of a sampled plant: `s^j/A(s)` behind a hold.
//!
//! ```text
//! 1/(s-p)  zero-order hold:    2 q^-1/(1+q^-1)  phi_p / (gamma - gamma_p)       phi_p = gamma_p / p
//!          first-order hold:   phi_p^2 / (gamma - gamma_p) + (phi_p - 1)/p
//! ```
//!
//! For several poles p is the matrix of the state equations, which covers repeated and
//! complex poles.

use crate::math::polynomial::scaled;

/// Terms of `tanh(x)/x`: the next one is below 1e-8 for |x| = 1.
const TERMS: usize = 20;

/// Coefficients of `tanh(x)/x = sum c_k x^2k`.
const TANH: [f32; TERMS] = {
    // tanh' = 1 - tanh^2
    let mut c = [0.0; TERMS];
    c[0] = 1.0;
    let mut k = 1;
    while k < TERMS {
        let mut square = 0.0;
        let mut i = 0;
        while i < k {
            square += c[i] * c[k - 1 - i];
            i += 1;
        }
        c[k] = -square / (2 * k + 1) as f32;
        k += 1;
    }
    c
};

/// Weights that turn the trends of an input into the numerators of `s^j/A(s)` over the filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Numerators<const M: usize> {
    /// Row j: weights of the trends under a zero-order hold.
    pub(crate) zero: [[f32; M]; M],
    /// The same under a first-order hold.
    pub(crate) first: [[f32; M]; M],
    /// Feedthrough of the input under a first-order hold.
    pub(crate) direct: [f32; M],
}

impl<const M: usize> Numerators<M> {
    /// For the plant with denominator `a` in s, `image` in gamma, behind the filter with the poles
    /// `filter` in gamma.
    ///
    /// With X the matrix of the state equations of 1/A (states s^j/A) and b their input, in units
    /// of 2/Delta: `N(gamma) = adj(gamma - tanh X) w`, w = (tanh X / X) b for the zero-order hold,
    /// (tanh X / X)^2 b for the first-order hold, which also has the feedthrough
    /// `d = ((tanh X / X) - 1)/X b`: `d A_g/A_f = d + sum d (a_g - f)_i gamma^i/A_f`.
    pub(crate) fn new(a: &[f32; M], image: &[f32; M], filter: &[f32; M], sample_time: f32) -> Self {
        let half = 0.5 * sample_time;
        let [a, image, filter] = [a, image, filter].map(|p| scaled(p, half));
        let mut b = [0.0; M];
        if let Some(last) = b.last_mut() {
            *last = 1.0;
        }
        let held = tanh_ratio(&b, &a);
        let straight = tanh_ratio(&held, &a);
        let mut numerators = Self {
            zero: adjugate(&held, &a, &image),
            first: adjugate(&straight, &a, &image),
            direct: [0.0; M],
        };
        // (tanh(x)/x - 1)/x = c_1 x + c_2 x^3 + ..
        let mut odd = times(&b, &a);
        for c in TANH.iter().skip(1) {
            for (d, x) in numerators.direct.iter_mut().zip(odd) {
                *d += c * x;
            }
            odd = times(&times(&odd, &a), &a);
        }
        for (row, d) in numerators.first.iter_mut().zip(numerators.direct) {
            for (i, value) in row.iter_mut().enumerate() {
                *value += d * (image[i] - filter[i]);
            }
        }
        numerators.in_seconds(half);
        numerators
    }

    /// Back from units of 2/Delta: (Delta/2)^(i-j), and (Delta/2)^(m-j) for the feedthrough.
    fn in_seconds(&mut self, half: f32) {
        for j in 0..M {
            for i in 0..M {
                for _ in j..i {
                    self.zero[j][i] *= half;
                    self.first[j][i] *= half;
                }
                for _ in i..j {
                    self.zero[j][i] /= half;
                    self.first[j][i] /= half;
                }
            }
            for _ in j..M {
                self.direct[j] *= half;
            }
        }
    }

    /// N_0 at rest: the b_0 that plain trends would give, over the true one.
    pub(crate) fn at_rest(&self) -> f32 {
        let row = self.zero.first();
        row.and_then(|row| row.first()).copied().unwrap_or(1.0)
    }
}

/// X v of the state equations.
fn times<const M: usize>(v: &[f32; M], a: &[f32; M]) -> [f32; M] {
    let mut last = 0.0;
    for i in 0..M {
        last -= a[i] * v[i];
    }
    core::array::from_fn(|i| if i + 1 < M { v[i + 1] } else { last })
}

/// tanh(X)/X v.
fn tanh_ratio<const M: usize>(v: &[f32; M], a: &[f32; M]) -> [f32; M] {
    let mut power = *v;
    let mut sum = [0.0; M];
    for c in TANH {
        for (s, x) in sum.iter_mut().zip(power) {
            *s += c * x;
        }
        power = times(&times(&power, a), a);
    }
    sum
}

/// Rows of `adj(gamma - tanh X) w`, weights of gamma^i.
fn adjugate<const M: usize>(w: &[f32; M], a: &[f32; M], image: &[f32; M]) -> [[f32; M]; M] {
    let mut rows = [[0.0; M]; M];
    // sum gamma^i (G^(m-1-i) + image_{m-1} G^(m-2-i) + .. + image_{i+1}) w, from the highest power
    // down
    let mut column = *w;
    for i in (0..M).rev() {
        for (row, value) in rows.iter_mut().zip(column) {
            row[i] = value;
        }
        let moved = times(&tanh_ratio(&column, a), a);
        for j in 0..M {
            column[j] = moved[j] + image[i] * w[j];
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trends::bilinear::to_gamma_plane;

    const SAMPLE_TIME: f32 = 0.02;

    fn numerators<const M: usize>(a: [f32; M]) -> Numerators<M> {
        let image = to_gamma_plane(&a, SAMPLE_TIME).unwrap();
        Numerators::new(&a, &image, &image, SAMPLE_TIME)
    }

    #[test]
    fn a_lag_by_hand() {
        // p = -20: phi = tanh(0.2)/0.2.
        let (found, phi) = (numerators([20.0]), 0.197_375_32 / 0.2);
        assert!((found.zero[0][0] - phi).abs() < 2e-7);
        assert!((found.first[0][0] - phi * phi).abs() < 3e-7);
        assert!((found.direct[0] - (phi - 1.0) / -20.0).abs() < 1e-8);
    }

    #[test]
    fn two_integrators_by_hand() {
        // 1/s^2: Delta^2/2 (z+1)/(z-1)^2 held, Delta^2/6 (z^2+4z+1)/(z-1)^2 straight = 1/gamma^2 -
        // Delta^2/12.
        let found = numerators([0.0, 0.0]);
        assert_eq!(found.zero, [[1.0, 0.0], [0.0, 1.0]]);
        assert_eq!(found.first, [[1.0, 0.0], [0.0, 1.0]]);
        let direct = -SAMPLE_TIME * SAMPLE_TIME / 12.0;
        assert!((found.direct[0] - direct).abs() < 1e-11 && found.direct[1] == 0.0);
    }

    #[test]
    fn the_gain_at_rest_is_that_of_the_plant() {
        // (s + 20)^2 (s + 30): N_0(0)/A_g(0) = 1/A(0), for both holds.
        let a = [12_000.0, 1600.0, 70.0];
        let (found, image) = (numerators(a), to_gamma_plane(&a, SAMPLE_TIME).unwrap());
        let held = found.at_rest() / image[0];
        let straight = found.first[0][0] / image[0] + found.direct[0];
        for gain in [held, straight] {
            assert!((gain * a[0] - 1.0).abs() < 2e-6, "{gain}");
        }
    }

    #[test]
    fn fast_sampling_needs_no_numerators() {
        let a = [0.0, 400.0, 20.0];
        let image = to_gamma_plane(&a, 1e-4).unwrap();
        let found = Numerators::new(&a, &image, &image, 1e-4);
        for j in 0..3 {
            for i in 0..3 {
                // In powers of 20 rad/s.
                let unit = 20.0_f32.powi(i as i32 - j as i32);
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((found.zero[j][i] * unit - expected).abs() < 2e-6);
            }
        }
    }
}
