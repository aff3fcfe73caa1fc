//! Other ways to forget, in f64: plain exponential, directional (Cao & Schwartz), stabilised
//! (Kulhavy & Zarrop).
//!
//! | kind | information R = P^-1 after a row phi | rests |
//! |---|---|---|
//! | plain | `lambda R + phi phi'` | loses all it knows |
//! | directional | `R - (1 - lambda) R phi phi' R / (phi' R phi) + phi phi'` | keeps what no row shows |
//! | stabilised | `lambda R + phi phi' + (1 - lambda) I / w`, with the nominal parameters as a second observation | returns to them |
//!
//! Cao & Schwartz, A directional forgetting algorithm based on the decomposition of the information
//! matrix, Automatica 36 (2000); Kulhavy & Zarrop, On a general concept of forgetting, Int. J.
//! Control 58 (1993).

use nalgebra::{SMatrix, SVector};

/// Which information is forgotten.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// All of it, at the same rate.
    Plain,
    /// That in the direction of the newest row.
    Directional,
    /// All of it, in favour of the nominal parameters with this variance relative to the noise.
    Stabilised {
        /// w.
        variance: f64,
    },
    /// All of it, before a row when the row before brought 1.5 times the share that goes, otherwise
    /// before every eighth; then every second sample one parameter in turn is observed at its
    /// nominal value, which follows the estimate where its variance is small: what the core does,
    /// with dense matrices. Until the variance was small once, a nominal value is the mean of the
    /// prior and weighs as much as keeps the prior variance. Behind a row that brought less nominal
    /// values stand still.
    InTurn {
        /// That of one observation, once the variance of the parameter was small.
        variance: f64,
        /// Variance below which a nominal value follows.
        follows: f64,
    },
}

/// Recursive least squares with one of these ways to forget.
#[derive(Clone, Debug)]
pub struct Forgetting<const N: usize> {
    kind: Kind,
    lambda: f64,
    theta: SVector<f64, N>,
    nominal: SVector<f64, N>,
    /// Variances that the observations in turn leave without data: those of the prior, until the
    /// data showed a parameter.
    unsupported: [f64; N],
    information: SMatrix<f64, N, N>,
    covariance: SMatrix<f64, N, N>,
    turn: usize,
    /// Rows before the next one that is forgotten for, in turns.
    wait: u32,
}

impl<const N: usize> Forgetting<N> {
    /// Starts at zero with these variances of the parameters relative to the noise, and the memory
    /// in samples.
    pub fn new(kind: Kind, variances: [f64; N], memory: f64) -> Self {
        Self {
            kind,
            lambda: 1.0 - 1.0 / memory,
            theta: SVector::zeros(),
            nominal: SVector::zeros(),
            unsupported: variances,
            information: SMatrix::from_diagonal(&variances.map(f64::recip).into()),
            covariance: SMatrix::from_diagonal(&variances.into()),
            turn: 0,
            wait: 0,
        }
    }

    /// The parameters.
    pub fn theta(&self) -> [f64; N] {
        self.theta.into()
    }

    /// Largest variance of a parameter, relative to the noise.
    pub fn largest_variance(&self) -> f64 {
        self.covariance.diagonal().max()
    }

    /// Makes the present estimate nominal.
    pub fn set_nominal(&mut self) {
        self.nominal = self.theta;
    }

    /// Takes one row.
    pub fn update(&mut self, phi: &[f64; N], psi: f64) {
        let phi = SVector::from(*phi);
        match self.kind {
            Kind::InTurn { .. } if self.wait > 0 => {}
            Kind::Plain | Kind::InTurn { .. } => self.covariance /= self.lambda,
            Kind::Directional => {
                let seen = self.information * phi;
                let amount = phi.dot(&seen);
                if amount > 1e-12 {
                    self.information -= seen * seen.transpose() * ((1.0 - self.lambda) / amount);
                    let gain = (1.0 - self.lambda) / (self.lambda * amount);
                    self.covariance += phi * phi.transpose() * gain;
                }
            }
            Kind::Stabilised { variance } => {
                let stable = (1.0 - self.lambda) / variance;
                let right = self.information * self.theta * self.lambda + self.nominal * stable;
                self.information =
                    self.information * self.lambda + SMatrix::<f64, N, N>::identity() * stable;
                if let Some(inverse) = self.information.cholesky() {
                    self.covariance = inverse.inverse();
                    self.theta = self.covariance * right;
                }
            }
        }
        let spread = self.covariance * phi;
        let gain = spread / (1.0 + phi.dot(&spread));
        self.theta += gain * (psi - phi.dot(&self.theta));
        self.covariance -= gain * spread.transpose();
        self.information += phi * phi.transpose();
        if let Kind::InTurn { variance, follows } = self.kind {
            let forgotten = if self.wait == 0 { self.lambda } else { 1.0 };
            let brings = forgotten * phi.dot(&spread) > 1.5 * (1.0 - self.lambda);
            self.wait = match (brings, self.wait) {
                (true, _) => 0,
                (false, 0) => 7,
                (false, wait) => wait - 1,
            };
            let (i, observes) = (self.turn / 2, self.turn % 2 == 1);
            self.turn = (self.turn + 1) % (2 * N);
            if !observes {
                return;
            }
            let column = self.covariance.column(i).into_owned();
            let known = column[i];
            let least = self.unsupported[i] / (2.0 * N as f64 * (1.0 - self.lambda));
            let gain = column / (variance.max(least) + known);
            self.theta += gain * (self.nominal[i] - self.theta[i]);
            self.covariance -= gain * column.transpose();
            if brings && known < follows {
                self.unsupported[i] = 0.0;
                self.nominal[i] = self.theta[i];
            }
        }
    }
}

