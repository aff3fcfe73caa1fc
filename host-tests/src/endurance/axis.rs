//! Plants that are fast to simulate: exact for held inputs, fixed size.

use nalgebra::{DMatrix, SMatrix, SVector};

use crate::plants::exponential::{companion_matrix, discretise};
use crate::plants::valve::FrictionDrive;

/// A drive in f64.
pub trait Axis {
    /// Position at the present instant.
    fn position(&self) -> f64;
    /// Velocity at the present instant.
    fn velocity(&self) -> f64;
    /// Holds `u` for one sample time.
    fn step(&mut self, u: f64);
    /// At rest at this position.
    fn place(&mut self, position: f64);
}

/// `b0 / (s^M + a[M-1] s^(M-1) + .. + a[1] s)`.
#[derive(Clone, Copy, Debug)]
pub struct Integrating<const M: usize> {
    a: [f64; M],
    phi: SMatrix<f64, M, M>,
    gamma: SVector<f64, M>,
    state: SVector<f64, M>,
}

impl<const M: usize> Integrating<M> {
    /// At rest in the origin; `a[0]` is 0.
    pub fn new(a: [f64; M], b0: f64, dt: f64) -> Self {
        let mut column = DMatrix::zeros(M, 1);
        column[(M - 1, 0)] = b0;
        let (phi, gamma, _) = discretise(&companion_matrix(&a), &column, dt);
        Self {
            a,
            phi: SMatrix::from_fn(|i, j| phi[(i, j)]),
            gamma: SVector::from_fn(|i, _| gamma[(i, 0)]),
            state: SVector::zeros(),
        }
    }
}

impl<const M: usize> Axis for Integrating<M> {
    fn position(&self) -> f64 {
        self.state[0]
    }

    fn velocity(&self) -> f64 {
        self.state[1] - self.a[M - 1] * self.state[0]
    }

    #[inline]
    fn step(&mut self, u: f64) {
        self.state = self.phi * self.state + self.gamma * u;
    }

    fn place(&mut self, position: f64) {
        // x_(i+1) = x_i' + a x_1 with every derivative zero.
        self.state = SVector::from_fn(|i, _| match i {
            0 => position,
            i => self.a[M - i] * position,
        });
    }
}

/// A drive with Coulomb friction, of order 2.
#[derive(Clone, Copy, Debug)]
pub struct WithFriction {
    drive: FrictionDrive,
    dt: f64,
    origin: f64,
}

impl WithFriction {
    /// At rest in the origin.
    pub fn new(drive: FrictionDrive, dt: f64) -> Self {
        Self {
            drive,
            dt,
            origin: 0.0,
        }
    }
}

impl Axis for WithFriction {
    fn position(&self) -> f64 {
        self.origin + self.drive.output()
    }

    fn velocity(&self) -> f64 {
        self.drive.velocity()
    }

    fn step(&mut self, u: f64) {
        self.drive.step(u, self.dt);
    }

    fn place(&mut self, position: f64) {
        let d = self.drive;
        self.drive = FrictionDrive::new(d.a, d.b, d.c, d.d);
        self.origin = position;
    }
}
