//! From the recursion to the numbers the user sees: the noise bias taken out, the uncertainty put in.
//!
//! Least squares with noisy regressors is biased. White noise of variance s on y puts
//! `s M` into every phi phi' and `s m` into every phi psi, where M and m are constants
//! of the filter. With P = (sum phi phi')^-1 over n samples, one step of the correction
//!
//! ```text
//! theta_c = theta + w P (M theta - m)          w = n s / (1 + n s tr P M)
//! P_c     = (I + 2 w P M) P (I + 2 w P M)'
//! Sigma   = s T P_c T' + floor
//! ```
//!
//! takes the bias out to first order, at the read-out only: nothing is added to the
//! 1 ms path but the level s. In P_c one w P M is the step, the other the noise of the
//! regressors times that of the residual. The residual of the filtered equation is not
//! white: it is `A/A_f` times the noise, and what matters for a parameter is how much of
//! it lies where that parameter is seen: T, see `shaping`. The floor is what trends in
//! place of derivatives and f32 cost, and what a damped step leaves of the bias. Last, a
//! constant that the data do not show is withdrawn, see `doubt`.

pub(crate) mod residual_spectrum;
pub(crate) mod s_plane;
pub(crate) mod significance;

use crate::estimation::regressor::Regressor;
use crate::estimation::terms::{Parameter, index_of};
use crate::math::{pow, sqrt};
use crate::readout::residual_spectrum::{Light, Matrix};
use crate::readout::significance::Doubt;
use crate::trends::{NoiseGain, TrendOperator};

/// What the read-out needs of the estimator's state; everything normalised.
pub(crate) struct Evidence<const N: usize> {
    pub(crate) columns: [Parameter; N],
    pub(crate) theta: [f32; N],
    pub(crate) covariance: Matrix<N>,
    /// Samples in the memory.
    pub(crate) samples: f32,
    /// Variance of the innovation, if there are more samples than parameters.
    pub(crate) residual: Option<f32>,
    /// Variance of the white noise of y that the third difference sees, in units of y squared.
    pub(crate) white: Option<f32>,
    /// Variance of the innovation before there is a residual.
    pub(crate) prior: f32,
    /// Standard deviations below which a constant is withdrawn.
    pub(crate) doubt: f32,
}

/// Estimate and covariance in the user's units.
pub(crate) struct Readout<const N: usize> {
    pub(crate) theta: [f32; N],
    pub(crate) covariance: Matrix<N>,
}

/// The third difference counts as noise while it does not exceed what the residual allows by this factor.
const PLAUSIBLE: f32 = 1.3;

/// The estimate with the bias of white noise taken out, in the user's units, and what is left to its uncertainty.
pub(crate) struct Estimate<const N: usize> {
    pub(crate) theta: [f32; N],
    /// P_c, normalised.
    covariance: Matrix<N>,
    /// Variances of the residual: of white noise of y, to be seen through `A/A_f`, and of the rest.
    shaped: f32,
    even: f32,
    /// What one step of the correction leaves of each parameter, in the user's units.
    left: [f32; N],
    doubt: Option<Doubt<N>>,
}

