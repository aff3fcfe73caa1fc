//! The filter polynomial `A_f = s^m + f_{m-1} s^{m-1} + .. + f_0` in front of the estimator.

use crate::math::polynomial::with_pole;

/// The default filter for a plant of this rough bandwidth in rad/s.
pub(crate) fn for_bandwidth<const M: usize>(bandwidth: f32) -> [f32; M] {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::polynomial::{is_hurwitz, slowest_rate};

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
