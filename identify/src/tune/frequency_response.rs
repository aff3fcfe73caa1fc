//! Frequency response of a controller, at the cost of its order squared for each frequency.

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
pub(super) struct FrequencyResponse {
    t: DMatrix<Complex<f64>>,
    b: DVector<Complex<f64>>,
    c: RowDVector<Complex<f64>>,
    through: f64,
    dt: f64,
}

impl FrequencyResponse {
    /// Of a controller every `dt` seconds.
    pub(super) fn new(controller: &Controller, dt: f64) -> Self {
        let complex = |v: f64| Complex::new(v, 0.0);
        let mut a = controller.a.clone();
        let scale = balance(&mut a);
        let b = controller.b[1].component_div(&scale);
        let c = controller.c.component_mul(&scale.transpose());
        let (q, t) = Schur::new(a.map(complex)).unpack();
        Self {
            b: q.adjoint() * b.map(complex),
            c: c.map(complex) * q,
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
        match shifted.solve_upper_triangular(&self.b) {
            Some(x) => -((&self.c * x)[0] + self.through),
            None => Complex::new(f64::NAN, f64::NAN),
        }
    }
}

/// Scales the states of a matrix so that its rows are about as large as its columns; gives D of
/// `D^-1 A D`.
pub(super) fn balance(a: &mut DMatrix<f64>) -> DVector<f64> {
    match a.iter().all(|v| v.is_finite()) {
        true => balance_parlett_reinsch(a),
        false => DVector::from_element(a.nrows(), 1.0),
    }
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
