//! What the estimator does for its memory beside taking rows.

use crate::estimation::factors::Factors;
use crate::estimation::inflation::Inflation;
use crate::estimation::rls::Estimator;
use crate::estimation::two_words::TwoWords;

impl<const N: usize> Estimator<N> {
    /// Other values, as well known as those before.
    pub(crate) const fn set_theta(&mut self, theta: [f32; N]) {
        self.theta = TwoWords::new(theta);
    }

    /// Whether lambda is applied before the rows from now on; the noise level always is that of the
    /// newest rows.
    #[inline(always)]
    pub(crate) const fn forget(&mut self, on: bool) {
        let forgetting = if on { self.forgetting } else { 1.0 };
        self.next = [forgetting, 1.0 / forgetting];
    }

    /// Square of the innovation of the newest row with what it was expected to be, relative to that
    /// of the noise; and the mean of those before it, negative as long as there are no more than
    /// parameters.
    pub(crate) fn surprise(&self, innovation: f32, spread: f32) -> [f32; 2] {
        let [forgetting, _] = self.next;
        let square = innovation * innovation / (forgetting + spread);
        let freedom = self.residual.samples() - 1.0 - N as f32;
        let before = self.residual.squares() - forgetting * square;
        [
            square,
            if freedom > 0.0 {
                before / freedom
            } else {
                -1.0
            },
        ]
    }

    /// Lets one sample time pass without a row: forgets, and leaves theta and the noise level.
    #[inline(always)]
    pub fn pass(&mut self) {
        self.finish_observation();
        self.factors.grow(1.0 / self.forgetting);
        self.samples *= self.forgetting;
    }

    /// P is to be multiplied by `growth`, after an observation of each parameter j at its own value
    /// that leaves at most `left_j` of P_jj; theta stays. [`inflate`](Self::inflate) does it in N
    /// parts, and no row comes between.
    ///
    /// Who reads P before the last part finds it as it will be.
    pub(crate) fn begin_inflation(&mut self, growth: f32, left: [f32; N]) {
        self.finish_observation();
        self.inflation = Inflation::new(growth, left);
        self.samples /= growth;
    }

    /// Whether parts are missing.
    #[inline(always)]
    pub(crate) const fn is_inflating(&self) -> bool {
        !self.inflation.is_done()
    }

    /// The next part.
    #[inline(never)]
    pub(crate) fn inflate(&mut self) {
        self.inflation.part(&mut self.factors);
    }

    /// P_ii as it is stored, whatever parts are missing.
    #[cfg(test)]
    pub(crate) fn stored_covariance(&self, index: usize) -> f32 {
        self.factors.covariance(index, index)
    }

    /// What the factors say once no part is missing.
    #[inline(always)]
    pub(super) fn read<R>(&self, of: impl FnOnce(&Factors<N>) -> R) -> R {
        match self.is_inflating() {
            true => of(&self.inflated()),
            false => of(&self.factors),
        }
    }

    /// The factors behind the last part.
    #[inline(never)]
    fn inflated(&self) -> Factors<N> {
        let (mut inflation, mut factors) = (self.inflation, self.factors);
        while !inflation.is_done() {
            inflation.part(&mut factors);
        }
        factors
    }
}
