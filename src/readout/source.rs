//! Input of the read-out: the recursion and its plan.

use crate::estimation::forgetting::StabilisedForgetting;
use crate::estimation::noise_level::NoiseLevel;
use crate::estimation::regressor::Regressor;
use crate::estimation::rls::Estimator;
use crate::estimation::structure::Structure;
use crate::math::matrix::Matrix;
use crate::trends::Design;

/// The recursion and its plan, borrowed for one reading.
pub(crate) struct ReadOut<'a, const M: usize, const N: usize, const I: usize> {
    pub(crate) structure: &'a Structure<M, N, I>,
    pub(crate) design: &'a Design<M>,
    pub(crate) regressor: &'a Regressor<M, N>,
    /// Rough bandwidth in rad/s.
    pub(crate) bandwidth: f32,
    /// Standard deviation of psi before there is a residual.
    pub(crate) prior_noise: f32,
    /// Standard deviations below which a constant is withdrawn.
    pub(crate) significance: f32,
    pub(crate) estimator: &'a Estimator<N>,
    pub(crate) forgetting: &'a StabilisedForgetting<N>,
    /// Whether an input is the sign of the velocity: it turns within samples.
    pub(crate) turns: bool,
    /// The newest y.
    pub(crate) position: f32,
    /// White noise of y by its third difference.
    pub(crate) noise: &'a NoiseLevel,
}

impl<const M: usize, const N: usize, const I: usize> ReadOut<'_, M, N, I> {
    /// Variance of the innovation of psi, the prior one until there are more samples than parameters.
    pub(super) fn residual(&self) -> f32 {
        self.estimator
            .noise_variance()
            .unwrap_or(self.prior_noise * self.prior_noise)
    }

    /// Adds the uncertainty of nominal values without support in the data.
    ///
    /// P counts a prior of standard deviation s sigma_0 as s times the noise; where the noise found is smaller than the
    /// expected sigma_0, so is what P makes of the prior. The weight of the nominal value k in theta is P e_k over what
    /// the observations of it alone leave of P_kk.
    pub(super) fn add_unsupported(&self, p: &Matrix<N>, covariance: &mut Matrix<N>) {
        let Some(variances) = self.forgetting.unsupported() else {
            return;
        };
        let bound = self.forgetting.bound();
        let missing = self.prior_noise * self.prior_noise - self.residual();
        if !(missing > 0.0) {
            return;
        }
        for (k, variance) in variances.iter().enumerate() {
            if !(*variance > 0.0) {
                continue;
            }
            let whole = if *variance > bound { *variance } else { bound };
            let variance = missing * variance;
            for i in 0..N {
                for j in 0..N {
                    covariance[i][j] += (p[i][k] / whole) * (p[j][k] / whole) * variance;
                }
            }
        }
    }

    /// Share of the [`DISCRETE`](super::DISCRETE) errors of two parameters that is common to both.
    ///
    /// Every parameter has a tenth of its own. Where friction turns with the velocity nothing is common: when within the
    /// sample it turned is known to about `omega Delta/4`, in a share `omega Delta/pi` of the samples, an error of the same
    /// order that moves the gain, the damping and the friction each in its own way.
    pub(super) const fn common(&self, same: bool) -> f32 {
        match (same, self.turns) {
            (true, _) => 1.01,
            (false, false) => 1.0,
            (false, true) => 0.0,
        }
    }

    /// P, normalised.
    pub(super) fn covariance(&self) -> Matrix<N> {
        self.estimator.covariances()
    }
}
