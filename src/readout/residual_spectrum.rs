//! How much of the residual's noise falls where each direction of the parameters is seen.
//!
//! The residual of the filtered equation is `A/A_f` times the white noise of y, not white. The information of least
//! squares and the noise in it are
//!
//! ```text
//! R = sum_omega W phi(j omega) phi(j omega)^H              ~ P^-1
//! S = sum_omega W phi(j omega) phi(j omega)^H |A/A_f|^2
//! ```
//!
//! over a flat command spectrum W.

use crate::estimation::terms::Parameter;
use crate::math::complex::Complex;
use crate::math::matrix::Matrix;
use crate::math::polynomial::{unscaled, value_at};
use crate::math::{pow, raised, sqrt};

/// The model whose residual it is; everything in the user's units.
pub(crate) struct ResidualSpectrum<'a, const M: usize, const N: usize> {
    /// What each parameter is.
    pub(crate) parameters: [Parameter; N],
    /// User's value of one normalised unit.
    pub(crate) units: &'a [f32; N],
    /// The parameters.
    pub(crate) theta: &'a [f32; N],
    /// a_0 .. a_{m-1}.
    pub(crate) denominator: [f32; M],
    /// f_0 .. f_{m-1}.
    pub(crate) filter: [f32; M],
    /// Natural frequency of the model in rad/s.
    pub(crate) natural: f32,
    /// Time in the memory in s.
    pub(crate) duration: f32,
    /// Rate of the slowest pole of the filter in rad/s.
    pub(crate) slowest: f32,
}

/// Frequencies of the sums, evenly on a logarithmic scale from 0.05 to 3.5 times the natural frequency.
const FREQUENCIES: usize = 12;
const LOWEST: f32 = 0.05;
const STEP: f32 = 1.47;

/// A record of T seconds shows a spectrum through a kernel with the tails of a Lorentz curve of half width 1/T.
const BLUR: f32 = 3.0;

