//! How much of the residual's noise falls where each direction of the parameters is seen.
//!
//! The residual of the filtered equation is `A/A_f` times the white noise of y, not white. The covariance of least
//! squares is then `P S P` with
//!
//! ```text
//! R = sum_omega W phi(j omega) phi(j omega)^H              ~ P^-1
//! S = sum_omega W phi(j omega) phi(j omega)^H |A/A_f|^2
//! ```
//!
//! over a flat command spectrum W. With `R = L L'` and `L^-1 S L^-T = Z Z'` the matrix
//! `T = L^-T Z L'` gives `T P T' = R^-1 S R^-1` where P is `R^-1`, and stays positive for any other P.

use crate::estimation::terms::Parameter;
use crate::math::{pow, sqrt};

/// A matrix of the parameters.
pub(crate) type Matrix<const N: usize> = [[f32; N]; N];

/// The model in whose light the residual is looked at; everything in the user's units.
pub(crate) struct Light<'a, const M: usize, const N: usize> {
    /// What each parameter is.
    pub(crate) columns: [Parameter; N],
    /// User's value of one normalised unit.
    pub(crate) units: &'a [f32; N],
    /// The parameters.
    pub(crate) theta: &'a [f32; N],
    /// Parameters that are not known beforehand.
    pub(crate) free: [bool; N],
    /// a_0 .. a_{m-1}.
    pub(crate) denominator: [f32; M],
    /// f_0 .. f_{m-1}.
    pub(crate) filter: [f32; M],
    /// Rough bandwidth in rad/s.
    pub(crate) bandwidth: f32,
    /// Time in the memory in s.
    pub(crate) duration: f32,
    /// Rate of the slowest pole of the filter in rad/s.
    pub(crate) slowest: f32,
}

/// A complex number.
#[derive(Clone, Copy)]
struct Complex {
    re: f32,
    im: f32,
}

impl Complex {
    const ZERO: Self = Self { re: 0.0, im: 0.0 };

    fn times(self, other: Self) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }

    fn size(self) -> f32 {
        self.re * self.re + self.im * self.im
    }

    /// (j x)^power times `factor`.
    fn power(x: f32, power: usize, factor: f32) -> Self {
        let mut value = factor;
        for _ in 0..power {
            value *= x;
        }
        match power % 4 {
            0 => Self { re: value, im: 0.0 },
            1 => Self { re: 0.0, im: value },
            2 => Self {
                re: -value,
                im: 0.0,
            },
            _ => Self {
                re: 0.0,
                im: -value,
            },
        }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            re: self.re + other.re,
            im: self.im + other.im,
        }
    }
}

/// `value^power`.
fn raised(value: f32, power: usize) -> f32 {
    let mut product = 1.0;
    for _ in 0..power {
        product *= value;
    }
    product
}

/// Frequencies of the sums, evenly on a logarithmic scale from 0.05 to 3.5 times the natural frequency.
const FREQUENCIES: usize = 12;
const LOWEST: f32 = 0.05;
const STEP: f32 = 1.47;

/// A record of T seconds sees a spectrum through a kernel whose tails are those of a Lorentz curve of half width 1/T.
const BLUR: f32 = 3.0;

