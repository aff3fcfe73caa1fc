//! An estimate whose covariance comes from the scores of blocks of time.

use crate::estimation::terms::{Parameter, index_of};
use crate::math::matrix::Matrix;
use crate::readout::compensation::compensate;
use crate::readout::estimate::Estimate;
use crate::readout::significance::Withdrawal;
use crate::readout::source::ReadOut;

/// Where less of the noise than this share could be taken out, the estimate is no smooth function
/// of the scores.
const MOSTLY: f32 = 0.5;

impl<const M: usize, const N: usize, const I: usize> ReadOut<'_, M, N, I> {
    /// The parameters as the trends have them, normalised, without the bias of white noise.
    pub(crate) fn normalised_theta(&self) -> [f32; N] {
        let units = self.regressor.units();
        let theta = self.trend_theta();
        core::array::from_fn(|j| theta[j] / units[j])
    }

    /// Which parameters were given as known.
    pub(crate) fn known(&self) -> [bool; N] {
        self.estimator.diagonal().map(|variance| variance == 0.0)
    }

    /// The estimate of [`estimate`](Self::estimate) under another covariance, `of` the parameters
    /// before the constant is withdrawn and of their change per score, all normalised; `None` where
    /// that gives none, or where the regressors are mostly noise.
    pub(crate) fn under(
        &self,
        of: impl FnOnce(&[f32; N], &Matrix<N>) -> Option<Matrix<N>>,
    ) -> Option<Estimate<M, N, I>> {
        let regression = self.regression();
        let (found, withdrawal) = self.compensated(&regression, true);
        let p = regression.p;
        if !(found.share() >= MOSTLY) {
            return None;
        }
        let units = self.regressor.units();
        let mut before = found.theta;
        if let Some(withdrawal) = &withdrawal {
            withdrawal.undo(&mut before);
        }
        let centre = core::array::from_fn(|j| before[j] / units[j]);
        let mut covariance = of(&centre, &found.gain(&p))?;
        self.add_nominal(&p, &mut covariance);
        if let Some(considered) = &found.considered {
            considered.add_to(&mut covariance, self.residual());
        }
        for i in 0..N {
            for j in 0..N {
                covariance[i][j] *= units[i] * units[j];
            }
        }
        found.add_left(&mut covariance);
        self.add_floor(&self.floor_of(&found.theta), &mut covariance, |i| {
            p[i][i] == 0.0
        });
        if let Some(withdrawal) = &withdrawal {
            withdrawal.apply_to_covariance(&mut covariance);
        }
        Some(self.in_s_plane(found.theta, covariance))
    }

    /// Adds the uncertainty of the prior and of nominal values, of which no score knows.
    ///
    /// The weight of the nominal value k in theta is P e_k over what it alone leaves of P_kk.
    fn add_nominal(&self, p: &Matrix<N>, covariance: &mut Matrix<N>) {
        let (expected, seen) = (self.prior_noise * self.prior_noise, self.residual());
        for (k, (whole, own)) in self.forgetting.nominal_variances().iter().enumerate() {
            if !(*whole > 0.0) {
                continue;
            }
            // A former estimate varies less than what it leaves.
            let variance = if *own > 0.0 {
                own * expected
            } else {
                whole * seen
            };
            for i in 0..N {
                for j in 0..N {
                    covariance[i][j] += (p[i][k] / whole) * (p[j][k] / whole) * variance;
                }
            }
        }
    }

    /// Variance by which the recursion judges its constant, normalised, 0 without one.
    pub(crate) fn constant_variance(&self) -> f32 {
        let regression = self.regression();
        let found = compensate(self, &regression, false);
        let p = regression.p;
        let variance =
            index_of(&self.structure.parameters(), Parameter::Constant).and_then(|index| {
                let own = *found.covariance_row(&p, index)?.get(index)?;
                Some(own * found.considered(&p, index))
            });
        variance.unwrap_or(0.0) * found.residual.significance
    }

    /// The estimate `theta` with its `covariance`, both normalised: an insignificant constant
    /// withdrawn, the floor of the arithmetic added.
    ///
    /// `direction` is the change of theta per change of the equation of the constant: along it
    /// theta is the solution without a constant. The constant counts as significant where it is so
    /// by its own variance and by that of the recursion, which few blocks do not make uncertain.
    pub(crate) fn with_covariance(
        &self,
        theta: &[f32; N],
        covariance: &Matrix<N>,
        direction: Option<[f32; N]>,
        of_recursion: f32,
    ) -> Estimate<M, N, I> {
        let units = self.regressor.units();
        let parameters = self.structure.parameters();
        let mut theta: [f32; N] = core::array::from_fn(|j| units[j] * theta[j]);
        let withdrawal = direction.and_then(|direction| {
            let index = index_of(&parameters, Parameter::Constant)?;
            let own = *covariance.get(index)?.get(index)?;
            let variance = if own > of_recursion {
                own
            } else {
                of_recursion
            };
            let length = *direction.get(index)?;
            let residual = variance / length;
            Withdrawal::of(
                &parameters,
                &theta,
                |of| match of == index {
                    true => Some(direction),
                    false => Some(covariance.get(of)?.map(|entry| entry / residual)),
                },
                units,
                residual,
                self.significance,
            )
        });
        if let Some(withdrawal) = &withdrawal {
            withdrawal.apply(&mut theta);
        }
        let mut in_units: Matrix<N> = core::array::from_fn(|i| {
            core::array::from_fn(|j| covariance[i][j] * units[i] * units[j])
        });
        self.add_floor(&self.floor_of(&theta), &mut in_units, |i| {
            covariance[i][i] == 0.0
        });
        if let Some(withdrawal) = &withdrawal {
            withdrawal.apply_to_covariance(&mut in_units);
        }
        let known = self.known();
        self.unless_unseen(self.in_s_plane(theta, in_units), |i| known[i])
    }
}
