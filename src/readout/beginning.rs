//! What the noise of y(0) has done to an estimate, taken out of it.
//!
//! Behind the filter that noise, nu, is a column `gamma rho^k` of every row, as soon as all but
//! the slow pole -p have settled. By the residue there, with A of the model and A_f of the filter,
//!
//! ```text
//! gamma = kappa nu        kappa = A(-p) / (p A_f'(-p))        pi = 1 / kappa^2
//! ```
//!
//! where no other pole is nearer to p than p itself; one that is counts as if it were so far away,
//! its own decay being no column.
//!
//! pi is the variance of a row over that of gamma, where the noise of y is that of the rows: the
//! equation weighs the newest y with about 1. Where disturbances are larger than that noise they
//! move the beginning as well, and so much more is allowed for. With Q, the change of the estimate
//! per change of a score, in the place of P the sums of [`Beginning`](crate::estimation::beginning)
//! give gamma, which is then taken out; what is left of it is in the deviations:
//!
//! ```text
//! theta_c - Q c gamma        Sigma + (Q c) (Q c)' s / S        S = d - c' Q c + pi
//! ```
//!
//! s is the variance of the residual.

use crate::math::matrix::{Matrix, dot};
use crate::math::raised;
use crate::readout::source::ReadOut;

/// What a beginning has done, everything normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Begun<const N: usize> {
    /// Q c, the change of the parameters per unit of gamma.
    pub(crate) direction: [f32; N],
    pub(crate) gamma: f32,
    /// 1 / S, the variance of gamma over that of the residual.
    pub(crate) variance: f32,
    /// Whether gamma is no part of the estimate.
    pub(crate) considered: bool,
}

impl<const N: usize> Begun<N> {
    /// Takes gamma out of theta.
    #[inline(never)]
    pub(super) fn take_out(&self, theta: &mut [f32; N]) {
        for (value, direction) in theta.iter_mut().zip(&self.direction) {
            *value -= direction * self.gamma;
        }
    }

    /// Adds to row `index` of a covariance, that of a residual of variance 1.
    pub(super) fn add_row(&self, index: usize, row: &mut [f32; N]) {
        if self.considered {
            return;
        }
        let own = self.direction.get(index).copied().unwrap_or(0.0) * self.variance;
        for (entry, direction) in row.iter_mut().zip(&self.direction) {
            *entry += own * direction;
        }
    }

    /// What it adds to the variance of a parameter beyond its row, under a residual of variance 1.
    pub(super) fn considered(&self, index: usize) -> f32 {
        match (self.considered, self.direction.get(index)) {
            (true, Some(own)) => own * own * self.variance,
            _ => 0.0,
        }
    }

    /// Adds to a covariance, that of a `residual` of such a variance.
    #[inline(never)]
    pub(super) fn add_to(&self, covariance: &mut Matrix<N>, residual: f32) {
        for (own, row) in self.direction.iter().zip(covariance) {
            for (entry, direction) in row.iter_mut().zip(&self.direction) {
                *entry += (own * direction) * (self.variance * residual);
            }
        }
    }
}

impl<const M: usize, const N: usize, const I: usize> ReadOut<'_, M, N, I> {
    /// What the beginning has done to the estimate `theta`, whose change per unit of gamma is
    /// `direction`; `None` where no number tells it.
    #[inline(never)]
    pub(crate) fn begun(&self, theta: &[f32; N], direction: [f32; N]) -> Option<Begun<N>> {
        let sums = self.beginning;
        let filter = self.design.filter.as_ref()?;
        let units = self.regressor.units();
        let a = (self.structure).denominator(&core::array::from_fn(|j| theta[j] * units[j]));
        let pole = (1.0 - self.design.slow_mode) / self.design.sample_time;
        // A, A_f and its slope at -p.
        let (mut model, mut of_filter, mut slope) = (1.0, 1.0, 0.0);
        for (a, f) in a.iter().zip(filter).rev() {
            model = a - pole * model;
            slope = of_filter - pole * slope;
            of_filter = f - pole * of_filter;
        }
        let (steep, least) = ((pole * slope).abs(), raised(pole, M));
        let kappa = model / if steep > least { steep } else { least };
        let seen = sums.square - dot(&sums.moments, &direction);
        let seen = if seen > 0.0 { seen } else { 0.0 };
        let variance = 1.0 / (seen + 1.0 / (kappa * kappa));
        let left = sums.product - dot(&sums.moments, theta);
        let gamma = if seen > 0.0 { left * variance } else { 0.0 };
        (gamma.is_finite() && variance.is_finite()).then_some(Begun {
            direction,
            gamma,
            variance,
            considered: false,
        })
    }

    /// The score of an error of y(0) of an estimate `theta` with an initial state.
    #[inline(never)]
    pub(crate) fn start_score(&self, theta: &[f32; N]) -> [f32; N] {
        let units = self.regressor.units();
        let a = (self.structure).denominator(&core::array::from_fn(|j| theta[j] * units[j]));
        let scale = self.regressor.top_scale();
        self.start_error.score(&a).map(|score| score * scale)
    }

    /// What that may have done, whose change per unit of it is `direction`; `spread` is the
    /// variance of the residual per variance of the noise of y.
    #[inline(never)]
    pub(crate) fn started(&self, direction: [f32; N], spread: f32) -> Option<Begun<N>> {
        let variance = self.start_error.variance / spread;
        let finite = variance.is_finite() && direction.iter().all(|value| value.is_finite());
        finite.then_some(Begun {
            direction,
            gamma: 0.0,
            variance,
            considered: true,
        })
    }
}

#[cfg(test)]
mod tests;
