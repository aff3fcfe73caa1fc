//! What load and rod of a drive take from the flow of its valve.

use crate::math::within;

/// Loss of flow over the velocity gain, per unit of e: see [`loss_over_gain`].
const LOSS: f32 = 0.75;
/// Largest share of the flow that counts as lost: beyond it the loss is no longer in proportion.
const LOST_MOST: f32 = 0.5;

/// kappa / C of a drive that gets stiffer towards its ends with e, in 1/travel: the drive p of a
/// valve that is open by f fades with the rate `kappa |f|`.
///
/// A chamber of volume V under the pressure P takes the flow q of the opening f. Its share of the
/// force fades with `n R T |dq/dP| / V`; where feed and vent balance, `|dq/dP|` is 1.05 to 1.25
/// times `q / P` in the mean of both edges, for critical ratios of 0.1 to 0.5 and 4 to 8 bar (ISO
/// 6358). The same q moves the piston of the area A with `C f = R T q / (P A)`. In the middle of
/// the travel V is `A (d + 1/2)` of the stroke, so that
///
/// ```text
/// kappa = 1.1 n C / (d + 1/2) = 1.1 n sqrt(e) C,   n = 1 to 1.4;   2.0 to 2.8 C with e = 3.2
/// ```
///
/// A drive without chambers has no e and loses nothing. Between both the loss is taken in
/// proportion to e, `0.75 e C`, which is that of a cylinder with n = 1.2.
pub(crate) const fn loss_over_gain(stiffening: f32) -> f32 {
    LOSS * stiffening
}

/// What arrives of a flow under an imbalance.
#[inline(always)]
pub(crate) const fn balanced(flow: f32, imbalance: f32) -> f32 {
    flow - imbalance * if flow < 0.0 { -flow } else { flow }
}

/// Share of the flow that load and rod take.
///
/// ```text
/// p' = k(x) (b0 f (1 - (i + lambda p) sgn f) - a1 v),   lambda = kappa / b0 = 0.75 e / (a1 L)
/// ```
///
/// p / a1 is the deflection of the drive under what accelerates it, and lambda p the loss for the
/// part of the travel L that it is. What drives a load gets less flow, what brakes it gets more.
/// The imbalance i is what a rod and a constant load take one way and give the other way.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Load {
    /// lambda.
    per_drive: f32,
    /// i.
    imbalance: f32,
    /// i + lambda p.
    lost: f32,
}

impl Load {
    /// Goes over to a drive of this a1, e and i over a travel of this length; one without stiffness
    /// has no deflection that could be known.
    pub(crate) const fn tune(&mut self, a1: f32, stiffening: f32, length: f32, imbalance: f32) {
        self.imbalance = imbalance;
        self.per_drive = if a1 > 0.0 {
            loss_over_gain(stiffening) / (a1 * length)
        } else {
            0.0
        };
    }

    /// The drive that the motion takes from now on.
    #[inline(always)]
    pub(crate) fn bear(&mut self, drive: f32) {
        self.lost = within(self.imbalance + self.per_drive * drive, LOST_MOST);
    }

    /// The part of a flow that arrives.
    #[inline(always)]
    pub(crate) const fn passes(&self, flow: f32) -> f32 {
        if flow > 0.0 {
            1.0 - self.lost
        } else {
            1.0 + self.lost
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sqrt;
    use crate::servo::control::place::stiffening;

    /// What flows through an edge over what flows where it is sonic, from a pressure to another
    /// (ISO 6358).
    fn through(critical: f32, from: f32, to: f32) -> f32 {
        let z = (to / from - critical) / (1.0 - critical);
        if z <= 0.0 {
            from
        } else {
            from * sqrt(1.0 - z * z)
        }
    }

    /// Slope of the flow of an edge by the pressure of the chamber, over flow by pressure, where
    /// feed and vent balance.
    fn slope(critical: f32, supply: f32) -> f32 {
        let flows = |p: f32| [through(critical, supply, p), through(critical, p, 1.0)];
        let (mut low, mut high) = (1.0, supply);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let [fed, vented] = flows(middle);
            if fed > vented {
                low = middle;
            } else {
                high = middle;
            }
        }
        let (p, h) = (low, 1e-2);
        let ([fed, vented], [fed_before, vented_before]) = (flows(p + h), flows(p - h));
        (vented - vented_before + fed_before - fed) / (4.0 * h) * p / vented
    }

    #[test]
    fn the_loss_of_a_cylinder_is_that_of_its_chambers() {
        for critical in [0.1, 0.2, 0.3, 0.4, 0.5] {
            for supply in [5.0, 7.0, 9.0] {
                let slope = slope(critical, supply);
                assert!(
                    (1.03..=1.26).contains(&slope),
                    "{critical} {supply}: {slope}"
                );
                for polytropic in [1.0, 1.2, 1.4] {
                    for dead_volume in [0.04, 0.06, 0.1] {
                        let exact = slope * polytropic / (dead_volume + 0.5);
                        let share = exact / loss_over_gain(stiffening(dead_volume));
                        assert!((0.7..1.6).contains(&share), "{share}");
                    }
                }
            }
        }
        assert_eq!(loss_over_gain(stiffening(f32::INFINITY)), 0.0);
    }

    #[test]
    fn what_drives_a_load_gets_less_and_what_brakes_it_more() {
        let mut load = Load::default();
        assert_eq!((load.passes(0.3), load.passes(-0.3)), (1.0, 1.0));
        // Under a drive of 900 a drive of 30 rad/s is off by 1 of 100: 0.75 3.2 / 100.
        load.tune(900.0, 3.2, 100.0, 0.0);
        load.bear(900.0);
        assert!((load.passes(0.3) - 0.976).abs() < 1e-6);
        assert!((load.passes(-0.3) - 1.024).abs() < 1e-6);
        load.bear(-900.0);
        assert!((load.passes(-0.3) - 0.976).abs() < 1e-6);
        // No load takes all of it, and none is no number.
        for (drive, least) in [(1e9, 0.5), (f32::INFINITY, 0.5), (-1e9, 1.5)] {
            load.bear(drive);
            assert_eq!(load.passes(1.0), least);
        }
        for (a1, stiffening) in [(900.0, 0.0), (0.0, 3.2), (f32::NAN, 3.2)] {
            load.tune(a1, stiffening, 100.0, 0.0);
            load.bear(1e6);
            assert_eq!(load.passes(1.0), 1.0);
        }
    }
}
