//! Cramer-Rao bound: the smallest standard deviation any unbiased estimate can have from a given
//! record.
//!
//! For white Gaussian position noise of variance `s^2` and a known initial state the information is
//! `sum_k (dy(k)/dtheta) (dy(k)/dtheta)' / s^2`. The sensitivities are exact: they obey the plant's
//! own equation driven by its state, `s' = A s + (dA/dp) x + (dB/dp) u`, and are discretised
//! together with it.
//!
//! Uniform noise of the same variance is treated as Gaussian, as usual; an estimator that knew the
//! uniform law could do better.

use nalgebra::{DMatrix, DVector};

use crate::plants::exponential::{companion_matrix, discretise};
use crate::plants::linear::{Input, LinearPlant};
use crate::plants::servo::Servo;

/// A free coefficient of a plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Coefficient {
    /// `a[i]`.
    A(usize),
    /// `b[i]` of an input.
    B {
        /// Index of the input.
        input: usize,
        /// Power of `s`.
        power: usize,
    },
    /// The constant on the right-hand side.
    Constant,
    /// `i`-th derivative of the output at the first sample, for zero inputs before it (0: the
    /// output itself).
    Initial(usize),
}

/// `x' = system x + input v`, y the first state, in observer form; the last input is the
/// constant 1.
struct StateSpace {
    system: DMatrix<f64>,
    input: DMatrix<f64>,
    state: DVector<f64>,
}

impl StateSpace {
    /// The plant with these derivatives of the output at the first sample.
    fn of(plant: &LinearPlant, initial: &[f64]) -> Self {
        let a = plant.a();
        let (m, columns) = (a.len(), plant.inputs().len() + 1);
        let mut input = DMatrix::zeros(m, columns);
        for (j, Input { b, .. }) in plant.inputs().iter().enumerate() {
            for (i, &b) in b.iter().enumerate() {
                input[(m - 1 - i, j)] = b;
            }
        }
        input[(m - 1, columns - 1)] = plant.constant();
        Self {
            system: companion_matrix(a),
            input,
            state: DVector::from_fn(m, |i, _| {
                initial[i] + (1..=i).map(|p| a[m - p] * initial[i - p]).sum::<f64>()
            }),
        }
    }

    /// The plant, below it the derivatives of its states by one coefficient.
    fn with_sensitivity(&self, coefficient: Coefficient, initial: &[f64]) -> Self {
        let (m, columns) = self.input.shape();
        let mut system = DMatrix::zeros(2 * m, 2 * m);
        system.view_mut((0, 0), (m, m)).copy_from(&self.system);
        system.view_mut((m, m), (m, m)).copy_from(&self.system);
        let mut input = DMatrix::zeros(2 * m, columns);
        input.view_mut((0, 0), (m, columns)).copy_from(&self.input);
        let mut state = DVector::zeros(2 * m);
        state.rows_mut(0, m).copy_from(&self.state);
        match coefficient {
            Coefficient::A(i) => {
                system[(m + m - 1 - i, 0)] = -1.0;
                // The initial state in observer form contains a[i] times the lower derivatives.
                for row in (m - i)..m {
                    state[m + row] = initial[row - (m - i)];
                }
            }
            Coefficient::B { input: j, power } => input[(m + m - 1 - power, j)] = 1.0,
            Coefficient::Constant => input[(m + m - 1, columns - 1)] = 1.0,
            Coefficient::Initial(i) => {
                state[m + i] = 1.0;
                // The first column of the companion matrix holds -a[m-1], -a[m-2], ..
                for row in i + 1..m {
                    state[m + row] = -self.system[(row - i - 1, 0)];
                }
            }
        }
        Self {
            system,
            input,
            state,
        }
    }

    /// Gives `see` the state at each sample.
    fn run(self, dt: f64, acting: &[DVector<f64>], mut see: impl FnMut(usize, &DVector<f64>)) {
        let (phi, gamma, _) = discretise(&self.system, &self.input, dt);
        let mut state = self.state;
        for (k, v) in acting.iter().enumerate() {
            see(k, &state);
            state = &phi * &state + &gamma * v;
        }
    }
}

/// The inputs of a plant as they act: delayed, and the constant as a last input 1.
fn acting(plant: &LinearPlant, u: &[&[f64]]) -> Vec<DVector<f64>> {
    (0..u[0].len())
        .map(|k| {
            let mut v = DVector::from_element(u.len() + 1, 1.0);
            for (j, input) in plant.inputs().iter().enumerate() {
                v[j] = k.checked_sub(input.delay).map_or(0.0, |i| u[j][i]);
            }
            v
        })
        .collect()
}

/// Output of a plant and its derivatives by the free coefficients, simulated from rest, exact for
/// held inputs.
#[derive(Clone, Debug)]
pub struct Sensitivity {
    /// Noise-free output, `y(0)..y(n-1)`.
    pub y: Vec<f64>,
    /// Row k, column j: `dy(k)/dtheta_j`.
    pub jacobian: DMatrix<f64>,
}

