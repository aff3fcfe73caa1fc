//! What changes within a sample, because the delay of an input is not of whole samples.
//!
//! Held: with a part f of a sample, `E = int_0^h e^(A t) dt` and `E_f = int_((1-f)h)^h e^(A t) dt`
//! the state of the denominator A has moved at the next sample by `E b u(k-w) + E_f b (u(k-w-1) -
//! u(k-w))`. Both are functions of A and commute with it, so that
//!
//! ```text
//! N_j u(t - d h) = N_j (u + f du) + sum_i W_ji N_i du     du = u(k-w-1) - u(k-w)
//! W = E_f E^-1 - f       about f (1 - f) h A / 2
//! ```
//!
//! over the filter, `N_j` the numerators of `s^j/A` for what is held over whole samples. Without W
//! the input is taken by its mean over the sample.
//!
//! Straight from sample to sample: the corner lies within, at the part f. From the straight line
//! through what is at the samples, `u + f du`, the input is away by a triangle of height
//! `f (1 - f) c`, `c = 2 u(k-w) - u(k-w-1) - u(k-w+1)`. With `R(t) = int_0^t e^(A s) (t - s) ds`,
//! what a ramp of slope 1 makes of the state, the triangle adds as much as, held,
//!
//! ```text
//! sum_i W_ji N_i c       W = ((1 - f) R(h) - R((1 - f) h)) / h  E^-1       about f (1 - f) / 2
//! ```

use nalgebra::DMatrix;
use trendid::trends::Hold;

use crate::instruments::lanes::{Design, Lane};
use crate::instruments::later::steps;
use crate::signals::{Input, Signals};

/// What the change within a sample adds to the trends of an input.
pub(super) struct Within {
    samples: Vec<f32>,
    trends: Box<dyn Lane>,
    weights: DMatrix<f64>,
}

impl Within {
    /// `None` at a delay of whole samples.
    pub(super) fn of(
        (signals, input): (&Signals, &Input),
        delay: f64,
        model: &[f64],
        design: &dyn Design,
    ) -> Option<Self> {
        let part = delay - delay.floor();
        if part == 0.0 {
            return None;
        }
        let weights = weights(model, signals.dt, part, input.hold)?;
        Some(match input.hold {
            Hold::First => Self {
                samples: corners(signals, input, delay),
                trends: design.of_input(Hold::Zero),
                weights,
            },
            hold => Self {
                samples: steps(signals, input, delay),
                trends: design.of_input(hold),
                weights,
            },
        })
    }

    /// Its part of the regressors at sample `k`; every sample in turn.
    pub(super) fn add(&mut self, k: usize, phi: &mut [f64]) {
        let trends = self.trends.input(self.samples[k]);
        for (j, phi) in phi.iter_mut().enumerate() {
            let row = self.weights.row(j);
            *phi += row.iter().zip(&trends).map(|(w, t)| w * t).sum::<f64>();
        }
    }
}

/// The change of slope within a sample, times minus its length, of an input `delay` samples late:
/// `2 u(k) - u(k-1) - u(k+1)` of its whole samples.
fn corners(signals: &Signals, input: &Input, delay: f64) -> Vec<f32> {
    let whole = delay.floor() as usize;
    let last = input.samples.len() - 1;
    let at = |k: usize| input.samples[k.saturating_sub(whole).min(last)];
    let before = |k: usize| input.samples[k.saturating_sub(whole + 1)];
    let corner = |k: usize| signals.acting(k, 2.0 * at(k) - before(k) - at(k + 1)) as f32;
    (0..=last).map(corner).collect()
}

/// `int_0^t e^(A s) ds` and `int_0^t e^(A s) (t - s) ds` of a matrix.
fn integrals(a: &DMatrix<f64>, t: f64) -> Option<[DMatrix<f64>; 2]> {
    let m = a.nrows();
    let mut block = DMatrix::zeros(3 * m, 3 * m);
    block.view_mut((0, 0), (m, m)).copy_from(&(a * t));
    block.view_mut((0, m), (m, m)).fill_diagonal(t);
    block.view_mut((m, 2 * m), (m, m)).fill_diagonal(t);
    // Scaling and squaring does not end with what is not finite.
    let finite = block.iter().all(|v| v.is_finite());
    let of = |exp: &DMatrix<f64>, first| exp.view((0, first), (m, m)).into_owned();
    finite.then(|| {
        let exp = block.exp();
        [of(&exp, m), of(&exp, 2 * m)]
    })
}

/// As a function of A, what is held over a sample and makes as much of the state as the value
/// before, `E_f E^-1`, or as a corner within: the W of straight inputs.
pub(crate) fn share(a: &DMatrix<f64>, dt: f64, part: f64, hold: Hold) -> Option<DMatrix<f64>> {
    let [whole, ramp] = integrals(a, dt)?;
    let [rest, of_rest] = integrals(a, (1.0 - part) * dt)?;
    let of_part = match hold {
        Hold::First => (ramp * (1.0 - part) - of_rest) / dt,
        _ => &whole - rest,
    };
    Some(of_part * whole.try_inverse()?)
}

/// What the trends take of that change without weights.
fn taken(part: f64, hold: Hold) -> f64 {
    match hold {
        Hold::First => 0.0,
        _ => part,
    }
}

/// Samples in which the fastest rate of a denominator moves its state, at most: slower ones are
/// integrators within a sample, to a millionth, and a scale must not be zero.
const SLOWEST: f64 = 1e6;

fn weights(model: &[f64], dt: f64, part: f64, hold: Hold) -> Option<DMatrix<f64>> {
    let m = model.len();
    // In units of the fastest rate, so that all derivatives are of one size.
    let of_order = |i: usize| model[m - i].abs().powf(1.0 / i as f64);
    let rate = (1..=m).map(of_order).fold(1.0 / (SLOWEST * dt), f64::max);
    let companion = DMatrix::from_fn(m, m, |i, j| match i + 1 == m {
        true => -model[j] / rate.powi((m - j) as i32),
        false => f64::from(u8::from(j == i + 1)),
    });
    let share = share(&companion, rate * dt, part, hold)?;
    let taken = taken(part, hold);
    Some(DMatrix::from_fn(m, m, |i, j| {
        let taken = if i == j { taken } else { 0.0 };
        (share[(i, j)] - taken) * rate.powi(i as i32 - j as i32)
    }))
}
