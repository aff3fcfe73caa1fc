//! Sets of powers of s, and the meaning of each entry of theta.

/// A set of powers of s: which a_i, or which b_i of one input, exist.
///
/// # Examples
/// ```
/// use trendid::estimation::Terms;
/// assert_eq!(Terms::up_to(2), Terms::of(&[0, 1]));
/// assert!(Terms::of(&[1, 2]).contains(1) && !Terms::of(&[1, 2]).contains(0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Terms(u8);

impl Terms {
    /// The empty set.
    pub const NONE: Self = Self(0);

    /// The listed powers, each 0..=7; every structure refuses a power of its order or above.
    pub const fn of(powers: &[usize]) -> Self {
        let mut bits = 0;
        let mut i = 0;
        while i < powers.len() {
            bits |= 1 << if powers[i] < 8 { powers[i] } else { 7 };
            i += 1;
        }
        Self(bits)
    }

    /// Powers 0 to `count - 1`.
    pub const fn up_to(count: usize) -> Self {
        Self::between(0, count)
    }

    /// Powers `first` to `end - 1`.
    pub const fn between(first: usize, end: usize) -> Self {
        let mut bits = 0;
        let mut i = first;
        while i < end && i < 8 {
            bits |= 1 << i;
            i += 1;
        }
        Self(bits)
    }

    /// Whether the power is in the set.
    pub const fn contains(self, power: usize) -> bool {
        power < 8 && self.0 & (1 << power) != 0
    }

    /// Number of powers in the set.
    pub const fn count(self) -> usize {
        self.0.count_ones() as usize
    }

    /// The largest power; `None` for the empty set.
    pub(crate) const fn highest(self) -> Option<usize> {
        match self.0 {
            0 => None,
            bits => Some(7 - bits.leading_zeros() as usize),
        }
    }
}

/// Meaning of one entry of theta.
#[doc(alias = "Column")]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Parameter {
    /// The coefficient a_power.
    Output {
        /// The power of s.
        power: usize,
    },
    /// The coefficient b_power of an input.
    Input {
        /// Which input.
        input: usize,
        /// The power of s.
        power: usize,
    },
    /// The contribution of a constant input 1.
    Constant,
    /// The initial state: minus the error of the position at which the trends began.
    #[doc(alias = "Start")]
    InitialState,
}

/// Where a parameter stands in theta.
pub(crate) fn index_of<const N: usize>(
    parameters: &[Parameter; N],
    wanted: Parameter,
) -> Option<usize> {
    parameters.iter().position(|found| *found == wanted)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_as_sets() {
        assert_eq!(Terms::between(1, 4), Terms::of(&[3, 1, 2]));
        assert_eq!(Terms::up_to(3).count(), 3);
        assert_eq!(Terms::NONE.count(), 0);
        assert_eq!(Terms::NONE.highest(), None);
        assert_eq!(Terms::of(&[0, 5]).highest(), Some(5));
        assert!(!Terms::up_to(3).contains(3) && !Terms::up_to(3).contains(99));
        // A power above the seventh is kept as the seventh, which every structure refuses.
        assert!(Terms::of(&[40]).contains(7) && Terms::of(&[8]).contains(7));
        assert_eq!(Terms::up_to(9), Terms::up_to(8));
    }
}
