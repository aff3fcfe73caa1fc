//! Linear plants in continuous time, simulated without discretisation error for held inputs.
//!
//! The form is the paper's (1): `A(s) y = B(s) u exp(-s T)` with `A` monic, coefficients in
//! ascending powers of `s`. The state space is the observer form, in which several inputs share one
//! state:
//!
//! ```text
//! x1' = x2 - a[m-1] x1 + b[m-1] u        y = x1
//! ...
//! xm' =    - a[0]   x1 + b[0]   u
//! ```
//!
//! One sample is one product with `exp([A B; 0 0] dt)`.

use std::collections::VecDeque;

use nalgebra::{DMatrix, DVector};

use crate::plants::exponential::{companion_matrix, discretise};

/// Highest order of [`LinearPlant`].
pub const MAX_ORDER: usize = 4;

/// A plant description that cannot be simulated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlantError {
    /// The order, `a.len()`, is not in `1..=4`.
    Order(usize),
    /// The numerator of the input with this index is empty or has more than `m` coefficients.
    Numerator(usize),
    /// The sampling interval is not positive and finite \[s\].
    Interval(f64),
    /// A coefficient is not finite.
    Coefficient(f64),
}

impl std::fmt::Display for PlantError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Order(m) => write!(f, "order {m} is not in 1..={MAX_ORDER}"),
            Self::Numerator(i) => write!(f, "numerator of input {i} does not fit the order"),
            Self::Interval(dt) => write!(f, "sampling interval {dt} s is not positive"),
            Self::Coefficient(c) => write!(f, "coefficient {c} is not finite"),
        }
    }
}

impl std::error::Error for PlantError {}

/// One input of a plant: its numerator and its delay.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// Numerator coefficients `b[0] + b[1] s + ..`, ascending, at most `m` of them.
    pub b: Vec<f64>,
    /// Delay in whole samples.
    pub delay: usize,
}

impl Input {
    /// An input without delay.
    pub fn new(b: &[f64]) -> Self {
        Self::delayed(b, 0)
    }

    /// An input that acts `delay` samples late.
    pub fn delayed(b: &[f64], delay: usize) -> Self {
        Self {
            b: b.to_vec(),
            delay,
        }
    }
}

/// `A(s) y = sum_j B_j(s) u_j(t - d_j dt) + constant`, exact for held inputs.
///
/// Convention of time: [`output`](Self::output) is `y(k)`; [`step`](Self::step) holds `u(k)` until
/// `k+1`.
#[derive(Clone, Debug)]
pub struct LinearPlant {
    a: Vec<f64>,
    inputs: Vec<Input>,
    constant: f64,
    dt: f64,
    /// `exp(A dt)`, m x m.
    phi: DMatrix<f64>,
    /// Response to held inputs (last column: to the constant), m x (inputs + 1).
    gamma: DMatrix<f64>,
    /// Response to a unit rise of each input over the interval, m x (inputs + 1).
    ramp: DMatrix<f64>,
    state: DVector<f64>,
    lines: Vec<VecDeque<f64>>,
    /// Input values that were in force just before the present instant.
    held: DVector<f64>,
}

impl LinearPlant {
    /// A plant with one input, `y = B(s)/A(s) u`, at rest in the origin; `a` and `b` ascending,
    /// `dt` in s.
    ///
    /// # Errors
    /// [`PlantError`] when the order is not 1 to 4, `b` is longer than `a`, or a number is
    /// unusable.
    pub fn new(a: &[f64], b: &[f64], dt: f64) -> Result<Self, PlantError> {
        Self::with_inputs(a, &[Input::new(b)], 0.0, dt)
    }

