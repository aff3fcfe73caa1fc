//! How trapezoids bend a model, to second order in the sample time.
//!
//! The samples of y obey an equation in `gamma = s - s^3 Delta^2/12 + ..`
//! ([`bilinear`](crate::trends::bilinear)), and a held input is `1 + (s Delta)^2/6 + ..` times what
//! its trends say. So `A(s) y = b_0 u` is, times `1 - m (gamma Delta)^2/12`,
//!
//! ```text
//! sum_i a_i gamma^i (1 + (i-m) c gamma^2) y = b_0 (1 + (2-m) c gamma^2) u        c = Delta^2/12, a_m = 1
//! ```
//!
//! The regression has of y no power beyond m and of u none but 0. Of the powers that it has, those
//! of an oscillator and of an integrating drive of order 3 keep their coefficients but the highest,
//! over which all are found:
//!
//! ```text
//! a_i' = a_i / h        b_0' = b_0 / h        h = 1 - 2 c a_m-2
//! ```
//!
//! What is left, `a_m-1 c gamma^{m+1} y` and the term of u, acts as the motion weighs it. Without
//! noise, for dampings of 0.1 to 1.5 and filters of 0.6 to 1.7 times the frequency, errors of 0.11
//! to 0.23 of `(omega Delta)^2` become -0.05 to 0.06, and for inputs on straight lines 0.04 to 0.22
//! become -0.12 to 0.05 (`--test core trapezoids` prints them). Of a drive of order 3 on a spring
//! and of order 4 more is left than was taken out; where an input has a numerator of higher power,
//! the regression takes other terms in. These stay as they are found, and so does a lag.

/// h lies between this and its inverse: rates of the model are below 1.7/Delta.
const LEAST: f32 = 0.5;

/// h of a model with the coefficients `a` of the s plane; `None` where more would be left than
/// taken out, and where the model is too fast for the sampling.
pub(crate) fn bend<const M: usize>(a: &[f32; M], sample_time: f32) -> Option<f32> {
    in_reach(1.0 - bending(a, sample_time)?)
}

/// h of a model that was found with the coefficients `found`.
pub(crate) fn bend_of_found<const M: usize>(found: &[f32; M], sample_time: f32) -> Option<f32> {
    in_reach(1.0 / (1.0 + bending(found, sample_time)?))
}

/// 2 c a_m-2.
fn bending<const M: usize>(a: &[f32; M], sample_time: f32) -> Option<f32> {
    let highest = match a.as_slice() {
        [spring, _] => spring,
        [0.0, stiffness, _] => stiffness,
        _ => return None,
    };
    Some(highest * sample_time * sample_time / 6.0)
}

/// An h that is near enough to 1 for an expansion; NaN is not.
fn in_reach(h: f32) -> Option<f32> {
    (h > LEAST && h < 1.0 / LEAST).then_some(h)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_oscillator_and_an_integrating_drive_have_one_factor() {
        // h = 1 - 400 * 0.03^2 / 6
        for h in [bend(&[400.0, 20.0], 0.03), bend(&[0.0, 400.0, 20.0], 0.03)] {
            assert!((h.unwrap() - 0.94).abs() < 1e-6);
        }
        for a in [[0.0, 400.0, 20.0], [0.0, -400.0, 5.0]] {
            let h = bend(&a, 0.03).unwrap();
            let inverse = bend_of_found(&a.map(|value| value / h), 0.03).unwrap();
            assert!((h - inverse).abs() < 1e-6);
        }
    }

    #[test]
    fn others_and_what_is_too_fast_stay() {
        assert_eq!(bend(&[10.0], 0.001), None);
        assert_eq!(bend(&[8000.0, 400.0, 20.0], 0.001), None);
        assert_eq!(bend_of_found(&[0.0, 8000.0, 400.0, 20.0], 0.001), None);
        // h above 1/2 up to 3/Delta^2 in s and 6/Delta^2 as found, and below 2.
        for (a, found, stays) in [
            (2.9e6, 5.9e6, false),
            (3.1e6, 6.1e6, true),
            (-5.9e6, -2.9e6, false),
            (-6.1e6, -3.1e6, true),
            (f32::NAN, f32::NAN, true),
        ] {
            assert_eq!(bend(&[0.0, a, 1.0], 0.001).is_none(), stays, "{a}");
            let found = bend_of_found(&[0.0, found, 1.0], 0.001);
            assert_eq!(found.is_none(), stays, "{a}");
        }
    }
}
