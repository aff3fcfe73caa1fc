//! Another beginning of the recursion: behind a change of the drive, or of the filter.

use crate::estimation::mean_square::MeanSquare;
use crate::estimation::rls::Estimator;
use crate::estimation::two_words::TwoWords;

impl<const N: usize> Estimator<N> {
    /// Nothing counts any more but theta, each parameter known with one of these `variances`,
    /// relative to the noise of psi; what is known stays known. Samples and noise count anew.
    #[inline(never)]
    pub(crate) fn begin_again(&mut self, variances: &[f32; N]) {
        self.finish_observation();
        self.factors.begin_again(variances);
        self.residual = MeanSquare::new(self.forgetting);
        self.samples = 0.0;
    }

    /// Goes on from `theta` with `scale` times the covariance, and counts samples and noise anew.
    ///
    /// No D_j grows beyond the one in `limit`, or beyond itself where it is larger already.
    pub fn resume(&mut self, theta: [f32; N], scale: f32, limit: &[f32; N]) {
        self.finish_observation();
        self.theta = TwoWords::new(theta);
        self.factors.grow_within(scale, limit);
        self.residual = MeanSquare::new(self.forgetting);
        self.samples = 0.0;
    }

    /// P + v v' for each vector, as [`Factors::widen`](crate::estimation::factors::Factors::widen)
    /// has it.
    pub(crate) fn widen(&mut self, vectors: impl Iterator<Item = [f32; N]>, limit: &[f32; N]) {
        self.finish_observation();
        self.factors.widen(vectors, limit);
    }

    /// Takes the noise of psi for known, with the weight of one row: the first ones tell it anew.
    pub(crate) fn expect_noise(&mut self, variance: f32) {
        let samples = self.free() + 1.0;
        self.residual = MeanSquare::of(self.forgetting, variance, samples);
    }
}
