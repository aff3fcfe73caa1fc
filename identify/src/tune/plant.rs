//! The plant as a sampled controller sees it: held inputs, a delay between samples, no
//! discretisation error.

use nalgebra::{Complex, DMatrix, DVector, RowDVector};

use super::model::Model;

/// Least unit of the states, per sample: slower plants differ by nothing that a loop shows.
const SLOWEST: f64 = 1e-6;

/// `x(k+1) = A x(k) + B_0 u(k-d) + B_1 u(k-d-1)`, `y = C x`.
///
/// The states are those of the controllable form, entry i times `rate^(m-1-i)`, so that all are of
/// one size.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledPlant {
    pub(super) a: DMatrix<f64>,
    pub(super) b: [DVector<f64>; 2],
    pub(super) c: RowDVector<f64>,
    /// Whole samples of the delay.
    pub(super) delay: usize,
    pub(super) dt: f64,
    /// The unit of the states \[rad/s\].
    pub(super) rate: f64,
}

impl SampledPlant {
    pub(super) fn new(model: &Model, dt: f64) -> Self {
        let m = model.a.len();
        let of_order = |i: usize| model.a[m - i].abs().powf(1.0 / i as f64);
        let largest = (1..=m).map(of_order).fold(0.0, f64::max);
        let rate = match largest > 0.0 {
            true => largest.max(SLOWEST / dt),
            false => 0.1 / dt,
        };
        let unit = |i: usize| rate.powi((m - 1 - i) as i32);
        let mut continuous = DMatrix::zeros(m + 1, m + 1);
        for i in 0..m {
            if i + 1 < m {
                continuous[(i, i + 1)] = rate;
            }
            continuous[(m - 1, i)] = -model.a[i] / unit(i);
        }
        // The input in the unit of the states.
        continuous[(m - 1, m)] = rate;
        let over = |t: f64| {
            let step = (continuous.clone() * t).exp();
            (
                step.view((0, 0), (m, m)).into_owned(),
                step.view((0, m), (m, 1)).column(0).into_owned(),
            )
        };
        let samples = model.delay / dt;
        let delay = samples.floor();
        // Of a sample interval the older input acts over this share.
        let part = samples - delay;
        let (a, _) = over(dt);
        let (rest, newer) = over((1.0 - part) * dt);
        let older = rest * over(part * dt).1;
        let c = RowDVector::from_fn(m, |_, i| {
            model.b.get(i).copied().unwrap_or(0.0) / unit(i) / rate
        });
        Self {
            a,
            b: [newer, older],
            c,
            delay: delay as usize,
            dt,
            rate,
        }
    }

    /// Sample time \[s\].
    pub fn sample_time(&self) -> f64 {
        self.dt
    }

    /// The size of the gain, with the sign of b_0: all gains of a controller are in units of it.
    pub(super) fn gain(&self) -> f64 {
        self.c.amax().copysign(self.c[0])
    }

    /// With a gain divided by so much.
    pub(super) fn divided(&self, gain: f64) -> Self {
        let c = &self.c / gain;
        Self { c, ..self.clone() }
    }

    /// Whether all numbers are finite.
    pub(super) fn is_finite(&self) -> bool {
        let numbers = self.a.iter().chain(&self.b[0]).chain(&self.b[1]);
        numbers.chain(&self.c).all(|v| v.is_finite())
    }

    /// Order of the plant.
    pub(super) fn order(&self) -> usize {
        self.a.nrows()
    }

    /// Frequency response of the samples, hold and delay included, at `omega` \[rad/s\].
    pub fn response(&self, omega: f64) -> Complex<f64> {
        let z = Complex::new(0.0, omega * self.dt).exp();
        let inverse = z.inv();
        let b = DVector::from_fn(self.order(), |i, _| {
            (inverse * self.b[1][i] + self.b[0][i]) * inverse.powu(self.delay as u32)
        });
        let x = solve(&self.a, z, b);
        self.c.iter().zip(x.iter()).map(|(c, x)| x * *c).sum()
    }
}

/// `(z - A)^-1 b`; not finite where z is an eigenvalue.
pub(super) fn solve(
    a: &DMatrix<f64>,
    z: Complex<f64>,
    b: DVector<Complex<f64>>,
) -> DVector<Complex<f64>> {
    let n = a.nrows();
    let matrix = DMatrix::from_fn(n, n, |i, j| match i == j {
        true => z - a[(i, j)],
        false => Complex::new(-a[(i, j)], 0.0),
    });
    let nothing = DVector::from_element(n, Complex::new(f64::NAN, f64::NAN));
    matrix.lu().solve(&b).unwrap_or(nothing)
}
