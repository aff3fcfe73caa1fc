//! The bias of white noise on y, and how it is taken out.
//!
//! White noise of variance s puts `n s M` into the `P^-1 = sum phi phi'` of n rows and `n s m` into
//! `sum phi psi`. Without both
//!
//! ```text
//! theta_c = Q (P^-1 theta - w m)       Q = (P^-1 - w M)^-1        P_c = Q P^-1 Q
//! w = n s / (1 + 4/nu), or less, so that 1 - w |M P| >= sqrt(2/nu)      nu = n omega Delta
//! ```
//!
//! is the estimate, and P_c its covariance where the residual is white of variance 1. The rows
//! tell something new once in 1/(omega Delta) samples, nu times in all. A Q of few rows is too
//! large more often than too small; with a little less noise taken out the estimate has moments,
//! and the least mean square error (Fuller, with his constant of 4). And the share of noise in nu
//! rows varies by sqrt(2/nu): in a direction whose rest is less than that nothing is known to have
//! moved, and no more is taken out. What is left there then is added to the uncertainty.
//!
//! Of the noise in doubt, w_doubt, which is what the limit leaves or w sqrt(2/nu) where that is
//! more, is not known whether it was taken out. To the drive it makes the bias
//!
//! ```text
//! e = Q w_doubt (M theta_0 - m)       theta_0 = theta_c - e, the drive
//! ```
//!
//! which is that of theta_c to first order. The second one is `Q w_doubt M e`: where the rows are
//! mostly noise theta_c is that of noise alone, `M theta = m`, whose bias is none, and tells
//! nothing of the drive. The share of that, r, is at most the trace of `Q w_doubt M`; and the drive
//! is off by no more than what a bandwidth that is told within a factor of three makes of each
//! parameter of y. So these, each on its own, are considered besides:
//!
//! ```text
//! sum over i: v_i v_i'        v_i = r (3^(m-k) - 1) Q w_doubt M e_i        of a_k, normalised: a design size is 1
//! ```
//!
//! The residual holds more than white noise explains: friction, a wrong model, or drift of y. Of
//! these drift alone is in the regressors, and no residual tells it from the others. As a random
//! walk it is the sum of white noise, whose moments its trends have one order lower: M_d, m_d, and
//! t_d of psi psi.
//! The bias that it would make if it were all of the rest is added to the uncertainty:
//!
//! ```text
//! Q n s_d (M_d theta_c - m_d)       s_d = rest / (t_d - 2 theta' m_d + theta' M_d theta)
//! ```
//!
//! Known as: bias-compensated least squares. Stoica and Soderstrom, Int. J. Control 35 (1982);
//! Zheng and Feng, IEEE Trans. Automatic Control 40 (1995); Fuller, Econometrica 45 (1977).

mod compensated;
mod correction;

use crate::estimation::terms::Parameter;
use crate::math::matrix::{Matrix, dot};
use crate::math::{larger, raised, sqrt};
use crate::readout::beginning::Regression;
pub(crate) use crate::readout::compensation::compensated::{Compensated, Residual};
use crate::readout::compensation::correction::{Correction, NoiseMoments};
use crate::readout::source::ReadOut;

/// Fuller's constant of the least mean square error.
const FULLER: f32 = 4.0;

/// The third difference counts as noise up to this multiple of the noise that the residual allows.
const PLAUSIBLE: f32 = 1.3;

/// White noise on y and its effect on the regression.
struct Noise<const M: usize> {
    moments: NoiseMoments<M>,
    /// Variance of the residual per variance of the noise.
    spread: f32,
    /// Variance of the residual.
    residual: f32,
    /// Variance of the noise; `None` where it is unknown or no filter stands in front of the
    /// estimator.
    white: Option<f32>,
    /// Whether the residual is less than the third difference makes of it, as few rows may leave by
    /// chance.
    lucky: bool,
}

impl<const M: usize> Noise<M> {
    /// Of so many independent `rows` that have led to `bare`.
    fn of<const N: usize, const I: usize>(
        source: &ReadOut<'_, M, N, I>,
        bare: &[f32; N],
        rows: f32,
    ) -> Self {
        let moments = moments::<0, M, N, I>(source);
        let spread = moments.spread(bare);
        let residual = source.residual();
        let allowed = if spread > 0.0 { residual / spread } else { 0.0 };
        // A third difference that the residual cannot explain is that of the signal: nothing is
        // compensated.
        let known = match (source.design.filter, source.noise.variance()) {
            (Some(_), Some(white)) if spread > 0.0 => Some(white),
            _ => None,
        };
        let white = match known {
            Some(white) if white <= PLAUSIBLE * allowed => {
                Some(if white < allowed { white } else { allowed })
            }
            _ => None,
        };
        Self {
            moments,
            spread,
            residual,
            white,
            lucky: white.is_none()
                && known.is_some_and(|white| white * (1.0 - chance(rows)) <= allowed),
        }
    }

    /// What white noise does not explain of the residual, nor chance.
    fn rest(&self, samples: f32) -> f32 {
        let Some(white) = self.white else {
            return self.residual;
        };
        let chance = chance(samples.max(1.0));
        (self.residual - white * self.spread * (1.0 + chance)).max(0.0)
    }

