//! Free simulation of a model in f64: the judge of its fit.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use trendid::trends::Hold;

use crate::estimate::Estimate;
use crate::problem::Problem;
use crate::sampled::{Force, Sampled};

/// Singular values of the columns, each of length one, that count as zero.
const DEPENDENT: f64 = 1e-6;

/// A model run on the inputs alone against a measured output.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeRun {
    /// Simulated output with the initial state refitted.
    pub y: Vec<f64>,
    /// `100 (1 - |y - y_sim| / |y - mean(y)|)`, initial state refitted.
    pub fit_x0: f64,
    /// The same with the constant of the differential equation refitted too.
    pub fit_x0c: f64,
}

impl Problem<'_> {
    /// Simulates samples `range` of the record and compares with the output there; the inputs before
    /// the range serve the delays. Cost: m + 2 simulations and a least-squares fit of m + 1 columns.
    ///
    /// The output is linear in the initial state and in the constant, so both are least-squares fits.
    /// `None` where the model runs away.
    pub fn free_run(
        &self,
        estimate: &Estimate,
        delay: usize,
        range: Range<usize>,
    ) -> Option<FreeRun> {
        let measured = DVector::from_column_slice(&self.signals.output[range.clone()]);
        let order = estimate.a.len();
        let model = Sampled::new(&estimate.a, self.signals.dt);
        let rest = vec![0.0; order];
        let samples = range.len();
        let forces = self.forces(estimate, delay, range, model.rate);
        let forced = model.response(&rest, samples, &forces)?;
        let mut columns = Vec::new();
        for i in 0..order {
            let mut start = rest.clone();
            start[i] = 1.0;
            columns.push(model.response(&start, samples, |_| Force::default())?);
        }
        let error = &measured - &forced;
        let (state, fit_x0) = refit(&columns, &error, &measured)?;
        let y = (forced + state).as_slice().to_vec();
        let mut unit = Force::default();
        unit.now[order - 1] = 1.0;
        unit.next = unit.now;
        columns.push(model.response(&rest, samples, |_| unit)?);
        let (_, fit_x0c) = refit(&columns, &error, &measured)?;
        Some(FreeRun { y, fit_x0, fit_x0c })
    }

    /// What the inputs and the constant add to the derivatives of the state from sample k of the range on.
    fn forces(
        &self,
        estimate: &Estimate,
        delay: usize,
        range: Range<usize>,
        rate: f64,
    ) -> impl Fn(usize) -> Force {
        let order = estimate.a.len();
        let scale = move |power: usize| rate.powi(power as i32 + 1 - order as i32);
        move |k| {
            let mut force = Force::default();
            force.now[order - 1] = estimate.constant * scale(0);
            force.next = force.now;
            for (input, b) in self.signals.inputs.iter().zip(&estimate.b) {
                let delay = if input.delayed { delay } else { 0 };
                // A delayed sample from before the record is its first one.
                let at = |k: usize| input.samples[(range.start + k).saturating_sub(delay)];
                let now = at(k);
                let next = match input.hold {
                    Hold::First => at(k + 1),
                    Hold::Zero => now,
                };
                for (power, b) in b.iter().enumerate() {
                    let b = b * scale(power);
                    force.now[order - 1 - power] += b * now;
                    force.next[order - 1 - power] += b * next;
                }
            }
            force
        }
    }
}

