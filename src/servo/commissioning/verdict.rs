//! When an estimate is a model.

use crate::math::sqrt;
use crate::servo::commissioning::predictor::Theta;
use crate::servo::supervision::state::Reason;

/// Bounds of an accepted model.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bounds {
    /// Largest error of a free simulation over the movement, squared.
    misfit: f32,
    /// Largest relative change of gain and natural frequency, and change of damping, between two
    /// estimates.
    change: [f32; 3],
    /// Largest relative standard deviation of gain and frequency, and standard deviation of the
    /// damping.
    std: [f32; 3],
}

/// Scale of the dead zone in the fit, and its largest standard deviation at first.
const DEAD_ZONE_SCALE: f32 = 0.05;
const DEAD_ZONE_STD: f32 = 0.014;

const BOUNDS: Bounds = Bounds {
    misfit: 0.3 * 0.3,
    change: [0.15, 0.08, 0.15],
    std: [0.12, 0.07, 0.15],
};

/// Velocity gain, natural frequency, damping.
fn physical(theta: &Theta) -> [f32; 3] {
    let w = sqrt(theta.a1);
    [theta.b0 / theta.a1, w, 0.5 * theta.a2 / w]
}

/// Whether an estimate is a model: it follows later samples, agrees with the estimate before, and
/// is certain. `std` is that of the fit, `misfit` that of a free simulation; its error is `silent`
/// within the noise; `slack` widens the bounds.
///
/// The standard deviations separate good models from bad ones best; a free simulation of an axis
/// that sticks is rough, and finds what has another structure.
pub(crate) fn verdict(
    theta: &Theta,
    previous: Option<&Theta>,
    std: [f32; 4],
    [misfit, silent]: [f32; 2],
    slack: f32,
) -> Result<(), Reason> {
    if !(misfit < slack * slack * BOUNDS.misfit || silent > 0.0) {
        return Err(Reason::PoorFit);
    }
    let Some(previous) = previous else {
        return Err(Reason::Uncertain);
    };
    let [c, w, xi] = physical(theta);
    let [other_c, other_w, other_xi] = physical(previous);
    let changes = [c / other_c - 1.0, w / other_w - 1.0, xi - other_xi];
    let agrees = changes
        .iter()
        .zip(BOUNDS.change)
        .all(|(change, most)| change.abs() < slack * most);
    let stds = [std[2], 0.5 * std[0], 0.5 * std[1] * (theta.a2 / w + 0.1)];
    // A dead zone is worth waiting for, but not worth a refusal: its bound widens fast.
    let square = slack * slack;
    let closed = DEAD_ZONE_SCALE * std[3] < DEAD_ZONE_STD * square * square;
    let certain = stds
        .iter()
        .zip(BOUNDS.std)
        .all(|(std, most)| *std < slack * most);
    if agrees && certain && closed {
        Ok(())
    } else {
        Err(Reason::Uncertain)
    }
}

/// How often estimates were not accepted, by the reason: the last of many is one by chance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Refusals {
    poor: u32,
    others: u32,
    /// The more frequent reason; of equally frequent ones the newer.
    pub(crate) most: Option<Reason>,
}

impl Refusals {
    pub(crate) const NONE: Self = Self {
        poor: 0,
        others: 0,
        most: None,
    };

    /// Takes the reason of an estimate.
    pub(crate) const fn count(&mut self, reason: Reason) {
        let (own, other) = match reason {
            Reason::PoorFit => (&mut self.poor, self.others),
            _ => (&mut self.others, self.poor),
        };
        *own = own.saturating_add(1);
        if *own >= other {
            self.most = Some(reason);
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    #[test]
    fn the_reason_is_that_of_most_estimates() {
        let mut refusals = Refusals::NONE;
        assert_eq!(refusals.most, None);
        for (reason, most) in [
            (Reason::Uncertain, Reason::Uncertain),
            (Reason::PoorFit, Reason::PoorFit),
            (Reason::PoorFit, Reason::PoorFit),
            (Reason::Uncertain, Reason::Uncertain),
            (Reason::PoorFit, Reason::PoorFit),
            (Reason::PoorFit, Reason::PoorFit),
            (Reason::Uncertain, Reason::PoorFit),
        ] {
            refusals.count(reason);
            assert_eq!(refusals.most, Some(most));
        }
    }

    pub(crate) const THETA: Theta = Theta {
        a1: 400.0,
        a2: 20.0,
        b0: 800.0,
        dead_zone: 0.03,
        offset: 0.0,
        friction: 1.0,
        delay: 0.01,
        kappa: 0.0,
        stiffening: 0.0,
        imbalance: 0.0,
    };
    const UNCERTAIN: Result<(), Reason> = Err(Reason::Uncertain);

    fn judged(other: Theta, std: [f32; 4], misfit: [f32; 2], slack: f32) -> Result<(), Reason> {
        verdict(&THETA, Some(&other), std, misfit, slack)
    }

    #[test]
    fn a_model_follows_or_its_error_is_within_the_noise() {
        let poor = Err(Reason::PoorFit);
        for slack in [1.0_f32, 1.5] {
            let most = slack * slack * 0.09;
            assert_eq!(judged(THETA, [0.0; 4], [0.99 * most, 0.0], slack), Ok(()));
            assert_eq!(judged(THETA, [0.0; 4], [1.01 * most, 0.0], slack), poor);
            assert_eq!(judged(THETA, [0.0; 4], [9.0, 1.0], slack), Ok(()));
            assert_eq!(judged(THETA, [0.0; 4], [f32::NAN, 0.0], slack), poor);
        }
        // One estimate alone agrees with none.
        assert_eq!(verdict(&THETA, None, [0.0; 4], [0.0; 2], 1.0), UNCERTAIN);
    }

    #[test]
    fn a_model_agrees_with_the_one_before() {
        // Gain within 15 %, frequency within 8 %, damping within 0.15.
        for slack in [1.0_f32, 1.5] {
            for (place, most) in [(0, 0.15), (1, 0.08), (2, 0.15)] {
                for (share, found) in [(0.99, Ok(())), (1.01, UNCERTAIN)] {
                    for side in [1.0, -1.0] {
                        let change = side * share * slack * most;
                        let mut other = THETA;
                        match place {
                            0 => other.b0 /= 1.0 + change,
                            1 => {
                                let w = 20.0 / (1.0 + change);
                                (other.a1, other.a2, other.b0) = (w * w, w, 2.0 * w * w);
                            }
                            _ => other.a2 -= 2.0 * change * 20.0,
                        }
                        let judged = judged(other, [0.0; 4], [0.0; 2], slack);
                        assert_eq!(judged, found, "{place} {share}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_model_is_certain() {
        // Deviations of gain, frequency, damping; of the dead zone, whose bound widens fast.
        for slack in [1.0_f32, 1.5] {
            let xi = 0.5 * (1.0 + 0.1);
            let dead_zone = 0.014 * slack * slack * slack * slack / 0.05;
            for (place, most) in [
                (2, 0.12 * slack),
                (0, 0.07 * slack / 0.5),
                (1, 0.15 * slack / xi),
                (3, dead_zone),
            ] {
                for (share, found) in [(0.99, Ok(())), (1.01, UNCERTAIN)] {
                    let mut std = [0.0; 4];
                    std[place] = share * most;
                    let judged = judged(THETA, std, [0.0; 2], slack);
                    assert_eq!(judged, found, "{place} {share}");
                }
            }
        }
    }
}
