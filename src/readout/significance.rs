//! A constant that the data do not show is withdrawn.
//!
//! Known as: pre-test estimator. Judge and Bock, The Statistical Implications of Pre-Test and
//! Stein-Rule Estimators (1978).
//!
//! The offset of a valve belongs in the model: left out, an offset of 10 % of the command
//! spoils the estimate by tens of percent. Estimated where there is none, it makes the gain
//! twice as uncertain within a second. So it is always estimated, and withdrawn at the
//! read-out while it lies within its own uncertainty. With P of the recursion and c the
//! index of the constant,
//!
//! ```text
//! z = |theta_c| / sigma_c              sigma_c^2 = P_cc times the variance of the innovation, or more where it is not white
//! g = P_c / P_cc                       theta - g theta_c is least squares without the constant
//! theta <- theta - s g theta_c         s = 1 for z <= limit, 0 for z >= 2 limit, a line between
//! ```
//!
//! The recursion is not changed by it, and nothing jumps when an offset shows itself.
//!
//! A constant is b_0 times an offset of the command. Where b_0 itself may be 0, as in rows that are
//! mostly noise, a constant of 0 says nothing of the offset: `b_0 = c = 0` is a drive of which
//! nothing is known, and to hold c there would make b_0 certain to be 0. So nothing is withdrawn
//! where what that leaves of b_0 is below a tenth of a deviation of b_0 with the constant, and all
//! of s from two tenths on.
//!
//! That a constant lies within its deviation sigma_c speaks for none as far as an offset would
//! show. Offsets lie anywhere within some percent of the command's range, e, and so within sigma_c
//! with a probability of about `sigma_c / (b_0 e)`: that share of sigma_c^2 stays in the
//! deviations. While a command has had one level only, gain and constant are not told apart; it is
//! all then. Beside a second input it is none: the width of a dead zone is that of a valve without
//! an offset, and two levels of a command determine neither.

use crate::estimation::terms::{Parameter, index_of};
use crate::math::matrix::Matrix;
use crate::math::{larger, smaller, sqrt};

/// e: offsets lie within this share of the range of the command. Valves are not built worse.
const OFFSETS: f32 = 0.1;

/// Deviations below which the gain of the command may be 0. Where noise hides the drive what is
/// left of it is some hundredths of one; in a short record of a drive it is about one or more.
const NONE: f32 = 0.1;

/// The gain of the command.
const GAIN: Parameter = Parameter::Input { input: 0, power: 0 };

/// Whether the drive has inputs beside its command.
const fn is_another_input(parameter: &Parameter) -> bool {
    matches!(parameter, Parameter::Input { input: 1.., .. })
}

/// The withdrawn share of the constant, and the change of the other parameters.
pub(crate) struct Withdrawal<const N: usize> {
    index: usize,
    /// |theta_c| over the limit below which all of it is withdrawn, in [0, 2).
    ratio: f32,
    /// How far the gain of the command is known not to be 0, in (0, 1].
    known: f32,
    /// A constant as large as offsets are, in the user's units; 0 where there is no such gain, and
    /// infinite where none counts.
    offset: f32,
    /// The constant before, in the user's units.
    value: f32,
    /// g in the user's units: change of each parameter per unit of the constant.
    direction: [f32; N],
}

impl<const N: usize> Withdrawal<N> {
    /// The withdrawal from the estimate `theta`, in the user's units; `None` for a significant
    /// constant, or beside a gain that may be 0.
    ///
    /// `row_of` gives a row of P, normalised; `residual` the variance of the innovation, or more
    /// where it is not white; `limit` the number of standard deviations.
    pub(crate) fn of(
        columns: &[Parameter; N],
        theta: &[f32; N],
        row_of: impl Fn(usize) -> Option<[f32; N]>,
        units: &[f32; N],
        residual: f32,
        limit: f32,
    ) -> Option<Self> {
        let index = index_of(columns, Parameter::Constant)?;
        let row = row_of(index)?;
        let (variance, value, unit) = (*row.get(index)?, *theta.get(index)?, *units.get(index)?);
        let limit = limit * unit * sqrt(residual * variance);
        // A known constant (variance 0) and NaN stay, too.
        if !(variance > 0.0 && value.abs() < 2.0 * limit) {
            return None;
        }
        let mut found = Self {
            index,
            ratio: value.abs() / limit,
            known: 1.0,
            offset: 0.0,
            value,
            direction: core::array::from_fn(|j| row[j] / variance * (units[j] / unit)),
        };
        if let Some(gain) = index_of(columns, GAIN) {
            let step = *found.direction.get(gain)? * value;
            let left = (*theta.get(gain)? - step) / *units.get(gain)?;
            let chance = NONE * sqrt(residual * *row_of(gain)?.get(gain)?);
            // An input whose parameters are known is none.
            let free = |(j, parameter)| {
                is_another_input(parameter)
                    && row_of(j).is_some_and(|row| row.get(j).is_some_and(|own| *own > 0.0))
            };
            found.offset = match columns.iter().enumerate().any(free) {
                true => f32::INFINITY,
                false => OFFSETS * (left * unit).abs(),
            };
            // A known gain is not 0.
            if chance > 0.0 {
                found.known = smaller(left.abs() / chance - 1.0, 1.0);
            }
        }
        (found.known > 0.0).then_some(found)
    }

    /// s, in (0, 1].
    fn share(&self) -> f32 {
        self.known * smaller(2.0 - self.ratio, 1.0)
    }

    /// Takes the share out of the estimate.
    pub(crate) fn apply(&self, theta: &mut [f32; N]) {
        let step = self.share() * self.value;
        for (value, direction) in theta.iter_mut().zip(&self.direction) {
            *value -= step * direction;
        }
    }

    /// Puts the share back.
    pub(crate) fn undo(&self, theta: &mut [f32; N]) {
        let step = self.share() * self.value;
        for (value, direction) in theta.iter_mut().zip(&self.direction) {
            *value += step * direction;
        }
    }

    /// Takes the share out of the covariance; the constant itself keeps its own.
    pub(crate) fn apply_to_covariance(&self, covariance: &mut Matrix<N>) {
        let Some(row) = covariance.get(self.index).copied() else {
            return;
        };
        let own = row.get(self.index).copied().unwrap_or(0.0);
        let share = self.share();
        let g = self.direction.map(|direction| share * direction);
        // Part of the withdrawn value stays as variance. The factor 0.6 keeps 3-sigma coverage
        // above 90 % for offsets of one sigma, and 1-sigma coverage below 75 % for none.
        let depth = smaller(self.ratio, 1.0);
        let seen = own + 0.6 * depth * (1.0 + depth) * self.value * self.value;
        let deviation = sqrt(larger(own, 0.0));
        let left = seen + smaller(deviation / self.offset, 1.0) * own;
        for i in 0..N {
            for j in 0..N {
                covariance[i][j] += left * g[i] * g[j] - g[i] * row[j] - g[j] * row[i];
            }
        }
        let own_row = covariance.get_mut(self.index);
        if let Some(left) = own_row.and_then(|row| row.get_mut(self.index))
            && *left < own
        {
            *left = own;
        }
    }
}

#[cfg(test)]
mod tests;
