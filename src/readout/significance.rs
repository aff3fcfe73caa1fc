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
//! That a constant is insignificant speaks for none as far as the data show it. While a command
//! has had one level only, gain and constant are not told apart, and theta_c is the mean of the
//! prior. So of P_cc the square of its share in the variance of the prior stays in the deviations:
//! a constant as large as the prior's deviation is off by 2.3 of them at most, and what the data
//! show of it stands in theta_c.

use crate::estimation::terms::{Parameter, index_of};
use crate::math::matrix::Matrix;
use crate::math::sqrt;

/// The withdrawn share of the constant, and the change of the other parameters.
pub(crate) struct Withdrawal<const N: usize> {
    index: usize,
    /// |theta_c| over the limit below which all of it is withdrawn, in [0, 2).
    ratio: f32,
    /// The constant before, in the user's units.
    value: f32,
    /// g in the user's units: change of each parameter per unit of the constant.
    direction: [f32; N],
    /// Share of the variance of the constant that is the prior's, in [0, 1].
    unseen: f32,
}

impl<const N: usize> Withdrawal<N> {
    /// The withdrawal from the estimate `theta`, in the user's units; `None` for a significant
    /// constant.
    ///
    /// `row_of` gives a row of P, normalised; `residual` the variance of the innovation, or more
    /// where it is not white; `limit` the number of standard deviations.
    pub(crate) fn of(
        columns: &[Parameter; N],
        theta: &[f32; N],
        row_of: impl FnOnce(usize) -> Option<[f32; N]>,
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
        Some(Self {
            index,
            ratio: value.abs() / limit,
            value,
            direction: core::array::from_fn(|j| row[j] / variance * (units[j] / unit)),
            unseen: 0.0,
        })
    }

    /// With the share of the variance of the constant that no data have made smaller.
    pub(crate) fn unseen(self, unseen: f32) -> Self {
        Self { unseen, ..self }
    }

