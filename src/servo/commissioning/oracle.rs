//! The drive of the fit in double precision, by small steps: what the quick series are held
//! against.
#![expect(
    clippy::disallowed_types,
    reason = "an oracle must be able to disagree"
)]

use super::predictor::{Prediction, Theta};

/// Numbers without a pattern, from -1 to 1.
pub(super) struct Dice(u32);

impl Dice {
    pub(super) const fn new(seed: u32) -> Self {
        Self(seed)
    }

    pub(super) fn roll(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((self.0 >> ((self.0 >> 28) + 4)) ^ self.0).wrapping_mul(277_803_737);
        (word >> 8) as f32 / 8_388_608.0 - 1.0
    }

    /// From `low` to `high`.
    pub(super) fn within(&mut self, low: f32, high: f32) -> f32 {
        low + 0.5 * (self.roll() + 1.0) * (high - low)
    }

    /// A drive as there are many, in travels.
    pub(super) fn theta(&mut self) -> Theta {
        let w = self.within(10.0, 40.0);
        let gain = self.within(1.0, 4.0);
        Theta {
            a1: w * w,
            a2: 2.0 * self.within(0.1, 0.9) * w,
            b0: gain * w * w,
            dead_zone: self.within(0.0, 0.08),
            offset: self.within(-0.05, 0.05),
            friction: self.within(0.0, 2.0),
            delay: self.within(0.0, 0.02),
            kappa: gain * self.within(0.0, 4.0),
            stiffening: self.within(0.0, 3.0),
            imbalance: self.within(-0.2, 0.2),
        }
    }
}

/// The state after `time`, under a constant flow and a constant friction: fourth order of Runge and
/// Kutta in 200 steps.
pub(super) fn moved(
    theta: &Theta,
    at: &Prediction,
    flow: f32,
    friction: f32,
    time: f32,
) -> [f64; 3] {
    let [a1, a2, b0, kappa] = [theta.a1, theta.a2, theta.b0, theta.kappa].map(f64::from);
    let imbalance = f64::from(theta.imbalance);
    let (flow, friction) = (f64::from(flow), f64::from(friction));
    let slope = |[_, v, p]: [f64; 3]| {
        [
            v,
            p - a2 * v - friction,
            b0 * (flow - imbalance * flow.abs()) - a1 * v - kappa * flow.abs() * p,
        ]
    };
    let h = f64::from(time) / 200.0;
    let plus = |at: [f64; 3], share: f64, slope: [f64; 3]| {
        core::array::from_fn(|k| at[k] + share * slope[k])
    };
    let mut state = [at.x, at.v, at.p].map(f64::from);
    for _ in 0..200 {
        let k1 = slope(state);
        let k2 = slope(plus(state, 0.5 * h, k1));
        let k3 = slope(plus(state, 0.5 * h, k2));
        let k4 = slope(plus(state, h, k3));
        state = core::array::from_fn(|k| {
            state[k] + h / 6.0 * (k1[k] + 2.0 * k2[k] + 2.0 * k3[k] + k4[k])
        });
    }
    state
}

/// Whether a prediction is that state, within `share` of what each of them moved or may move.
pub(super) fn close(found: &Prediction, expected: [f64; 3], sizes: [f32; 3], share: f64) -> bool {
    [found.x, found.v, found.p]
        .into_iter()
        .zip(expected)
        .zip(sizes)
        .all(|((found, expected), size)| {
            (f64::from(found) - expected).abs() <= share * f64::from(size)
        })
}

/// The same number.
pub(super) fn f64_of(x: f32) -> f64 {
    x.into()
}
