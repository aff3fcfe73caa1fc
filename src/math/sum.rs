//! Sums: where they begin, and a running one in two words that does not stagnate.

/// A sum of no terms. `x + -0.0` is x for every x, and no instruction; `x + 0.0` is one, since it
/// makes 0 of -0.
pub(crate) const EMPTY: f32 = -0.0;

/// A sum `high + low` (Fast2Sum; Dekker 1971).
///
/// ```text
/// c = x + low,   s = high + c,   low <- c - (s - high),   high <- s
/// ```
///
/// With terms of one sign an addition errs by at most the rounding of `c`, 2^-24 of the term
/// itself, so that the sum of any number of terms is right to some units of the last digit until it
/// leaves f32; one word alone stops growing at 2^24 terms of one size. A sum beyond f32 is infinite
/// and stays so: its second word is NaN, and with the next term the first.
#[derive(Debug, Clone, Copy, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Sum {
    high: f32,
    low: f32,
}

/// Beyond f32 all sums are the same.
impl PartialEq for Sum {
    fn eq(&self, other: &Self) -> bool {
        let known = |x: f32| if x.is_nan() { f32::INFINITY } else { x };
        known(self.high) == known(other.high) && known(self.low) == known(other.low)
    }
}

impl Sum {
    /// Nothing added yet.
    pub(crate) const ZERO: Self = Self {
        high: 0.0,
        low: 0.0,
    };

    /// The sum.
    pub(crate) const fn value(self) -> f32 {
        if self.high.is_nan() {
            f32::INFINITY
        } else {
            self.high
        }
    }

    /// Adds a term.
    #[inline(always)]
    pub(crate) fn add(&mut self, term: f32) {
        let change = term + self.low;
        let sum = self.high + change;
        self.low = change - (sum - self.high);
        self.high = sum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_below_the_last_digit_add_up() {
        let mut sum = Sum::ZERO;
        sum.add(16_777_216.0);
        for _ in 0..1000 {
            sum.add(1.0);
        }
        assert_eq!(16_777_216.0 + 1.0, 16_777_216.0_f32);
        assert_eq!(sum.value(), 16_778_216.0);
    }

    #[test]
    fn beyond_f32_it_is_infinite_and_not_nan() {
        let mut sum = Sum::ZERO;
        for _ in 0..3 {
            sum.add(f32::MAX);
        }
        sum.add(1.0);
        assert_eq!(sum.value(), f32::INFINITY);
    }
}
