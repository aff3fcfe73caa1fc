//! Offline output-error fit: the free simulation of a linear plant brought as near to a record as
//! it goes.
//!
//! Levenberg-Marquardt with exact sensitivities. For white noise of the output this is the
//! maximum-likelihood estimate: on a long record its deviation is the Cramer-Rao bound. It needs
//! the whole record and a start near the truth, and serves as the comparison an online estimate
//! cannot be expected to beat.

use nalgebra::{DMatrix, DVector};

use crate::oracles::cramer_rao::{Coefficient, Sensitivity};
use crate::plants::linear::{Input, LinearPlant};

/// Result of an output-error fit.
#[derive(Clone, Debug)]
pub struct OutputErrorFit {
    /// Fitted plant, in its fitted initial state.
    pub plant: LinearPlant,
    /// Fitted values of the free coefficients, in their order.
    pub theta: Vec<f64>,
    /// Covariance of `theta` with the noise variance taken from the residuals.
    pub covariance: DMatrix<f64>,
    /// Simulated output.
    pub y: Vec<f64>,
    /// Standard deviation of the residuals.
    pub residual: f64,
    /// Accepted and refused iterations.
    pub iterations: usize,
    /// Whether the last step was below a part in 1e8 of every coefficient's deviation or changed
    /// nothing.
    pub converged: bool,
}

/// What is varied during the fit.
#[derive(Clone)]
struct Model {
    a: Vec<f64>,
    inputs: Vec<Input>,
    constant: f64,
    initial: Vec<f64>,
    dt: f64,
}

impl Model {
    fn value(&mut self, coefficient: Coefficient) -> &mut f64 {
        match coefficient {
            Coefficient::A(i) => &mut self.a[i],
            Coefficient::B { input, power } => &mut self.inputs[input].b[power],
            Coefficient::Constant => &mut self.constant,
            Coefficient::Initial(i) => &mut self.initial[i],
        }
    }

    fn plant(&self) -> Option<LinearPlant> {
        LinearPlant::with_inputs(&self.a, &self.inputs, self.constant, self.dt).ok()
    }

    fn simulated(&self, free: &[Coefficient], u: &[&[f64]]) -> Option<Sensitivity> {
        Some(Sensitivity::simulate(
            &self.plant()?,
            free,
            &self.initial,
            u,
        ))
    }
}

/// Fits the coefficients `free` of `start` to the output `y` of the held inputs `u`; the rest stays
/// as it is.
///
/// `initial` are output and derivatives at the first sample for zero inputs before it; those named
/// in `free` are fitted. Nothing when the record does not determine the coefficients or the start
/// cannot be simulated.
///
/// # Panics
/// When lengths or indices do not fit the plant.
pub fn output_error(
    start: &LinearPlant,
    free: &[Coefficient],
    initial: &[f64],
    u: &[&[f64]],
    y: &[f64],
) -> Option<OutputErrorFit> {
    let model = Model {
        a: start.a().to_vec(),
        inputs: start.inputs().to_vec(),
        constant: start.constant(),
        initial: initial.to_vec(),
        dt: start.dt(),
    };
    let record = Records { free, u, y };
    let mut point = Point::of(model, &record).filter(|point| point.loss.is_finite())?;
    let mut damping = 1e-3;
    let mut converged = false;
    let mut iterations = 0;
    while iterations < 100 && !converged {
        iterations += 1;
        let (next, small) = point.step(damping, &record)?;
        if let Some(next) = next.filter(|next| next.loss <= point.loss) {
            converged = small || point.loss - next.loss <= 1e-14 * point.loss;
            point = next;
            damping = (damping * 0.1).max(1e-15);
        } else {
            converged = small;
            damping *= 10.0;
        }
    }
    let freedom = y.len().saturating_sub(free.len()).max(1);
    let residual = (point.loss / freedom as f64).sqrt();
    let covariance = point.simulated.covariance(residual)?;
    let mut model = point.model;
    let mut plant = model.plant()?;
    plant.place(&model.initial);
    Some(OutputErrorFit {
        plant,
        theta: free.iter().map(|&c| *model.value(c)).collect(),
        covariance,
        y: point.simulated.y,
        residual,
        iterations,
        converged,
    })
}

/// What is fitted to what.
struct Records<'a> {
    free: &'a [Coefficient],
    u: &'a [&'a [f64]],
    y: &'a [f64],
}

