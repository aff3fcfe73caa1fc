//! Covariance inflation: P is multiplied within bounds, one parameter at a time.

use crate::estimation::factors::Factors;

/// What is still to be done where P is inflated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Inflation<const N: usize> {
    /// What P is multiplied by in the end; 1 behind it.
    pub(crate) growth: f32,
    /// What that leaves of each P_jj at most.
    left: [f32; N],
    /// The parameter to be observed next; N for none.
    next: usize,
}

impl<const N: usize> Inflation<N> {
    /// Nothing.
    pub(crate) const NONE: Self = Self {
        growth: 1.0,
        left: [0.0; N],
        next: N,
    };

    /// P is to be multiplied by `growth`, which leaves at most `left`.
    pub(crate) const fn new(growth: f32, left: [f32; N]) -> Self {
        let next = 0;
        Self { growth, left, next }
    }

    /// Whether no part is missing.
    #[inline(always)]
    pub(crate) const fn is_done(&self) -> bool {
        self.next >= N
    }

    /// One observation of a parameter at its own value, so that only P learns of it.
    #[inline(always)]
    pub(crate) fn part(&mut self, factors: &mut Factors<N>) {
        if let Some(left) = self.left.get(self.next) {
            factors.observe(self.next, left / self.growth);
            self.next += 1;
            if self.next == N {
                factors.grow(self.growth);
                self.growth = 1.0;
            }
        }
    }
}
