//! Free simulation of a model in f64: the judge of its fit.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use trendid::trends::Hold;

use crate::estimate::Estimate;
use crate::polynomials::Polynomials;
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

/// A free simulation with what its error is measured by.
pub(crate) struct Simulation {
    /// Simulated output with the initial state refitted.
    pub y: Vec<f64>,
    /// Sums of the squared error: initial state refitted; and the constant too.
    pub squares: [f64; 2],
    /// Sum of the squared distance of the output from its mean.
    pub spread: f64,
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
        delay: f64,
        range: Range<usize>,
    ) -> Option<FreeRun> {
        let model = Polynomials {
            a: estimate.a.clone(),
            b: estimate.b.clone(),
            constant: estimate.constant,
        };
        let Simulation { y, squares, spread } = self.simulate(&model, delay, range)?;
        let [fit_x0, fit_x0c] = squares.map(|squares| 100.0 * (1.0 - (squares / spread).sqrt()));
        (fit_x0.is_finite() && fit_x0c.is_finite()).then_some(FreeRun { y, fit_x0, fit_x0c })
    }

    /// The simulation behind [`free_run`](Self::free_run). A standstill holds the state and does not count.
    pub(crate) fn simulate(
        &self,
        model: &Polynomials,
        delay: f64,
        range: Range<usize>,
    ) -> Option<Simulation> {
        let signals = self.signals;
        let acts = |k: usize| f64::from(u8::from(signals.acts(range.start + k)));
        let counted = |y: DVector<f64>| match signals.standstill {
            Some(_) => DVector::from_fn(y.len(), |k, _| y[k] * acts(k)),
            None => y,
        };
        let all = DVector::from_column_slice(&signals.output[range.clone()]);
        let order = model.a.len();
        let sampled = Sampled::new(&model.a, signals.dt);
        let rest = vec![0.0; order];
        let samples = range.len();
        let still = |k: usize| !signals.acts(range.start + k);
        let forces = self.forces(model, delay, range.clone(), sampled.rate);
        let forced = sampled.response(&rest, samples, &forces, still)?;
        let mut states = Vec::new();
        for i in 0..order {
            let mut start = rest.clone();
            start[i] = 1.0;
            states.push(sampled.response(&start, samples, |_| Force::default(), still)?);
        }
        let unit = |k: usize| {
            let mut force = Force::default();
            force.now[order - 1] = acts(k);
            force.next = force.now;
            force
        };
        let offset = counted(sampled.response(&rest, samples, unit, still)?);
        let error = counted(&all - &forced);
        let mut columns: Vec<DVector<f64>> = states.iter().cloned().map(counted).collect();
        let (weights, x0) = refit(&columns, &error)?;
        columns.push(offset);
        let (_, x0c) = refit(&columns, &error)?;
        let mut y = forced;
        for (state, weight) in states.iter().zip(&weights) {
            y.axpy(*weight, state, 1.0);
        }
        let moving = (0..samples).filter(|k| !still(*k));
        let n = moving.clone().count().max(1) as f64;
        let mean = moving.clone().map(|k| all[k]).sum::<f64>() / n;
        Some(Simulation {
            y: y.as_slice().to_vec(),
            squares: [x0, x0c],
            spread: moving.map(|k| (all[k] - mean).powi(2)).sum(),
        })
    }

    /// What the inputs and the constant add to the derivatives of the state from sample k of the range on.
    fn forces(
        &self,
        model: &Polynomials,
        delay: f64,
        range: Range<usize>,
        rate: f64,
    ) -> impl Fn(usize) -> Force {
        let order = model.a.len();
        let scale = move |power: usize| rate.powi(power as i32 + 1 - order as i32);
        let (whole, part) = (delay.floor() as usize, delay - delay.floor());
        move |k| {
            let mut force = Force::default();
            if self.signals.acts(range.start + k) {
                force.now[order - 1] = model.constant * scale(0);
            }
            force.next = force.now;
            for (input, b) in self.signals.inputs.iter().zip(&model.b) {
                let (whole, part) = if input.delayed {
                    (whole, part)
                } else {
                    (0, 0.0)
                };
                // A delayed sample from before the record is its first one.
                let at = |k: usize| {
                    let k = range.start + k;
                    let u = input.samples[k.saturating_sub(whole)];
                    match part {
                        0.0 => u,
                        _ => u + part * (input.samples[k.saturating_sub(whole + 1)] - u),
                    }
                };
                let (now, next) = match input.hold {
                    Hold::First => (at(k), at(k + 1)),
                    Hold::Zero => (at(k), at(k)),
                    Hold::Mean => (at(k + 1), at(k + 1)),
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

/// The weights of the combination of `columns` nearest to `error` in the sense of least squares, and the sum of the
/// squares of what remains. Dependent columns share their weight.
fn refit(columns: &[DVector<f64>], error: &DVector<f64>) -> Option<(Vec<f64>, f64)> {
    // Columns of length one, so that the bound has no unit.
    let lengths: Vec<f64> = columns
        .iter()
        .map(|c| c.norm().max(f64::MIN_POSITIVE))
        .collect();
    let unit: Vec<DVector<f64>> = columns.iter().zip(&lengths).map(|(c, l)| c / *l).collect();
    let qr = DMatrix::from_columns(&unit).qr();
    let weights = qr
        .r()
        .svd(true, true)
        .solve(&qr.q().tr_mul(error), DEPENDENT)
        .ok()?;
    let mut left = error.clone();
    for (column, weight) in unit.iter().zip(weights.iter()) {
        left.axpy(-*weight, column, 1.0);
    }
    let squares = left.norm_squared();
    let weights = weights.iter().zip(&lengths).map(|(w, l)| w / l).collect();
    squares.is_finite().then_some((weights, squares))
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
            standstill: None,
        };
        let structure = Structure {
            order: model.a.len(),
            integrator: true,
            zeros: 0,
            constant: true,
        };
        let problem = Problem::new(&signals, structure, Options::default()).expect("a problem");
        problem.free_run(model, delay as f64, y.len() / 2..y.len())
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
        let combined = |weights: &[f64]| {
            let parts = columns.iter().zip(weights).map(|(c, w)| c * *w);
            parts.fold(DVector::zeros(50), |sum, part| sum + part)
        };
        let (weights, squares) = refit(&columns, &target).expect("a fit");
        assert!((combined(&weights) - &target).amax() < 1e-9 && squares < 1e-15);
        let (weights, squares) = refit(&columns, &noise).expect("a fit");
        let left = &noise - combined(&weights);
        assert!((left.norm_squared() / squares - 1.0).abs() < 1e-9);
        assert!(left.dot(&one).abs() < 1e-9 && left.dot(&t).abs() < 1e-7);
    }
}
