//! From the recursion to the user's numbers: noise bias removed, uncertainty added.
//!
//! Least squares with noisy regressors is biased. White noise of variance s on y puts
//! `s M` into every phi phi' and `s m` into every phi psi, where M and m are constants
//! of the filter. With P = (sum phi phi')^-1 over n samples
//!
//! ```text
//! Q       = (P^-1 - w M)^-1                    w = n s, a little less, and limited                 compensation
//! theta_c = Q (P^-1 theta - w m)
//! P_c     = Q P^-1 Q
//! Sigma   = s T P_c T' + floor                                          residual_spectrum, sandwich, floor
//! ```
//!
//! takes the bias out, at the read-out only: nothing is added to the 1 ms path but the level s. The
//! residual of the filtered equation is not white: it is `A/A_f` times the noise.
//! T weighs it by the frequencies at which a parameter is seen. The floor covers the error of
//! trends in place of derivatives and the rounding of f32; beside it stand the bias that a limited
//! w leaves, and the one that drift of y may make.
//! Behind a change that was followed what is left of the old drive is added (`former`).
//! Then an insignificant constant is withdrawn (`significance`), and parameters of the plane of the
//! trends become those of the s plane (`s_plane`).
//!
//! Known as: bias-compensated least squares with sandwich covariance and a pre-test; sources in the
//! files.

pub(crate) mod beginning;
mod compensation;
pub(crate) mod estimate;
mod floor;
mod former;
mod handing_over;
mod input_error;
mod residual_spectrum;
pub(crate) mod s_plane;
mod sandwich;
mod scores;
mod significance;
mod source;

use beginning::Regression;
pub use estimate::Estimate;
pub(crate) use former::Former;
pub(crate) use residual_spectrum::in_band;
pub(crate) use source::ReadOut;

use crate::estimation::terms::{Parameter, index_of};
use crate::math::matrix::Matrix;
use crate::readout::compensation::{Compensated, compensate, dependent};
use crate::readout::residual_spectrum::{ResidualSpectrum, natural_frequency};
use crate::readout::s_plane::{estimate_in_s_plane, theta_in_s_plane};
use crate::readout::sandwich::{sandwich, transform};
use crate::readout::significance::Withdrawal;

/// Rounding to f32, relative to what is rounded: a quarter of the distance between two numbers, the
/// mean of what one costs.
///
/// A row of size 1 has this error over `omega_n Delta`, by the samples over which the trends add it
/// up. The same in every row while the motion is steady, it does not average out: errors of at most
/// rho in n rows move theta by `P sum phi rho_k`, whose entries are at most `rho sqrt(n P_ii)`,
/// whatever their order and sign.
const ROUNDING: f32 = 0.25 * f32::EPSILON;

