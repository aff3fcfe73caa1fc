//! The bias of white noise on y, and the step that takes it out.
//!
//! Known as: bias-compensated least squares. Stoica and Soderstrom, Int. J. Control 35 (1982);
//! Zheng and Feng, IEEE Trans. Automatic Control 40 (1995).

use crate::math::matrix::{
    Matrix, product, product_row, product_row_transposed, product_transposed,
};
use crate::math::sqrt;
use crate::readout::source::ReadOut;

/// The third difference counts as noise up to this multiple of the noise that the residual allows.
const PLAUSIBLE: f32 = 1.3;

/// White noise on y and its effect on the regression.
struct Noise<const N: usize> {
    /// M and m: phi phi' and phi psi per sample of noise of variance 1.
    matrix: Matrix<N>,
    vector: [f32; N],
    /// Variance of the residual per variance of the noise.
    spread: f32,
    /// Variance of the residual.
    residual: f32,
    /// Variance of the noise; `None` where it is unknown or no filter stands in front of the
    /// estimator.
    white: Option<f32>,
}

impl<const N: usize> Noise<N> {
    fn of<const M: usize, const I: usize>(source: &ReadOut<'_, M, N, I>) -> Self {
        let theta = source.estimator.theta();
        let (matrix, vector, echo) = source.regressor.noise_moments(&source.design.noise_gain);
        // The residual is psi - phi' theta.
        let mut spread = echo;
        for i in 0..N {
            spread -= 2.0 * theta[i] * vector[i];
            for j in 0..N {
                spread += theta[i] * matrix[i][j] * theta[j];
            }
        }
        let residual = source.residual();
        let allowed = if spread > 0.0 { residual / spread } else { 0.0 };
        // A third difference that the residual cannot explain is that of the signal: nothing is
        // compensated.
        let white = match (source.design.filter, source.noise.variance()) {
            (Some(_), Some(white)) if white <= PLAUSIBLE * allowed => {
                Some(if white < allowed { white } else { allowed })
            }
            _ => None,
        };
        Self {
            matrix,
            vector,
            spread,
            residual,
            white,
        }
    }

    /// Splits the residual into the part that white noise explains and the rest.
    ///
    /// The rest is slow (drift, friction, a wrong model): about `2/(omega Delta)` samples count as
    /// one; `angle` is omega Delta.
    fn split(&self, top_scale: f32, samples: f32, angle: f32) -> Residual {
        let Some(white) = self.white else {
            return Residual {
                shaped: 0.0,
                even: self.residual,
                significance: self.residual,
            };
        };
        let excess = |explained: f32| (self.residual - explained).max(0.0) * 2.0 / angle;
        // Chance alone must not count as excess; the significance of a constant allows for it.
        let chance = 4.0 * sqrt(2.0 / samples.max(1.0));
        let explained = white * self.spread;
        Residual {
            shaped: top_scale * top_scale * white,
            even: excess(explained * (1.0 + chance)),
            significance: self.residual + excess(explained),
        }
    }
}

/// Variances of the residual.
pub(crate) struct Residual {
    /// Of white noise of y, to be seen through `A/A_f`.
    pub(crate) shaped: f32,
    /// Of the rest.
    pub(crate) even: f32,
    /// By which the significance of a constant is measured.
    pub(crate) significance: f32,
}

/// The estimate with the bias of white noise taken out.
pub(crate) struct Compensated<const N: usize> {
    /// The parameters as the trends have them, in the user's units.
    pub(crate) theta: [f32; N],
    /// I + 2 w P M; `None` where nothing was corrected.
    transform: Option<Matrix<N>>,
    /// Remaining bias of each parameter after one step of the correction, in the user's units.
    pub(crate) left: [f32; N],
    pub(crate) residual: Residual,
}

impl<const N: usize> Compensated<N> {
    /// P_c, normalised, from the covariance `p` of the recursion.
    pub(crate) fn covariance(&self, p: &Matrix<N>) -> Matrix<N> {
        match &self.transform {
            Some(transform) => product_transposed(&product(transform, p), transform),
            None => *p,
        }
    }

