//! An input that is held and changes within a sample, because its delay is not of whole samples.
//!
//! With a part f of a sample, `E = int_0^h e^(A t) dt` and `E_f = int_((1-f)h)^h e^(A t) dt` the
//! state of the denominator A has moved at the next sample by `E b u(k-w) + E_f b (u(k-w-1) -
//! u(k-w))`. Both are functions of A and commute with it, so that
//!
//! ```text
//! N_j u(t - d h) = N_j (u + f du) + sum_i W_ji N_i du     du = u(k-w-1) - u(k-w)
//! W = E_f E^-1 - f       about f (1 - f) h A / 2
//! ```
//!
//! over the filter, `N_j` the numerators of `s^j/A` for what is held over whole samples. Without W
//! the input is taken by its mean over the sample.

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
    /// `None` at a delay of whole samples, and for what goes straight between samples.
    pub(super) fn of(
        (signals, input): (&Signals, &Input),
        delay: f64,
        model: &[f64],
        design: &dyn Design,
    ) -> Option<Self> {
        let part = delay - delay.floor();
        if part == 0.0 || input.hold == Hold::First {
            return None;
        }
        Some(Self {
            samples: steps(signals, input, delay),
            trends: design.of_input(input.hold),
            weights: weights(model, signals.dt, part)?,
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

/// `int_0^t e^(A s) ds` of a matrix.
pub(crate) fn integral(a: &DMatrix<f64>, t: f64) -> Option<DMatrix<f64>> {
    let m = a.nrows();
    let mut block = DMatrix::zeros(2 * m, 2 * m);
    block.view_mut((0, 0), (m, m)).copy_from(&(a * t));
    block.view_mut((0, m), (m, m)).fill_diagonal(t);
    // Scaling and squaring does not end with what is not finite.
    let finite = block.iter().all(|v| v.is_finite());
    finite.then(|| block.exp().view((0, m), (m, m)).into_owned())
}

/// `E_f E^-1`: the share of a sample that the value before has, as a function of A.
pub(crate) fn share(a: &DMatrix<f64>, dt: f64, part: f64) -> Option<DMatrix<f64>> {
    let whole = integral(a, dt)?;
    let of_part = &whole - integral(a, (1.0 - part) * dt)?;
    Some(of_part * whole.try_inverse()?)
}

/// Samples in which the fastest rate of a denominator moves its state, at most: slower ones are
/// integrators within a sample, to a millionth, and a scale must not be zero.
const SLOWEST: f64 = 1e6;

fn weights(model: &[f64], dt: f64, part: f64) -> Option<DMatrix<f64>> {
    let m = model.len();
    // In units of the fastest rate, so that all derivatives are of one size.
    let of_order = |i: usize| model[m - i].abs().powf(1.0 / i as f64);
    let rate = (1..=m).map(of_order).fold(1.0 / (SLOWEST * dt), f64::max);
    let companion = DMatrix::from_fn(m, m, |i, j| match i + 1 == m {
        true => -model[j] / rate.powi((m - j) as i32),
        false => f64::from(u8::from(j == i + 1)),
    });
    let share = share(&companion, rate * dt, part)?;
    Some(DMatrix::from_fn(m, m, |i, j| {
        let mean = if i == j { part } else { 0.0 };
        (share[(i, j)] - mean) * rate.powi(i as i32 - j as i32)
    }))
}
