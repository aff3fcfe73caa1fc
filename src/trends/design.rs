//! The properties that follow from the coefficients of a trend operator, computed once.

use crate::math::polynomial::largest_rate;
use crate::math::raised;
use crate::trends::bilinear::{to_gamma_plane, to_s_plane};
use crate::trends::difference::{Scheme, Trends};
use crate::trends::noise_gain::NoiseGain;
use crate::trends::trapezoids::{bend, bend_of_found};

/// The properties of a trend operator that its owner needs beside the trends.
///
/// | symbol | field | unit |
/// |---|---|---|
/// | Delta | `sample_time` | s |
/// | `r_0^i` of (10) | `feedthrough` | of the trend per unit of the signal |
/// | f_0 .. f_{m-1} | `filter` | rad^(m-i)/s^(m-i) |
/// | - | `noise_gain` | products of those of the trends |
/// | - | `slow_mode` | 1 |
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Design<const M: usize> {
    /// Sample time.
    pub sample_time: f32,
    /// Goodwin or Tustin.
    pub scheme: Scheme,
    /// Weight of the newest y(k) in each trend.
    #[doc(alias = "lead")]
    pub feedthrough: Trends<M>,
    /// Coefficients of the filter `A_f`; `None` where there is none.
    #[doc(alias = "filter_polynomial")]
    pub filter: Option<[f32; M]>,
    /// Covariance of the trends under white noise of variance 1 on y; zero where there is no
    /// filter.
    pub noise_gain: NoiseGain<M>,
    /// Decay of the slowest real mode of the filter in one sample; 0 where there is no filter.
    #[doc(alias = "decay")]
    pub slow_mode: f32,
    /// Samples until the memory is full.
    pub warm_up: u32,
    pub(crate) size: Size,
    pub(crate) plane: Plane<M>,
}

/// How the highest trend of a signal of size 1 grows with its bandwidth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Size {
    /// Behind a filter: not at all.
    Unit,
    /// As the derivative of order m.
    Derivative,
    /// As m differences over so many samples.
    Difference { samples: f32 },
}

/// The plane of the parameters that are found with the trends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Plane<const M: usize> {
    /// The s plane, up to an error of discretisation.
    S,
    /// The s plane as trapezoids bend it.
    Bent,
    /// The gamma plane of the samples, exactly for the plant whose numerators are used.
    Gamma {
        /// a_0 .. a_{m-1} of that plant, in gamma.
        model: [f32; M],
        /// The b_0 that plain trends would give, over the true one.
        numerator: f32,
    },
}

/// A model in another plane.
#[doc(alias = "Image")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mapped<const M: usize> {
    /// a_0 .. a_{m-1} there.
    pub a: [f32; M],
    /// Every b_i there, and the constant, is this many times the one here.
    pub numerator: f32,
}

/// Share of the discretisation error behind [`trapezoids`](crate::trends::trapezoids): 0.14 for 0.2
/// of `(omega Delta)^2` covers what is left of inputs on straight lines, 0.12.
const UNBENT: f32 = 0.7;

/// m differences over a long span are at most this to the power m, of a signal of size 1.
const LARGEST_DIFFERENCE: f32 = 1.5;

impl<const M: usize> Design<M> {
    /// Size of the highest trend of a signal of size 1 at `bandwidth` rad/s.
    #[doc(alias = "gain")]
    pub fn scale(&self, bandwidth: f32) -> f32 {
        let each = match self.size {
            Size::Unit => 1.0,
            Size::Derivative => bandwidth,
            Size::Difference { samples } => {
                let angle = bandwidth * self.sample_time * samples;
                if angle < LARGEST_DIFFERENCE {
                    angle
                } else {
                    LARGEST_DIFFERENCE
                }
            }
        };
        raised(each, M)
    }

    /// The slow pole of the filter in rad/s, below 0.
    pub(crate) fn slow_pole(&self) -> f32 {
        (self.slow_mode - 1.0) / self.sample_time
    }