    /// The bias by drift that makes all of the rest of the residual of `bare`, of which `found`
    /// left `theta`.
    fn drift<const N: usize, const I: usize>(
        &self,
        source: &ReadOut<'_, M, N, I>,
        [bare, theta]: [&[f32; N]; 2],
        p: &Matrix<N>,
        found: Option<&Correction<M, N>>,
    ) -> [f32; N] {
        let drift = moments::<1, M, N, I>(source);
        let samples = source.estimator.samples();
        let level = samples * self.rest(samples) / drift.spread(bare);
        // Without a filter no moments are known, and all are 0.
        if !(level > 0.0 && level.is_finite()) {
            return [0.0; N];
        }
        drift.bias(theta, p, found, level)
    }

    /// Splits the residual into the part that white noise explains and the rest.
    ///
    /// The rest is slow (drift, friction, a wrong model): its samples are [`dependent`]; `angle` is
    /// omega Delta. So is all of a residual that is small by chance: where the filter is slower
    /// than the drive, white noise has few independent values there.
    fn split(&self, top_scale: f32, samples: f32, angle: f32) -> Residual {
        let Some(white) = self.white else {
            let dependent = if self.lucky { dependent(angle) } else { 1.0 };
            return Residual {
                shaped: 0.0,
                even: self.residual * dependent,
                significance: self.residual,
            };
        };
        // The significance of a constant allows for chance.
        let unexplained = (self.residual - white * self.spread).max(0.0);
        Residual {
            shaped: top_scale * top_scale * white,
            even: self.rest(samples) * dependent(angle),
            significance: self.residual + unexplained * dependent(angle),
        }
    }
}

/// What chance makes of a variance by so many samples, as a share of it: four deviations.
fn chance(samples: f32) -> f32 {
    4.0 * sqrt(2.0 / samples)
}

/// Samples of something as slow as the drive that count as one; `angle` is omega Delta.
pub(super) fn dependent(angle: f32) -> f32 {
    2.0 / angle
}

/// The moments of white noise on y, summed up over time `SUMS` times.
fn moments<const SUMS: usize, const M: usize, const N: usize, const I: usize>(
    source: &ReadOut<'_, M, N, I>,
) -> NoiseMoments<M> {
    let gain = &source.design.noise_gain;
    let (matrix, vector, top) = source.regressor.noise_moments::<SUMS>(gain);
    NoiseMoments {
        matrix,
        vector,
        top,
    }
}

/// The correction of a regression; without `deviations` nothing of what is left in.
///
/// Inlined, with what it calls, where it is called once: the matrices that it hands over are not
/// copied then.
#[inline(always)]
pub(crate) fn compensate<const M: usize, const N: usize, const I: usize>(
    source: &ReadOut<'_, M, N, I>,
    Regression { theta: bare, p }: &Regression<N>,
    deviations: bool,
) -> Compensated<M, N> {
    let samples = source.estimator.samples();
    let angle = source.bandwidth * source.design.sample_time;
    let rows = samples * angle;
    let noise = Noise::of(source, bare, rows.max(1.0));
    let level = samples * noise.white.unwrap_or(0.0) * (rows / (rows + FULLER));
    let correction = match noise.white {
        Some(_) => Correction::of(bare, p, &noise.moments, level, known_share(rows)),
        None => None,
    };
    let found = correction.as_ref();
    let theta = found.map_or(*bare, |found| found.theta);
    let (mut left, mut in_doubt) = ([0.0; N], [[0.0; N]; M]);
    if deviations {
        if let Some(found) = found {
            let doubt = level * larger(1.0 - found.share, 1.0 - known_share(rows));
            left = noise.moments.bias(&theta, p, Some(found), doubt);
            in_doubt = found.in_doubt(p, &noise.moments, doubt, &source.sizes());
        }
        let drift = noise.drift(source, [bare, &theta], p, found);
        for (left, drift) in left.iter_mut().zip(drift) {
            *left += drift;
        }
    }
    let score = source.start_score(&theta);
    let mut direction = core::array::from_fn(|i| dot(&p[i], &score));
    if let Some(found) = found {
        found.add_along(&score, &mut direction);
    }
    let considered = source.considered(direction, noise.spread);
    let units = source.regressor.units();
    Compensated {
        theta: core::array::from_fn(|j| theta[j] * units[j]),
        left: core::array::from_fn(|j| left[j] * units[j]),
        correction,
        in_doubt: in_doubt.map(|bias| core::array::from_fn(|j| bias[j] * units[j])),
        residual: noise.split(source.regressor.top_scale(), samples, angle),
        considered,
    }
}

impl<const M: usize, const N: usize, const I: usize> ReadOut<'_, M, N, I> {
    /// By how much each parameter of y is off where the bandwidth is by a factor of three,
    /// normalised.
    fn sizes(&self) -> [f32; M] {
        let parameters = self.structure.parameters();
        core::array::from_fn(|i| match parameters.get(i) {
            Some(Parameter::Output { power }) => raised(3.0, M - power) - 1.0,
            _ => 0.0,
        })
    }
}

/// Share of a direction that may be taken for noise, as `rows` independent ones know it; in [0, 1).
fn known_share(rows: f32) -> f32 {
    if rows > 2.0 {
        1.0 - sqrt(2.0 / rows)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests;
