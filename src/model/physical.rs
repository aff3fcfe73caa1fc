//! The physical reading of a transfer function: gain, natural frequency, damping, time constants.

use crate::math::{deviation, sqrt};
use crate::model::transfer_function::TransferFunction;

/// Gain, natural frequency, damping and time constants; `None` where a quantity does not exist.
///
/// | quantity | equation | unit |
/// |---|---|---|
/// | gain | b_0 / a_nu, nu integrators | y per u (nu = 0), y/s per u (nu = 1) |
/// | omega0 | sqrt(a_nu) | rad/s |
/// | damping | a_{nu+1} / (2 omega0) | 1 |
/// | time constants | -1 / real pole | s |
///
/// omega0 and damping are given for the oscillating pair: with two poles behind the
/// integrators in closed form (also when it is overdamped), with more poles from the
/// complex pair nearest to zero.
///
/// # Examples
/// ```
/// use trendid::TransferFunction;
/// use trendid::model::Physical;
/// let servo = TransferFunction::<3, 1> {
///     a: [0.0, 400.0, 20.0],
///     b: [[1.0e6, 0.0, 0.0]],
///     constant: 0.0,
/// };
/// let reading = Physical::of(&servo, 0);
/// assert_eq!(reading.omega0, Some(20.0));
/// assert_eq!(reading.damping, Some(0.5));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Physical<const M: usize> {
    /// Static gain, or velocity gain C behind one integrator.
    pub gain: Option<f32>,
    /// Natural frequency in rad/s.
    pub omega0: Option<f32>,
    /// Damping ratio xi.
    pub damping: Option<f32>,
    /// Time constants of the real poles, longest first, in s.
    pub time_constants: [Option<f32>; M],
    /// Whether the poles behind the integrators are all stable.
    pub stable: bool,
}

impl<const M: usize> Physical<M> {
    /// Reads the transfer function from `input` to the output.
    pub fn of<const I: usize>(transfer: &TransferFunction<M, I>, input: usize) -> Self {
        let mut reading = Self {
            gain: transfer.gain(input),
            omega0: None,
            damping: None,
            time_constants: [None; M],
            stable: transfer.is_stable(),
        };
        let behind = transfer.behind_integrators().unwrap_or(&[]);
        if let [a0, a1] = *behind
            && a0 > 0.0
            && a0.is_finite()
            && a1.is_finite()
        {
            let omega0 = sqrt(a0);
            reading.omega0 = finite(omega0);
            reading.damping = finite(0.5 * a1 / omega0);
        }
        let Some(poles) = transfer.poles() else {
            return reading;
        };
        let mut n = 0;
        for pole in poles.iter().skip(transfer.integrators()) {
            if pole.im == 0.0 && pole.re < 0.0 {
                if let Some(slot) = reading.time_constants.get_mut(n) {
                    *slot = finite(-1.0 / pole.re);
                    n += 1;
                }
            } else if pole.im != 0.0 && reading.omega0.is_none() {
                let omega0 = sqrt(pole.re * pole.re + pole.im * pole.im);
                reading.omega0 = finite(omega0);
                reading.damping = finite(-pole.re / omega0);
            }
        }
        reading
    }
}

/// `value`, unless a quotient of very small coefficients overflowed.
fn finite(value: f32) -> Option<f32> {
    value.is_finite().then_some(value)
}

/// What rounding may leave of a sum of nine products of rounded factors, relative to the sum of
/// their sizes: where the terms cancel, the variance is known no better.
const ROUNDING: f32 = 8.0 * f32::EPSILON;

/// Standard deviations of gain, omega0 and damping, first order in the covariance of
/// `[b_0, a_nu, a_{nu+1}]`.
///
/// For two poles behind the integrators, in the user's units; `None` unless a_nu is positive.
pub(crate) fn second_order_std(
    [b0, a_nu, a_next]: [f32; 3],
    covariance: &[[f32; 3]; 3],
) -> Option<[f32; 3]> {
    if !(a_nu > 0.0) {
        return None;
    }
    let omega0 = sqrt(a_nu);
    let slopes = [
        [1.0 / a_nu, -b0 / (a_nu * a_nu), 0.0],
        [0.0, 0.5 / omega0, 0.0],
        [0.0, -0.25 * a_next / (a_nu * omega0), 0.5 / omega0],
    ];
    Some(slopes.map(|slope| {
        let (mut variance, mut size) = (0.0, 0.0);
        for i in 0..3 {
            for j in 0..3 {
                let term = slope[i] * covariance[i][j] * slope[j];
                variance += term;
                size += term.abs();
            }
        }
        deviation(variance + ROUNDING * size)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_variance_that_cancels_is_not_zero() {
        // b0 and a1 err together: the gain is known much better than f32 resolves, not perfectly.
        let (b0, a1, share) = (1e6_f32, 400.0_f32, 0.01_f32);
        let sigma = [share * b0, share * a1, 0.2];
        let mut covariance = [[0.0; 3]; 3];
        for i in 0..2 {
            for j in 0..2 {
                covariance[i][j] = sigma[i] * sigma[j];
            }
        }
        covariance[2][2] = sigma[2] * sigma[2];
        let [gain, omega0, _] = second_order_std([b0, a1, 20.0], &covariance).unwrap();
        assert!(gain > 0.0 && gain < 2e-5 * b0 / a1, "{gain}");
        assert!((omega0 / (0.5 * share * 20.0) - 1.0).abs() < 1e-3);
        for x in [f32::NAN, f32::INFINITY] {
            covariance[0][1] = x;
            let [gain, ..] = second_order_std([b0, a1, 20.0], &covariance).unwrap();
            assert_eq!(gain, f32::INFINITY);
        }
    }
}