/// The combination of `columns` nearest to `error` in the sense of least squares, and the fit in percent
/// of what remains against the spread of `measured`. Dependent columns share their weight.
fn refit(
    columns: &[DVector<f64>],
    error: &DVector<f64>,
    measured: &DVector<f64>,
) -> Option<(DVector<f64>, f64)> {
    // Columns of length one, so that the bound has no unit.
    let unit: Vec<DVector<f64>> = columns
        .iter()
        .map(|c| c / c.norm().max(f64::MIN_POSITIVE))
        .collect();
    let qr = DMatrix::from_columns(&unit).qr();
    let weights = qr
        .r()
        .svd(true, true)
        .solve(&qr.q().tr_mul(error), DEPENDENT)
        .ok()?;
    let mut combination = DVector::zeros(error.len());
    for (column, weight) in unit.iter().zip(weights.iter()) {
        combination.axpy(*weight, column, 1.0);
    }
    let spread = measured.add_scalar(-measured.mean()).norm();
    let fit = 100.0 * (1.0 - (error - &combination).norm() / spread);
    fit.is_finite().then_some((combination, fit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::Reading;
    use crate::problem::{Options, Structure};
    use crate::signals::{Input, Signals};

    /// A model without covariance.
    fn model(a: &[f64], b: f64, constant: f64) -> Estimate {
        Estimate {
            theta: Vec::new(),
            sigma: Vec::new(),
            covariance: Vec::new(),
            a: a.to_vec(),
            b: vec![vec![b]],
            constant,
            reading: Reading {
                gain: None,
                omega0: None,
                damping: None,
                time_constants: Vec::new(),
                poles: None,
                stable: true,
            },
            reading_sigma: None,
        }
    }

    fn simulated(
        (u, hold): (&[f64], Hold),
        y: &[f64],
        dt: f64,
        model: &Estimate,
        delay: usize,
    ) -> Option<FreeRun> {
        let input = Input {
            name: "u",
            samples: u,
            delayed: true,
            hold,
        };
        let signals = Signals {
            dt,
            output: y,
            inputs: vec![input],
        };
        let structure = Structure {
            order: model.a.len(),
            integrator: true,
            zeros: 0,
            constant: true,
        };
        let problem = Problem::new(&signals, structure, Options::default()).expect("a problem");
        problem.free_run(model, delay, y.len() / 2..y.len())
    }

    #[test]
    fn a_model_fits_its_own_response_from_any_state_and_offset() {
        // y'' + 3 y' = 2 u(t - 3 dt) + 0.4 from y = 5, y' = -1, by its velocity: v' = -3 v + f.
        let dt = 0.01;
        let u: Vec<f64> = (0..600)
            .map(|k| if (k / 70) % 2 == 0 { 1.0 } else { -0.7 })
            .collect();
        let (mut y, mut v, decay) = (vec![5.0], -1.0_f64, (-3.0_f64 * dt).exp());
        for k in 0..599_usize {
            let end = (2.0 * u[k.saturating_sub(3)] + 0.4) / 3.0;
            y.push(y[k] + end * dt + (v - end) * (1.0 - decay) / 3.0);
            v = end + (v - end) * decay;
        }
        let run = |constant, delay| {
            let model = model(&[0.0, 3.0], 2.0, constant);
            simulated((&u, Hold::Zero), &y, dt, &model, delay).expect("a simulation")
        };
        let exact = run(0.4, 3);
        assert!(exact.fit_x0 > 99.999_999, "{}", exact.fit_x0);
        assert!((exact.y[299] - y[599]).abs() < 1e-8);
        // The constant is refitted for the second figure only.
        let without = run(0.0, 3);
        assert!(without.fit_x0 < 90.0 && without.fit_x0c > 99.999_999);
        assert!(run(0.4, 0).fit_x0c < 99.5);
        // What runs away is not a fit.
        let unstable = model(&[-1.0, -5e3], 2.0, 0.4);
        assert_eq!(simulated((&u, Hold::Zero), &y, dt, &unstable, 3), None);
        let overflowing = model(&[f64::MAX, f64::MAX], 2.0, 0.4);
        assert_eq!(simulated((&u, Hold::Zero), &y, dt, &overflowing, 3), None);
    }

    #[test]
    fn a_first_order_hold_goes_straight_to_the_next_sample() {
        // y' = u with u = t: the straight line is exact, the held one is not.
        let dt = 0.1;
        let t: Vec<f64> = (0..200).map(|k| f64::from(k) * dt).collect();
        let y: Vec<f64> = t.iter().map(|t| 0.5 * t * t).collect();
        let model = model(&[0.0], 1.0, 0.0);
        let fit = |hold| simulated((&t, hold), &y, dt, &model, 0).expect("a simulation");
        assert!(fit(Hold::First).fit_x0 > 99.999_999);
        assert!(fit(Hold::Zero).fit_x0 < 99.9);
    }

    #[test]
    fn the_refit_is_a_projection_whatever_the_columns() {
        let t = DVector::from_fn(50, |k, _| k as f64);
        let one = DVector::from_element(50, 1.0);
        let target = t.map(|t| 3.0 - 0.25 * t);
        let noise = DVector::from_fn(50, |k, _| if k % 2 == 0 { 1.0 } else { -1.0 });
        // A column that repeats another one changes nothing, nor does one of zeros.
        let columns = [t.clone(), one.clone(), t.clone(), DVector::zeros(50)];
        let (found, fit) = refit(&columns, &target, &target).expect("a fit");
        assert!((found - &target).amax() < 1e-9 && fit > 99.999_999);
        let (found, _) = refit(&columns, &noise, &target).expect("a fit");
        let left = &noise - found;
        assert!(left.dot(&one).abs() < 1e-9 && left.dot(&t).abs() < 1e-7);
    }
}
