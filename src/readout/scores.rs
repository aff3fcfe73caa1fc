//! An estimate whose covariance comes from the scores of blocks of time.

use crate::estimation::terms::Parameter;
use crate::math::matrix::Matrix;
use crate::readout::estimate::Estimate;
use crate::readout::residual_spectrum::natural_frequency;
use crate::readout::s_plane::estimate_in_s_plane;
use crate::readout::significance::Withdrawal;
use crate::readout::source::ReadOut;

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

    /// The estimate `theta` with its `covariance`, both normalised: an insignificant constant withdrawn, the floor of the
    /// arithmetic added.
    pub(crate) fn with_covariance(
        &self,
        theta: &[f32; N],
        covariance: &Matrix<N>,
    ) -> Estimate<M, N, I> {
        let units = self.regressor.units();
        let parameters = self.structure.parameters();
        let mut theta: [f32; N] = core::array::from_fn(|j| units[j] * theta[j]);
        let withdrawal = Withdrawal::of(
            &parameters,
            &theta,
            |index| covariance.get(index).copied(),
            units,
            1.0,
            self.significance,
        );
        if let Some(withdrawal) = &withdrawal {
            withdrawal.apply(&mut theta);
        }
        let denominator = self.structure.denominator(&theta);
        let natural = natural_frequency(&denominator, self.bandwidth);
        let floor = self.floor(natural, &denominator);
        let known = |i: usize| covariance[i][i] == 0.0;
        let coefficient =
            |i: usize| !matches!(parameters[i], Parameter::Constant | Parameter::InitialState);
        let mut covariance: Matrix<N> = core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                let mut value = covariance[i][j] * units[i] * units[j];
                if coefficient(i) && coefficient(j) && !known(i) && !known(j) {
                    value += self.common(i == j) * (floor * theta[i]) * (floor * theta[j]);
                }
                value
            })
        });
        if let Some(withdrawal) = &withdrawal {
            withdrawal.apply_to_covariance(&mut covariance);
        }
        let found = Estimate {
            structure: *self.structure,
            theta,
            covariance,
        };
        estimate_in_s_plane(found, self.design)
    }
}
