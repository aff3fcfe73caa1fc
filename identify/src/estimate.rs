//! A model as values: parameters, covariance, polynomials, physical reading.

use nalgebra::DMatrix;

/// The model at one moment of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Parameters in the order a_i, b_i of each input, constant, start.
    pub theta: Vec<f64>,
    /// Their standard deviations.
    pub sigma: Vec<f64>,
    /// Their covariance.
    pub covariance: Vec<Vec<f64>>,
    /// a_0 .. a_{m-1} of the monic denominator.
    pub a: Vec<f64>,
    /// b_0 .. of each input, as many as the structure has.
    pub b: Vec<Vec<f64>>,
    /// The constant on the right-hand side of the differential equation.
    pub constant: f64,
    /// Gain, omega0 and damping with the first input.
    pub reading: Reading,
    /// Standard deviations of gain, omega0 and damping.
    pub reading_sigma: Option<[f64; 3]>,
}

/// Physical reading of a transfer function of any order.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Static or velocity gain.
    pub gain: Option<f64>,
    /// Natural frequency \[rad/s\].
    pub omega0: Option<f64>,
    /// Damping ratio.
    pub damping: Option<f64>,
    /// Time constants of the real poles \[s\].
    pub time_constants: Vec<f64>,
    /// Poles (re, im) \[rad/s\]; `None` where the iteration did not converge.
    pub poles: Option<Vec<(f64, f64)>>,
    /// Whether the poles behind the integrators are stable.
    pub stable: bool,
}

impl Estimate {
    /// The largest distance of a pole from zero \[rad/s\].
    pub fn fastest(&self) -> f64 {
        let poles = self.reading.poles.iter().flatten();
        poles.fold(0.0, |m, (re, im)| m.max(re.hypot(*im)))
    }

    /// The largest difference of a parameter from another estimate's, in standard deviations.
    pub fn distance(&self, other: &Self) -> f64 {
        let moved = self.theta.iter().zip(&other.theta).zip(&self.sigma);
        moved.fold(0.0, |m, ((x, y), sigma)| m.max((x - y).abs() / sigma))
    }

    /// The differences of all parameters from another estimate's.
    pub(crate) fn moves_from(&self, other: &Self) -> Vec<f64> {
        let pairs = self.theta.iter().zip(&other.theta);
        pairs.map(|(here, there)| here - there).collect()
    }

    /// Standard deviation of a function of the parameters with this gradient: `sqrt(g' P g)`.
    pub fn sigma_of(&self, gradient: &[f64]) -> f64 {
        let rows = self.covariance.iter().zip(gradient);
        let variance = rows.map(|(row, g)| {
            let product = row.iter().zip(gradient).map(|(p, h)| p * h);
            g * product.sum::<f64>()
        });
        variance.sum::<f64>().sqrt()
    }

    /// Correlation of the parameters, n x n; NaN where a standard deviation is 0.
    pub fn correlation(&self) -> DMatrix<f64> {
        let n = self.theta.len();
        DMatrix::from_fn(n, n, |i, j| {
            self.covariance[i][j] / (self.sigma[i] * self.sigma[j])
        })
    }
}
