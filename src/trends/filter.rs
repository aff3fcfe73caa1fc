//! The filter polynomial `A_f = s^m + f_{m-1} s^{m-1} + .. + f_0` in front of the estimator.

use crate::error::positive;

/// `(s^degree + f_{degree-1} s^{degree-1} + ..)(s + pole)`.
pub(crate) const fn with_pole<const M: usize>(
    mut filter: [f32; M],
    degree: usize,
    pole: f32,
) -> [f32; M] {
    // From the highest power down, so that no coefficient is used after it changed.
    let mut j = degree;
    while j > 0 {
        let own = if j == degree { 1.0 } else { filter[j] };
        filter[j] = filter[j - 1] + own * pole;
        j -= 1;
    }
    filter[0] = if degree == 0 { pole } else { filter[0] * pole };
    filter
}

/// The default filter for a plant of this rough bandwidth in rad/s.
pub(crate) const fn for_bandwidth<const M: usize>(bandwidth: f32) -> [f32; M] {
    let corner = 1.1 * bandwidth;
    let slow = if M == 1 { corner } else { 0.1 * corner };
    let mut filter = with_pole([0.0; M], 0, slow);
    if M == 2 {
        return with_pole(filter, 1, corner);
    }
    if M >= 3 {
        // The pair: damping 0.7 at the corner.
        let (pair0, pair1) = (corner * corner, 1.4 * corner);
        filter[0] = slow * pair0;
        filter[1] = pair0 + slow * pair1;
        filter[2] = slow + pair1;
    }
    if M == 4 {
        filter = with_pole(filter, 3, corner);
    }
    filter
}

/// The first coefficient with which `s^m + .. + filter[0]` cannot be a Hurwitz polynomial, m <= 4.
pub(crate) const fn hurwitz_violation<const M: usize>(filter: &[f32; M]) -> Option<usize> {
    let mut i = 0;
    while i < M {
        if !positive(filter[i]) {
            return Some(i);
        }
        i += 1;
    }
    let stable = match M {
        3 => filter[2] * filter[1] > filter[0],
        4 => {
            let first = filter[3] * filter[2] - filter[1];
            first * filter[1] > filter[3] * filter[3] * filter[0]
        }
        _ => true,
    };
    if stable { None } else { Some(0) }
}

/// The real root nearest to zero, as a positive rate, by Newton's method from zero.
///
/// Where the slowest mode is a pair there is none such; then the result is some rate
/// of its size.
pub(crate) fn slowest<const M: usize>(filter: &[f32; M]) -> f32 {
    let mut rate = 0.0;
    for _ in 0..30 {
        // A_f(-rate) and its slope with respect to rate.
        let (mut value, mut slope) = (1.0, 0.0);
        for i in (0..M).rev() {
            slope = -slope * rate - value;
            value = filter[i] - value * rate;
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
        let mut filter = [0.0; 4];
        for (degree, pole) in [1.0, 2.0, 3.0, 4.0].into_iter().enumerate() {
            filter = with_pole(filter, degree, pole);
        }
        assert_eq!(filter, [24.0, 50.0, 35.0, 10.0]);
        assert!((slowest(&filter) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn the_default_has_its_slow_pole_and_its_pair() {
        // (s + 2.2)(s^2 + 30.8 s + 484) for 20 rad/s.
        let wanted = [1064.8, 551.76, 33.0];
        for (found, wanted) in for_bandwidth::<3>(20.0).into_iter().zip(wanted) {
            assert!((found / wanted - 1.0).abs() < 1e-6, "{found}");
        }
        assert!((slowest(&for_bandwidth::<3>(20.0)) - 2.2).abs() < 1e-4);
        assert_eq!(for_bandwidth::<1>(20.0), [22.0]);
        let [low, high] = for_bandwidth::<2>(20.0);
        assert!((low - 48.4).abs() < 1e-4 && (high - 24.2).abs() < 1e-4);
        assert!(hurwitz_violation(&for_bandwidth::<4>(20.0)).is_none());
        assert_eq!(hurwitz_violation(&[8.0, 1.0, 1.0]), Some(0));
    }
}
