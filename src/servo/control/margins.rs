//! How far a loop is from its limit, read from 1 + L along the frequencies.

use crate::math::complex::Complex;
use crate::math::sqrt;

/// How far a loop is from its limit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Margins {
    /// Largest sensitivity, `max 1/|1 + L|`.
    pub sensitivity: f32,
    /// Phase margin in rad, and the delay margin in s: the least of all crossings of |L| = 1.
    pub phase: f32,
    /// The delay that may come on top.
    pub delay: f32,
    /// Factor of the gain up to which the loop is stable.
    pub gain: f32,
}

impl Margins {
    pub(crate) const NONE: Self = Self {
        sensitivity: 0.0,
        phase: core::f32::consts::PI,
        delay: f32::INFINITY,
        gain: f32::INFINITY,
    };

    /// Notes what two neighbouring values of 1 + L show of them.
    pub(crate) fn note(&mut self, last: &Complex, closed: &Complex, w: f32) {
        let inverse = 1.0 / sqrt(closed.size());
        if inverse > self.sensitivity {
            self.sensitivity = inverse;
        }
        let open = |c: &Complex| (c.re - 1.0) * (c.re - 1.0) + c.im * c.im;
        if (open(last) - 1.0) * (open(closed) - 1.0) < 0.0 {
            // The chord from L to -1 of a unit circle.
            let chord = sqrt(closed.size());
            let angle = chord * (1.0 + chord * chord * (1.0 / 24.0));
            if angle < self.phase {
                self.phase = angle;
            }
            if angle / w < self.delay {
                self.delay = angle / w;
            }
        }
        let real = closed.re - 1.0;
        if last.im * closed.im < 0.0 && real < 0.0 && real > -1.0 {
            let gain = -1.0 / real;
            if gain < self.gain {
                self.gain = gain;
            }
        }
    }
}

#[cfg(test)]
mod tests;
