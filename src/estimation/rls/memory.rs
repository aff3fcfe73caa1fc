//! What the estimator does for its memory beside taking rows.

use crate::estimation::rls::Estimator;

impl<const N: usize> Estimator<N> {
    /// Whether lambda is applied before the rows from now on; the noise level always is that of the newest rows.
    #[inline(always)]
    pub(crate) const fn forget(&mut self, on: bool) {
        let forgetting = if on { self.forgetting } else { 1.0 };
        self.next = [forgetting, 1.0 / forgetting];
    }

    /// Square of the innovation of the newest row with what it was expected to be, relative to that of the noise; and the mean of
    /// those before it, negative as long as there are no more than parameters.
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

    /// Multiplies P by `growth`, after an observation of each parameter j at its own value that leaves at most `left_j` of P_jj; theta
    /// stays.
    pub(crate) fn loosen(&mut self, growth: f32, left: [f32; N]) {
        self.finish_observation();
        let share = 1.0 / growth;
        for (index, left) in left.into_iter().enumerate() {
            // Of its own value: only P learns of it.
            self.factors.observe(index, left * share);
        }
        self.factors.grow(growth);
        self.samples *= share;
    }
}
