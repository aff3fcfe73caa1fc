//! Whether the samples separate the parameters of an estimate.

use nalgebra::DMatrix;

use crate::error::{Error, Weakness};
use crate::estimate::Estimate;
use crate::problem::Problem;

/// Smallest eigenvalue of the correlation of the parameters that f32 distinguishes from zero.
const SINGULAR: f64 = 1e-6;

/// Share of a parameter in a singular direction from which it is named.
const INVOLVED: f64 = 0.1;

/// The correlation that belongs to a covariance.
fn correlation(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let sigma = |i: usize| covariance[(i, i)].sqrt();
    DMatrix::from_fn(covariance.nrows(), covariance.ncols(), |i, j| {
        covariance[(i, j)] / (sigma(i) * sigma(j))
    })
}

impl Problem<'_> {
    /// Whether the samples separate all parameters of an estimate.
    ///
    /// # Errors
    /// [`Error::CannotCarry`] with what is missing.
    pub fn check(&self, estimate: &Estimate) -> Result<(), Error> {
        self.check_correlation(estimate, estimate.correlation())
    }

    /// The same of an estimate in f64, with the constant that belongs to centred signals: that of
    /// the signals as they are follows `a_0` where their offset is large.
    ///
    /// # Errors
    /// As [`check`](Self::check).
    pub(crate) fn check_centred(&self, estimate: &Estimate) -> Result<(), Error> {
        let p = estimate.theta.len();
        let covariance = DMatrix::from_fn(p, p, |i, j| estimate.covariance[i][j]);
        let centring = self.centring(p);
        let centred = &centring * covariance * centring.transpose();
        self.check_correlation(estimate, correlation(&centred))
    }

    /// `A (y - m) = B (u - n) + d' is A y = B u + d` with `d' = d - a_0 m + sum b_0 n`.
    fn centring(&self, parameters: usize) -> DMatrix<f64> {
        let mut centring = DMatrix::identity(parameters, parameters);
        if !self.structure.constant {
            return centring;
        }
        let signals = self.signals;
        let acting = (0..self.samples()).filter(|k| signals.acts(*k));
        let count = acting.clone().count().max(1) as f64;
        let mean = |x: &[f64]| acting.clone().map(|k| x[k]).sum::<f64>() / count;
        let last = parameters - 1;
        if !self.structure.integrator {
            centring[(last, 0)] = -mean(signals.output);
        }
        let mut place = self.structure.order - usize::from(self.structure.integrator);
        for input in &signals.inputs {
            centring[(last, place)] = mean(input.samples);
            place += self.terms(input);
        }
        centring
    }

    fn check_correlation(
        &self,
        estimate: &Estimate,
        correlation: DMatrix<f64>,
    ) -> Result<(), Error> {
        let parameters = estimate.theta.iter().chain(&estimate.sigma);
        if !parameters.copied().all(f64::is_finite) {
            return Err(self.cannot_carry(Weakness::NotFinite));
        }
        if !correlation.iter().copied().all(f64::is_finite) {
            return Err(self.cannot_carry(Weakness::NoInfluence));
        }
        let modes = correlation.symmetric_eigen();
        let (weakest, value) = modes.eigenvalues.argmin();
        if value < SINGULAR {
            let direction = modes.eigenvectors.column(weakest);
            let mixed = self.parameter_names().into_iter().zip(direction.iter());
            let names = mixed.filter(|(_, d)| d.abs() > INVOLVED).map(|(n, _)| n);
            return Err(self.cannot_carry(Weakness::Inseparable(names.collect())));
        }
        Ok(())
    }
}
