//! Parameters in two words: a correction below half the last digit is carried over to the next one,
//! not lost.

use crate::estimation::mean_square::flush;

/// Second words below this change no digit of any result.
const NEGLIGIBLE: f32 = 1e-18;

/// A vector in two words each, `high + low` (Fast2Sum; Dekker 1971).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TwoWords<const N: usize> {
    high: [f32; N],
    /// Rounding error of each correction.
    low: [f32; N],
}

impl<const N: usize> TwoWords<N> {
    /// `high`, and nothing left over.
    pub(crate) const fn new(high: [f32; N]) -> Self {
        Self {
            high,
            low: [0.0; N],
        }
    }

    /// The first words.
    pub(crate) const fn high(&self) -> &[f32; N] {
        &self.high
    }

    /// Adds `gain` times `step`.
    #[inline(always)]
    pub(crate) fn add(&mut self, gain: &[f32; N], step: f32) {
        for j in 0..N {
            let change = gain[j] * step + self.low[j];
            let sum = self.high[j] + change;
            self.low[j] = change - (sum - self.high[j]);
            self.high[j] = sum;
        }
    }

    /// The second word `index`, without what is too small to matter.
    #[inline(always)]
    pub(crate) fn flush(&mut self, index: usize) {
        if let Some(low) = self.low.get_mut(index) {
            flush(low, NEGLIGIBLE);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corrections_below_the_last_digit_add_up() {
        let mut sum = TwoWords::new([1.0_f32]);
        for _ in 0..1000 {
            sum.add(&[1e-9], 1.0);
        }
        // One word would still be 1: each correction is below half its last digit.
        assert_eq!(1.0 + 1e-9, 1.0_f32);
        assert!((sum.high()[0] - 1.000_001).abs() < 1e-7);
    }

    #[test]
    fn second_words_end_at_zero_and_not_in_subnormal_numbers() {
        let mut number = TwoWords {
            high: [1.0; 3],
            low: [1e-19, -1e-19, 1e-17],
        };
        for index in [0, 1, 2, 3] {
            number.flush(index);
        }
        assert_eq!(number.low, [0.0, 0.0, 1e-17]);
    }
}
