//! What the parameters of the fit are taken for beforehand, and what they can be.

use crate::math::sqrt;
use crate::servo::commissioning::predictor::{PARAMETERS, Theta};
use crate::servo::control::load::loss_over_gain;
use crate::servo::design::constants::{GAIN_MAX_RATIO, VALVE_MAX};

/// The stiffening that is taken for a drive that shows none: between 0, of a drive of the same
/// stiffness everywhere, and 3.2 of a usual cylinder, nearer to the cylinder, which strikes its end
/// where its model is too soft.
const STIFFENING_USUAL: f32 = 2.2;
/// Largest e of k(x): a dead volume of 0.035.
const STIFFENING_MAX: f32 = 3.5;

/// Natural frequencies in rad/s, squared, that are looked for: an axis that takes two seconds for a
/// swing, and one that has twenty samples of 1 ms for it.
const STIFFNESS: [f32; 2] = [3.0 * 3.0, 300.0 * 300.0];
/// Velocity gains in travels per s: one that takes minutes for its travel, and the most that a
/// setting allows by default.
const GAIN: [f32; 2] = [1e-3, GAIN_MAX_RATIO];
/// a2 over the natural frequency: of a damping of 0.01, and of 4.
const DAMPING: [f32; 2] = [0.02, 8.0];
/// Longest delay in s: of a valve behind a bus.
const DELAY: f32 = 0.03;

/// Largest loss of flow over the velocity gain: twice that of a cylinder.
const LOSS_MOST: f32 = 5.6;

/// Imbalance of the flow: the deviation that is taken for it beforehand, and the largest.
///
/// A rod that leaves the share r of the area makes an oil cylinder behind a symmetrical valve
/// `sqrt(r)` times as fast one way as the other, an imbalance of `(1 - sqrt(r)) / (1 + sqrt(r))`:
/// 0.06 to 0.17 for an r of 0.8 to 0.5, which rods of 0.45 to 0.7 of the bore leave. With air it is
/// `(1 - r) / (1 + r)`, and a constant load of the share s of supply times area makes 0.4 s at half
/// of the flow and more at less, by the leaks beside it (`cargo test -p trendid-host-tests --test
/// servo both_ways`). The largest is more than three times as much.
const IMBALANCE_USUAL: f32 = 0.07;
const IMBALANCE_MOST: f32 = 0.4;

/// What a parameter is varied by: itself, or a part of what it acts on.
pub(crate) fn scales(theta: &Theta) -> [f32; PARAMETERS] {
    let w = sqrt(theta.a1);
    [
        theta.a1,
        theta.a2 + 0.1 * w,
        theta.b0,
        0.05,
        0.05,
        0.1 * theta.b0 / w,
        0.1 / w,
        theta.b0 / theta.a1,
        1.0,
        IMBALANCE_USUAL,
    ]
}

/// Parameters that a drive can have.
pub(crate) fn bounded(theta: [f32; PARAMETERS]) -> Theta {
    let within = |x: f32, low: f32, high: f32| {
        if x > high {
            high
        } else if x > low {
            x
        } else {
            low
        }
    };
    let free = Theta::from_array(theta);
    let a1 = within(free.a1, STIFFNESS[0], STIFFNESS[1]);
    let w = sqrt(a1);
    let b0 = within(free.b0, GAIN[0] * a1, GAIN[1] * a1);
    Theta {
        a1,
        a2: within(free.a2, DAMPING[0] * w, DAMPING[1] * w),
        b0,
        dead_zone: within(free.dead_zone, 0.0, VALVE_MAX),
        offset: within(free.offset, -VALVE_MAX, VALVE_MAX),
        friction: within(free.friction, 0.0, b0 / w),
        delay: within(free.delay, 0.0, DELAY),
        kappa: within(free.kappa, 0.0, LOSS_MOST * b0 / a1),
        stiffening: within(free.stiffening, 0.0, STIFFENING_MAX),
        imbalance: within(free.imbalance, -IMBALANCE_MOST, IMBALANCE_MOST),
    }
}

