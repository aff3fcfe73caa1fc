//! The servo of the paper, its identifier, and the Cramer-Rao bound beside it.

use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, ConfigError, Servo, Structure};
use trendid_host_tests::plants::servo::REFERENCE;
use trendid_host_tests::signals::excitation::Excitation;
use trendid_host_tests::signals::noise::{Additive, Condition, quantised};

/// Sample time in s.
const DT: f64 = 1e-3;

/// Commands after which the sequence of the excitation begins again.
const PERIOD: usize = 60_000;

/// Commands and strokes that the identifier is told of.
const RANGES: [f32; 2] = [0.4, 50.0];

/// The servo with its identifier.
pub(crate) struct ServoPlay {
    drive: Drive,
    noise: Additive,
    /// Resolution \[mm\].
    eps: f64,
    commands: Vec<f64>,
    identifier: Servo,
    k: usize,
}

impl ServoPlay {
    /// Begins at rest; widths of noise, drift and resolution in um.
    pub(crate) fn new(
        [eta, drift, eps]: [f32; 3],
        filter: f32,
        memory: f32,
        seed: u32,
    ) -> Result<Self, ConfigError> {
        let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, DT as f32, filter)?;
        let [input, output] = RANGES;
        let mut config = Config::new(Structure::SERVO, filter, [input], output);
        config.memory = (memory > 0.0).then_some(memory);
        let condition = Condition {
            w_um: f64::from(drift),
            eta_um: f64::from(eta),
            eps_um: f64::from(eps),
            ..Condition::CLEAN
        };
        let eps = 1e-3 * f64::from(eps);
        // Uniform noise of the widths; the drift is not white and has no part in the bound.
        let variance = (1e-6 * f64::from(eta * eta) + eps * eps) / 12.0;
        Ok(Self {
            drive: Drive::new(variance),
            noise: Additive::new(&condition, u64::from(seed)),
            eps,
            commands: Excitation::ABSOLUTE.sequence(PERIOD, DT, u64::from(seed)),
            identifier: Servo::try_new(&config, trends)?,
            k: 0,
        })
    }

    /// One sample: t, u, y, x.
    pub(crate) fn step(&mut self) -> [f32; 4] {
        let u = self.commands[self.k % PERIOD];
        let x = self.drive.position();
        let y = quantised(x + self.noise.next().unwrap_or(0.0), self.eps);
        let _ = self.identifier.update(u as f32, y as f32);
        self.drive.step(u);
        let t = self.k as f64 * DT;
        self.k += 1;
        [t, u, y, x].map(|value| value as f32)
    }

    /// Values, standard deviations, bounds: each of a1, a2, b0, C, omega0, xi.
    pub(crate) fn read(&self) -> [f32; 18] {
        let found = self.identifier.estimate();
        let (theta, std) = (found.theta(), found.std());
        let reading = found.physical();
        let known = found.physical_std().unwrap_or([f32::INFINITY; 3]);
        let unknown = |value: Option<f32>| value.unwrap_or(f32::NAN);
        let mut read = [f32::NAN; 18];
        read[..3].copy_from_slice(&theta[..3]);
        read[3..6].copy_from_slice(&[reading.gain, reading.omega0, reading.damping].map(unknown));
        read[6..9].copy_from_slice(&std[..3]);
        read[9..12].copy_from_slice(&known);
        if let Some(bound) = self.drive.bound() {
            read[12..].copy_from_slice(&bound.map(|b| b as f32));
        }
        read
    }
}

/// The drive with the sensitivities of its position, and the Cramer-Rao bound of a1, a2, b0 that
/// follows from them for white noise and a known start.
///
/// x''' = - a1 x' - a2 x'' + b0 u; the derivative of x by a parameter obeys the same equation,
/// driven by - x', - x'' and u.
struct Drive {
    /// x and its derivatives by a1, a2, b0, each with two derivatives by time.
    state: [[f64; 3]; 4],
    information: [[f64; 3]; 3],
    variance: f64,
}

impl Drive {
    const fn new(variance: f64) -> Self {
        Self {
            state: [[0.0; 3]; 4],
            information: [[0.0; 3]; 3],
            variance,
        }
    }

    /// Position in mm.
    const fn position(&self) -> f64 {
        self.state[0][0]
    }

    /// Holds a command for a sample: Runge and Kutta of order four in two steps, exact to nine
    /// digits of the motion.
    fn step(&mut self, u: f64) {
        const H: f64 = 0.5 * DT;
        let psi = [1, 2, 3].map(|i: usize| self.state[i][0]);
        for (row, p) in self.information.iter_mut().zip(psi) {
            for (sum, q) in row.iter_mut().zip(psi) {
                *sum += p * q;
            }
        }
        for _ in 0..2 {
            let x = self.state;
            let k1 = rate(&x, u);
            let k2 = rate(&moved(&x, &k1, 0.5 * H), u);
            let k3 = rate(&moved(&x, &k2, 0.5 * H), u);
            let k4 = rate(&moved(&x, &k3, H), u);
            for i in 0..4 {
                for j in 0..3 {
                    let sum = k1[i][j] + 2.0 * (k2[i][j] + k3[i][j]) + k4[i][j];
                    self.state[i][j] += H / 6.0 * sum;
                }
            }
        }
    }

