//! Mean squares whose sums neither stagnate nor end in subnormal numbers.

/// At this weight both sums are halved: a longer past would round the newest sample away.
///
/// With 2^18 samples in the sum the newest one still has six bits of its own, whatever its size
/// relative to the mean.
const HORIZON: f32 = 262_144.0;

/// Squares of quantities that are normalised, or of lengths in any sensible unit, are zero below
/// this.
const NEGLIGIBLE: f32 = 1e-30;

/// Weighted sum of squares and the weight of the samples in it.
///
/// ```text
/// S <- lambda S + x,   n <- lambda n + 1;   beyond n = 2^18:  S <- S / 2,  n <- n / 2
/// ```
///
/// The halving is exact: the mean is the same before and after. Without forgetting it
/// makes the mean one over the newest 2^17 to 2^18 samples, for any number of samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MeanSquare {
    forgetting: f32,
    squares: f32,
    samples: f32,
}

impl MeanSquare {
    /// Nothing seen yet; `forgetting` is lambda in (0, 1].
    pub(crate) const fn new(forgetting: f32) -> Self {
        Self::of(forgetting, 0.0, 0.0)
    }

    /// So many `samples` whose squares are `squares` in all.
    pub(crate) const fn of(forgetting: f32, squares: f32, samples: f32) -> Self {
        Self {
            forgetting,
            squares,
            samples,
        }
    }

    /// Takes one square.
    #[inline(always)]
    pub(crate) fn update(&mut self, square: f32) {
        self.squares = self.forgetting * self.squares + square;
        self.samples = self.forgetting * self.samples + 1.0;
        if self.samples > HORIZON {
            self.squares *= 0.5;
            self.samples *= 0.5;
        }
    }

    /// Whether the mean is below `limit`; without a division.
    #[inline(always)]
    pub(crate) fn exceeded_by(&self, limit: f32) -> bool {
        self.squares < limit * self.samples
    }

    /// S.
    pub(crate) const fn squares(&self) -> f32 {
        self.squares
    }

    /// n, at most 2^18.
    pub(crate) const fn samples(&self) -> f32 {
        self.samples
    }

    /// A sum that is about to become subnormal is zero.
    #[inline(always)]
    pub(crate) fn flush(&mut self) {
        flush(&mut self.squares, NEGLIGIBLE);
    }
}

/// Sets `value` to zero where its magnitude is below `least`.
#[inline(always)]
pub(crate) fn flush(value: &mut f32, least: f32) {
    // Without their sign bits numbers are in the order of their bits; cheaper than a comparison of
    // floats.
    if value.to_bits() << 1 < least.to_bits() << 1 {
        *value = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_beyond_the_horizon_follows_as_before() {
        // 1e6 equal squares of a size that f32 cannot add exactly, then as many of another.
        let mut mean = MeanSquare::new(1.0);
        for _ in 0..1_000_000 {
            mean.update(0.1);
        }
        assert!((mean.squares() / mean.samples() / 0.1 - 1.0).abs() < 0.01);
        for _ in 0..2_000_000 {
            mean.update(0.3);
        }
        assert!((mean.squares() / mean.samples() / 0.3 - 1.0).abs() < 0.01);
        assert!(mean.samples() <= HORIZON && mean.samples() >= HORIZON / 2.0);
    }

    #[test]
    fn halving_keeps_the_mean() {
        let mut mean = MeanSquare {
            forgetting: 1.0,
            squares: 3.0 * HORIZON,
            samples: HORIZON,
        };
        mean.update(3.0);
        assert_eq!(mean.squares() / mean.samples(), 3.0);
        assert!(mean.samples() < 0.51 * HORIZON);
    }

    #[test]
    fn sums_end_at_zero_and_not_in_subnormal_numbers() {
        let mut mean = MeanSquare::new(0.5);
        mean.update(1.0);
        for k in 0..300 {
            mean.flush();
            assert!(mean.squares == 0.0 || mean.squares >= NEGLIGIBLE, "{k}");
            mean.update(0.0);
        }
        assert_eq!(mean.squares(), 0.0);
        assert!((mean.samples() - 2.0).abs() < 1e-6);
    }

    #[test]
    fn a_limit_is_exceeded_by_a_mean_below_it() {
        let mut mean = MeanSquare::new(1.0);
        for square in [1.0, 3.0] {
            mean.update(square);
        }
        assert!(mean.exceeded_by(2.01) && !mean.exceeded_by(2.0));
    }
}
