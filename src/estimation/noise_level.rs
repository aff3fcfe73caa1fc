//! The level of the white noise on y, from its third difference.

use crate::estimation::mean_square::MeanSquare;

/// Samples before the level is given.
const LEAST: f32 = 10.0;

/// Variance of white measurement noise, blind to the movement of the drive.
///
/// The third difference `y(k) - 3 y(k-1) + 3 y(k-2) - y(k-3)` of a movement below
/// some tens of rad/s vanishes at 1 kHz; that of white noise has
/// `1 + 9 + 9 + 1 = 20` times the variance of one sample.
///
/// # Examples
/// ```
/// let mut level = trendid::estimation::NoiseLevel::new(1.0);
/// for k in 0..1000 {
///     let (ramp, noise) = (0.5 * k as f32, if k % 7 < 3 { 0.1 } else { -0.1 });
///     level.update(ramp + noise);
/// }
/// assert!(level.variance().unwrap() > 0.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseLevel {
    past: [f32; 3],
    forgetting: f32,
    level: MeanSquare,
}

impl NoiseLevel {
    /// A level that forgets like the estimator, `forgetting` = lambda in (0, 1].
    pub const fn new(forgetting: f32) -> Self {
        Self {
            past: [0.0; 3],
            forgetting,
            level: MeanSquare::new(forgetting),
        }
    }

    /// Takes y(k), in any unit. Cost: 20 instructions.
    #[inline(always)]
    pub fn update(&mut self, y: f32) {
        self.take(y, self.third_difference(y));
    }

    /// Takes y(k) whose third difference is `third`.
    #[inline(always)]
    pub(crate) fn take(&mut self, y: f32, third: f32) {
        self.pass(y);
        self.level.update(third * third);
    }

    /// The third difference that y(k) makes with the samples before it.
    #[inline(always)]
    pub fn third_difference(&self, y: f32) -> f32 {
        let [y1, y2, y3] = self.past;
        (y - y3) - 3.0 * (y1 - y2)
    }

    /// Takes a replacement of y(k), which carries no information on the noise.
    #[inline(always)]
    pub fn pass(&mut self, y: f32) {
        let [y1, y2, _] = self.past;
        self.past = [y, y1, y2];
    }

    /// Puts `y` in the place of the newest sample.
    pub const fn correct_newest(&mut self, y: f32) {
        self.past[0] = y;
    }

    /// A sum that is about to become subnormal is zero.
    #[inline(always)]
    pub(crate) fn flush(&mut self) {
        self.level.flush();
    }

    /// As if y had stood at this value before the first sample.
    pub const fn settle(&mut self, y: f32) {
        self.past = [y; 3];
    }

    /// Variance of the noise in the unit of y squared; `None` for fewer than ten samples.
    pub fn variance(&self) -> Option<f32> {
        let n = self.level.samples();
        (n >= LEAST).then(|| self.level.squares() / (20.0 * n))
    }

    /// The variance; -1, which is below everything, for fewer than ten samples.
    #[inline(always)]
    pub(crate) fn known(&self) -> f32 {
        let n = self.level.samples();
        if n >= LEAST {
            self.level.squares() * (1.0 / 20.0) / n
        } else {
            -1.0
        }
    }

    /// Forgets the signal and the level.
    pub const fn reset(&mut self) {
        *self = Self::new(self.forgetting);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_has_no_noise_but_for_its_corner() {
        let mut level = NoiseLevel::new(1.0);
        level.settle(5.0);
        for k in 0..100 {
            level.update(5.0 + (k * k) as f32);
        }
        // Leaving the rest makes two third differences of 1; the other 98 are zero.
        assert!((level.variance().unwrap() - 2.0 / (20.0 * 100.0)).abs() < 1e-9);
    }

    #[test]
    fn where_a_settled_signal_stands_does_not_matter() {
        let mut level = NoiseLevel::new(1.0);
        level.settle(1e4);
        for _ in 0..50 {
            level.update(1e4);
        }
        assert_eq!(level.variance(), Some(0.0));
    }

    #[test]
    fn nothing_is_said_of_few_samples() {
        let mut level = NoiseLevel::new(1.0);
        for _ in 0..9 {
            level.update(0.0);
            assert_eq!(level.variance(), None);
        }
        level.update(0.0);
        assert_eq!(level.variance(), Some(0.0));
        level.reset();
        assert_eq!(level, NoiseLevel::new(1.0));
    }

    #[test]
    fn what_is_known_is_the_variance_or_below_everything() {
        let mut level = NoiseLevel::new(0.9);
        for k in 0..40 {
            assert_eq!(level.known() < 0.0, level.variance().is_none(), "{k}");
            if let Some(variance) = level.variance() {
                assert!((level.known() - variance).abs() <= 1e-6 * variance);
            }
            level.update(if k % 3 == 0 { 1.0 } else { -1.0 });
        }
    }

    #[test]
    fn the_newest_sample_can_be_another_one() {
        let (mut level, mut other) = (NoiseLevel::new(1.0), NoiseLevel::new(1.0));
        for y in [1.0, 4.0, 9.0] {
            level.pass(y);
            other.pass(y);
        }
        level.correct_newest(16.0);
        assert_ne!(level.third_difference(25.0), other.third_difference(25.0));
        // 25 - 4 - 3 (16 - 4) + ..: y(k-1) alone is another one.
        assert_eq!(
            level.third_difference(25.0),
            (25.0 - 1.0) - 3.0 * (16.0 - 4.0)
        );
        level.level.update(1e-33);
        level.flush();
        assert_eq!(level.level.squares(), 0.0);
    }

    #[test]
    fn alternating_signs_are_amplified_as_the_kernel_says() {
        // +-1: the third difference is +-8, so the level reads 64/20 once the start is forgotten.
        let mut level = NoiseLevel::new(0.95);
        for k in 0..1000 {
            level.update(if k % 2 == 0 { 1.0 } else { -1.0 });
        }
        assert!((level.variance().unwrap() - 3.2).abs() < 1e-4);
    }
}
