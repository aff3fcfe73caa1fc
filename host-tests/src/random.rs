//! Random numbers of a seed.

use std::convert::Infallible;

use chacha20::ChaCha8Rng;
use rand::{RngExt, SeedableRng, TryRng};

/// ChaCha with 8 rounds: its stream is the same on every machine, and a copy goes on where the
/// original stood.
#[derive(Debug)]
pub struct Random(ChaCha8Rng);

impl Random {
    /// The stream of this number of a seed.
    pub fn numbered(seed: u64, stream: u64) -> Self {
        let mut random = Self::seed_from_u64(seed);
        random.0.set_stream(stream);
        random
    }
}

/// A number from `low` to `high`, its logarithm as likely everywhere.
pub fn log_uniform(random: &mut Random, low: f64, high: f64) -> f64 {
    let part: f64 = random.random();
    low * (high / low).powf(part)
}

impl Clone for Random {
    fn clone(&self) -> Self {
        Self(ChaCha8Rng::deserialize_state(&self.0.serialize_state()))
    }
}

impl SeedableRng for Random {
    type Seed = [u8; 32];

    fn from_seed(seed: Self::Seed) -> Self {
        Self(ChaCha8Rng::from_seed(seed))
    }
}

impl TryRng for Random {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        self.0.try_next_u32()
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        self.0.try_next_u64()
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        self.0.try_fill_bytes(bytes)
    }
}

#[cfg(test)]
mod tests {
    use rand::Rng;

    use super::*;

    /// Every figure of every document follows from these: a version of the library that changes
    /// them changes all.
    #[test]
    fn the_streams_are_those_of_the_figures() {
        let mut random = Random::seed_from_u64(1);
        let found: [u32; 4] = std::array::from_fn(|_| random.next_u32());
        assert_eq!(
            found,
            [2_359_561_649, 1_728_662_762, 4_228_812_395, 345_245_400]
        );
        let mut random = Random::numbered(1, 3);
        let found: [u64; 2] = std::array::from_fn(|_| random.next_u64());
        assert_eq!(
            found,
            [10_481_881_765_394_875_549, 12_435_132_161_185_724_354]
        );
    }

    #[test]
    fn a_copy_goes_on_where_the_original_stood() {
        let mut random = Random::seed_from_u64(200_001);
        for words in 0..300 {
            let mut copy = random.clone();
            let mut ahead = [random.clone(), copy.clone()];
            let [first, second] = &mut ahead;
            for _ in 0..40 {
                assert_eq!(first.next_u64(), second.next_u64(), "after {words}");
            }
            assert_eq!(copy.next_u32(), random.next_u32(), "after {words}");
        }
    }
}