    /// Standard deviations of a1, a2, b0, C, omega0, xi; `None` without noise or before the record
    /// says anything.
    fn bound(&self) -> Option<[f64; 6]> {
        let p = inverse(&self.information)?;
        let [_, a1, a2] = REFERENCE.a();
        let b0 = REFERENCE.b0();
        let omega0 = a1.sqrt();
        let xi = a2 / (2.0 * omega0);
        // Gradients of C = b0/a1, omega0 = sqrt(a1), xi = a2/(2 omega0).
        let gradients = [
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [-b0 / (a1 * a1), 0.0, 1.0 / a1],
            [0.5 / omega0, 0.0, 0.0],
            [-0.5 * xi / a1, 0.5 / omega0, 0.0],
        ];
        Some(gradients.map(|g| {
            let variance: f64 = (0..3)
                .flat_map(|i| (0..3).map(move |j| (i, j)))
                .map(|(i, j)| g[i] * p[i][j] * g[j])
                .sum();
            (self.variance * variance.max(0.0)).sqrt()
        }))
    }
}

/// Derivatives by time.
fn rate(x: &[[f64; 3]; 4], u: f64) -> [[f64; 3]; 4] {
    let [_, a1, a2] = REFERENCE.a();
    let forced = [REFERENCE.b0() * u, -x[0][1], -x[0][2], u];
    std::array::from_fn(|i| {
        let [_, v, a] = x[i];
        [v, a, forced[i] - a1 * v - a2 * a]
    })
}

fn moved(x: &[[f64; 3]; 4], by: &[[f64; 3]; 4], h: f64) -> [[f64; 3]; 4] {
    std::array::from_fn(|i| std::array::from_fn(|j| x[i][j] + h * by[i][j]))
}

/// Inverse of a symmetric matrix by its cofactors, in units in which its diagonal is one.
fn inverse(m: &[[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let scale: [f64; 3] = std::array::from_fn(|i| m[i][i].sqrt());
    if scale.iter().any(|s| !(*s > 0.0)) {
        return None;
    }
    let n = |i: usize, j: usize| m[i % 3][j % 3] / (scale[i % 3] * scale[j % 3]);
    let cofactor =
        |i: usize, j: usize| n(i + 1, j + 1) * n(i + 2, j + 2) - n(i + 1, j + 2) * n(i + 2, j + 1);
    let determinant: f64 = (0..3).map(|j| n(0, j) * cofactor(0, j)).sum();
    (determinant > 1e-9).then(|| {
        std::array::from_fn(|i| {
            std::array::from_fn(|j| cofactor(j, i) / (determinant * scale[i] * scale[j]))
        })
    })
}

#[cfg(test)]
mod tests {
    use trendid_host_tests::oracles::cramer_rao::{Coefficient, coefficient_bound};

    use super::*;

    /// The bound sample by sample is that of the oracle over the whole record.
    #[test]
    fn the_bound_is_that_of_the_oracle() {
        let mut play = ServoPlay::new([500.0, 0.0, 0.0], 20.0, 0.0, 7).unwrap();
        for _ in 0..2000 {
            let _ = play.step();
        }
        let u = Excitation::ABSOLUTE.sequence(PERIOD, DT, 7);
        let exact = REFERENCE.plant(DT).response(&u[..2001]);
        assert!((play.drive.position() / exact[2000] - 1.0).abs() < 1e-8);
        let free = [
            Coefficient::A(1),
            Coefficient::A(2),
            Coefficient::B { input: 0, power: 0 },
        ];
        let sigma = 0.5 / 12.0_f64.sqrt();
        let oracle = coefficient_bound(&REFERENCE.plant(DT), &free, &[&u[..2000]], sigma);
        let bound = play.drive.bound().unwrap();
        let oracle = oracle.unwrap();
        for i in 0..3 {
            assert!(
                (bound[i] / oracle[i] - 1.0).abs() < 1e-6,
                "{i}: {} {}",
                bound[i],
                oracle[i]
            );
        }
    }

    #[test]
    fn the_servo_is_found_within_its_bands() {
        let truth = [400.0, 20.0, 1e6, 2500.0, 20.0, 0.5];
        let (mut within, mut all) = (0, 0);
        for seed in 0..20 {
            let mut play = ServoPlay::new([500.0, 0.0, 10.0], 20.0, 0.0, seed).unwrap();
            for _ in 0..4000 {
                let _ = play.step();
            }
            let read = play.read();
            for i in 0..6 {
                all += 1;
                within += u32::from((read[i] - truth[i]).abs() < 3.0 * read[6 + i]);
                assert!(
                    read[6 + i] > 0.5 * read[12 + i],
                    "{i}: no better than the bound"
                );
            }
        }
        assert!(within * 100 >= all * 95, "{within} of {all}");
    }
}
