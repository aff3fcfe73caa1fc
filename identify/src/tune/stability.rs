//! Whether a sampled loop is stable, at a cost in proportion to its delay.
//!
//! The commands before are no states but powers of 1/z. With the states x of the plant, those of
//! the controller and u as unknowns the closed loop is `N(z) (x, xi, u) = 0`, and
//!
//! ```text
//! f(z) = det N(z) / z^(number of x and xi) = product of (1 - p_i / z) over its poles p_i
//! ```
//!
//! f is 1 at infinity and has no pole outside of the circle around 0 that all p_i have to be in. So
//! along it f turns around 0 once for each p_i outside (argument principle): Nyquist's criterion
//! for the closed loop itself, with nothing of the open loop to count.

use std::f64::consts::PI;

use nalgebra::{Complex, DMatrix};

use super::controller::Controller;
use super::frequency_response::{balance, powers};
use super::plant::SampledPlant;

/// The radius that all poles have to be in.
const RADIUS: f64 = 1.0 - 1e-9;
/// Angles of a decade, and the first one \[rad\]: no pole that is inside turns f below it.
const IN_A_DECADE: f64 = 20.0;
const FIRST: f64 = 1e-10;
/// Largest turn between two angles \[rad\], and how often an interval with a larger one is halved.
const TURN: f64 = 0.8;
const HALVED: usize = 40;

/// Whether all poles of the closed loop are inside the unit circle.
pub(super) fn is_stable(plant: &SampledPlant, controller: &Controller) -> bool {
    let closed = Closed::new(plant, controller);
    let mut before = (0.0, closed.at(0.0));
    let mut turned = 0.0;
    // Evenly on a logarithmic scale, and so close that no power of 1/z turns by more than 1 rad.
    let (ratio, widest) = (10f64.powf(1.0 / IN_A_DECADE), 1.0 / closed.poles() as f64);
    while before.0 < PI {
        let angle = (before.0 * ratio).clamp(FIRST, before.0 + widest.max(FIRST));
        let angle = angle.min(PI);
        let next = (angle, closed.at(angle));
        let Some(turn) = closed.turn(before, next, HALVED) else {
            return false;
        };
        turned += turn;
        before = next;
    }
    turned.abs() < 0.5 * PI
}

/// `N(z) = z - fixed` with 1 in the place of z in the row of u, the terms of u by their delays
/// beside it.
struct Closed {
    fixed: DMatrix<f64>,
    /// Of u in each row: samples that the command is old, and the factor.
    late: Vec<Vec<(usize, f64)>>,
    /// The longest of these.
    oldest: usize,
}

impl Closed {
    fn new(plant: &SampledPlant, controller: &Controller) -> Self {
        let (m, n) = (plant.order(), controller.own());
        let u = m + n;
        let mut fixed = DMatrix::zeros(u + 1, u + 1);
        fixed.view_mut((0, 0), (m, m)).copy_from(&plant.a);
        let own = controller.a.view((0, 0), (n, n));
        fixed.view_mut((m, m), (n, n)).copy_from(&own);
        for j in 0..m {
            for i in 0..n {
                fixed[(m + i, j)] = controller.b[1][i] * plant.c[j];
            }
            fixed[(u, j)] = controller.d[1] * plant.c[j];
        }
        for j in 0..n {
            fixed[(u, m + j)] = controller.c[j];
        }
        let mut late = vec![Vec::new(); u + 1];
        for i in 0..m {
            late[i] = vec![
                (plant.delay, plant.b[0][i]),
                (plant.delay + 1, plant.b[1][i]),
            ];
        }
        for lag in 1..=controller.past {
            for i in 0..n {
                late[m + i].push((lag, controller.a[(i, n + lag - 1)]));
            }
            late[u].push((lag, controller.c[n + lag - 1]));
        }
        late.iter_mut()
            .for_each(|row| row.retain(|(_, v)| *v != 0.0));
        let mut found = Self {
            fixed,
            late,
            oldest: controller.past.max(plant.delay + 1),
        };
        found.balance();
        found
    }

    /// Scales the unknowns as they are at rest, which leaves the determinant.
    fn balance(&mut self) {
        let u = self.late.len() - 1;
        let mut at_rest = self.fixed.clone();
        for (i, row) in self.late.iter().enumerate() {
            at_rest[(i, u)] += row.iter().map(|(_, v)| v).sum::<f64>();
        }
        let scale = balance(&mut at_rest);
        for i in 0..=u {
            for j in 0..=u {
                self.fixed[(i, j)] *= scale[j] / scale[i];
            }
            for (_, v) in &mut self.late[i] {
                *v *= scale[u] / scale[i];
            }
        }
    }

    /// Number of poles.
    fn poles(&self) -> usize {
        self.oldest + self.late.len()
    }

    /// f at an angle of the circle \[rad\].
    fn at(&self, angle: f64) -> Complex<f64> {
        let z = Complex::from_polar(RADIUS, angle);
        let before = powers(z.inv(), self.oldest + 1);
        let u = self.late.len() - 1;
        let mut matrix = self.fixed.map(|v| Complex::new(-v, 0.0));
        for (i, row) in self.late.iter().enumerate() {
            matrix[(i, i)] += if i < u { z } else { Complex::new(1.0, 0.0) };
            let of_u: Complex<f64> = row.iter().map(|(lag, v)| before[*lag] * *v).sum();
            matrix[(i, u)] -= of_u;
        }
        matrix.lu().determinant() * before[1].powu(u as u32)
    }

    /// How far f turns from one angle to another \[rad\]; `None` where that is not told, because f
    /// is 0 or a pole is as close to the circle as numbers are.
    ///
    /// An interval counts where its halves turn as far together, both by little: two poles beside
    /// the circle turn f by a whole turn.
    fn turn(
        &self,
        from: (f64, Complex<f64>),
        to: (f64, Complex<f64>),
        halved: usize,
    ) -> Option<f64> {
        let middle = 0.5 * (from.0 + to.0);
        let middle = (middle, self.at(middle));
        let [first, second] = [(from, middle), (middle, to)].map(|(x, y)| (y.1 / x.1).arg());
        if first.is_nan() || second.is_nan() {
            return None;
        }
        if (first.abs() + second.abs()) < TURN {
            return Some(first + second);
        }
        let halved = halved.checked_sub(1)?;
        Some(self.turn(from, middle, halved)? + self.turn(middle, to, halved)?)
    }
}
