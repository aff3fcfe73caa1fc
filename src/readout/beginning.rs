//! What the noise of y(0) has done to an estimate, taken out of it.
//!
//! Behind the filter that noise, nu, is a column `gamma rho^k` of every row, as soon as all but
//! the slow pole -p have settled. By the residue there, with A of the model and A_f of the filter,
//!
//! ```text
//! gamma = kappa nu        kappa = A(-p) / (p A_f'(-p))        pi = 1 / E kappa^2
//! ```
//!
//! where no other pole is nearer to p than p itself; one that is counts as if it were so far away,
//! its own decay being no column.
//!
//! pi is the variance of a row over that of gamma, where the noise of y is that of the rows: the
//! equation weighs the newest y with about 1. Where disturbances are larger than that noise they
//! move the beginning as well, and so much more is allowed for. With it the sums of
//! [`Beginning`](crate::estimation::beginning) give theta and P of the recursion as they were with
//! the column,
//!
//! ```text
//! gamma = (b - c' theta) / S        theta - P c gamma        P + P c c' P / S        S = d - c' P c + pi
//! ```
//!
//! and all that is read is read from these: the noise of the other samples is taken out of what the
//! beginning has left, or a direction in which it was the whole motion would pass for a known one.
//!
//! The model in kappa is not that of the recursion. Least squares bends a model until it explains
//! nu, `A(-p) = 0`, and such a model tells of none. It is the one of a column of which nothing is
//! known, pi = 0, with the variance that A(-p) has then.

use crate::estimation::terms::Parameter;
use crate::math::matrix::{Matrix, add_square, dot};
use crate::math::polynomial::value_and_slope;
use crate::math::{larger, raised};
use crate::readout::source::ReadOut;

/// Estimate and P of the recursion with the column of its beginning, normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Regression<const N: usize> {
    pub(crate) theta: [f32; N],
    pub(crate) p: Matrix<N>,
}

/// The column of a beginning, everything normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Column<const N: usize> {
    /// P c, the change of the parameters per unit of gamma.
    pub(crate) direction: [f32; N],
    pub(crate) gamma: f32,
    /// 1 / S, the variance of gamma over that of the residual.
    pub(crate) variance: f32,
}

impl<const N: usize> Column<N> {
    /// Makes the recursion one with the column.
    pub(crate) fn enter(&self, regression: &mut Regression<N>) {
        for (value, direction) in regression.theta.iter_mut().zip(&self.direction) {
            *value -= direction * self.gamma;
        }
        add_square(&mut regression.p, &self.direction, self.variance);
    }
}

/// What an error of y(0) may have done to a structure with an initial state, no part of its
/// estimate; everything normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Considered<const N: usize> {
    /// The change of the parameters per unit of the error.
    pub(crate) direction: [f32; N],
    /// Variance of the error over that of the residual.
    pub(crate) variance: f32,
}

impl<const N: usize> Considered<N> {
    /// What it adds to the variance of a parameter under a residual of variance 1.
    pub(super) fn of(&self, index: usize) -> f32 {
        let own = self.direction.get(index).copied().unwrap_or(0.0);
        own * own * self.variance
    }

    /// Adds to a covariance, that of a `residual` of such a variance.
    #[inline(never)]
    pub(super) fn add_to(&self, covariance: &mut Matrix<N>, residual: f32) {
        add_square(covariance, &self.direction, self.variance * residual);
    }
}

impl<const M: usize, const N: usize, const I: usize> ReadOut<'_, M, N, I> {
    /// The recursion, with the column of its beginning where it has none of its own.
    #[inline(never)]
    pub(crate) fn regression(&self) -> Regression<N> {
        let mut regression = self.recursion_alone();
        if let Some(column) = self.column(&regression) {
            column.enter(&mut regression);
        }
        regression
    }

    /// The recursion as it stands.
    pub(crate) fn recursion_alone(&self) -> Regression<N> {
        Regression {
            theta: *self.estimator.theta(),
            p: self.covariance(),
        }
    }

    /// The column of the beginning beside a recursion; `None` without one, or where no number
    /// tells it.
    #[inline(never)]
    pub(crate) fn column(&self, recursion: &Regression<N>) -> Option<Column<N>> {
        let sums = self.beginning;
        let filter = self.design.filter.as_ref()?;
        if !(sums.square > 0.0) {
            return None;
        }
        let Regression { theta, p } = recursion;
        let direction: [f32; N] = core::array::from_fn(|i| dot(&p[i], &sums.moments));
        let seen = sums.square - dot(&sums.moments, &direction);
        let left = sums.product - dot(&sums.moments, theta);
        // Where all of the column is that of the parameters nothing tells gamma.
        let free = if seen > 0.0 { 1.0 / seen } else { 0.0 };
        let gradient = self.slow_gradient();
        let along = dot(&gradient, &direction);
        let model = self.slow_top() + dot(&gradient, theta) - along * (left * free);
        let spread: f32 = gradient
            .iter()
            .zip(p)
            .map(|(g, p)| g * dot(&gradient, p))
            .sum();
        let square = model * model + (spread + along * along * free) * self.residual();
        let pi = self.slow_residue(filter) / square;
        let variance = 1.0 / (larger(seen, 0.0) + pi);
        let gamma = if seen > 0.0 { left * variance } else { 0.0 };
        (gamma.is_finite() && variance.is_finite()).then_some(Column {
            direction,
            gamma,
            variance,
        })
    }

    /// A(-p) per unit of each parameter; what a parameter of 0 has is [`slow_top`](Self::slow_top).
    fn slow_gradient(&self) -> [f32; N] {
        let (parameters, units) = (self.structure.parameters(), self.regressor.units());
        let pole = self.design.slow_pole();
        core::array::from_fn(|j| match parameters[j] {
            Parameter::Output { power } => units[j] * raised(pole, power),
            _ => 0.0,
        })
    }

    /// (-p)^m.
    fn slow_top(&self) -> f32 {
        raised(self.design.slow_pole(), M)
    }

    /// The square of p A_f'(-p), or of what it is with another pole as far from p as p is.
    fn slow_residue(&self, filter: &[f32; M]) -> f32 {
        let pole = self.design.slow_pole();
        let [_, slope] = value_and_slope(filter, pole);
        let steep = larger((pole * slope).abs(), raised(-pole, M));
        steep * steep
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
    pub(crate) fn considered(&self, direction: [f32; N], spread: f32) -> Option<Considered<N>> {
        let variance = self.start_error.variance / spread;
        let finite = variance.is_finite() && direction.iter().all(|value| value.is_finite());
        finite.then_some(Considered {
            direction,
            variance,
        })
    }
}

#[cfg(test)]
mod tests;
