//! The filter polynomial `A_f = s^m + f_{m-1} s^{m-1} + .. + f_0` in front of the estimator.

use crate::math::polynomial::with_pole;

/// Natural frequency of the pair over the bandwidth, and its damping.
const CORNER: f32 = 1.1;
const DAMPING: f32 = 0.7;

/// The time constant of the pair of the default filter, in s.
pub(crate) const fn time_constant(bandwidth: f32) -> f32 {
    1.0 / (DAMPING * CORNER * bandwidth)
}

/// Three of them.
pub(crate) const fn settling_time(bandwidth: f32) -> f32 {
    3.0 / (DAMPING * CORNER * bandwidth)
}

/// Coefficients f_0 .. f_{m-1} of the filter with the real poles `-poles[i]`, in rad^(m-i)/s^(m-i).
///
/// # Examples
/// ```
/// assert_eq!(trendid::trends::polynomial_of_poles([2.0; 3]), [8.0, 12.0, 6.0]);
/// ```
pub fn polynomial_of_poles<const M: usize>(poles: [f32; M]) -> [f32; M] {
    let mut filter = [0.0; M];
    for (i, pole) in poles.into_iter().enumerate() {
        filter = with_pole(filter, i, pole);
    }
    filter
}

/// The default filter for a plant of this rough bandwidth in rad/s.
pub(crate) fn for_bandwidth<const M: usize>(bandwidth: f32) -> [f32; M] {
    let corner = CORNER * bandwidth;
    let slow = if M == 1 { corner } else { 0.1 * corner };
    let mut filter = with_pole([0.0; M], 0, slow);
    if M == 2 {
        return with_pole(filter, 1, corner);
    }
    if M >= 3 {
        let (pair0, pair1) = (corner * corner, 2.0 * DAMPING * corner);
        filter[0] = slow * pair0;
        filter[1] = pair0 + slow * pair1;
        filter[2] = slow + pair1;
    }
    if M == 4 {
        filter = with_pole(filter, 3, corner);
    }
    filter
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::polynomial::{is_hurwitz, slowest_rate};

    #[test]
    fn settling_is_three_time_constants_of_the_pair() {
        let filter = for_bandwidth::<3>(20.0);
        // (s + a)(s^2 + b s + c): b/2 is the decay of the pair.
        let decay = 0.5 * (filter[2] - slowest_rate(&filter));
        assert!((settling_time(20.0) * decay - 3.0).abs() < 1e-3);
    }

    #[test]
    fn the_default_has_its_slow_pole_and_its_pair() {
        // (s + 2.2)(s^2 + 30.8 s + 484) for 20 rad/s.
        let wanted = [1064.8, 551.76, 33.0];
        for (found, wanted) in for_bandwidth::<3>(20.0).into_iter().zip(wanted) {
            assert!((found / wanted - 1.0).abs() < 1e-6, "{found}");
        }
        assert!((slowest_rate(&for_bandwidth::<3>(20.0)) - 2.2).abs() < 1e-4);
        assert_eq!(for_bandwidth::<1>(20.0), [22.0]);
        let [low, high] = for_bandwidth::<2>(20.0);
        assert!((low - 48.4).abs() < 1e-4 && (high - 24.2).abs() < 1e-4);
        assert!(is_hurwitz(&for_bandwidth::<4>(20.0)));
    }
}