/// Estimate with the bias of white noise taken out, and a doubtful constant withdrawn.
pub(crate) fn estimate<T: TrendOperator<M>, const M: usize, const N: usize>(
    evidence: &Evidence<N>,
    gain: &NoiseGain<M>,
    regressor: &Regressor<M, N>,
    trends: &T,
    bandwidth: f32,
) -> Estimate<N> {
    let (matrix, vector, echo) = regressor.noise_moments(&gain.lower, &gain.mixed, gain.top);
    // What white noise of variance 1 makes of the residual: psi - phi' theta.
    let mut spread = echo;
    for i in 0..N {
        spread -= 2.0 * evidence.theta[i] * vector[i];
        for j in 0..N {
            spread += evidence.theta[i] * matrix[i][j] * evidence.theta[j];
        }
    }
    let residual = evidence.residual.unwrap_or(evidence.prior);
    let allowed = if spread > 0.0 { residual / spread } else { 0.0 };
    // Where the third difference is the signal's, the noise is unknown and nothing is compensated.
    let white = match evidence.white {
        Some(white) if white <= PLAUSIBLE * allowed => {
            Some(if white < allowed { white } else { allowed })
        }
        _ => None,
    };

    let mut damping = 0.0;
    let mut theta = evidence.theta;
    let mut covariance = evidence.covariance;
    if let (Some(white), Some(_)) = (white, trends.filter_polynomial()) {
        let mut trace = 0.0;
        for i in 0..N {
            for j in 0..N {
                trace += evidence.covariance[i][j] * matrix[j][i];
            }
        }
        // Damped where one step is no longer small: few samples under much noise.
        let noise = evidence.samples * white;
        let weight = noise / (1.0 + noise * trace);
        damping = weight * trace;
        let mut drive = [0.0; N];
        for i in 0..N {
            drive[i] = -vector[i];
            for j in 0..N {
                drive[i] += matrix[i][j] * evidence.theta[j];
            }
        }
        // I + 2 w P M
        let mut transform = [[0.0; N]; N];
        for i in 0..N {
            for j in 0..N {
                let mut sum = 0.0;
                for k in 0..N {
                    sum += evidence.covariance[i][k] * matrix[k][j];
                }
                transform[i][j] = 2.0 * weight * sum + if i == j { 1.0 } else { 0.0 };
                theta[i] += weight * evidence.covariance[i][j] * drive[j];
            }
        }
        covariance = product(&transform, &evidence.covariance);
        covariance = product_transposed(&covariance, &transform);
    }
    let units = regressor.units();
    for j in 0..N {
        theta[j] *= units[j];
    }
    let sound = theta.iter().all(|v| v.is_finite());
    if !sound {
        for j in 0..N {
            theta[j] = evidence.theta[j] * units[j];
        }
    }
    let left = core::array::from_fn(|j| damping * (theta[j] - evidence.theta[j] * units[j]));
    let (shaped, even, doubtful) = match (trends.filter_polynomial(), white) {
        (Some(_), Some(white)) => {
            let scale = regressor.top_scale() * regressor.top_scale();
            // What white noise does not explain is slow (drift, friction, a wrong model): about
            // 2/(omega Delta) samples say the same thing.
            let excess = |explained: f32| {
                (residual - explained).max(0.0) * 2.0 / (bandwidth * trends.sample_time())
            };
            // Chance alone makes no excess; a constant may be doubted for it.
            let chance = 4.0 * sqrt(2.0 / evidence.samples.max(1.0));
            let explained = white * spread;
            (
                scale * white,
                excess(explained * (1.0 + chance)),
                residual + excess(explained),
            )
        }
        _ => (0.0, residual, residual),
    };
    // As long as nothing is known of the noise there is nothing to doubt: after a retuning nothing jumps.
    let doubt = evidence.residual.and_then(|_| {
        Doubt::of(
            &evidence.columns,
            &theta,
            &covariance,
            units,
            doubtful,
            evidence.doubt,
        )
    });
    if let Some(doubt) = &doubt {
        doubt.withdraw(&mut theta);
    }
    Estimate {
        theta,
        left,
        doubt,
        covariance,
        shaped,
        even,
    }
}

/// What trends in place of derivatives cost, relative to a parameter, in units of `(omega_n Delta)^2`.
///
/// Found without noise at 1 and 5 ms: 0.17 to 0.24 of every a_i and b_i of servos with damping 0.2 to 1, -0.08 of a
/// lag, 0.1 to 0.22 of an oscillator, the same of all parameters but for a tenth: a gain `b_0/a_nu` hardly suffers.
const DISCRETE: f32 = 0.2;

/// What f32 costs, relative to a parameter.
const ARITHMETIC: f32 = 2e-5;

/// Estimate and covariance in the user's units.
pub(crate) fn read_out<T: TrendOperator<M>, const M: usize, const N: usize>(
    evidence: &Evidence<N>,
    gain: &NoiseGain<M>,
    regressor: &Regressor<M, N>,
    trends: &T,
    bandwidth: f32,
) -> Readout<N> {
    let estimate = estimate(evidence, gain, regressor, trends, bandwidth);
    let Estimate {
        theta,
        shaped,
        even,
        ..
    } = estimate;
    let units = regressor.units();
    let mut covariance = estimate.covariance;
    let mut floor = ARITHMETIC;
    if let Some(filter) = trends.filter_polynomial() {
        let light = Light {
            columns: evidence.columns,
            units,
            theta: &theta,
            free: core::array::from_fn(|j| evidence.covariance[j][j] > 0.0),
            denominator: regressor.denominator(&theta),
            filter,
            bandwidth,
            duration: evidence.samples.max(1.0) * trends.sample_time(),
            slowest: (1.0 - trends.decay()) / trends.sample_time(),
        };
        let angle = light.natural() * trends.sample_time();
        floor += DISCRETE * angle * angle * trends.inexact(&light.denominator);
        let in_band = match light.transform() {
            Some(t) => in_light(&t, &covariance, &evidence.columns),
            None => covariance,
        };
        for i in 0..N {
            for j in 0..N {
                covariance[i][j] = shaped * in_band[i][j] + even * covariance[i][j];
            }
        }
    } else {
        for i in 0..N {
            for j in 0..N {
                covariance[i][j] *= even;
            }
        }
    }
    let coefficient = |i: usize| {
        !matches!(
            evidence.columns[i],
            Parameter::Constant | Parameter::InitialState
        )
    };
    for i in 0..N {
        for j in 0..N {
            covariance[i][j] *= units[i] * units[j];
            covariance[i][j] += estimate.left[i] * estimate.left[j];
            let known = evidence.covariance[i][i] == 0.0 || evidence.covariance[j][j] == 0.0;
            if coefficient(i) && coefficient(j) && !known {
                let share = if i == j { 1.01 } else { 1.0 };
                covariance[i][j] += share * (floor * theta[i]) * (floor * theta[j]);
            }
        }
    }
    if let Some(doubt) = &estimate.doubt {
        doubt.settle(&mut covariance);
    }
    Readout { theta, covariance }
}

