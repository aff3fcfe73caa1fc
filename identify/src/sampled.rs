//! A denominator, sampled without error for inputs that are held or go straight to the next sample.
//!
//! The state is that of the observer form, each entry related to a power of a rate `r`, so that all
//! are of one size however fast the plant is:
//!
//! ```text
//! x1' = r (x2 - alpha_1 x1) + b_{m-1} u         alpha_i = a_{m-i} / r^i
//! ...                                           r = max |a_{m-i}|^(1/i)
//! xm' = r (   - alpha_m x1) + b_0 u / r^(m-1)   y = x1
//! ```

use nalgebra::{DMatrix, DVector};
use trendid::trends::Hold;

use crate::instruments::share;

/// Highest order.
const ORDER: usize = 4;

/// One step of the state.
type Step = [[f64; ORDER]; ORDER];

/// What acts on the derivatives of the state, at a sample and at the next.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Force {
    pub now: [f64; ORDER],
    pub next: [f64; ORDER],
}

/// A denominator, sampled.
pub(crate) struct Sampled {
    order: usize,
    dt: f64,
    /// The rate `r` \[rad/s\].
    pub rate: f64,
    /// `alpha_1 ..` of the state equations.
    alpha: [f64; ORDER],
    /// `x(k+1) = free x(k) + held now + rising (next - now)`.
    free: Step,
    held: Step,
    rising: Step,
}

impl Sampled {
    pub(crate) fn new(a: &[f64], dt: f64) -> Self {
        let m = a.len();
        let of_order = |i: usize| a[m - i].abs().powf(1.0 / i as f64);
        let largest = (1..=m).map(of_order).fold(0.0, f64::max);
        let rate = if largest > 0.0 { largest } else { 1.0 / dt };
        // d/dt [x; now; next - now], the last as a ramp over the interval.
        let mut block = DMatrix::zeros(3 * m, 3 * m);
        let mut alpha = [0.0; ORDER];
        for i in 0..m {
            alpha[i] = a[m - 1 - i] / rate.powi(i as i32 + 1);
            block[(i, 0)] = -alpha[i] * rate * dt;
            if i + 1 < m {
                block[(i, i + 1)] = rate * dt;
            }
            block[(i, m + i)] = dt;
            block[(m + i, 2 * m + i)] = 1.0;
        }
        // Scaling and squaring does not end with what is not finite.
        let step = if block.iter().all(|v| v.is_finite()) {
            block.exp()
        } else {
            block
        };
        let part = |first: usize| {
            let mut part = [[0.0; ORDER]; ORDER];
            for (i, row) in part.iter_mut().enumerate().take(m) {
                for (j, v) in row.iter_mut().enumerate().take(m) {
                    *v = step[(i, first + j)];
                }
            }
            part
        };
        Self {
            order: m,
            dt,
            rate,
            alpha,
            free: part(0),
            held: part(m),
            rising: part(2 * m),
        }
    }

    /// What acts on the derivatives of the state for the part of a sample until an input changes,
    /// or what a corner there adds, as a constant force over the whole sample.
    pub(crate) fn before(&self, part: f64, hold: Hold, force: [f64; ORDER]) -> [f64; ORDER] {
        let m = self.order;
        let a = DMatrix::from_fn(m, m, |i, j| match j {
            0 => -self.alpha[i] * self.rate,
            _ => 0.0,
        } + if j == i + 1 { self.rate } else { 0.0 });
        let mean = match hold {
            Hold::First => 0.5 * part * (1.0 - part),
            _ => part,
        };
        let mut before = force.map(|force| mean * force);
        if let Some(share) = share(&a, self.dt, part, hold) {
            for i in 0..m {
                before[i] = (0..m).map(|j| share[(i, j)] * force[j]).sum();
            }
        }
        before
    }

    /// The output from a state on, held where the drive stands `still`; `None` where it runs away.
    pub(crate) fn response(
        &self,
        start: &[f64],
        samples: usize,
        force: impl Fn(usize) -> Force,
        still: impl Fn(usize) -> bool,
    ) -> Option<DVector<f64>> {
        let mut state = [0.0; ORDER];
        state[..self.order].copy_from_slice(start);
        let mut y = DVector::zeros(samples);
        for k in 0..samples {
            y[k] = state[0];
            if k + 1 < samples {
                if still(k) {
                    // Held by friction: the output stays, its derivatives are zero.
                    for i in 1..self.order {
                        state[i] = self.alpha[i - 1] * state[0];
                    }
                    continue;
                }
                let Force { now, next } = force(k);
                let mut moved = [0.0; ORDER];
                for i in 0..self.order {
                    for j in 0..self.order {
                        moved[i] += self.free[i][j] * state[j]
                            + self.held[i][j] * now[j]
                            + self.rising[i][j] * (next[j] - now[j]);
                    }
                }
                state = moved;
            }
        }
        y.iter().all(|v| v.is_finite()).then_some(y)
    }
}
