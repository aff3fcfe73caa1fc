//! Random numbers of a seed, the same everywhere. Tests of other packages include this file.

#![allow(dead_code, reason = "each test draws what it needs")]

/// Numbers of a seed.
pub(crate) struct Uniform(pub(crate) u64);

impl Uniform {
    /// Seeds that are neighbours begin apart.
    pub(crate) fn of(seed: u64) -> Self {
        let mut uniform = Self(seed);
        for _ in 0..9 {
            uniform.next();
        }
        uniform
    }

    /// From 0 to 1.
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005);
        self.0 = self.0.wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// From -1 to 1.
    pub(crate) fn either_side(&mut self) -> f64 {
        2.0 * self.next() - 1.0
    }

    /// From `low` to `high`, evenly in the logarithm.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }

    /// Of mean 0 and deviation 1.
    pub(crate) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.next()).sum::<f64>() - 6.0
    }

    /// From 0 to one less than `count`.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.next() * count as f64) as usize
    }

    /// One of some.
    pub(crate) fn one<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }

    /// As often as not.
    pub(crate) fn yes(&mut self) -> bool {
        self.next() < 0.5
    }
}