/// The parameters, where the record says nothing of them: friction and imbalance are none unless
/// they are seen, of the stiffness the mean of all drives is, unless it is known, and the loss of
/// flow goes with it.
pub(crate) fn usual(theta: &Theta, knows_stiffening: bool) -> Theta {
    Theta {
        friction: 0.0,
        imbalance: 0.0,
        kappa: loss_over_gain(theta.stiffening) * theta.b0 / theta.a1,
        stiffening: if knows_stiffening {
            theta.stiffening
        } else {
            STIFFENING_USUAL
        },
        ..*theta
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::commissioning::oracle::Dice;

    #[test]
    fn parameters_are_those_that_a_drive_can_have() {
        let mut dice = Dice::new(6);
        for _ in 0..50 {
            let theta = dice.theta();
            assert_eq!(bounded(theta.to_array()), theta, "inside nothing changes");
        }
        let high = bounded([f32::INFINITY; PARAMETERS]);
        let low = bounded([-f32::INFINITY; PARAMETERS]);
        let nothing = bounded([f32::NAN; PARAMETERS]);
        assert_eq!((high.a1, low.a1), (9e4, 9.0));
        // Damping from 0.01 to 4, a gain from a thousandth of the travel per second to fifty.
        assert_eq!((high.a2, low.a2), (8.0 * 300.0, 0.02 * 3.0));
        assert_eq!((high.b0, low.b0), (50.0 * 9e4, 1e-3 * 9.0));
        assert_eq!((high.friction, low.friction), (50.0 * 9e4 / 300.0, 0.0));
        assert_eq!((high.kappa, low.kappa), (LOSS_MOST * 50.0, 0.0));
        assert_eq!([high.dead_zone, high.offset, high.delay], [0.3, 0.3, 0.03]);
        assert_eq!([low.dead_zone, low.offset, low.delay], [0.0, -0.3, 0.0]);
        assert_eq!([high.stiffening, low.stiffening], [STIFFENING_MAX, 0.0]);
        assert_eq!([high.imbalance, low.imbalance], [0.4, -0.4]);
        assert_eq!(nothing, low);
    }

    #[test]
    fn what_a_record_does_not_show_is_as_of_most_drives() {
        let mut dice = Dice::new(9);
        for _ in 0..20 {
            let theta = dice.theta();
            let [unknown, known] = [false, true].map(|knows| usual(&theta, knows));
            assert_eq!(unknown.stiffening, STIFFENING_USUAL);
            assert_eq!(known.stiffening, theta.stiffening);
            for found in [unknown, known] {
                let lost = found.kappa * theta.a1 / theta.b0;
                assert!((lost - loss_over_gain(theta.stiffening)).abs() < 1e-6);
                assert_eq!(
                    Theta {
                        friction: theta.friction,
                        kappa: theta.kappa,
                        stiffening: theta.stiffening,
                        imbalance: theta.imbalance,
                        ..found
                    },
                    theta
                );
                assert_eq!([found.friction, found.imbalance], [0.0; 2]);
            }
        }
    }

    #[test]
    fn what_a_parameter_is_varied_by_has_its_unit() {
        // The same drive with another unit of time.
        let theta = Dice::new(7).theta();
        let [s, square, cube] = [3.0_f32, 9.0, 27.0];
        let quicker = Theta {
            a1: square * theta.a1,
            a2: s * theta.a2,
            b0: cube * theta.b0,
            ..theta
        };
        let units = [square, s, cube, 1.0, 1.0, square, 1.0 / s, s, 1.0, 1.0];
        for ((slow, quick), unit) in scales(&theta).iter().zip(scales(&quicker)).zip(units) {
            assert!((quick / (slow * unit) - 1.0).abs() < 1e-5 && *slow > 0.0);
        }
        // A parameter that may be zero is varied all the same.
        let none = Theta {
            a2: 0.0,
            friction: 0.0,
            kappa: 0.0,
            delay: 0.0,
            imbalance: 0.0,
            ..theta
        };
        assert!(scales(&none).iter().all(|scale| *scale > 0.0));
    }
}
