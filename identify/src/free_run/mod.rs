//! Free simulation of a model in f64: the judge of its fit.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use trendid::trends::Hold;

use crate::estimate::Estimate;
use crate::folds::Refitted;
use crate::polynomials::Polynomials;
use crate::problem::Problem;
use crate::sampled::{Force, Sampled};

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
    /// The errors.
    pub left: [DVector<f64>; 2],
    /// Sum of the squared distance of the output from its mean.
    pub spread: f64,
}

impl Problem<'_> {
    /// Simulates samples `range` of the record and compares with the output there; the inputs
    /// before the range serve the delays. Cost: m + 2 simulations and a least-squares fit of m + 1
    /// columns.
    ///
    /// The output is linear in the initial state and in the constant, so both are least-squares
    /// fits. `None` where the model runs away.
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
        let Simulation {
            y, squares, spread, ..
        } = self.simulate(&model, delay, range)?;
        let [fit_x0, fit_x0c] = squares.map(|squares| 100.0 * (1.0 - (squares / spread).sqrt()));
        (fit_x0.is_finite() && fit_x0c.is_finite()).then_some(FreeRun { y, fit_x0, fit_x0c })
    }

    /// The simulation behind [`free_run`](Self::free_run). A standstill holds the state and does
    /// not count.
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
        let forces = self.forces(model, delay, range.clone(), &sampled);
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
        let (weights, of_x0) = refit(&columns, &error)?;
        columns.push(offset);
        // With one column more nothing is further away, whatever is cut off.
        let (_, of_x0c) = refit(&columns, &error)?;
        let x0 = of_x0.norm_squared();
        let x0c = of_x0c.norm_squared().min(x0);
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
            left: [of_x0, of_x0c],
            spread: moving.map(|k| (all[k] - mean).powi(2)).sum(),
        })
    }

    /// What such a simulation leaves of the output, where the drive moves.
    pub(crate) fn left(
        &self,
        model: &Polynomials,
        delay: f64,
        range: Range<usize>,
        refitted: Refitted,
    ) -> Option<Vec<f64>> {
        let [state, both] = self.simulate(model, delay, range.clone())?.left;
        let left = match refitted {
            Refitted::State => state,
            Refitted::StateAndConstant => both,
        };
        let moving = range.zip(&left).filter(|(k, _)| self.signals.acts(*k));
        Some(moving.map(|(_, left)| *left).collect())
    }

    /// What the inputs and the constant add to the derivatives of the state from sample k of the
    /// range on.
    fn forces(
        &self,
        model: &Polynomials,
        delay: f64,
        range: Range<usize>,
        sampled: &Sampled,
    ) -> impl Fn(usize) -> Force {
        let order = model.a.len();
        let scale = |power: usize| sampled.rate.powi(power as i32 + 1 - order as i32);
        let constant = model.constant * scale(0);
        let (whole, part) = (delay.floor() as usize, delay - delay.floor());
        // Of each input its force, and that of what changes within a sample.
        let inputs = self.signals.inputs.iter();
        let forces: Vec<_> = inputs
            .zip(&model.b)
            .map(|(input, b)| {
                let mut force = Force::default().now;
                for (power, b) in b.iter().enumerate() {
                    force[order - 1 - power] = b * scale(power);
                }
                (force, sampled.before(part, input.hold, force))
            })
            .collect();
        move |k| {
            let mut force = Force::default();
            if !self.signals.acts(range.start + k) {
                return force;
            }
            force.now[order - 1] = constant;
            force.next = force.now;
            for (input, (all, before)) in self.signals.inputs.iter().zip(&forces) {
                let (whole, part) = if input.delayed {
                    (whole, part)
                } else {
                    (0, 0.0)
                };
                // A delayed sample from before the record is its first one.
                let at = |k: usize, d: usize| input.samples[(range.start + k).saturating_sub(d)];
                let corner = match (input.hold, part > 0.0) {
                    (Hold::First, true) => 2.0 * at(k, whole) - at(k, whole + 1) - at(k + 1, whole),
                    _ => 0.0,
                };
                let mut add = |now: usize, next: usize| {
                    for (slot, k) in [(&mut force.now, now), (&mut force.next, next)] {
                        let u = at(k, whole);
                        let step = match part {
                            0.0 => 0.0,
                            _ => at(k, whole + 1) - u,
                        };
                        for i in 0..order {
                            let late = match input.hold {
                                Hold::First => part * all[i] * step + before[i] * corner,
                                _ => before[i] * step,
                            };
                            slot[i] += all[i] * u + late;
                        }
                    }
                };
                match input.hold {
                    Hold::First => add(k, k + 1),
                    Hold::Zero => add(k, k),
                    Hold::Mean => add(k + 1, k + 1),
                }
            }
            force
        }
    }
}

/// The weights of the combination of `columns` nearest to `error` in the sense of least squares,
/// and what remains. Dependent columns share their weight.
///
/// Dependent are those within rounding: singular values below as many units of it as there are
/// samples, each of which is one step of the simulation (Golub and Van Loan, Matrix Computations,
/// section 5.5: numerical rank).
fn refit(columns: &[DVector<f64>], error: &DVector<f64>) -> Option<(Vec<f64>, DVector<f64>)> {
    // Columns of length one, so that the bound has no unit.
    let lengths: Vec<f64> = columns
        .iter()
        .map(|c| c.norm().max(f64::MIN_POSITIVE))
        .collect();
    let unit: Vec<DVector<f64>> = columns.iter().zip(&lengths).map(|(c, l)| c / *l).collect();
    let qr = DMatrix::from_columns(&unit).qr();
    let (q, svd) = (qr.q(), qr.r().svd(true, true));
    let dependent = error.len() as f64 * f64::EPSILON * svd.singular_values.max();
    let within = q.tr_mul(error);
    let weights = svd.solve(&within, dependent).ok()?;
    // By the directions and not by the weights, whose rounding is larger by what they cancel.
    let mut left = error.clone();
    let directions = svd.u.as_ref()?.column_iter().zip(&svd.singular_values);
    for (direction, _) in directions.filter(|(_, value)| **value > dependent) {
        left.gemv(-direction.dot(&within), &q, &direction, 1.0);
    }
    let finite = left.norm_squared().is_finite();
    let weights = weights.iter().zip(&lengths).map(|(w, l)| w / l).collect();
    finite.then_some((weights, left))
}

#[cfg(test)]
mod tests;
