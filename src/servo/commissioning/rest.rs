//! Stage 0: the axis at rest with the valve centred, which shows noise and drift.

use crate::servo::design::constants::{CODE_CHANGING_NOISE, LEAST_RUN_TIME, STUCK_RUN_RATIO};

/// Time in s of rest, for the drift.
const TIME: f32 = 0.05;
/// Relative deviation to which the noise must be known: that of n second differences of white noise
/// is `1 / sqrt n`, however far apart they are.
const NOISE_DEVIATION: f32 = 0.16;
/// Movement in travels that ends it early.
const MOVEMENT: f32 = 4e-3;
/// Least deviation from rest that counts as movement, in travels.
const DETECTION_MIN: f32 = 2e-4;
/// Standard deviations of the position that a movement that counts has at least.
pub(crate) const DETECTION_DEVIATIONS: f32 = 8.0;

/// What the axis at rest has shown.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Still {
    /// Standard deviation of the position.
    pub(crate) sigma: f32,
    /// Mean position, in the middle of the rest, and velocity.
    pub(crate) place: f32,
    pub(crate) drift: f32,
    /// Time from the middle to the end of the rest in s.
    pub(crate) since: f32,
    /// Deviation that counts as movement.
    pub(crate) detection: f32,
    /// Longest run of equal positions, where the noise changes the code often; 0 where it does not,
    /// and where the axis drifted.
    pub(crate) run: u32,
}

impl Still {
    /// Whether so many samples of one code are a stuck sensor: its noise would have changed it,
    /// moving or not.
    pub(crate) fn is_stuck(&self, same: u32, step: f32) -> bool {
        self.run > 0
            && same > STUCK_RUN_RATIO.saturating_mul(self.run)
            && same as f32 * step > LEAST_RUN_TIME
    }
}

/// Means, slope and second differences over the rest.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Rest {
    count: f32,
    origin: f32,
    last: [f32; 2],
    sum: f32,
    weighted: f32,
    differences: f32,
    /// Present run of equal positions, and the longest.
    run: u32,
    longest: u32,
}

impl Rest {
    /// Takes a position; what was found, at the end. `time` is the sample time, `resolution` that
    /// of the sensor.
    pub(crate) fn update(&mut self, y: f32, time: f32, resolution: f32) -> Option<Still> {
        if self.count == 0.0 {
            self.origin = y;
        }
        let moved = y - self.origin;
        if self.count >= 2.0 {
            let second = moved - 2.0 * self.last[0] + self.last[1];
            self.differences += second * second;
        }
        if self.count > 0.0 && moved == self.last[0] {
            self.run += 1;
        } else {
            self.run = 1;
        }
        self.longest = self.longest.max(self.run);
        self.last = [moved, self.last[0]];
        self.sum += moved;
        self.weighted += self.count * moved;
        self.count += 1.0;
        let known = self.count * (NOISE_DEVIATION * NOISE_DEVIATION) >= 1.0;
        let over = known && self.count * time >= TIME;
        let away = !(-MOVEMENT..=MOVEMENT).contains(&moved);
        (over || away).then(|| self.found(time, resolution))
    }

    fn found(&self, time: f32, resolution: f32) -> Still {
        let n = self.count;
        let rounding = resolution * resolution * (1.0 / 12.0);
        let counted = if n > 3.0 { n - 2.0 } else { 1.0 };
        let noise = self.differences / (6.0 * counted);
        let variance = if noise > rounding { noise } else { rounding };
        let sigma = crate::math::sqrt(variance);
        // sum of (k - mean)^2 = n (n^2 - 1) / 12
        let spread = n * (n * n - 1.0) * (1.0 / 12.0);
        let slope = if spread > 0.0 {
            (self.weighted - 0.5 * (n - 1.0) * self.sum) / spread
        } else {
            0.0
        };
        let certain = slope * slope * spread > 25.0 * variance;
        let mut detection = DETECTION_MIN;
        for least in [DETECTION_DEVIATIONS * sigma, 3.0 * resolution] {
            if least > detection {
                detection = least;
            }
        }
        Still {
            sigma,
            place: self.origin + self.sum / n,
            drift: if certain { slope / time } else { 0.0 },
            since: 0.5 * (n - 1.0) * time,
            detection,
            // In motion every sample has another code, whatever the noise.
            run: if sigma > CODE_CHANGING_NOISE * resolution && !certain {
                self.longest
            } else {
                0
            },
        }
    }
}

#[cfg(test)]
pub(super) mod tests;