impl Sensitivity {
    /// Simulates `plant`'s equation from the derivatives `initial` of the output (zeros: at rest)
    /// for held inputs.
    ///
    /// `u[j]` is the sequence of input `j`; all have the same length.
    ///
    /// # Panics
    /// When lengths or indices do not fit the plant.
    pub fn simulate(
        plant: &LinearPlant,
        free: &[Coefficient],
        initial: &[f64],
        u: &[&[f64]],
    ) -> Self {
        let n = u[0].len();
        assert_eq!(u.len(), plant.inputs().len(), "one sequence per input");
        assert!(u.iter().all(|s| s.len() == n), "sequences of one length");
        assert_eq!(
            initial.len(),
            plant.a().len(),
            "one initial derivative per order"
        );
        let system = StateSpace::of(plant, initial);
        let acting = acting(plant, u);
        let mut y = vec![0.0; n];
        let mut jacobian = DMatrix::zeros(n, free.len());
        if free.is_empty() {
            system.run(plant.dt(), &acting, |k, state| y[k] = state[0]);
            return Self { y, jacobian };
        }
        let m = system.state.len();
        for (p, coefficient) in free.iter().enumerate() {
            let both = system.with_sensitivity(*coefficient, initial);
            both.run(plant.dt(), &acting, |k, state| {
                y[k] = state[0];
                jacobian[(k, p)] = state[m];
            });
        }
        Self { y, jacobian }
    }

    /// Covariance bound of the free coefficients for white noise of standard deviation `sigma`, or
    /// nothing when the record does not determine them.
    pub fn covariance(&self, sigma: f64) -> Option<DMatrix<f64>> {
        // Columns differ by orders of magnitude: scale to unit length before inverting.
        let lengths: Vec<f64> = self.jacobian.column_iter().map(|c| c.norm()).collect();
        if lengths.iter().any(|&l| !(l > 0.0 && l.is_finite())) {
            return None;
        }
        let mut scaled = self.jacobian.clone();
        for (mut column, l) in scaled.column_iter_mut().zip(&lengths) {
            column /= *l;
        }
        let mut covariance = (scaled.transpose() * scaled).cholesky()?.inverse();
        for i in 0..lengths.len() {
            for j in 0..lengths.len() {
                covariance[(i, j)] *= sigma * sigma / (lengths[i] * lengths[j]);
            }
        }
        Some(covariance)
    }
}

/// Bound of each free coefficient of `plant` as a standard deviation, for held inputs from rest and
/// white noise.
///
/// Nothing when the record does not determine them all.
///
/// # Panics
/// As [`Sensitivity::simulate`].
pub fn coefficient_bound(
    plant: &LinearPlant,
    free: &[Coefficient],
    u: &[&[f64]],
    sigma: f64,
) -> Option<Vec<f64>> {
    let at_rest = vec![0.0; plant.a().len()];
    let sensitivity = Sensitivity::simulate(plant, free, &at_rest, u);
    let covariance = sensitivity.covariance(sigma)?;
    Some(covariance.diagonal().iter().map(|v| v.sqrt()).collect())
}

/// What is known of the state of the servo at the first sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum InitialState {
    /// All of it: at rest in a known position.
    Known,
    /// At rest in a position that is itself known only from the noisy record: the case of an
    /// identifier that starts on a drive at rest. It matters for `C` over a short record.
    PositionUnknown,
    /// Nothing.
    Unknown,
}

/// Relative bound of `C`, `w0` and `xi` \[%\] for the command sequence `u` and white position noise
/// of standard deviation `sigma_mm` \[mm\], from rest; nothing when the record does not determine
/// them.
///
/// `C = b0/a1`, `w0 = sqrt(a1)`, `xi = a2/(2 sqrt(a1))`: the covariance of `(a1, a2, b0)` goes
/// through the Jacobian.
pub fn servo_bound_pct(
    servo: &Servo,
    dt: f64,
    u: &[f64],
    sigma_mm: f64,
    initial: InitialState,
) -> Option<[f64; 3]> {
    let mut free = vec![
        Coefficient::A(1),
        Coefficient::A(2),
        Coefficient::B { input: 0, power: 0 },
    ];
    free.extend(match initial {
        InitialState::Known => (0..0).map(Coefficient::Initial),
        InitialState::PositionUnknown => (0..1).map(Coefficient::Initial),
        InitialState::Unknown => (0..3).map(Coefficient::Initial),
    });
    let sensitivity = Sensitivity::simulate(&servo.plant(dt), &free, &[0.0; 3], &[u]);
    let covariance = sensitivity.covariance(sigma_mm)?;
    Some(servo_deviation_pct(servo, &covariance))
}

/// Relative standard deviations of `C`, `w0`, `xi` \[%\] from a covariance whose first three rows
/// are `a1, a2, b0`.
pub fn servo_deviation_pct(servo: &Servo, covariance: &DMatrix<f64>) -> [f64; 3] {
    let [_, a1, a2] = servo.a();
    let b0 = servo.b0();
    // d ln C = db0/b0 - da1/a1, d ln w0 = da1/(2 a1), d ln xi = da2/a2 - da1/(2 a1).
    let relative = [
        [-1.0 / a1, 0.0, 1.0 / b0],
        [0.5 / a1, 0.0, 0.0],
        [-0.5 / a1, 1.0 / a2, 0.0],
    ];
    relative.map(|row| {
        let mut variance = 0.0;
        for i in 0..3 {
            for j in 0..3 {
                variance += row[i] * covariance[(i, j)] * row[j];
            }
        }
        100.0 * variance.sqrt()
    })
}

#[cfg(test)]
mod tests;
