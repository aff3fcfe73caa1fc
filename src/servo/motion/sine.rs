//! A sine that begins without a kick.

use crate::math::sin;
use crate::servo::motion::{MotionLimits, Setpoint};

/// `centre + amplitude blend(t) sin(omega t)`; the blend rises from 0 to 1 over one period, over
/// more where the limits require it.
///
/// The phase is a phasor that is turned by one sample at a time: + - x only.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sine {
    centre: f32,
    amplitude: f32,
    /// Angular frequency in rad/s.
    omega: f32,
    /// cos and sin of the angle of one sample.
    turn: [f32; 2],
    /// cos and sin of the phase.
    phase: [f32; 2],
    /// Elapsed share of the growth, and the share of a sample.
    share: f32,
    growth: f32,
}

/// Periods of growth, with the largest acceleration and jerk over `A omega^2` and `A omega^3`
/// meanwhile.
const GROWTHS: [[f32; 3]; 3] = [[1.0, 1.16, 1.56], [2.0, 1.02, 1.10], [4.0, 1.002, 1.013]];

/// The largest amplitude that the limits allow at `frequency` (Hz) with this growth.
fn amplitude(frequency: f32, limits: &MotionLimits, growth: [f32; 3]) -> f32 {
    let [_, acceleration, jerk] = growth;
    let omega = 2.0 * core::f32::consts::PI * frequency;
    let by_velocity = limits.velocity / omega;
    let by_acceleration = limits.acceleration / (acceleration * omega * omega);
    let by_jerk = limits.jerk / (jerk * omega * omega * omega);
    by_velocity.min(by_acceleration).min(by_jerk)
}

impl Sine {
    /// The largest amplitude that the limits allow at `frequency` (Hz), with the slowest growth.
    pub(crate) fn max_amplitude(frequency: f32, limits: &MotionLimits) -> f32 {
        let [.., slowest] = GROWTHS;
        amplitude(frequency, limits, slowest)
    }

    /// A sine of `frequency` in Hz that grows as fast as the limits allow. Not for the 1 ms path:
    /// one sine and cosine.
    pub(crate) fn new(
        centre: f32,
        wanted: f32,
        frequency: f32,
        limits: &MotionLimits,
        sample_time: f32,
    ) -> Self {
        let [.., [slowest, ..]] = GROWTHS;
        let periods = GROWTHS
            .into_iter()
            .find(|growth| wanted.abs() <= amplitude(frequency, limits, *growth))
            .map_or(slowest, |[periods, ..]| periods);
        let omega = 2.0 * core::f32::consts::PI * frequency;
        let angle = omega * sample_time;
        Self {
            centre,
            amplitude: wanted,
            omega,
            turn: [sin(angle + core::f32::consts::FRAC_PI_2), sin(angle)],
            phase: [1.0, 0.0],
            share: 0.0,
            growth: frequency * sample_time / periods,
        }
    }

    /// The same, with `2^doublings` of its samples in one. Cost: 6 instructions per doubling.
    pub(crate) fn coarse(mut self, doublings: u32) -> Self {
        for _ in 0..doublings {
            let [cos, sin] = self.turn;
            self.turn = [cos * cos - sin * sin, 2.0 * sin * cos];
            self.growth *= 2.0;
        }
        self
    }

    /// One sample of `step` seconds on. Cost: about 60 instructions.
    #[inline]
    pub(crate) fn next(&mut self, step: f32) -> Setpoint {
        let [c, s] = self.phase;
        let [cos, sin] = self.turn;
        let mut rotated = [c * cos - s * sin, s * cos + c * sin];
        // One step of Newton keeps the phasor on the unit circle.
        let correction = 1.5 - 0.5 * (rotated[0] * rotated[0] + rotated[1] * rotated[1]);
        rotated[0] *= correction;
        rotated[1] *= correction;
        self.phase = rotated;
        let [c, s] = rotated;
        let blend = self.blend(step);
        let w = self.omega;
        let wave = [s, w * c, -w * w * s, -w * w * w * c];
        Setpoint {
            position: self.centre + self.amplitude * blend[0] * wave[0],
            velocity: self.amplitude * (blend[0] * wave[1] + blend[1] * wave[0]),
            acceleration: self.amplitude
                * (blend[0] * wave[2] + 2.0 * blend[1] * wave[1] + blend[2] * wave[0]),
            jerk: self.amplitude
                * (blend[0] * wave[3]
                    + 3.0 * (blend[1] * wave[2] + blend[2] * wave[1])
                    + blend[3] * wave[0]),
        }
    }

    /// The smooth step of degree 7 and its derivatives: the amplitude begins without a kick.
    #[inline]
    fn blend(&mut self, step: f32) -> [f32; 4] {
        if self.share >= 1.0 {
            return [1.0, 0.0, 0.0, 0.0];
        }
        self.share += self.growth;
        let x = if self.share < 1.0 { self.share } else { 1.0 };
        let (x2, x3) = (x * x, x * x * x);
        let rate = self.growth / step;
        [
            x3 * x * (35.0 - 84.0 * x + 70.0 * x2 - 20.0 * x3),
            rate * 140.0 * x3 * (1.0 - 3.0 * x + 3.0 * x2 - x3),
            rate * rate * 420.0 * x2 * (1.0 - 4.0 * x + 5.0 * x2 - 2.0 * x3),
            rate * rate * rate * 840.0 * x * (1.0 - 6.0 * x + 10.0 * x2 - 5.0 * x3),
        ]
    }
}

#[cfg(test)]
mod tests;
