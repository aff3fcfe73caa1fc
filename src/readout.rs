//! From the recursion to the numbers the user sees: the noise bias taken out, the uncertainty put in.
//!
//! Least squares with noisy regressors is biased. White noise of variance s on y puts
//! `s M` into every phi phi' and `s m` into every phi psi, where M and m are constants
//! of the filter. With P = (sum phi phi')^-1 over n samples, one step of the correction
//!
//! ```text
//! theta_c = theta + w P (M theta - m)          w = n s / (1 + n s tr P M)
//! P_c     = (I + w P M) P (I + w P M)'
//! sigma^2 = r P_c + what one step leaves + the arithmetic
//! ```
//!
//! takes the bias out to first order, at the read-out only: nothing is added to the
//! 1 ms path but the level s. The residual of the filtered equation is not white: it
//! is `A/A_f` times the noise, and what matters is how much of it lies where the
//! drive moves. r is the mean of `s |A/A_f|^2` weighted by the spectrum of the
//! regressor.

use crate::math::{pow, sqrt};
use crate::regressor::Regressor;
use crate::trend::{NoiseGain, TrendOperator};

/// What the read-out needs of the estimator's state; everything normalised.
pub(crate) struct Evidence<const N: usize> {
    pub(crate) theta: [f32; N],
    pub(crate) covariance: [[f32; N]; N],
    /// Samples in the memory.
    pub(crate) samples: f32,
    /// Variance of the innovation, if there are more samples than parameters.
    pub(crate) residual: Option<f32>,
    /// Variance of the white noise of y that the third difference sees, in units of y squared.
    pub(crate) white: Option<f32>,
    /// Variance of the innovation before there is a residual.
    pub(crate) prior: f32,
}

/// Estimate and covariance in the user's units.
pub(crate) struct Readout<const N: usize> {
    pub(crate) theta: [f32; N],
    pub(crate) covariance: [[f32; N]; N],
}

/// The third difference counts as noise while it does not exceed what the residual allows by this factor.
const PLAUSIBLE: f32 = 1.3;

/// Least share of the noise that counts as in band: the first estimates are too far off to say.
const IN_BAND: f32 = 0.3;

/// What is left without noise, relative to the parameter: the trapezoids and f32, measured on the reference servo.
const ARITHMETIC: f32 = 1e-4;

/// Estimate and covariance with the bias of white noise taken out.
pub(crate) fn read_out<T: TrendOperator<M>, const M: usize, const N: usize>(
    evidence: &Evidence<N>,
    gain: &NoiseGain<M>,
    regressor: &Regressor<M, N>,
    trends: &T,
    bandwidth: f32,
) -> Readout<N> {
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

    let mut unsettled = 0.0;
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
        unsettled = noise * trace / (1.0 + noise * trace);
        let mut drive = [0.0; N];
        for i in 0..N {
            drive[i] = -vector[i];
            for j in 0..N {
                drive[i] += matrix[i][j] * evidence.theta[j];
            }
        }
        // T = I + w P M
        let mut transform = [[0.0; N]; N];
        for i in 0..N {
            for j in 0..N {
                let mut sum = 0.0;
                for k in 0..N {
                    sum += evidence.covariance[i][k] * matrix[k][j];
                }
                transform[i][j] = weight * sum + if i == j { 1.0 } else { 0.0 };
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
    let level = residual_level(
        &theta, residual, white, spread, evidence, regressor, trends, bandwidth,
    );
    for i in 0..N {
        for j in 0..N {
            covariance[i][j] *= level * units[i] * units[j];
        }
    }
    for j in 0..N {
        // What one step of the correction leaves is of the order of its damping; and
        // nothing is known better than the arithmetic.
        let left = unsettled * (theta[j] - evidence.theta[j] * units[j]);
        let arithmetic = ARITHMETIC * theta[j];
        covariance[j][j] += left * left + arithmetic * arithmetic;
    }
    let sound = theta.iter().all(|v| v.is_finite());
    if !sound {
        for j in 0..N {
            theta[j] = evidence.theta[j] * units[j];
        }
    }
    Readout { theta, covariance }
}

/// r: the variance per sample of the part of the residual that looks like the regressor.
#[allow(
    clippy::too_many_arguments,
    reason = "one formula, split off for reading"
)]
fn residual_level<T: TrendOperator<M>, const M: usize, const N: usize>(
    theta: &[f32; N],
    residual: f32,
    white: Option<f32>,
    spread: f32,
    evidence: &Evidence<N>,
    regressor: &Regressor<M, N>,
    trends: &T,
    bandwidth: f32,
) -> f32 {
    let Some(filter) = trends.filter_polynomial() else {
        return residual;
    };
    let a = regressor.denominator(theta);
    let share = in_band(&a, &filter, bandwidth).max(IN_BAND);
    let scale = regressor.top_scale() * regressor.top_scale();
    let Some(white) = white else {
        return residual;
    };
    // What white noise does not explain is slow (drift, friction, a wrong model): about
    // 2/(omega Delta) samples say the same thing. Chance alone makes no excess.
    let chance = 4.0 * sqrt(2.0 / evidence.samples.max(1.0));
    let excess = (residual - white * spread * (1.0 + chance)).max(0.0);
    scale * white * share + excess * 2.0 / (bandwidth * trends.sample_time())
}

/// Mean of |A/A_f|^2 over 0.1 to 2.5 times the natural frequency, weighted by the spectrum of the regressor.
pub(crate) fn in_band<const M: usize>(a: &[f32; M], filter: &[f32; M], bandwidth: f32) -> f32 {
    let first = a.iter().position(|v| *v != 0.0).unwrap_or(0);
    let natural = pow(a[first].abs(), 1.0 / (M - first) as f32);
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

fn product<const N: usize>(a: &[[f32; N]; N], b: &[[f32; N]; N]) -> [[f32; N]; N] {
    core::array::from_fn(|i| core::array::from_fn(|j| (0..N).map(|k| a[i][k] * b[k][j]).sum()))
}

fn product_transposed<const N: usize>(a: &[[f32; N]; N], b: &[[f32; N]; N]) -> [[f32; N]; N] {
    core::array::from_fn(|i| core::array::from_fn(|j| (0..N).map(|k| a[i][k] * b[j][k]).sum()))
}
