//! Input of the read-out: the recursion and its plan.

use crate::estimation::beginning::Beginning;
use crate::estimation::forgetting::StabilisedForgetting;
use crate::estimation::noise_level::NoiseLevel;
use crate::estimation::regressor::Regressor;
use crate::estimation::rls::Estimator;
use crate::estimation::start_error::StartError;
use crate::estimation::structure::Structure;
use crate::math::matrix::Matrix;
use crate::readout::former::Former;
use crate::trends::Design;

/// Share of a variance below which what a prior adds to it is left out.
const SHOWN: f32 = 1e-3;

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
    /// Part of a sample by which each input is late beside whole ones.
    pub(crate) delay_parts: &'a [f32; I],
    /// What counts of the drive before the newest change.
    pub(crate) former: Former,
    /// The newest y.
    pub(crate) position: f32,
    /// White noise of y by its third difference.
    pub(crate) noise: &'a NoiseLevel,
    /// The initial state of a structure that has none.
    pub(crate) beginning: &'a Beginning<N>,
    /// The error of y(0) of a structure with one.
    pub(crate) start_error: &'a StartError<M, N>,
}

impl<const M: usize, const N: usize, const I: usize> ReadOut<'_, M, N, I> {
    /// Variance of the innovation of psi, the prior one until there are more samples than
    /// parameters.
    pub(crate) fn residual(&self) -> f32 {
        self.estimator
            .noise_variance()
            .unwrap_or(self.prior_noise * self.prior_noise)
    }

    /// Adds the uncertainty of nominal values that no data support or that were set:
    /// [`StabilisedForgetting::lacking`].
    ///
    /// Without a memory what the data have shown is left out: no entry i would grow by more than a
    /// thousandth.
    pub(super) fn add_nominal_values(&self, p: &Matrix<N>, covariance: &mut Matrix<N>) {
        let (expected, residual) = (self.prior_noise * self.prior_noise, self.residual());
        let noise = residual / expected;
        let bound = self.forgetting.bound();
        for (k, own) in self.forgetting.own_variances().into_iter().enumerate() {
            let [whole, missing] = self.forgetting.lacking(own, p[k][k], noise);
            let shown = bound == 0.0 && p[k][k] * missing < SHOWN * whole * (whole * noise);
            if shown || !(missing > 0.0) {
                continue;
            }
            for i in 0..N {
                for j in 0..N {
                    covariance[i][j] +=
                        (p[i][k] / whole) * (p[j][k] / whole) * (missing * expected);
                }
            }
        }
    }

    /// P, normalised.
    pub(super) fn covariance(&self) -> Matrix<N> {
        self.estimator.covariances()
    }
}
