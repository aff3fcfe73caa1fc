//! C, omega0 and xi of an estimate, with their standard deviations.

use trendid::Identifier;
use trendid::trends::FilteredTrends;

use crate::plants::servo::Servo;

/// Values and standard deviations of C, omega0, xi.
pub(super) type Reading = [[f64; 2]; 3];

/// C, omega0, xi of `b0 / (s (s^2 + a2 s + a1))`.
pub(super) fn second_order<const N: usize, const I: usize>(
    identifier: &Identifier<FilteredTrends<3>, 3, N, I>,
) -> Option<Reading> {
    let estimate = identifier.estimate();
    let theta = estimate.theta();
    let servo = Servo::from_coefficients(theta[0].into(), theta[1].into(), theta[2].into())?;
    let std = estimate.physical_std()?;
    Some([
        [servo.c, std[0].into()],
        [servo.omega0, std[1].into()],
        [servo.xi, std[2].into()],
    ])
}

/// C and a1 of `b0 / (s (s + a1))`.
pub(super) fn first_order<const N: usize, const I: usize>(
    identifier: &Identifier<FilteredTrends<2>, 2, N, I>,
) -> Option<Reading> {
    let estimate = identifier.estimate();
    let theta = estimate.theta().map(f64::from);
    let p = estimate.covariance().map(|row| row.map(f64::from));
    let gain = theta[1] / theta[0];
    let relative = p[1][1] / theta[1].powi(2) + p[0][0] / theta[0].powi(2)
        - 2.0 * p[0][1] / (theta[0] * theta[1]);
    Some([
        [gain, gain.abs() * relative.max(0.0).sqrt()],
        [theta[0], p[0][0].sqrt()],
        [0.0, 1.0],
    ])
}