impl<const M: usize, const N: usize> ResidualSpectrum<'_, M, N> {
    /// The sums R and S, in normalised units.
    pub(crate) fn sums(&self) -> (Matrix<N>, Matrix<N>) {
        let mut sums = [[[0.0; N]; N]; 2];
        let mut plants = [Complex::ZERO; FREQUENCIES];
        let (mut filters, mut residuals) = ([0.0; FREQUENCIES], [0.0; FREQUENCIES]);
        let denominator = unscaled(&self.denominator, self.natural);
        let filter = unscaled(&self.filter, self.natural);
        let mut x = LOWEST;
        for k in 0..FREQUENCIES {
            let s = Complex { re: 0.0, im: x };
            plants[k] = value_at(&denominator, s);
            filters[k] = value_at(&filter, s).size();
            residuals[k] = plants[k].size() / filters[k];
            x *= STEP;
        }
        let scales = self.scales();
        let mut x = LOWEST;
        for (plant, filter) in plants.into_iter().zip(filters) {
            let residual = self.blurred(&residuals, x);
            // d omega is proportional to omega on a logarithmic scale.
            self.add_frequency(&mut sums, &scales, x, plant, [x / filter, residual]);
            x *= STEP;
        }
        for matrix in &mut sums {
            for i in 0..N {
                for j in 0..i {
                    matrix[j][i] = matrix[i][j];
                }
            }
        }
        let [r, s] = sums;
        (r, s)
    }

    /// omega_n^(m-power) for every power below m.
    fn scales(&self) -> [f32; M] {
        core::array::from_fn(|power| raised(self.natural, M - power))
    }

    /// Adds what is seen at `x` times the natural frequency to the lower triangles of R and S.
    ///
    /// Each input, the constant and the initial state are excitations of their own.
    fn add_frequency(
        &self,
        [r, s]: &mut [Matrix<N>; 2],
        scales: &[f32; M],
        x: f32,
        plant: Complex,
        [weight, residual]: [f32; 2],
    ) {
        for first in 0..N {
            let rate = match self.parameters[first] {
                Parameter::Input { input, power } if self.leads(first, input) => {
                    let range = scale_of(scales, power) / self.units[first];
                    let phi = self.response(input, scales, range, x, plant);
                    for i in 0..N {
                        for j in 0..=i {
                            let both = weight * (phi[i].re * phi[j].re + phi[i].im * phi[j].im);
                            r[i][j] += both;
                            s[i][j] += both * residual;
                        }
                    }
                    continue;
                }
                Parameter::InitialState => self.slowest / self.natural,
                Parameter::Constant => LOWEST,
                _ => continue,
            };
            let phi = 1.0 / sqrt(x * x + rate * rate);
            let both = weight * (phi * phi);
            r[first][first] += both;
            s[first][first] += both * residual;
        }
    }

    /// Mean of `|A/A_f|^2` about `x`, as a record of this duration shows it.
    fn blurred(&self, residuals: &[f32; FREQUENCIES], x: f32) -> f32 {
        let width = BLUR / (self.duration * self.natural);
        let (mut sum, mut weights) = (0.0, 0.0);
        let mut other = LOWEST;
        for residual in residuals {
            let (near, far) = (x - other, x + other);
            let weight =
                other / (width * width + near * near) + other / (width * width + far * far);
            sum += weight * residual;
            weights += weight;
            other *= STEP;
        }
        sum / weights
    }

    /// Whether the parameter at `place` is the first of its input.
    fn leads(&self, place: usize, input: usize) -> bool {
        !self
            .parameters
            .iter()
            .take(place)
            .any(|c| matches!(c, Parameter::Input { input: other, .. } if *other == input))
    }

    /// The normalised regressor for the input at `x` times the natural frequency, without `1/A_f`.
    fn response(
        &self,
        input: usize,
        scales: &[f32; M],
        range: f32,
        x: f32,
        plant: Complex,
    ) -> [Complex; N] {
        // G = B/A
        let mut numerator = Complex::ZERO;
        for (parameter, value) in self.parameters.iter().zip(self.theta) {
            if let Parameter::Input { input: of, power } = *parameter
                && of == input
            {
                let b = value / scale_of(scales, power);
                numerator = numerator.plus(Complex::power(x, power, b));
            }
        }
        let output = numerator.times(plant.inverse());
        let mut phi = [Complex::ZERO; N];
        for (j, parameter) in self.parameters.iter().enumerate() {
            let value = match *parameter {
                Parameter::Output { power } => {
                    let order = Complex::power(x, power, -1.0 / scale_of(scales, power));
                    order.times(output)
                }
                Parameter::Input { input: of, power } if of == input => {
                    Complex::power(x, power, 1.0 / scale_of(scales, power))
                }
                _ => Complex::ZERO,
            };
            let scale = range * self.units[j];
            phi[j] = Complex {
                re: scale * value.re,
                im: scale * value.im,
            };
        }
        phi
    }
}

/// omega_n^(m-power); 1 for a power that no parameter has.
fn scale_of(scales: &[f32], power: usize) -> f32 {
    scales.get(power).copied().unwrap_or(1.0)
}

/// The natural frequency of a denominator in rad/s, or the bandwidth where it has no sensible one.
pub(crate) fn natural_frequency<const M: usize>(a: &[f32; M], bandwidth: f32) -> f32 {
    let first = a.iter().position(|v| *v != 0.0).unwrap_or(0);
    let natural = pow(a[first].abs(), 1.0 / (M - first) as f32);
    if natural > 0.1 * bandwidth && natural < 10.0 * bandwidth {
        natural
    } else {
        bandwidth
    }
}

/// Mean of |A/A_f|^2 over 0.1 to 2.5 times the natural frequency, weighted by the spectrum of the regressor.
pub(crate) fn in_band<const M: usize>(a: &[f32; M], filter: &[f32; M], bandwidth: f32) -> f32 {
    let natural = natural_frequency(a, bandwidth);
    let (a, filter) = (unscaled(a, natural), unscaled(filter, natural));
    let (mut sum, mut weights) = (0.0, 0.0);
    for step in 0..25 {
        let x = 0.1 * (step + 1) as f32;
        let s = Complex { re: 0.0, im: x };
        let plant = value_at(&a, s).size();
        let filter = value_at(&filter, s).size();
        // x^(2m) / |A A_f|^2: the trend of order m of y under a flat command.
        let weight = raised(x * x, M) / (plant * filter);
        if weight.is_finite() {
            sum += weight * plant / filter;
            weights += weight;
        }
    }
    if weights > 0.0 { sum / weights } else { 1.0 }
}