    /// A plant with several inputs and a constant on the right-hand side of the differential
    /// equation.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn with_inputs(
        a: &[f64],
        inputs: &[Input],
        constant: f64,
        dt: f64,
    ) -> Result<Self, PlantError> {
        let m = a.len();
        if !(1..=MAX_ORDER).contains(&m) {
            return Err(PlantError::Order(m));
        }
        if let Some(i) = inputs.iter().position(|i| i.b.is_empty() || i.b.len() > m) {
            return Err(PlantError::Numerator(i));
        }
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(PlantError::Interval(dt));
        }
        let numbers = a.iter().chain(inputs.iter().flat_map(|i| &i.b));
        if let Some(&c) = numbers.chain([&constant]).find(|c| !c.is_finite()) {
            return Err(PlantError::Coefficient(c));
        }
        let n = inputs.len() + 1;
        let mut columns = DMatrix::zeros(m, n);
        for (j, input) in inputs.iter().enumerate() {
            for (i, &b) in input.b.iter().enumerate() {
                columns[(m - 1 - i, j)] = b;
            }
        }
        columns[(m - 1, n - 1)] = constant;
        let (phi, gamma, ramp) = discretise(&companion_matrix(a), &columns, dt);
        Ok(Self {
            a: a.to_vec(),
            inputs: inputs.to_vec(),
            constant,
            dt,
            phi,
            gamma,
            ramp,
            state: DVector::zeros(m),
            lines: inputs
                .iter()
                .map(|i| VecDeque::from(vec![0.0; i.delay]))
                .collect(),
            held: DVector::zeros(inputs.len()),
        })
    }

    /// Denominator coefficients `a[0]..a[m-1]`, ascending; the coefficient of `s^m` is 1.
    pub fn a(&self) -> &[f64] {
        &self.a
    }

    /// The inputs with their numerators and delays.
    pub fn inputs(&self) -> &[Input] {
        &self.inputs
    }

    /// The constant on the right-hand side of the differential equation.
    pub fn constant(&self) -> f64 {
        self.constant
    }

    /// Sampling interval \[s\].
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// Output `y(k)` at the present instant.
    pub fn output(&self) -> f64 {
        self.state[0]
    }

    /// `n`-th time derivative of the output just before the present instant, `n < m` (0 is the
    /// output).
    ///
    /// # Panics
    /// When `n` is not below the order.
    pub fn derivative(&self, n: usize) -> f64 {
        let m = self.a.len();
        assert!(n < m, "derivative {n} of a plant of order {m}");
        // y^(n) = C A^n x + sum_j C A^(n-1) B_j u_j while the inputs are held.
        let mut row = DVector::zeros(m).transpose();
        row[0] = 1.0;
        let full = companion_matrix(&self.a);
        let mut value = 0.0;
        for i in 0..n {
            if i + 1 == n {
                for (j, input) in self.inputs.iter().enumerate() {
                    for (p, &b) in input.b.iter().enumerate() {
                        value += row[m - 1 - p] * b * self.held[j];
                    }
                }
                value += row[m - 1] * self.constant;
            }
            row = &row * &full;
        }
        value + (&row * &self.state)[0]
    }

    /// Puts the plant at rest at output `y`, with empty delay lines.
    pub fn reset(&mut self, y: f64) {
        let mut derivatives = vec![0.0; self.a.len()];
        derivatives[0] = y;
        self.place(&derivatives);
    }

    /// Sets output and derivatives `y, y', ..` for zero inputs, with empty delay lines.
    ///
    /// # Panics
    /// When not exactly `m` values are given.
    pub fn place(&mut self, derivatives: &[f64]) {
        let m = self.a.len();
        assert_eq!(derivatives.len(), m, "one value per order");
        // For zero inputs x[i] = y^(i) + a[m-1] y^(i-1) + .. + a[m-i] y.
        for i in 0..m {
            self.state[i] = derivatives[i]
                + (1..=i)
                    .map(|p| self.a[m - p] * derivatives[i - p])
                    .sum::<f64>();
        }
        for line in &mut self.lines {
            line.iter_mut().for_each(|u| *u = 0.0);
        }
        self.held.fill(0.0);
    }

    /// Holds the inputs `u(k)` for one interval and advances to `k+1`; returns `y(k+1)`.
    ///
    /// # Panics
    /// When `u` does not have one value per input.
    pub fn step(&mut self, u: &[f64]) -> f64 {
        self.advance(u, None)
    }

    /// As [`step`](Self::step) with inputs that go in a straight line from `u` to `next`
    /// (first-order hold).
    ///
    /// # Panics
    /// When `u` and `next` do not have one value per input, or an input is delayed.
    pub fn step_ramp(&mut self, u: &[f64], next: &[f64]) -> f64 {
        assert!(
            self.lines.iter().all(VecDeque::is_empty),
            "first-order hold is defined here without delay"
        );
        self.advance(u, Some(next))
    }

    fn advance(&mut self, u: &[f64], next: Option<&[f64]>) -> f64 {
        let n = self.inputs.len();
        assert_eq!(u.len(), n, "one value per input");
        let mut held = DVector::from_element(n + 1, 1.0);
        for j in 0..n {
            self.lines[j].push_back(u[j]);
            held[j] = self.lines[j].pop_front().unwrap_or(u[j]);
        }
        let mut state = &self.phi * &self.state + &self.gamma * &held;
        if let Some(next) = next {
            let mut rise = DVector::zeros(n + 1);
            for j in 0..n {
                rise[j] = next[j] - u[j];
                held[j] = next[j];
            }
            state += &self.ramp * rise;
        }
        self.state = state;
        self.held.copy_from(&held.rows(0, n));
        self.state[0]
    }

    /// `y(0)..y(n-1)` of a plant with one input for the held input sequence `u`, from the present
    /// state.
    ///
    /// # Panics
    /// When the plant does not have exactly one input.
    pub fn response(&mut self, u: &[f64]) -> Vec<f64> {
        u.iter()
            .map(|&u| {
                let y = self.output();
                self.step(&[u]);
                y
            })
            .collect()
    }
}

#[cfg(test)]
mod tests;
