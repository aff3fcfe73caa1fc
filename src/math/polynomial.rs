//! Monic polynomials `s^m + c_{m-1} s^{m-1} + .. + c_0`, given by c_0 .. c_{m-1}.

use crate::math::complex::Complex;
use crate::math::pow;

/// `(s^degree + c_{degree-1} s^{degree-1} + ..)(s + pole)`.
pub(crate) fn with_pole<const M: usize>(mut c: [f32; M], degree: usize, pole: f32) -> [f32; M] {
    // From the highest power down, so that no coefficient is used after it changed.
    for j in (1..=degree).rev() {
        let own = if j == degree { 1.0 } else { c[j] };
        c[j] = c[j - 1] + own * pole;
    }
    c[0] = if degree == 0 { pole } else { c[0] * pole };
    c
}

/// The polynomial of `unit` times the roots.
pub(crate) fn scaled<const M: usize>(c: &[f32; M], unit: f32) -> [f32; M] {
    rescaled(c, unit, |value, power| value * power)
}

/// The polynomial of the roots over `unit`: the way back from [`scaled`].
pub(crate) fn unscaled<const M: usize>(c: &[f32; M], unit: f32) -> [f32; M] {
    rescaled(c, unit, |value, power| value / power)
}

fn rescaled<const M: usize>(c: &[f32; M], unit: f32, by: impl Fn(f32, f32) -> f32) -> [f32; M] {
    let mut scaled = *c;
    let mut power = 1.0;
    for value in scaled.iter_mut().rev() {
        power *= unit;
        *value = by(*value, power);
    }
    scaled
}

/// The polynomial at j x: as [`value_at`], for half the multiplications.
pub(crate) fn value_at_imaginary(c: &[f32], x: f32) -> Complex {
    c.iter().rev().fold(Complex::ONE, |value, c| Complex {
        re: c - value.im * x,
        im: value.re * x,
    })
}

/// The polynomial at s.
pub(crate) fn value_at(c: &[f32], s: Complex) -> Complex {
    c.iter().rev().fold(Complex::ONE, |value, c| {
        let mut next = value.times(s);
        next.re += c;
        next
    })
}

/// The polynomial and its slope at a real x.
pub(crate) fn value_and_slope<const M: usize>(c: &[f32; M], x: f32) -> [f32; 2] {
    c.iter().rev().fold([1.0, 0.0], |[value, slope], c| {
        [c + x * value, value + x * slope]
    })
}

/// The largest of |c_i|^(1/(m-i)): no root is beyond twice this.
pub(crate) fn largest_rate<const M: usize>(c: &[f32; M]) -> f32 {
    let rates = c.iter().enumerate();
    rates.fold(0.0, |m, (i, v)| m.max(pow(v.abs(), 1.0 / (M - i) as f32)))
}

/// Whether every root lies in the left half plane, m <= 4 (conditions of Hurwitz 1895).
pub(crate) fn is_hurwitz(c: &[f32]) -> bool {
    c.iter().all(|v| *v > 0.0 && v.is_finite())
        && match *c {
            [c0, c1, c2] => c2 * c1 > c0,
            [c0, c1, c2, c3] => (c3 * c2 - c1) * c1 > c3 * c3 * c0,
            _ => true,
        }
}

/// Whether every root lies inside the unit circle (Schur 1917, Cohn 1922).
pub(crate) fn is_schur<const M: usize>(c: &[f32; M]) -> bool {
    let mut c = *c;
    // Slices instead of indices: firmware calls this, and no index has to be checked.
    let mut left: &mut [f32] = &mut c;
    while let Some((last, upper)) = left.split_first_mut() {
        let last = *last;
        // NaN fails.
        if !(last > -1.0 && last < 1.0) {
            return false;
        }
        // (C(s) - c_0 s^degree C(1/s)) / s, monic again: pairs from both ends.
        let rest = 1.0 - last * last;
        let mut ends = upper.iter_mut();
        while let Some(low) = ends.next() {
            match ends.next_back() {
                Some(high) => {
                    let (l, h) = (*low, *high);
                    *low = (l - last * h) / rest;
                    *high = (h - last * l) / rest;
                }
                None => *low = (*low - last * *low) / rest,
            }
        }
        left = upper;
    }
    true
}

