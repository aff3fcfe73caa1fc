//! How much of the residual's noise falls where each direction of the parameters is seen.
//!
//! The residual of the filtered equation is `A/A_f` times the white noise of y, not white. The
//! information of least squares and the noise in it are
//!
//! ```text
//! R = sum_omega W phi(j omega) phi(j omega)^H              ~ P^-1
//! S = sum_omega W phi(j omega) phi(j omega)^H |A/A_f|^2
//! ```
//!
//! over a flat command spectrum W. An entry of phi is a power of j omega, that of y times -G, so an
//! entry of the matrices is a moment of W, W Re G, W Im G or W |G|^2 over even or odd powers of
//! omega: those are summed, not the matrices.

use crate::estimation::terms::Parameter;
use crate::math::complex::Complex;
use crate::math::matrix::Matrix;
use crate::math::polynomial::{unscaled, value_at_imaginary};
use crate::math::{pow, raised};

/// The model whose residual it is; everything in the user's units.
pub(crate) struct ResidualSpectrum<'a, const M: usize, const N: usize> {
    /// Meaning of each parameter.
    pub(crate) parameters: [Parameter; N],
    /// User's value of one normalised unit.
    pub(crate) units: &'a [f32; N],
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

/// Frequencies of the sums, on a logarithmic scale from 0.05 to 3.5 times the natural frequency.
const FREQUENCIES: usize = 12;
const LOWEST: f32 = 0.05;
const STEP: f32 = 1.47;

/// Half width over 1/T of how T seconds show a line, as a Lorentz curve: of `sinc^2(w T/2)` 2.8.
const BLUR: f32 = 3.0;

/// Sums over the frequencies of W times `x^(2k)`, in `imaginary` times `x^(2k+1)`, k = 0, 1, ..
#[derive(Clone, Copy)]
struct Moments<const M: usize> {
    /// Of W.
    one: [f32; M],
    /// Of W Re G.
    real: [f32; M],
    /// Of W Im G.
    imaginary: [f32; M],
    /// Of W |G|^2.
    square: [f32; M],
}

impl<const M: usize> Moments<M> {
    const ZERO: Self = Self {
        one: [0.0; M],
        real: [0.0; M],
        imaginary: [0.0; M],
        square: [0.0; M],
    };

    /// Adds the frequency x with the weight W, where the plant is `g`.
    fn add(&mut self, x: f32, weight: f32, g: Complex) {
        let (square, size) = (x * x, g.size());
        let mut even = weight;
        for k in 0..M {
            self.one[k] += even;
            self.real[k] += even * g.re;
            self.imaginary[k] += even * x * g.im;
            self.square[k] += even * size;
            even *= square;
        }
    }

    /// Sum of W times the real part of `row` times the conjugate of `column`.
    fn entry(&self, row: Seen, column: Seen) -> f32 {
        let sum = row.power + column.power;
        let of = |moments: &[f32; M]| moments.get(sum / 2).copied().unwrap_or(0.0);
        let value = match (row.output, column.output) {
            (true, true) if sum.is_multiple_of(2) => of(&self.square),
            (false, false) if sum.is_multiple_of(2) => of(&self.one),
            (true, true) | (false, false) => 0.0,
            _ if sum.is_multiple_of(2) => -of(&self.real),
            // j^(p-q) with p - q odd: the row or the column carries -G, or its conjugate.
            (true, false) => of(&self.imaginary),
            (false, true) => -of(&self.imaginary),
        };
        // j^(p-q) is 1 or j where p - q is 0 or 1 modulo 4, and their negative elsewhere.
        match (4 * M + row.power - column.power) % 4 {
            0 | 1 => value,
            _ => -value,
        }
    }
}

/// How a parameter is seen under one input: `factor (j x)^power`, times -G for one of the output.
#[derive(Clone, Copy)]
struct Seen {
    factor: f32,
    power: usize,
    output: bool,
}