/// Rows of the default structure for an integrating servo, from samples of command and position.
///
/// Trends through `1/A_f` by trapezoids, each entry scaled to the size of its signal at the
/// bandwidth; the columns are those of (a1, a2, b0, constant, initial state).
#[derive(Clone, Debug)]
pub struct ServoRows {
    filter: [f64; 3],
    half: f64,
    scale: [f64; 4],
    signals: [[f64; 3]; 3],
    initial: f64,
    decay: f64,
    origin: Option<f64>,
    /// User's unit of each parameter.
    pub units: [f64; 5],
}

impl ServoRows {
    /// Rows for a bandwidth in rad/s, the sizes of command and position, and the sample time in s.
    pub fn new(bandwidth: f64, input: f64, output: f64, dt: f64) -> Self {
        let (slow, square) = (0.11 * bandwidth, 1.21 * bandwidth * bandwidth);
        let middle = 1.54 * bandwidth;
        let at = |power: i32| bandwidth.powi(3 - power);
        Self {
            filter: [slow * square, square + slow * middle, middle + slow],
            half: 0.5 * dt,
            scale: [1.0 / output, at(1) / output, at(2) / output, at(0) / input],
            signals: [[0.0; 3]; 3],
            initial: 1.0,
            decay: (1.0 - 0.5 * dt * slow) / (1.0 + 0.5 * dt * slow),
            origin: None,
            units: [at(1), at(2), at(0) * output / input, at(0) * output, output],
        }
    }

    /// The row of u(k) and y(k).
    pub fn update(&mut self, u: f64, y: f64) -> ([f64; 5], f64) {
        let y = y - *self.origin.get_or_insert(y);
        let [output, input, constant] = self.signals;
        let (y, output) = self.chain(output, y, 0.0);
        let (u, input) = self.chain(input, 0.0, u);
        let (one, constant) = self.chain(constant, 0.0, 1.0);
        self.signals = [output, input, constant];
        let initial = self.initial;
        self.initial *= self.decay;
        let [top, first, second, held] = self.scale;
        let phi = [
            -first * y[1],
            -second * y[2],
            held * u[0],
            // Of size 1, as the bandwidth makes it.
            self.units[3] * top * one[0],
            self.units[4] * top * initial,
        ];
        (phi, top * y[3])
    }

    /// One sample through the integrators: the trends 0 to 3, and what they leave for the next
    /// sample.
    fn chain(&self, memory: [f64; 3], direct: f64, held: f64) -> ([f64; 4], [f64; 3]) {
        let h = self.half;
        let mut known = memory;
        known[1] += h * known[2];
        known[0] += h * known[1];
        let feedback: f64 = (0..3).map(|i| self.filter[i] * known[i]).sum();
        let closed = 1.0 + h * (self.filter[2] + h * (self.filter[1] + h * self.filter[0]));
        let top = (direct - feedback) / closed;
        let second = memory[2] + h * top;
        let first = memory[1] + h * second;
        let zeroth = memory[0] + h * first;
        let next = [
            zeroth + h * first,
            first + h * second,
            second + h * top + 2.0 * h * held,
        ];
        ([zeroth, first, second, top], next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plants::servo::{REFERENCE, Servo};
    use crate::signals::excitation::Excitation;

    #[test]
    fn each_finds_the_reference_servo() {
        for kind in [
            Kind::Plain,
            Kind::Directional,
            Kind::Stabilised { variance: 1e3 },
        ] {
            let mut rows = ServoRows::new(20.0, 0.4, 50.0, 1e-3);
            let mut estimator = Forgetting::<5>::new(kind, [1e8; 5], 2000.0);
            let mut plant = REFERENCE.plant(1e-3);
            for u in Excitation::ABSOLUTE.sequence(10_000, 1e-3, 1) {
                let (phi, psi) = rows.update(u, plant.output());
                estimator.update(&phi, psi);
                estimator.set_nominal();
                plant.step(&[u]);
            }
            let theta: [f64; 5] = std::array::from_fn(|j| rows.units[j] * estimator.theta()[j]);
            let found = Servo::from_coefficients(theta[0], theta[1], theta[2]).expect("a servo");
            for error in found.error_pct(&REFERENCE) {
                assert!(error.abs() < 0.02, "{kind:?}: {found:?}");
            }
        }
    }

    #[test]
    fn at_rest_plain_forgetting_winds_up_and_the_others_do_not() {
        let largest = |kind| {
            let mut estimator = Forgetting::<2>::new(kind, [1e4; 2], 200.0);
            for k in 0..20_000 {
                let wave = f64::from(k % 7) - 3.0;
                let phi = if k < 2000 { [1.0, wave] } else { [1.0, 0.0] };
                estimator.update(&phi, phi[0] - 2.0 * phi[1]);
            }
            estimator.largest_variance()
        };
        assert!(largest(Kind::Plain) > 1e30);
        assert!(largest(Kind::Directional) < 1.0);
        assert!(largest(Kind::Stabilised { variance: 1e3 }) < 1.1e3);
    }
}
