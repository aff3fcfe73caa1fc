//! Controllers as state equations of the samples: the one form that is simulated, judged and
//! printed from.

use nalgebra::{DMatrix, DVector, RowDVector};

/// `x(k+1) = A x(k) + B_r r(k) + B_y y(k)`, `u(k) = C x(k) + D_r r(k) + D_y y(k)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    pub(super) a: DMatrix<f64>,
    /// B_r and B_y.
    pub(super) b: [DVector<f64>; 2],
    pub(super) c: RowDVector<f64>,
    /// D_r and D_y.
    pub(super) d: [f64; 2],
    /// So many states at the end are the commands before, u(k-1) first.
    pub(super) past: usize,
}

impl Controller {
    /// One sample: the command for a reference and an output; `state` begins with zeros.
    pub fn step(&self, state: &mut DVector<f64>, r: f64, y: f64) -> f64 {
        let u = (&self.c * &*state)[0] + self.d[0] * r + self.d[1] * y;
        *state = &self.a * &*state + &self.b[0] * r + &self.b[1] * y;
        u
    }

    /// Number of states.
    pub fn states(&self) -> usize {
        self.a.nrows()
    }

    /// Number of states that are no command before.
    pub(super) fn own(&self) -> usize {
        self.states() - self.past
    }

    /// For a plant whose gain is `gain` times that of the one that it is for.
    pub(super) fn for_gain(mut self, gain: f64) -> Self {
        let (own, all) = (self.own(), self.states());
        // The commands before are in the new unit, the other states in the old one.
        self.a.view_mut((0, own), (own, self.past)).scale_mut(gain);
        for i in own..all {
            self.a.view_mut((i, 0), (1, own)).unscale_mut(gain);
            self.b.iter_mut().for_each(|b| b[i] /= gain);
        }
        self.c.columns_mut(0, own).unscale_mut(gain);
        self.d = self.d.map(|d| d / gain);
        self
    }
}

/// Gains of a position loop around a velocity loop, in the units of the signals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cascade {
    /// Position loop \[1/s\].
    pub kv: f64,
    /// Velocity loop: u per unit of velocity.
    pub kp: f64,
    /// Its integral time \[s\].
    pub ti: f64,
    /// Time constant of the filter on the difference of y \[s\].
    pub tf: f64,
}

impl Cascade {
    /// `v += alpha ((y - y_1)/T - v)`, `e = kv (r - y) - v`, `u = kp e + I`, `I += kp T/ti e`.
    pub fn controller(&self, dt: f64) -> Controller {
        let Self { kv, kp, ti, tf } = *self;
        let alpha = dt / (tf + dt);
        // States v, y(k-1), I; v(k) = (1 - alpha) v + alpha (y - y_1)/T.
        let v = [1.0 - alpha, -alpha / dt, 0.0, 0.0, alpha / dt];
        // e in v, y_1, I, r, y.
        let e = [-v[0], -v[1], 0.0, kv, -kv - v[4]];
        let integral = kp * dt / ti;
        let rows = [
            v,
            [0.0, 0.0, 0.0, 0.0, 1.0],
            [
                integral * e[0],
                integral * e[1],
                1.0,
                integral * e[3],
                integral * e[4],
            ],
        ];
        let u = [kp * e[0], kp * e[1], 1.0, kp * e[3], kp * e[4]];
        from_rows(&rows, &u)
    }
}

/// Gains of a PID controller with a filtered derivative of the output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pid {
    /// Gain: u per unit of y.
    pub kp: f64,
    /// Integral time \[s\].
    pub ti: f64,
    /// Derivative time \[s\]; 0 for a PI controller.
    pub td: f64,
    /// Time constant of the filter of the derivative \[s\].
    pub tf: f64,
}

impl Pid {
    /// `e = r - y`, `D = beta D - kp td/(tf + T) (y - y_1)`, `u = kp e + I + D`, `I += kp T/ti e`.
    pub fn controller(&self, dt: f64) -> Controller {
        let Self { kp, ti, td, tf } = *self;
        let beta = tf / (tf + dt);
        let derivative = kp * td / (tf + dt);
        // States D, y(k-1), I.
        let d = [beta, derivative, 0.0, 0.0, -derivative];
        let integral = kp * dt / ti;
        let rows = [
            d,
            [0.0, 0.0, 0.0, 0.0, 1.0],
            [0.0, 0.0, 1.0, integral, -integral],
        ];
        let u = [d[0], d[1], 1.0, kp, -kp + d[4]];
        from_rows(&rows, &u)
    }

    /// `u(k) = -a1 u(k-1) - a2 u(k-2) + b0 e(k) + b1 e(k-1) + b2 e(k-2)`, the derivative taken of
    /// the error: (b, a).
    pub fn difference_equation(&self, dt: f64) -> ([f64; 3], [f64; 2]) {
        let Self { kp, ti, td, tf } = *self;
        let beta = tf / (tf + dt);
        let (i, d) = (kp * dt / ti, kp * td / (tf + dt));
        // kp + i q/(1-q) + d (1-q)/(1 - beta q), over (1-q)(1 - beta q).
        let b = [
            kp + d,
            -kp * (1.0 + beta) + i - 2.0 * d,
            kp * beta - i * beta + d,
        ];
        (b, [-1.0 - beta, beta])
    }
}

/// Rows over three states, r and y.
fn from_rows(rows: &[[f64; 5]; 3], u: &[f64; 5]) -> Controller {
    Controller {
        a: DMatrix::from_fn(3, 3, |i, j| rows[i][j]),
        b: [3, 4].map(|j| DVector::from_fn(3, |i, _| rows[i][j])),
        c: RowDVector::from_fn(3, |_, j| u[j]),
        d: [u[3], u[4]],
        past: 0,
    }
}