impl<const M: usize, const N: usize> Light<'_, M, N> {
    /// The natural frequency of the model, or the bandwidth where the model has no sensible one.
    pub(crate) fn natural(&self) -> f32 {
        let a = &self.denominator;
        let first = a.iter().position(|v| *v != 0.0).unwrap_or(0);
        let natural = pow(a[first].abs(), 1.0 / (M - first) as f32);
        if natural > 0.1 * self.bandwidth && natural < 10.0 * self.bandwidth {
            natural
        } else {
            self.bandwidth
        }
    }

    /// Monic polynomial of order m at `s omega_n`, divided by `omega_n^m`.
    fn monic(coefficients: &[f32; M], s: Complex, natural: f32) -> Complex {
        let mut value = Complex { re: 1.0, im: 0.0 };
        for (i, c) in coefficients.iter().enumerate().rev() {
            value = value.times(s);
            value.re += c / raised(natural, M - i);
        }
        value
    }

    /// The sums R and S, in normalised units.
    fn sums(&self) -> (Matrix<N>, Matrix<N>) {
        let natural = self.natural();
        let mut r = [[0.0; N]; N];
        let mut s = [[0.0; N]; N];
        let mut residuals = [0.0; FREQUENCIES];
        let mut x = LOWEST;
        for residual in &mut residuals {
            let s_exact = Complex { re: 0.0, im: x };
            *residual = Self::monic(&self.denominator, s_exact, natural).size()
                / Self::monic(&self.filter, s_exact, natural).size();
            x *= STEP;
        }
        let mut x = LOWEST;
        for _ in 0..FREQUENCIES {
            let s_exact = Complex { re: 0.0, im: x };
            let plant = Self::monic(&self.denominator, s_exact, natural);
            let filter = Self::monic(&self.filter, s_exact, natural).size();
            let residual = self.blurred(&residuals, x, natural);
            // d omega is proportional to omega on a logarithmic scale.
            let weight = x / filter;
            for (first, column) in self.columns.iter().enumerate() {
                let phi = match *column {
                    Parameter::Input { input, power } if self.leads(first, input) => {
                        let range = raised(natural, M - power) / self.units[first];
                        self.response(input, range, x, natural, plant)
                    }
                    Parameter::Constant | Parameter::InitialState => {
                        let rate = if let Parameter::InitialState = column {
                            self.slowest / natural
                        } else {
                            LOWEST
                        };
                        let mut phi = [Complex::ZERO; N];
                        phi[first].re = 1.0 / sqrt(x * x + rate * rate);
                        phi
                    }
                    _ => continue,
                };
                for i in 0..N {
                    for j in 0..N {
                        let both = weight * (phi[i].re * phi[j].re + phi[i].im * phi[j].im);
                        r[i][j] += both;
                        s[i][j] += both * residual;
                    }
                }
            }
            x *= STEP;
        }
        (r, s)
    }

    /// Mean of `|A/A_f|^2` about `x`, as a record of this duration sees it.
    fn blurred(&self, residuals: &[f32; FREQUENCIES], x: f32, natural: f32) -> f32 {
        let width = BLUR / (self.duration * natural);
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

    /// Whether the column is the first of its input.
    fn leads(&self, place: usize, input: usize) -> bool {
        !self
            .columns
            .iter()
            .take(place)
            .any(|c| matches!(c, Parameter::Input { input: other, .. } if *other == input))
    }

    /// The normalised regressor for the input at `x` times the natural frequency, without `1/A_f`.
    fn response(
        &self,
        input: usize,
        range: f32,
        x: f32,
        natural: f32,
        plant: Complex,
    ) -> [Complex; N] {
        // G = B/A by conjugate over size.
        let mut numerator = Complex::ZERO;
        for (column, value) in self.columns.iter().zip(self.theta) {
            if let Parameter::Input { input: of, power } = *column
                && of == input
            {
                let b = value / raised(natural, M - power);
                numerator = numerator.plus(Complex::power(x, power, b));
            }
        }
        let size = plant.size();
        let inverse = Complex {
            re: plant.re / size,
            im: -plant.im / size,
        };
        let output = numerator.times(inverse);
        let mut phi = [Complex::ZERO; N];
        for (j, column) in self.columns.iter().enumerate() {
            let value = match *column {
                Parameter::Output { power } => {
                    let order = Complex::power(x, power, -1.0 / raised(natural, M - power));
                    order.times(output)
                }
                Parameter::Input { input: of, power } if of == input => {
                    Complex::power(x, power, 1.0 / raised(natural, M - power))
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

    /// T, or nothing where the sums have no proper factors.
    pub(crate) fn transform(&self) -> Option<Matrix<N>> {
        let (mut r, mut s) = self.sums();
        // Known parameters stand apart; the others get unit size.
        let mut size = [1.0; N];
        for j in 0..N {
            if self.free[j] {
                if !(r[j][j] > 0.0 && r[j][j].is_finite() && s[j][j].is_finite()) {
                    return None;
                }
                size[j] = 1.0 / sqrt(r[j][j]);
            }
        }
        for i in 0..N {
            for j in 0..N {
                if self.free[i] && self.free[j] {
                    r[i][j] *= size[i] * size[j];
                    s[i][j] *= size[i] * size[j];
                } else {
                    let apart = if i == j { 1.0 } else { 0.0 };
                    r[i][j] = apart;
                    s[i][j] = apart;
                }
            }
        }
        let l = cholesky(&r)?;
        // L^-1 S L^-T, column by column and then row by row.
        let mut inner = s;
        for _ in 0..2 {
            let mut next = [[0.0; N]; N];
            for j in 0..N {
                let mut column = [0.0; N];
                for i in 0..N {
                    let mut sum = inner[i][j];
                    for k in 0..i {
                        sum -= l[i][k] * column[k];
                    }
                    column[i] = sum / l[i][i];
                }
                // Transposed, so that the second pass takes the other side.
                next[j] = column;
            }
            inner = next;
        }
        let z = cholesky(&inner)?;
        // T = L^-T (Z L'), back substitution.
        let mut transform = [[0.0; N]; N];
        for j in 0..N {
            let mut column = [0.0; N];
            for i in 0..N {
                for k in 0..N {
                    column[i] += z[i][k] * l[j][k];
                }
            }
            for i in (0..N).rev() {
                let mut sum = column[i];
                for k in i + 1..N {
                    sum -= l[k][i] * transform[k][j];
                }
                transform[i][j] = sum / l[i][i];
            }
        }
        // Back from unit size: T <- D T D^-1 with D = size.
        for i in 0..N {
            for j in 0..N {
                transform[i][j] *= size[i] / size[j];
            }
        }
        let sound = transform.iter().flatten().all(|v| v.is_finite());
        sound.then_some(transform)
    }
}

/// Lower triangle L with L L' = `matrix`; nothing where it is not clearly positive.
fn cholesky<const N: usize>(matrix: &Matrix<N>) -> Option<Matrix<N>> {
    let mut l = [[0.0; N]; N];
    for j in 0..N {
        let mut pivot = matrix[j][j];
        for k in 0..j {
            pivot -= l[j][k] * l[j][k];
        }
        if !(pivot > 1e-6 * matrix[j][j]) {
            return None;
        }
        l[j][j] = sqrt(pivot);
        for i in j + 1..N {
            let mut sum = matrix[i][j];
            for k in 0..j {
                sum -= l[i][k] * l[j][k];
            }
            l[i][j] = sum / l[j][j];
        }
    }
    Some(l)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A servo seen through a filter that is its own denominator with the slow pole 2: s^3 + 22 s^2 + 440 s + 800.
    fn light<'a>(units: &'a [f32; 4], theta: &'a [f32; 4]) -> Light<'a, 3, 4> {
        Light {
            columns: [
                Parameter::Output { power: 1 },
                Parameter::Output { power: 2 },
                Parameter::Input { input: 0, power: 0 },
                Parameter::InitialState,
            ],
            units,
            theta,
            free: [true; 4],
            denominator: [0.0, 400.0, 20.0],
            filter: [800.0, 440.0, 22.0],
            bandwidth: 20.0,
            duration: 1e6,
            slowest: 2.0,
        }
    }

    #[test]
    fn a_white_residual_needs_no_shaping() {
        let (units, theta) = ([400.0, 20.0, 4e5, 50.0], [400.0, 20.0, 1e6, 0.0]);
        let mut light = light(&units, &theta);
        light.filter = [0.0, 400.0, 20.0];
        let transform = light.transform().unwrap();
        for i in 0..4 {
            for j in 0..4 {
                let unit = if i == j { 1.0 } else { 0.0 };
                assert!((transform[i][j] - unit).abs() < 1e-3, "{transform:?}");
            }
        }
    }

    #[test]
    fn a_slow_pole_hides_noise_from_the_gain_most() {
        // |A/A_f|^2 = omega^2/(omega^2 + 4): small where C is seen, one where the damping is.
        let (units, theta) = ([400.0, 20.0, 4e5, 50.0], [400.0, 20.0, 1e6, 0.0]);
        let light = light(&units, &theta);
        let (r, s) = light.sums();
        let transform = light.transform().unwrap();
        let share = |i: usize| s[i][i] / r[i][i];
        assert!(share(0) < share(1) && share(1) > 0.9 && share(3) < 0.7);
        // T R^-1 T' R = R^-1 S: the traces agree, in whatever units.
        let inverse = |column: [f32; 4]| -> [f32; 4] {
            let size: [f32; 4] = core::array::from_fn(|i| 1.0 / sqrt(r[i][i]));
            let scaled: Matrix<4> =
                core::array::from_fn(|i| core::array::from_fn(|j| r[i][j] * size[i] * size[j]));
            let l = cholesky(&scaled).unwrap();
            let mut x: [f32; 4] = core::array::from_fn(|i| column[i] * size[i]);
            for i in 0..4 {
                for k in 0..i {
                    x[i] -= l[i][k] * x[k];
                }
                x[i] /= l[i][i];
            }
            for i in (0..4).rev() {
                for k in i + 1..4 {
                    x[i] -= l[k][i] * x[k];
                }
                x[i] /= l[i][i];
            }
            core::array::from_fn(|i| x[i] * size[i])
        };
        let (mut left, mut right) = (0.0, 0.0);
        for i in 0..4 {
            right += inverse(core::array::from_fn(|k| s[k][i]))[i];
            // Row i of T R^-1 T' R.
            let row = inverse(transform[i]);
            let back: [f32; 4] =
                core::array::from_fn(|j| (0..4).map(|k| row[k] * transform[j][k]).sum());
            left += (0..4).map(|j| back[j] * r[j][i]).sum::<f32>();
        }
        assert!((left / right - 1.0).abs() < 1e-2, "{left} {right}");
    }

    #[test]
    fn known_parameters_stand_apart() {
        let (units, theta) = ([400.0, 20.0, 4e5, 50.0], [400.0, 20.0, 1e6, 0.0]);
        let mut light = light(&units, &theta);
        light.free[1] = false;
        let transform = light.transform().unwrap();
        for j in [0, 2, 3] {
            assert_eq!((transform[1][j], transform[j][1]), (0.0, 0.0));
        }
    }

    #[test]
    fn nonsense_gives_nothing() {
        let (units, theta) = (
            [400.0, 20.0, 4e5, 50.0],
            [f32::NAN, 20.0, f32::INFINITY, 0.0],
        );
        let mut light = light(&units, &theta);
        light.denominator = [0.0, f32::NAN, 20.0];
        assert_eq!(light.transform(), None);
    }
}