/// What tells a constant from the start and a command in a short record lies above the frequencies of the constant:
/// noise counts this many times. Found on seeds of their own with offsets of 0.1 to 10 %.
const APART: f32 = 1.5;

/// T P T' of what least squares without the constant knows; what the constant adds is seen where the constant is.
///
/// T knows nothing of how a constant and the command resemble each other in a short record; P does.
fn in_light<const N: usize>(t: &Matrix<N>, p: &Matrix<N>, columns: &[Parameter; N]) -> Matrix<N> {
    let constant = index_of(columns, Parameter::Constant);
    let at = |matrix: &Matrix<N>, i: usize, j: usize| {
        matrix
            .get(i)
            .and_then(|row| row.get(j))
            .copied()
            .unwrap_or(0.0)
    };
    let Some(c) = constant.filter(|c| at(p, *c, *c) > 0.0) else {
        return product_transposed(&product(t, p), t);
    };
    let (own, light) = (at(p, c, c), at(t, c, c));
    let added: Matrix<N> =
        core::array::from_fn(|i| core::array::from_fn(|j| at(p, i, c) * (at(p, c, j) / own)));
    let mut without = *p;
    for i in 0..N {
        for j in 0..N {
            without[i][j] -= added[i][j];
        }
    }
    let mut seen = product_transposed(&product(t, &without), t);
    for i in 0..N {
        for j in 0..N {
            seen[i][j] += APART * light * light * added[i][j];
        }
    }
    seen
}

/// Mean of |A/A_f|^2 over 0.1 to 2.5 times the natural frequency, weighted by the spectrum of the regressor.
pub(crate) fn in_band<const M: usize>(a: &[f32; M], filter: &[f32; M], bandwidth: f32) -> f32 {
    let first = a.iter().enumerate().find(|(_, v)| **v != 0.0);
    let (first, value) = first.unwrap_or((0, &0.0));
    let natural = pow(value.abs(), 1.0 / (M - first) as f32);
    let natural = if natural > 0.1 * bandwidth && natural < 10.0 * bandwidth {
        natural
    } else {
        bandwidth
    };
    let (mut sum, mut weights) = (0.0, 0.0);
    for step in 0..25 {
        let omega = natural * 0.1 * (step + 1) as f32;
        let ratio = omega / natural;
        let mut power = 1.0;
        for _ in 0..M {
            power *= ratio * ratio;
        }
        let plant = squared(a, omega);
        let shaped = squared(filter, omega);
        // omega^(2m) / |A A_f|^2: the trend of order m of y under a flat command.
        let weight = 1.0 / (plant * shaped * power);
        if weight.is_finite() {
            sum += weight * plant / shaped;
            weights += weight;
        }
    }
    if weights > 0.0 { sum / weights } else { 1.0 }
}

/// |(j omega)^m + sum c_i (j omega)^i|^2, relative to omega^(2m).
fn squared<const M: usize>(coefficients: &[f32; M], omega: f32) -> f32 {
    let (mut re, mut im) = (1.0, 0.0);
    // Horner in 1/(j omega) = -j/omega, from c_{m-1} down: sums stay of order 1.
    let mut terms = [(0.0, 0.0); M];
    let (mut pr, mut pi) = (1.0, 0.0);
    for i in (0..M).rev() {
        let turned = (pi / omega, -pr / omega);
        (pr, pi) = turned;
        terms[i] = (coefficients[i] * pr, coefficients[i] * pi);
    }
    for (r, i) in terms {
        re += r;
        im += i;
    }
    re * re + im * im
}

fn product<const N: usize>(a: &Matrix<N>, b: &Matrix<N>) -> Matrix<N> {
    core::array::from_fn(|i| core::array::from_fn(|j| (0..N).map(|k| a[i][k] * b[k][j]).sum()))
}

fn product_transposed<const N: usize>(a: &Matrix<N>, b: &Matrix<N>) -> Matrix<N> {
    core::array::from_fn(|i| core::array::from_fn(|j| (0..N).map(|k| a[i][k] * b[j][k]).sum()))
}