impl<const M: usize, const N: usize, const I: usize> ReadOut<'_, M, N, I> {
    /// The estimate without its noise bias, an insignificant constant withdrawn from theta.
    #[inline(always)]
    fn compensated(
        &self,
        regression: &Regression<N>,
        deviations: bool,
    ) -> (Compensated<M, N>, Option<Withdrawal<N>>) {
        let p = &regression.p;
        let mut found = compensate(self, regression, deviations);
        // Before there are rows that tell the noise every constant counts: after a change of the
        // filter nothing jumps.
        let told = self.estimator.noise_variance();
        let told = told.filter(|_| self.estimator.samples() > self.estimator.free());
        let withdrawal = told.and_then(|_| {
            let parameters = self.structure.parameters();
            let constant = index_of(&parameters, Parameter::Constant)?;
            Withdrawal::of(
                &parameters,
                &found.theta,
                |index| found.covariance_row(p, index),
                self.regressor.units(),
                found.residual.significance * found.considered(p, constant),
                self.significance,
            )
        });
        if let Some(withdrawal) = &withdrawal {
            withdrawal.apply(&mut found.theta);
        }
        (found, withdrawal)
    }

    /// The parameters as the trends have them, in the user's units.
    ///
    /// Not inlined: whoever reads them, in whatever language, calls the same code.
    #[inline(never)]
    pub(crate) fn trend_theta(&self) -> [f32; N] {
        self.compensated(&self.regression(), false).0.theta
    }

    /// The parameters of the s plane, in the user's units.
    pub(crate) fn theta(&self) -> [f32; N] {
        let known = self.known();
        theta_in_s_plane(&self.trend_theta(), self.structure, self.design, &known)
    }

    /// Parameters and covariance in the user's units.
    pub(crate) fn estimate(&self) -> Estimate<M, N, I> {
        let regression = self.regression();
        let (found, withdrawal) = self.compensated(&regression, true);
        let p = regression.p;
        let (mut covariance, floor) = self.shaped(&p, &found);
        self.add_nominal_values(&p, &mut covariance);
        if let Some(considered) = &found.considered {
            considered.add_to(&mut covariance, self.residual());
        }
        let units = self.regressor.units();
        let parameters = self.structure.parameters();
        let known = |i: usize| p[i][i] == 0.0;
        let coefficient =
            |i: usize| !matches!(parameters[i], Parameter::Constant | Parameter::InitialState);
        let angle = self.bandwidth * self.design.sample_time;
        let coefficients = core::array::from_fn(|i| coefficient(i) && !known(i));
        let left = || self.forgetting.left();
        (self.former).add(coefficients, left, angle, &p, &mut covariance);
        for i in 0..N {
            for j in 0..N {
                covariance[i][j] *= units[i] * units[j];
            }
        }
        self.add_floor(&self.of_each(floor, &found.theta), &mut covariance, known);
        found.add_left(&mut covariance);
        if let Some(withdrawal) = &withdrawal {
            withdrawal.apply_to_covariance(&mut covariance);
        }
        let theta = found.theta;
        self.unless_unseen(self.in_s_plane(theta, covariance), known)
    }

    /// The estimate, unless nothing was seen: no residual and no parameter to err by is not to be
    /// certain. Nor was anything of what a drive has just become.
    fn unless_unseen(
        &self,
        mut found: Estimate<M, N, I>,
        known: impl Fn(usize) -> bool,
    ) -> Estimate<M, N, I> {
        for i in 0..N {
            if (self.former.alone || found.covariance[i][i] == 0.0) && !known(i) {
                found.covariance[i][i] = f32::INFINITY;
            }
        }
        found
    }

    /// P_c under the noise where each parameter is seen, normalised; the floor relative to a
    /// parameter.
    fn shaped(&self, p: &Matrix<N>, found: &Compensated<M, N>) -> (Matrix<N>, f32) {
        let mut covariance = found.covariance(p);
        let even = found.residual.even;
        let parameters = self.structure.parameters();
        let sample_time = self.design.sample_time;
        let denominator = self.structure.denominator(&found.theta);
        let natural = natural_frequency(&denominator, self.bandwidth);
        let floor = self.floor(natural, &denominator, &found.theta);
        let Some(filter) = self.design.filter else {
            for entry in covariance.as_flattened_mut() {
                *entry *= even;
            }
            return (covariance, floor);
        };
        let spectrum = ResidualSpectrum {
            parameters,
            units: self.regressor.units(),
            theta: &found.theta,
            denominator,
            filter,
            natural,
            duration: self.estimator.samples().max(1.0) * sample_time,
            slowest: -self.design.slow_pole(),
        };
        let angle = natural * sample_time;
        let (r, s) = spectrum.sums();
        let in_band = match transform(r, s, core::array::from_fn(|j| p[j][j] > 0.0)) {
            Some(t) => sandwich(&t, &covariance, &parameters),
            None => covariance,
        };
        let shaped = found.residual.shaped;
        let rounding = ROUNDING / angle;
        let even = even
            + self.estimator.samples().max(1.0) * rounding * rounding
            + self.resolution(shaped) * dependent(angle);
        for i in 0..N {
            for j in 0..N {
                covariance[i][j] = shaped * in_band[i][j] + even * covariance[i][j];
            }
        }
        (covariance, floor)
    }

    /// Variance of psi by the rounding of y to f32, as far as the noise does not hide it; `white`
    /// is that of the noise.
    ///
    /// Where the drive has gone so far that the last digit of its position is larger than the
    /// noise, the rounding goes through all its values as slowly as the position passes them: it is
    /// no white noise: its samples are [`dependent`].
    fn resolution(&self, white: f32) -> f32 {
        let step = self.regressor.top_scale() * ROUNDING * self.position;
        let square = step * step;
        match white > square {
            true => square * (square / white),
            false => square,
        }
    }

    /// The recursion as it stands in the user's units, its covariance that of a white residual.
    pub(crate) fn recursion(&self) -> Estimate<M, N, I> {
        let (theta, covariance) = self.recursion_of_trends();
        self.in_s_plane(theta, covariance)
    }

    /// The same in the plane of the trends.
    pub(crate) fn recursion_of_trends(&self) -> ([f32; N], Matrix<N>) {
        let units = self.regressor.units();
        let bare = self.estimator.theta();
        let noise = self.residual();
        let mut covariance = self.covariance();
        for i in 0..N {
            for j in 0..N {
                covariance[i][j] = noise * covariance[i][j] * units[i] * units[j];
            }
        }
        (core::array::from_fn(|j| units[j] * bare[j]), covariance)
    }

    fn in_s_plane(&self, theta: [f32; N], covariance: Matrix<N>) -> Estimate<M, N, I> {
        let found = Estimate {
            structure: *self.structure,
            theta,
            covariance,
        };
        estimate_in_s_plane(found, self.design, &self.known())
    }
}

#[cfg(test)]
mod tests;
