//! Frequency response of a controller, at the cost of its order squared and of its
//! delay for each frequency.

use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{Complex, DMatrix, DVector, RowDVector, Schur};

use super::controller::Controller;

/// From minus the output to the command: what stands before the plant in the loop.
///
/// The states are turned so that their matrix is triangular (Schur's form `A = Q T Q^H`, which
/// exists for every matrix): `C (z - A)^-1 B = C Q (z - T)^-1 Q^H B`. Before that they are scaled
/// by powers of two (balancing of Parlett and Reinsch): the rounding of the turn is that of the
/// largest number in the matrix, and an observer far above the rates of its plant has states that
/// differ by many orders.
///
/// States that are the commands before are powers of 1/z, and not among those of the matrix.
pub(super) struct FrequencyResponse {
    t: DMatrix<Complex<f64>>,
    b: DVector<Complex<f64>>,
    c: RowDVector<Complex<f64>>,
    through: f64,
    dt: f64,
    /// How the states depend on the commands before, by the samples that they are old.
    states_by_past: Vec<(usize, DVector<Complex<f64>>)>,
    /// How the command does, from one sample on.
    command_by_past: Vec<f64>,
}

impl FrequencyResponse {
    /// Of a controller every `dt` seconds.
    pub(super) fn new(controller: &Controller, dt: f64) -> Self {
        let complex = |v: f64| Complex::new(v, 0.0);
        let own = controller.own();
        let mut a = controller.a.view((0, 0), (own, own)).into_owned();
        let scale = balance(&mut a);
        let (q, t) = Schur::new(a.map(complex)).unpack();
        let turned = |b: DVector<f64>| q.adjoint() * b.component_div(&scale).map(complex);
        let past = |lag: usize| controller.a.view((0, own + lag - 1), (own, 1));
        let states_by_past = (1..=controller.past)
            .filter(|lag| past(*lag).iter().any(|v| *v != 0.0))
            .map(|lag| (lag, turned(past(lag).column(0).into_owned())));
        let c = controller
            .c
            .columns(0, own)
            .component_mul(&scale.transpose());
        Self {
            b: turned(controller.b[1].rows(0, own).into_owned()),
            states_by_past: states_by_past.collect(),
            command_by_past: controller.c.iter().skip(own).copied().collect(),
            c: c.map(complex) * &q,
            t,
            through: controller.d[1],
            dt,
        }
    }

    /// At `omega` \[rad/s\]; not finite where a pole is.
    pub(super) fn at(&self, omega: f64) -> Complex<f64> {
        let z = Complex::new(0.0, omega * self.dt).exp();
        let mut shifted = -&self.t;
        for i in 0..shifted.nrows() {
            shifted[(i, i)] += z;
        }
        let nothing = Complex::new(f64::NAN, f64::NAN);
        let by_states = |b: &DVector<Complex<f64>>| {
            let states = shifted.solve_upper_triangular(b);
            states.map_or(nothing, |x| (&self.c * x)[0])
        };
        let by_output = by_states(&self.b) + self.through;
        if self.command_by_past.is_empty() {
            return -by_output;
        }
        let before = powers(z.inv(), self.command_by_past.len() + 1);
        let terms = self.command_by_past.iter().zip(&before[1..]);
        let command: Complex<f64> = terms.map(|(c, q)| q * *c).sum();
        let of_past = |b: DVector<Complex<f64>>, (lag, past): &(usize, DVector<Complex<f64>>)| {
            b + past * before[*lag]
        };
        let zeros = DVector::zeros(self.b.len());
        let by_command = by_states(&self.states_by_past.iter().fold(zeros, of_past)) + command;
        -by_output / (-by_command + 1.0)
    }
}

/// 1, q, q^2 .., so many.
pub(super) fn powers(q: Complex<f64>, count: usize) -> Vec<Complex<f64>> {
    let one = Complex::new(1.0, 0.0);
    std::iter::successors(Some(one), |before| Some(before * q))
        .take(count)
        .collect()
}

/// The numbers that a matrix is balanced by: their squares neither overflow nor vanish.
const BALANCED: std::ops::Range<f64> = 1e-140..1e140;

/// Scales the states of a matrix so that its rows are about as large as its columns; gives D of
/// `D^-1 A D`. A matrix with larger numbers than [`BALANCED`] stays, and smaller ones count as 0.
pub(super) fn balance(a: &mut DMatrix<f64>) -> DVector<f64> {
    if !a.iter().all(|v| v.abs() < BALANCED.end) {
        return DVector::from_element(a.nrows(), 1.0);
    }
    let seen = |v: f64| if v.abs() < BALANCED.start { 0.0 } else { v };
    let scale = balance_parlett_reinsch(&mut a.map(seen));
    for (i, mut row) in a.row_iter_mut().enumerate() {
        row.component_mul_assign(&scale.transpose());
        row.unscale_mut(scale[i]);
    }
    scale
}

#[cfg(test)]
mod tests {
    use super::super::controller::Pid;
    use super::*;

    #[test]
    fn state_equations_and_difference_equation_are_the_same_controller() {
        let pid = Pid {
            kp: 2.0,
            ti: 0.3,
            td: 0.05,
            tf: 0.004,
        };
        let (dt, omega) = (1e-3, 37.0);
        let (b, a) = pid.difference_equation(dt);
        let q = Complex::new(0.0, -omega * dt).exp();
        let direct = (q * q * b[2] + q * b[1] + b[0]) / (q * q * a[1] + q * a[0] + 1.0);
        let found = FrequencyResponse::new(&pid.controller(dt), dt).at(omega);
        assert!((found - direct).norm() < 1e-9 * direct.norm());
        // Kp (1 + 1/(Ti s) + Td s/(1 + Tf s)), up to the sampling.
        let s = Complex::new(0.0, omega);
        let continuous = (s * pid.td / (s * pid.tf + 1.0) + (s * pid.ti).inv() + 1.0) * pid.kp;
        assert!((found - continuous).norm() < 0.02 * continuous.norm());
    }
}
