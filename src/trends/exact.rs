//! Trends that are exact at any sample time: the numerators of the hold and the poles of the s
//! plane.

use crate::error::{ConfigError, assert_order, check_finite, check_positive};
use crate::trends::bilinear::to_gamma_plane;
use crate::trends::chain::Chain;
use crate::trends::design::{Design, Plane};
use crate::trends::difference::{Scheme, Trends};
use crate::trends::filter::for_bandwidth;
use crate::trends::filtered::FilteredTrends;
use crate::trends::hold::Numerators;
use crate::trends::operator::{Form, Hold, TrendOperator, sealed};

/// [`FilteredTrends`] for signals that are sampled slowly: a dozen samples per period and fewer.
///
/// `Departs from (8):` nothing of y is interpolated in the equation `A_g(gamma) y = N(gamma) u`
/// that the samples of y obey. Its poles are `gamma_p = (2/Delta) tanh(p Delta/2)` for the poles p
/// of the plant, its numerators those of the hold. The trend j of an input is replaced by
/// `N_j(gamma)` of `s^j/A(s)` over the filter. The plant's own A is not known at first: the filter
/// replaces it until [`ExactTrends::with_model`] is given an estimate. With the right A every
/// parameter is exact for any Delta and any filter; with another A the numerators are wrong by its
/// distance times `(omega Delta)^2 / 12`. The model is read in the s plane and keeps the gain
/// (behind the integrators) that was found. The standard deviations of an estimate are those of the
/// s plane; prior deviations are not mapped, a prior is rough anyway.
///
/// | symbol | argument | unit |
/// |---|---|---|
/// | Delta | `sample_time` | s |
/// | `A_f` | `filter`, every pole below 2/Delta | rad^(m-i)/s^(m-i) |
///
/// Cost: m^2 multiplications per input more than [`FilteredTrends`], which suffices at 1 kHz.
///
/// # Examples
/// ```
/// use trendid::{Config, Identifier, Structure};
/// use trendid::trends::ExactTrends;
/// // A lag of 8 rad/s and static gain 2, sampled every 50 ms, with a filter of 5 rad/s.
/// let trends = ExactTrends::from_polynomial(0.05, [5.0])?;
/// let config = Config::new(Structure::<1, 2, 1>::FULL, 5.0, [1.0], 1.0);
/// let mut identifier: Identifier<_, 1, 2> = Identifier::try_new(&config, trends)?;
/// let (mut y, decay) = (0.0_f32, (-8.0 * 0.05_f32).exp());
/// for k in 0..200 {
///     let u = if (k / 7) % 2 == 0 { 1.0 } else { -1.0 };
///     let _ = identifier.update(u, y);
///     y = 2.0 * u + (y - 2.0 * u) * decay;
/// }
/// // Plain trends are 1 % off here.
/// let model = identifier.estimate().transfer_function();
/// assert!((model.a[0] - 8.0).abs() < 1e-4 && (model.b[0][0] - 16.0).abs() < 2e-4);
/// # Ok::<(), trendid::ConfigError>(())
/// ```
/// An order outside 1..=4 does not compile:
/// ```compile_fail,E0080
/// use trendid::trends::ExactTrends;
/// let trends = ExactTrends::<5>::for_bandwidth(0.001, 20.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ExactTrends<const M: usize> {
    chain: FilteredTrends<M>,
    numerators: Numerators<M>,
}

impl<const M: usize> ExactTrends<M> {
    /// Trends behind `1/A_f(s)`, `A_f = s^m + filter[m-1] s^{m-1} + .. + filter[0]`, with the
    /// numerators of A = `A_f`.
    ///
    /// # Errors
    /// As [`FilteredTrends::from_polynomial`]; [`ConfigError::TooFast`] where `A_f` has a pole at
    /// 2/Delta or above.
    pub fn from_polynomial(sample_time: f32, filter: [f32; M]) -> Result<Self, ConfigError> {
        const { assert_order(M) };
        check_positive("sample_time", sample_time)?;
        // The map keeps the half plane of every pole: a filter that is unstable there is unstable
        // here.
        let image = in_gamma_plane("filter", &filter, sample_time)?;
        let chain = FilteredTrends::from_polynomial(Scheme::Tustin, sample_time, image)?;
        Ok(Self::of(chain, &filter, image, &image))
    }

    /// The same filter with the numerators of a plant `A = s^m + a[m-1] s^{m-1} + .. + a[0]`,
    /// stable or not.
    ///
    /// # Errors
    /// [`ConfigError::NotFinite`], [`ConfigError::TooFast`] where A has a pole at 2/Delta or above.
    pub fn with_model(&self, a: [f32; M]) -> Result<Self, ConfigError> {
        let image = in_gamma_plane("a", &a, self.design().sample_time)?;
        let filter = self.chain.filter();
        Ok(Self::of(self.chain.clone(), &a, image, &filter))
    }

    /// Trends behind the default filter for a plant of rough bandwidth omega (rad/s), see
    /// [`FilteredTrends::for_bandwidth`].
    ///
    /// # Errors
    /// As [`ExactTrends::from_polynomial`].
    pub fn for_bandwidth(sample_time: f32, bandwidth: f32) -> Result<Self, ConfigError> {
        check_positive("bandwidth", bandwidth)?;
        Self::from_polynomial(sample_time, for_bandwidth(bandwidth))
    }

    /// The numerators of a plant with denominator `a` in s, `image` in gamma, behind the filter in
    /// gamma.
    fn of(chain: FilteredTrends<M>, a: &[f32; M], image: [f32; M], filter: &[f32; M]) -> Self {
        let numerators = Numerators::new(a, &image, filter, chain.design().sample_time);
        let plane = Plane::Gamma {
            model: image,
            numerator: numerators.at_rest(),
        };
        Self {
            chain: chain.with_plane(plane),
            numerators,
        }
    }
}

/// A polynomial of the s plane in the gamma plane.
fn in_gamma_plane<const M: usize>(
    name: &'static str,
    a: &[f32; M],
    sample_time: f32,
) -> Result<[f32; M], ConfigError> {
    for (i, value) in a.iter().enumerate() {
        check_finite((name, i), *value)?;
    }
    to_gamma_plane(a, sample_time).ok_or(ConfigError::TooFast {
        setting: name.into(),
        limit: 2.0 / sample_time,
    })
}

impl<const M: usize> sealed::Sealed for ExactTrends<M> {}

impl<const M: usize> TrendOperator<M> for ExactTrends<M> {
    type Memory = Chain<M>;

    #[inline(always)]
    fn output(&self, memory: &mut Chain<M>, y: f32, form: Form) -> Trends<M> {
        self.chain.output(memory, y, form)
    }

    #[inline]
    fn input(&self, memory: &mut Chain<M>, u: f32, hold: Hold) -> [f32; M] {
        let trends = self.chain.input(memory, u, hold);
        let (rows, direct) = match hold {
            Hold::Zero | Hold::Mean => (&self.numerators.zero, 0.0),
            Hold::First => (&self.numerators.first, u),
        };
        core::array::from_fn(|j| {
            let mut sum = self.numerators.direct[j] * direct;
            for i in 0..M {
                sum += rows[j][i] * trends[i];
            }
            sum
        })
    }

    fn withdraw(&self, memory: &mut Chain<M>, u: f32) {
        self.chain.withdraw(memory, u);
    }

    fn design(&self) -> &Design<M> {
        self.chain.design()
    }
}
