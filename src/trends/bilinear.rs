//! The bilinear (Tustin) map of poles between the s plane and the gamma plane of the trapezoids.
//!
//! Known as: delta and bilinear planes. Middleton and Goodwin, Digital Control and Estimation
//! (1990).
//!
//! ```text
//! gamma = (2/Delta)(1-q^-1)/(1+q^-1)        gamma_p = (2/Delta) tanh(p Delta/2)
//! ```
//!
//! A sampled output obeys a difference equation whose roots are the gamma_p of the
//! true poles p, exactly. In units of 2/Delta the roots of the polynomials
//! `x(sigma) = atanh(sqrt(sigma) g)/sqrt(sigma)` lead from g = tanh(p) at sigma = 0 to p
//! at sigma = 1, along
//!
//! ```text
//! dx/dsigma = f(x) = sum_k 4^k sigma^(k-1) x^(2k+1) / (2 (2k+1)!)       k = 1, 2, ..
//! dA/dsigma = - f(s) A'(s) mod A(s)
//! ```
//!
//! so the coefficients flow from one plane to the other and no root is computed:
//! repeated and complex poles need no special case, a pole at 0 stays at 0, and only the
//! small difference between the planes is rounded.

use crate::math::polynomial::{is_schur, scaled, unscaled};

/// Terms of f: the last one is below 1e-9 for |x| = 1.
const TERMS: usize = 9;

/// Runge-Kutta steps from one plane to the other: 1e-6 of a coefficient for poles at |p| Delta/2
/// = 1.
const STEPS: usize = 8;

/// Coefficients of `gamma^m + ..` with the roots `(2/Delta) tanh(p Delta/2)` for those of
/// `s^m + ..`.
///
/// `None` unless every |p| is below 2/Delta.
pub(crate) fn to_gamma_plane<const M: usize>(a: &[f32; M], sample_time: f32) -> Option<[f32; M]> {
    let half = 0.5 * sample_time;
    let scaled = scaled(a, half);
    let found = is_schur(&scaled).then(|| unscaled(&flow(&scaled, 1.0, 0.0), half))?;
    found.iter().all(|v| v.is_finite()).then_some(found)
}

/// The inverse of [`to_gamma_plane`].
pub(crate) fn to_s_plane<const M: usize>(a: &[f32; M], sample_time: f32) -> Option<[f32; M]> {
    let half = 0.5 * sample_time;
    let found = flow(&scaled(a, half), 0.0, 1.0);
    // A real root beyond 2/Delta in gamma has no p: its flow ends outside the unit circle or
    // diverges.
    is_schur(&found).then(|| unscaled(&found, half))
}

/// `s r(s) mod A(s)`.
fn shifted<const M: usize>(r: &[f32; M], a: &[f32; M]) -> [f32; M] {
    let top = r.last().copied().unwrap_or(0.0);
    let mut below = 0.0;
    let mut next = [0.0; M];
    for i in 0..M {
        next[i] = below - top * a[i];
        below = r[i];
    }
    next
}

/// dA/dsigma.
fn slope<const M: usize>(a: &[f32; M], sigma: f32) -> [f32; M] {
    // A'(s), then s A'(s), s^3 A'(s), ..
    let mut r = [0.0; M];
    for i in 0..M {
        let above = if i + 1 < M { a[i + 1] } else { 1.0 };
        r[i] = (i + 1) as f32 * above;
    }
    r = shifted(&r, a);
    let mut weight = 0.5;
    let mut slope = [0.0; M];
    for k in 1..=TERMS {
        r = shifted(&shifted(&r, a), a);
        weight *= 4.0 / ((2 * k) * (2 * k + 1)) as f32;
        for i in 0..M {
            slope[i] -= weight * r[i];
        }
        weight *= sigma;
    }
    slope
}

/// The coefficients after sigma has gone from one value to another.
fn flow<const M: usize>(a: &[f32; M], from: f32, to: f32) -> [f32; M] {
    let step = (to - from) / STEPS as f32;
    // Pairs instead of indices: firmware calls this, and no index has to be checked.
    let ahead = |a: &[f32; M], slope: &[f32; M], step: f32| {
        let mut ahead = *a;
        for (value, slope) in ahead.iter_mut().zip(slope) {
            *value += step * slope;
        }
        ahead
    };
    let mut a = *a;
    for n in 0..STEPS {
        let sigma = from + n as f32 * step;
        let first = slope(&a, sigma);
        let second = slope(&ahead(&a, &first, 0.5 * step), sigma + 0.5 * step);
        let third = slope(&ahead(&a, &second, 0.5 * step), sigma + 0.5 * step);
        let fourth = slope(&ahead(&a, &third, step), sigma + step);
        for i in 0..M {
            a[i] += step / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]);
        }
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `(s^2 + 2 d s + w^2)(s + p)` and its image, from tanh of the poles by hand.
    #[test]
    fn known_poles() {
        // A pole at -1 rad/s and Delta = 1 s: 2 tanh(1/2).
        let image = to_gamma_plane(&[1.0], 1.0).unwrap();
        assert!((image[0] - 0.924_234_3).abs() < 5e-7, "{image:?}");
        // +-j: 2 tan(1/2), squared; the double integrator stays.
        let image = to_gamma_plane(&[1.0, 0.0], 1.0).unwrap();
        assert!((image[0] - 1.193_785_6).abs() < 1e-6 && image[1].abs() < 1e-6);
        assert_eq!(to_gamma_plane(&[0.0, 0.0, 0.0], 0.001), Some([0.0; 3]));
    }

    #[test]
    fn there_and_back() {
        for a in [
            [0.0, 0.0, 400.0, 20.0],
            [0.0, 1.8e5, 1.8e5, 45.0],
            [1.6e5, 3.2e4, 2.4e3, 80.0], // (s + 20)^4
            [1.6e9, 3.2e7, 2.4e5, 800.0],
            [-1.0e4, 3.0e3, 200.0, 10.0],
        ] {
            for sample_time in [0.001, 0.002] {
                let image = to_gamma_plane(&a, sample_time).unwrap();
                let back = to_s_plane(&image, sample_time).unwrap();
                for (x, y) in a.iter().zip(back) {
                    assert!((x - y).abs() <= 3e-6 * x.abs(), "{a:?} {back:?}");
                }
            }
        }
    }

    #[test]
    fn beyond_the_sampling_there_is_nothing() {
        assert_eq!(to_gamma_plane(&[2100.0], 0.001), None);
        assert_eq!(to_gamma_plane(&[f32::NAN, 1.0], 0.001), None);
        // A root of gamma at -3/Delta.
        assert_eq!(to_s_plane(&[3000.0], 0.001), None);
        assert_eq!(to_s_plane(&[-3000.0], 0.001), None);
    }
}