    /// s, in (0, 1].
    fn share(&self) -> f32 {
        (2.0 - self.ratio).min(1.0)
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
        let depth = self.ratio.min(1.0);
        let seen = own + 0.6 * depth * (1.0 + depth) * self.value * self.value;
        let left = seen + self.unseen * (self.unseen * own);
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
mod tests {
    use super::*;

    const COLUMNS: [Parameter; 2] = [Parameter::Input { input: 0, power: 0 }, Parameter::Constant];
    const P: Matrix<2> = [[2.0, 1.0], [1.0, 1.0]];

    fn withdrawal(constant: f32) -> Option<Withdrawal<2>> {
        Withdrawal::of(
            &COLUMNS,
            &[10.0, constant],
            |i| P.get(i).copied(),
            &[1.0; 2],
            4.0,
            2.0,
        )
    }

    #[test]
    fn a_constant_within_its_uncertainty_goes_and_one_beyond_stays() {
        // sigma_c = 2: all is withdrawn up to 4, nothing from 8 on, half of it at 6.
        for (constant, gain, left) in [(3.0, 7.0, 0.0), (-4.0, 14.0, 0.0), (6.0, 7.0, 3.0)] {
            let mut theta = [10.0, constant];
            withdrawal(constant).unwrap().apply(&mut theta);
            assert_eq!(theta, [gain, left]);
        }
        assert!(withdrawal(8.0).is_none() && withdrawal(f32::NAN).is_none());
    }

    #[test]
    fn a_known_constant_stays() {
        let known = [[2.0, 0.0], [0.0, 0.0]];
        let found = Withdrawal::of(
            &COLUMNS,
            &[10.0, 0.1],
            |i| known.get(i).copied(),
            &[1.0; 2],
            4.0,
            2.0,
        );
        assert!(found.is_none());
        assert!(
            Withdrawal::of(
                &COLUMNS,
                &[10.0, 0.0],
                |i| P.get(i).copied(),
                &[1.0; 2],
                0.0,
                2.0
            )
            .is_none()
        );
    }

    #[test]
    fn the_limit_grows_with_the_root_of_residual_and_variance() {
        let p: Matrix<2> = [[2.0, 0.1], [0.1, 0.25]];
        // sigma_c = 1: nothing is withdrawn from 4 on.
        for (constant, goes) in [(3.9, true), (4.1, false)] {
            let theta = [10.0, constant];
            let found =
                Withdrawal::of(&COLUMNS, &theta, |i| p.get(i).copied(), &[1.0; 2], 4.0, 2.0);
            assert_eq!(found.is_some(), goes, "{constant}");
        }
    }

    #[test]
    fn the_covariance_is_that_without_the_constant_and_a_part_of_it() {
        let mut covariance = P;
        withdrawal(3.0)
            .unwrap()
            .apply_to_covariance(&mut covariance);
        // Without the constant the variance of the gain is 2 - 1/1; 3 is three quarters of the
        // limit.
        let left = 9.0 * 0.6 * 0.75 * 1.75;
        assert!((covariance[0][0] - (1.0 + left)).abs() < 1e-6);
        assert!((covariance[1][1] - left).abs() < 1e-6);
    }

    #[test]
    fn what_is_withdrawn_in_part_takes_that_part_of_the_covariance_along() {
        let p: Matrix<2> = [[2.0, 0.8], [0.8, 1.0]];
        let found = Withdrawal::of(
            &COLUMNS,
            &[10.0, 6.0],
            |i| p.get(i).copied(),
            &[1.0; 2],
            4.0,
            2.0,
        );
        let mut covariance = p;
        found.unwrap().apply_to_covariance(&mut covariance);
        // Half of 6, which is one and a half times the limit: g = (0.8, 1) / 2, and the variance
        // of the constant with 0.6 (1 + 1) 36.
        let left = 1.0 + 1.2 * 36.0;
        let wanted = [
            [2.0 + left * 0.16 - 0.64, 0.8 + left * 0.2 - 0.8],
            [0.8 + left * 0.2 - 0.8, 1.0 + left * 0.25 - 1.0],
        ];
        for (found, wanted) in covariance.iter().flatten().zip(wanted.iter().flatten()) {
            assert!((found - wanted).abs() < 1e-4, "{covariance:?} {wanted}");
        }
    }

    #[test]
    fn what_was_taken_out_can_be_put_back() {
        // In the user's units the constant is 5 times, the gain 30 times the normalised one.
        let (units, before) = ([30.0, 5.0], [10.0, 12.0]);
        let row_of = |i: usize| P.get(i).copied();
        let found = Withdrawal::of(&COLUMNS, &before, row_of, &units, 4.0, 2.0).unwrap();
        let mut theta = before;
        found.apply(&mut theta);
        // All of it: within 20. The gain follows by P_gc/P_cc = 1 in its units.
        assert!((theta[0] - (10.0 - 12.0 * 6.0)).abs() < 1e-4 && theta[1].abs() < 1e-5);
        found.undo(&mut theta);
        assert!((theta[0] - 10.0).abs() < 1e-4 && (theta[1] - 12.0).abs() < 1e-4);
    }

    #[test]
    fn what_no_data_show_of_a_constant_stays_in_the_covariance() {
        let of = |unseen: f32| {
            let mut covariance = P;
            let found = withdrawal(0.0).unwrap().unseen(unseen);
            found.apply_to_covariance(&mut covariance);
            covariance
        };
        // All of it is the prior's: as before the withdrawal.
        assert_eq!(of(1.0), P);
        assert_eq!(of(0.0)[0][0], P[0][0] - P[0][1]);
        assert_eq!(of(0.5)[0][0], P[0][0] - P[0][1] + 0.25);
    }

    #[test]
    fn a_constant_keeps_its_variance_and_leaves_the_gain_what_no_data_show() {
        let p: Matrix<2> = [[2.0, 0.5], [0.5, 0.25]];
        let row_of = |i: usize| p.get(i).copied();
        let found = Withdrawal::of(&COLUMNS, &[10.0, 0.0], row_of, &[1.0; 2], 4.0, 2.0);
        let mut covariance = p;
        let found = found.unwrap().unseen(0.5);
        found.apply_to_covariance(&mut covariance);
        // A gain that follows by 2: its variance without the constant, and a quarter of what the
        // constant makes of it.
        assert_eq!(covariance[0][0], 2.0 - 1.0 + 0.25);
        assert_eq!(covariance[1][1], 0.25);
    }
}