    /// w tr P M, the share of the correction that one step leaves: in [0, 1).
    pub(crate) fn damping(&self) -> f32 {
        let Some(transform) = &self.transform else {
            return 0.0;
        };
        let diagonal = transform.iter().enumerate();
        let twice = diagonal.filter_map(|(i, row)| Some(row.get(i)? - 1.0));
        0.5 * twice.sum::<f32>()
    }

    /// Change of the estimate per unit of a score, normalised: (I + w P M) P.
    pub(crate) fn gain(&self, p: &Matrix<N>) -> Matrix<N> {
        match &self.transform {
            Some(transform) => {
                let twice = product(transform, p);
                core::array::from_fn(|i| core::array::from_fn(|j| 0.5 * (twice[i][j] + p[i][j])))
            }
            None => *p,
        }
    }

    /// Row `index` of P_c, enough for an estimate without deviations.
    #[inline(always)]
    pub(crate) fn covariance_row(&self, p: &Matrix<N>, index: usize) -> Option<[f32; N]> {
        match &self.transform {
            Some(transform) => {
                let row = product_row(transform.get(index)?, p);
                Some(product_row_transposed(&row, transform))
            }
            None => p.get(index).copied(),
        }
    }
}

/// One step of the correction from the recursion with the covariance `p`.
///
/// Inlined, with what it calls, where it is called once: the matrices that it hands over are not
/// copied then.
#[inline(always)]
pub(crate) fn compensate<const M: usize, const N: usize, const I: usize>(
    source: &ReadOut<'_, M, N, I>,
    p: &Matrix<N>,
) -> Compensated<N> {
    let bare = source.estimator.theta();
    let samples = source.estimator.samples();
    let noise = Noise::of(source);
    let (theta, transform, damping) = match noise.white {
        Some(white) => {
            let (theta, transform, damping) = corrected(bare, p, &noise, samples * white);
            (theta, Some(transform), damping)
        }
        None => (*bare, None, 0.0),
    };
    let units = source.regressor.units();
    let in_units = |theta: &[f32; N]| core::array::from_fn(|j| theta[j] * units[j]);
    let (bare, mut theta): ([f32; N], [f32; N]) = (in_units(bare), in_units(&theta));
    if !theta.iter().all(|value| value.is_finite()) {
        theta = bare;
    }
    let angle = source.bandwidth * source.design.sample_time;
    Compensated {
        left: core::array::from_fn(|j| damping * (theta[j] - bare[j])),
        theta,
        transform,
        residual: noise.split(source.regressor.top_scale(), samples, angle),
    }
}

/// theta_c, normalised, I + 2 w P M and the damping w tr P M; `level` is n s.
#[inline(always)]
fn corrected<const N: usize>(
    bare: &[f32; N],
    p: &Matrix<N>,
    noise: &Noise<N>,
    level: f32,
) -> ([f32; N], Matrix<N>, f32) {
    let Noise { matrix, vector, .. } = noise;
    let mut trace = 0.0;
    for i in 0..N {
        for j in 0..N {
            trace += p[i][j] * matrix[j][i];
        }
    }
    // Damped where one step is no longer small: few samples under much noise.
    let weight = level / (1.0 + level * trace);
    let mut bias = [0.0; N];
    for i in 0..N {
        bias[i] = -vector[i];
        for j in 0..N {
            bias[i] += matrix[i][j] * bare[j];
        }
    }
    let mut theta = *bare;
    // I + 2 w P M
    let mut transform = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..N {
            let mut sum = 0.0;
            for k in 0..N {
                sum += p[i][k] * matrix[k][j];
            }
            transform[i][j] = 2.0 * weight * sum + if i == j { 1.0 } else { 0.0 };
            theta[i] += weight * p[i][j] * bias[j];
        }
    }
    (theta, transform, weight * trace)
}

#[cfg(test)]
mod tests;