/// A model with its simulation and what that misses.
struct Point {
    model: Model,
    simulated: Sensitivity,
    error: DVector<f64>,
    /// Sum of the squared errors.
    loss: f64,
}

impl Point {
    fn of(model: Model, record: &Records) -> Option<Self> {
        let simulated = model.simulated(record.free, record.u)?;
        let error = DVector::from_column_slice(record.y) - DVector::from_column_slice(&simulated.y);
        Some(Self {
            loss: error.norm_squared(),
            model,
            simulated,
            error,
        })
    }

    /// A step of Levenberg and Marquardt, and whether it is too small to matter; no point where it
    /// cannot be simulated.
    ///
    /// Nothing when the record does not determine the coefficients.
    fn step(&self, damping: f64, record: &Records) -> Option<(Option<Self>, bool)> {
        let p = record.free.len();
        let mut scaled = self.simulated.jacobian.clone();
        let lengths: Vec<f64> = scaled.column_iter().map(|c| c.norm()).collect();
        if lengths.iter().any(|l| *l <= 0.0 || !l.is_finite()) {
            return None;
        }
        for (mut column, l) in scaled.column_iter_mut().zip(&lengths) {
            column /= *l;
        }
        let normal = scaled.tr_mul(&scaled) + DMatrix::identity(p, p) * damping;
        let step = normal.cholesky()?.solve(&scaled.tr_mul(&self.error));
        let mut next = self.model.clone();
        for (i, &coefficient) in record.free.iter().enumerate() {
            *next.value(coefficient) += step[i] / lengths[i];
        }
        // In scaled coordinates a deviation is residual / length of a unit column.
        let deviation = (self.loss / record.y.len() as f64).sqrt();
        let small = step.amax() <= 1e-8 * deviation + 1e-14;
        Some((Self::of(next, record), small))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plants::servo::Servo;
    use crate::signals::experiment::Experiment;
    use crate::signals::noise::Condition;

    const SERVO: [Coefficient; 3] = [
        Coefficient::A(1),
        Coefficient::A(2),
        Coefficient::B { input: 0, power: 0 },
    ];

    fn start() -> LinearPlant {
        Servo {
            c: 2000.0,
            omega0: 25.0,
            xi: 0.8,
        }
        .plant(1e-3)
    }

    #[test]
    fn noise_free_record_gives_the_truth() {
        let record = Experiment::reference(Condition::CLEAN, 1.0).record(1);
        let fit = output_error(&start(), &SERVO, &[0.0; 3], &[&record.u], &record.y).unwrap();
        assert!(fit.converged, "{} iterations", fit.iterations);
        for (got, want) in fit.theta.iter().zip([400.0, 20.0, 1e6]) {
            assert!((got / want - 1.0).abs() < 1e-9, "{got} {want}");
        }
    }

    #[test]
    fn initial_state_and_constant_are_fitted() {
        let inputs = [Input::delayed(&[50.0, 2.0], 3)];
        let mut plant = LinearPlant::with_inputs(&[90.0, 6.0], &inputs, 4.0, 2e-3).unwrap();
        plant.place(&[0.4, -2.0]);
        let u = crate::signals::excitation::Excitation::ABSOLUTE.sequence(2000, 2e-3, 4);
        let y = plant.clone().response(&u);
        let guess = [Input::delayed(&[40.0, 1.0], 3)];
        let guess = LinearPlant::with_inputs(&[80.0, 8.0], &guess, 0.0, 2e-3).unwrap();
        let free = [
            Coefficient::A(0),
            Coefficient::A(1),
            Coefficient::B { input: 0, power: 0 },
            Coefficient::B { input: 0, power: 1 },
            Coefficient::Constant,
            Coefficient::Initial(0),
            Coefficient::Initial(1),
        ];
        let mut fit = output_error(&guess, &free, &[0.0; 2], &[&u], &y).unwrap();
        let truth = [90.0, 6.0, 50.0, 2.0, 4.0, 0.4, -2.0];
        for (got, want) in fit.theta.iter().zip(truth) {
            assert!((got - want).abs() < 1e-7 * f64::abs(want), "{got} {want}");
        }
        let again = fit.plant.response(&u);
        assert!(again.iter().zip(&y).all(|(a, b)| (a - b).abs() < 1e-8));
    }

    #[test]
    fn a_record_without_excitation_is_refused() {
        assert!(output_error(&start(), &SERVO, &[0.0; 3], &[&[0.0; 50]], &[0.0; 50]).is_none());
    }
}