    /// Share of the discretisation error that these trends leave to a model with the denominator
    /// `found`, 0 to 1; `zeros` states whether an input has a b_i beyond b_0.
    ///
    /// In the gamma plane: the distance to the model of the numerators, in powers of the largest
    /// rate.
    #[doc(alias = "inexact")]
    pub fn discretisation_share(&self, found: &[f32; M], zeros: bool) -> f32 {
        let model = match self.plane {
            Plane::Bent if !zeros && bend_of_found(found, self.sample_time).is_some() => {
                return UNBENT;
            }
            Plane::S | Plane::Bent => return 1.0,
            Plane::Gamma { model, .. } => model,
        };
        let rate = largest_rate(found);
        let mut far = 0.0_f32;
        let mut power = 1.0;
        for i in (0..M).rev() {
            power *= rate;
            far = far.max((found[i] - model[i]).abs() / power);
        }
        // NaN counts as far.
        if far < 1.0 { far } else { 1.0 }
    }

    /// Whether parameters are found in the s plane.
    pub(crate) const fn is_of_s_plane(&self) -> bool {
        matches!(self.plane, Plane::S)
    }

    /// Whether the s plane is more than one factor of all coefficients away.
    pub(crate) const fn curves(&self) -> bool {
        matches!(self.plane, Plane::Gamma { .. })
    }

    /// Whether a model has the same parameters with these trends as with the `other` ones.
    pub(crate) fn shares_plane(&self, other: &Self) -> bool {
        !matches!(self.plane, Plane::Gamma { .. })
            && self.plane == other.plane
            && self.sample_time == other.sample_time
    }

    /// The model of the s plane for the denominator `found` with these trends, behind this many
    /// integrators; `zeros` states whether an input has a b_i beyond b_0.
    ///
    /// `None` where `found` already is of the s plane, and where a pole is too fast for the
    /// sampling.
    #[doc(alias = "continuous")]
    pub fn to_s_plane(
        &self,
        found: &[f32; M],
        integrators: usize,
        zeros: bool,
    ) -> Option<Mapped<M>> {
        match self.plane {
            Plane::S => None,
            Plane::Bent if zeros => None,
            Plane::Bent => bend_of_found(found, self.sample_time).map(|h| Mapped::scaled(found, h)),
            Plane::Gamma { numerator, .. } => {
                let a = to_s_plane(found, self.sample_time)?;
                let numerator = at_rest(numerator, &a, found, integrators);
                numerator.is_finite().then_some(Mapped { a, numerator })
            }
        }
    }

    /// The inverse of [`Design::to_s_plane`].
    #[doc(alias = "sampled")]
    #[doc(alias = "to_gamma_plane")]
    pub fn to_trend_plane(
        &self,
        a: &[f32; M],
        integrators: usize,
        zeros: bool,
    ) -> Option<Mapped<M>> {
        match self.plane {
            Plane::S => None,
            Plane::Bent if zeros => None,
            Plane::Bent => bend(a, self.sample_time).map(|h| Mapped::scaled(a, 1.0 / h)),
            Plane::Gamma { numerator, .. } => {
                let image = to_gamma_plane(a, self.sample_time)?;
                let numerator = 1.0 / at_rest(numerator, a, &image, integrators);
                numerator.is_finite().then_some(Mapped {
                    a: image,
                    numerator,
                })
            }
        }
    }
}

impl<const M: usize> Mapped<M> {
    /// All coefficients times one factor.
    fn scaled(a: &[f32; M], factor: f32) -> Self {
        Self {
            a: a.map(|value| factor * value),
            numerator: factor,
        }
    }
}

/// Factor from the numerators found to those of a model with denominator `a` in the s plane,
/// `image` in gamma.
///
/// The gain behind the integrators is what the samples show, so it stays.
fn at_rest<const M: usize>(own: f32, a: &[f32; M], image: &[f32; M], integrators: usize) -> f32 {
    match (a.get(integrators), image.get(integrators)) {
        (Some(a), Some(image)) if *image != 0.0 => own * a / image,
        _ => own,
    }
}
