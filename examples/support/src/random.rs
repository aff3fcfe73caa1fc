//! Numbers that look random and are the same on every machine: one stream for each seed.

/// A linear congruential generator, modulo 2^32; its high bits are the good ones.
///
/// Source: the multiplier and increment of Knuth and Lewis (Numerical Recipes, section 7.1).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Random(u32);

impl Random {
    /// The stream of a seed.
    #[must_use]
    pub const fn new(seed: u32) -> Self {
        Self(seed)
    }

    /// The next 32 bits.
    pub const fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        self.0
    }

    /// The next number from 0 to below 1.
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / 16_777_216.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_gives_its_stream() {
        let mut random = Random::new(1);
        // 1664525 + 1013904223, and that once more modulo 2^32.
        assert_eq!(
            [random.bits(), random.bits()],
            [1_015_568_748, 1_586_005_467]
        );
    }

    #[test]
    fn units_fill_their_range_evenly() {
        let (mut random, mut tenths) = (Random::new(7), [0_u32; 10]);
        for _ in 0..100_000 {
            let x = random.unit();
            assert!((0.0..1.0).contains(&x));
            tenths[(10.0 * x) as usize] += 1;
        }
        assert!(
            tenths.iter().all(|n| n.abs_diff(10_000) < 400),
            "{tenths:?}"
        );
    }
}