impl<const M: usize, const N: usize> ResidualSpectrum<'_, M, N> {
    /// The sums R and S, in normalised units.
    ///
    /// Each input, the constant and the initial state are excitations of their own.
    pub(crate) fn sums(&self) -> (Matrix<N>, Matrix<N>) {
        let denominator = unscaled(&self.denominator, self.natural);
        let filter = unscaled(&self.filter, self.natural);
        let (mut plants, mut weights) = ([Complex::ZERO; FREQUENCIES], [0.0; FREQUENCIES]);
        let mut residuals = [0.0; FREQUENCIES];
        let grid = grid();
        for (k, x) in grid.into_iter().enumerate() {
            plants[k] = value_at_imaginary(&denominator, x);
            let filter = value_at_imaginary(&filter, x).size();
            residuals[k] = plants[k].size() / filter;
            // d omega is proportional to omega on a logarithmic scale.
            weights[k] = x / filter;
        }
        let residuals = self.blurred(&grid, &residuals);
        let plants = plants.map(Complex::inverse);
        let scales: [f32; M] = core::array::from_fn(|power| raised(self.natural, M - power));
        let mut sums = [[[0.0; N]; N]; 2];
        for first in 0..N {
            let rate = match self.parameters[first] {
                Parameter::Input { input, power } if self.leads(first, input) => {
                    let range = scale_of(&scales, power) / self.units[first];
                    let seen = self.seen(input, &scales, range);
                    let numerator = self.numerator(input, &scales);
                    let mut moments = [Moments::<M>::ZERO; 2];
                    for k in 0..FREQUENCIES {
                        let g = value_of(&numerator, grid[k]).times(plants[k]);
                        moments[0].add(grid[k], weights[k], g);
                        moments[1].add(grid[k], weights[k] * residuals[k], g);
                    }
                    for (sum, moments) in sums.iter_mut().zip(&moments) {
                        add_entries(sum, moments, &seen);
                    }
                    continue;
                }
                Parameter::InitialState => self.slowest / self.natural,
                Parameter::Constant => LOWEST,
                _ => continue,
            };
            for k in 0..FREQUENCIES {
                let both = weights[k] / (grid[k] * grid[k] + rate * rate);
                sums[0][first][first] += both;
                sums[1][first][first] += both * residuals[k];
            }
        }
        sums.into()
    }

    /// Mean of `|A/A_f|^2` about each frequency, as a record of this duration shows it.
    fn blurred(
        &self,
        grid: &[f32; FREQUENCIES],
        residuals: &[f32; FREQUENCIES],
    ) -> [f32; FREQUENCIES] {
        let width = BLUR / (self.duration * self.natural);
        let (mut sums, mut weights) = ([0.0; FREQUENCIES], [0.0; FREQUENCIES]);
        for k in 0..FREQUENCIES {
            // The kernel is symmetric: each pair once.
            for l in 0..=k {
                let (x, other) = (grid[k], grid[l]);
                let (near, far) = (x - other, x + other);
                let kernel =
                    1.0 / (width * width + near * near) + 1.0 / (width * width + far * far);
                weights[k] += kernel * other;
                sums[k] += kernel * other * residuals[l];
                if l < k {
                    weights[l] += kernel * x;
                    sums[l] += kernel * x * residuals[k];
                }
            }
        }
        core::array::from_fn(|k| sums[k] / weights[k])
    }

    /// Whether the parameter at `place` is the first of its input.
    fn leads(&self, place: usize, input: usize) -> bool {
        !self
            .parameters
            .iter()
            .take(place)
            .any(|c| matches!(c, Parameter::Input { input: other, .. } if *other == input))
    }

    /// How the parameters are seen under `input` of the size `range`; `None` where they are not.
    fn seen(&self, input: usize, scales: &[f32; M], range: f32) -> [Option<Seen>; N] {
        core::array::from_fn(|j| {
            let (power, output) = match self.parameters[j] {
                Parameter::Output { power } => (power, true),
                Parameter::Input { input: of, power } if of == input => (power, false),
                _ => return None,
            };
            Some(Seen {
                factor: range * self.units[j] / scale_of(scales, power),
                power,
                output,
            })
        })
    }

    /// b_0 .. b_{m-1} of an input over the powers of the natural frequency.
    fn numerator(&self, input: usize, scales: &[f32; M]) -> [f32; M] {
        let mut b = [0.0; M];
        for (parameter, value) in self.parameters.iter().zip(self.theta) {
            if let Parameter::Input { input: of, power } = *parameter
                && of == input
                && let Some(b) = b.get_mut(power)
            {
                *b = value / scale_of(scales, power);
            }
        }
        b
    }
}

/// The frequencies over the natural frequency.
const fn grid() -> [f32; FREQUENCIES] {
    let mut grid = [LOWEST; FREQUENCIES];
    let mut k = 1;
    while k < FREQUENCIES {
        grid[k] = grid[k - 1] * STEP;
        k += 1;
    }
    grid
}

/// The polynomial with the coefficients `b` at j x.
fn value_of(b: &[f32], x: f32) -> Complex {
    b.iter().rev().fold(Complex::ZERO, |value, b| Complex {
        re: b - value.im * x,
        im: value.re * x,
    })
}

/// Adds what is seen under one input to R or S.
fn add_entries<const M: usize, const N: usize>(
    sum: &mut Matrix<N>,
    moments: &Moments<M>,
    seen: &[Option<Seen>; N],
) {
    for i in 0..N {
        for j in 0..=i {
            if let (Some(row), Some(column)) = (seen[i], seen[j]) {
                let entry = row.factor * column.factor * moments.entry(row, column);
                sum[i][j] += entry;
                sum[j][i] = sum[i][j];
            }
        }
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

/// Mean of |A/A_f|^2 from 0.1 to 2.5 times the natural frequency, weighted as the regressor is.
pub(crate) fn in_band<const M: usize>(a: &[f32; M], filter: &[f32; M], bandwidth: f32) -> f32 {
    let natural = natural_frequency(a, bandwidth);
    let (a, filter) = (unscaled(a, natural), unscaled(filter, natural));
    let (mut sum, mut weights) = (0.0, 0.0);
    for step in 0..25 {
        let x = 0.1 * (step + 1) as f32;
        let plant = value_at_imaginary(&a, x).size();
        let filter = value_at_imaginary(&filter, x).size();
        // x^(2m) / |A A_f|^2: the trend of order m of y under a flat command.
        let weight = raised(x * x, M) / (plant * filter);
        if weight.is_finite() {
            sum += weight * plant / filter;
            weights += weight;
        }
    }
    if weights > 0.0 { sum / weights } else { 1.0 }
}

#[cfg(test)]
mod tests;