/// The real root nearest to zero, as a positive rate, by Newton's method from zero.
///
/// Where the slowest mode is a complex pair there is no such root; the result then is a rate
/// of its size.
pub(crate) fn slowest_rate<const M: usize>(c: &[f32; M]) -> f32 {
    let mut rate = 0.0;
    for _ in 0..30 {
        // C(-rate) and its slope with respect to rate.
        let (mut value, mut slope) = (1.0, 0.0);
        for i in (0..M).rev() {
            slope = -slope * rate - value;
            value = c[i] - value * rate;
        }
        if slope == 0.0 {
            break;
        }
        let next = rate - value / slope;
        if !(next > rate && next < 1e6) {
            break;
        }
        rate = next;
    }
    rate
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poles_multiply_up() {
        let mut c = [0.0; 4];
        for (degree, pole) in [1.0, 2.0, 3.0, 4.0].into_iter().enumerate() {
            c = with_pole(c, degree, pole);
        }
        assert_eq!(c, [24.0, 50.0, 35.0, 10.0]);
        assert!((slowest_rate(&c) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn scaling_scales_the_roots() {
        // (s + 1)(s + 2) and (s + 3)(s + 6).
        assert_eq!(scaled(&[2.0, 3.0], 3.0), [18.0, 9.0]);
        assert_eq!(unscaled(&[18.0, 9.0], 3.0), [2.0, 3.0]);
        assert_eq!(largest_rate(&[16.0, 3.0]), 4.0);
    }

    #[test]
    fn on_the_imaginary_axis() {
        // (j 2)^3 + 3 (j 2)^2 + 5 (j 2) + 7
        let value = value_at_imaginary(&[7.0, 5.0, 3.0], 2.0);
        assert_eq!(value, Complex { re: -5.0, im: 2.0 });
        assert_eq!(
            value,
            value_at(&[7.0, 5.0, 3.0], Complex { re: 0.0, im: 2.0 })
        );
    }

    #[test]
    fn a_value_with_its_slope() {
        // x^3 + 2 x^2 - 3 x + 5 and 3 x^2 + 4 x - 3 at -2.
        assert_eq!(value_and_slope(&[5.0, -3.0, 2.0], -2.0), [11.0, 1.0]);
        assert_eq!(value_and_slope(&[], 7.0), [1.0, 0.0]);
    }

    #[test]
    fn hurwitz() {
        assert!(is_hurwitz(&[1.0, 2.0, 2.0]));
        // s^3 + s^2 + s + 2 has positive coefficients and a pair on the right.
        assert!(!is_hurwitz(&[2.0, 1.0, 1.0]) && !is_hurwitz(&[8.0, 1.0, 1.0]));
        assert!(!is_hurwitz(&[f32::NAN]) && !is_hurwitz(&[-1.0, 1.0]));
        // (s^2 + 1)^2 stands on the limit.
        assert!(!is_hurwitz(&[1.0, 0.0, 2.0, 0.0]) && is_hurwitz(&[1.0, 4.0, 6.0, 4.0]));
    }

    #[test]
    fn schur_and_cohn() {
        assert!(is_schur(&[0.25, 1.0])); // (s + 0.5)^2
        assert!(!is_schur(&[1.21, 2.2])); // (s + 1.1)^2
        assert!(is_schur(&[-0.5]) && !is_schur(&[-1.5]));
        assert!(is_schur(&[0.0, 0.0, 0.0, 0.9]) && !is_schur(&[0.0, 0.0, 0.0, 1.1]));
    }
}
