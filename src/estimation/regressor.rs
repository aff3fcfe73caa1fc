//! The regressor: the one place for the signs, the order and the normalisation of the parameters.
//!
//! ```text
//! paper, (5), (12):  R_m y = - sum a_i R_i y + sum b_i P_i u      v theta, theta = (-a .., b ..)
//! here:              psi   = phi' theta                           theta = (a .., b .., c)
//! psi = s_m R_m y,   phi_j = -s_j R_i y for a_i,  +s_j P_i u for b_i,  +s_j P_0 1 for the constant,
//!                                                  +s_j rho^k for the initial state
//! ```
//!
//! The minus sign is in phi, so theta holds a_i and b_i as they stand in the
//! transfer function. The scales s make every entry of order 1: the recursion is
//! dimensionless.

use crate::estimation::structure::Structure;
use crate::estimation::terms::Parameter;
use crate::math::matrix::Matrix;
use crate::trends::{Design, NoiseGain, Trends};

/// The trend behind one entry of phi.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Source {
    /// 0..M: trends of y; M..M+M*I: trends of the inputs one after the other; then constant and
    /// initial state.
    index: u8,
    /// The signed scale of phi.
    scale: f32,
}

/// Turns trends into the normalised regressor, and normalised parameters back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Regressor<const M: usize, const N: usize> {
    sources: [Source; N],
    /// s_m, the scale of the left-hand side.
    top_scale: f32,
    /// unit_j = s_j / s_m: theta_j in the user's unit is unit_j times the normalised one.
    units: [f32; N],
    /// Weight of y(k) in the equation error: without the parameters, and per unit of each.
    feedthrough_top: f32,
    feedthrough: [f32; N],
    /// Lower limit of beta: a tenth of its value without any a_i.
    feedthrough_floor: f32,
}

impl<const M: usize, const N: usize> Regressor<M, N> {
    /// Scales from the design values: a signal of `output_range` and `input_range[i]` at
    /// `bandwidth`.
    pub(crate) fn new<const I: usize>(
        structure: &Structure<M, N, I>,
        design: &Design<M>,
        bandwidth: f32,
        input_range: &[f32; I],
        output_range: f32,
    ) -> Self {
        // sizes[i]: size of the trend of order i of a signal of size 1.
        let mut sizes = [0.0; M];
        let mut size = design.scale(bandwidth);
        let top_scale = 1.0 / (size * output_range);
        for s in sizes.iter_mut().rev() {
            size /= bandwidth;
            *s = size;
        }
        const { assert!(M + I * M < 255, "every trend has a number of 8 bits") };
        let mut regressor = Self {
            sources: [Source {
                index: 0,
                scale: 0.0,
            }; N],
            top_scale,
            units: [0.0; N],
            feedthrough_top: 0.0,
            feedthrough: [0.0; N],
            feedthrough_floor: 0.0,
        };
        // A structure has no power and no input beyond these: nothing is looked up in vain.
        let size_of = |power: usize| sizes.get(power).copied().unwrap_or(1.0);
        let range_of = |input: usize| input_range.get(input).copied().unwrap_or(1.0);
        for (j, parameter) in structure.parameters().into_iter().enumerate() {
            let (index, scale, sign) = match parameter {
                Parameter::Output { power } => (power, 1.0 / (size_of(power) * output_range), -1.0),
                Parameter::Input { input, power } => (
                    M + input * M + power,
                    1.0 / (size_of(power) * range_of(input)),
                    1.0,
                ),
                Parameter::Constant => (M + I * M, 1.0 / sizes[0], 1.0),
                Parameter::InitialState => (M + I * M + 1, 1.0 / design.scale(bandwidth), 1.0),
            };
            regressor.sources[j] = Source {
                index: index as u8,
                scale: sign * scale,
            };
            regressor.units[j] = scale / top_scale;
        }
        regressor.set_feedthrough(&design.feedthrough);
        regressor
    }

    /// Replaces the weights of y(k) by those of other trends with the same scales.
    pub(crate) fn set_feedthrough(&mut self, feedthrough: &Trends<M>) {
        self.feedthrough_top = feedthrough.top * self.top_scale;
        self.feedthrough_floor = 0.1 * self.feedthrough_top;
        for (weight, source) in self.feedthrough.iter_mut().zip(&self.sources) {
            *weight = match feedthrough.lower.get(source.index as usize) {
                Some(lower) => -source.scale * lower,
                None => 0.0,
            };
        }
    }

    /// The normalised regressor phi and the normalised left-hand side psi. Cost: 9 instructions per
    /// parameter.
    #[inline(always)]
    pub(crate) fn assemble<const I: usize>(
        &self,
        output: &Trends<M>,
        inputs: &[[f32; M]; I],
        extra: &[f32; 2],
    ) -> ([f32; N], f32) {
        let inputs = inputs.as_flattened();
        let mut phi = [0.0; N];
        for (j, (entry, source)) in phi.iter_mut().zip(&self.sources).enumerate() {
            let index = source.index as usize;
            // The constant and the initial state are the last parameters: found at once there, not
            // looked for elsewhere.
            let extra = match j + extra.len() < N {
                true => None,
                false => extra.get(index.wrapping_sub(M + inputs.len())),
            };
            let trend = extra.or_else(|| match index < M {
                true => output.lower.get(index),
                false => inputs.get(index - M),
            });
            *entry = source.scale * trend.copied().unwrap_or(0.0);
        }
        (phi, self.top_scale * output.top)
    }

    /// beta > 0: growth of the normalised equation error per unit of y(k); alpha of (10) in scaled
    /// form.
    #[inline(always)]
    pub(crate) fn feedthrough(&self, theta: &[f32; N]) -> f32 {
        let mut beta = self.feedthrough_top;
        // Those of y are the first parameters, at most M.
        for (weight, parameter) in self.feedthrough.iter().zip(theta).take(M) {
            beta += weight * parameter;
        }
        if beta > self.feedthrough_floor {
            beta
        } else {
            self.feedthrough_floor
        }
    }

    /// Unit of each parameter: user's value = unit times normalised value.
    pub(crate) fn units(&self) -> &[f32; N] {
        &self.units
    }

    /// s_m.
    pub(crate) fn top_scale(&self) -> f32 {
        self.top_scale
    }

    /// Moments of phi phi', phi psi and psi psi per sample of noise on y: white noise of variance
    /// 1, summed up over time `SUMS` times. A trend of a sum is that of the noise one order lower.
    ///
    /// Those of the parameters of y, which are the first: at most M, zeros behind them and where
    /// the order is below 0.
    pub(crate) fn noise_moments<const SUMS: usize>(
        &self,
        gain: &NoiseGain<M>,
    ) -> (Matrix<M>, [f32; M], f32) {
        let between = |i: usize, j: usize| {
            let [i, j] = [i.checked_sub(SUMS)?, j.checked_sub(SUMS)?];
            gain.between(i, j)
        };
        let of_output = |source: &Source| (source.index as usize) < M;
        let mut matrix = [[0.0; M]; M];
        let mut vector = [0.0; M];
        for (i, row) in self.sources.iter().enumerate().take(M) {
            if !of_output(row) {
                continue;
            }
            let at = row.index as usize;
            for (j, column) in self.sources.iter().enumerate().take(M) {
                if of_output(column)
                    && let Some(gain) = between(at, column.index as usize)
                {
                    matrix[i][j] = row.scale * column.scale * gain;
                }
            }
            vector[i] = row.scale * self.top_scale * between(at, M).unwrap_or(0.0);
        }
        let top = between(M, M).unwrap_or(0.0);
        (matrix, vector, self.top_scale * self.top_scale * top)
    }

    /// Size of the normalised left-hand side that `output_std` of noise on y makes.
    pub(crate) fn noise(&self, output_std: f32) -> f32 {
        self.feedthrough_top * output_std
    }
}

#[cfg(test)]
mod tests;
