//! Filtered trends: the state-variable filter (sections 1-2 of the paper behind one stable filter).
//!
//! Known as: state-variable filter (Young 1981; Garnier and Wang 2008), Poisson moment functionals
//! where all poles are equal (Saha and Rao 1983).

use crate::error::{ConfigError, assert_order, check_positive, check_range};
use crate::math::polynomial::slowest_rate;
use crate::trends::chain::{Chain, Integrators};
use crate::trends::design::{Design, Plane, Size};
use crate::trends::difference::{Scheme, Trends};
use crate::trends::filter::{for_bandwidth, polynomial_of_poles};
use crate::trends::noise_gain::NoiseGain;
use crate::trends::operator::{Form, Hold, TrendOperator, sealed};

/// Trends through one stable filter `1/A_f`, the same for y and every u.
///
/// `Departs from (4), (8):` both sides of (5) are multiplied by
/// `F = Delta^m (1+q^-1)^m / R_A`, `R_A = sum f_i R_i`. With
/// `gamma = (2/Delta)(1-q^-1)/(1+q^-1)` the filtered trends are
///
/// ```text
/// F R_i y = gamma^i / A_f(gamma) y           A_f = gamma^m + f_{m-1} gamma^{m-1} + .. + f_0
/// F P_i u = gamma^i / A_f(gamma) 2 q^-1/(1+q^-1) u
/// ```
///
/// the states of a chain of m integrators with feedback, and no third difference
/// of a noisy position is ever formed. For y every integrator is a trapezoid. For
/// a held u the factor of (6) makes the first one the exact integral `Delta u(k-1)`.
/// Goodwin's scheme is the same chain with forward rectangles.
///
/// | symbol | argument | unit |
/// |---|---|---|
/// | Delta | `sample_time` | s |
/// | p_i, `A_f = prod (s + p_i)` | `poles` | rad/s, positive |
///
/// Most of what trapezoids bend of an oscillator and of an integrating drive of order 3 is taken
/// out when the model is read (`trapezoids`).
///
/// Poles that were measured to be good: [`for_bandwidth`](Self::for_bandwidth).
///
/// # Examples
/// ```
/// use trendid::trends::{Chain, FilteredTrends, Hold, Memory, Scheme, TrendOperator};
/// let trends = FilteredTrends::<1>::try_new(Scheme::Tustin, 0.001, [20.0])?;
/// let mut memory = Chain::input_at_rest(trends.design(), Hold::Zero, 0.0);
/// let mut last = [0.0];
/// for _ in 0..2000 {
///     last = trends.input(&mut memory, 3.0, Hold::Zero);
/// }
/// assert!((last[0] - 3.0 / 20.0).abs() < 1e-6); // 1/(s+20) of a constant
/// # Ok::<(), trendid::ConfigError>(())
/// ```
/// An order outside 1..=4 does not compile:
/// ```compile_fail,E0080
/// use trendid::trends::{FilteredTrends, Scheme};
/// let trends = FilteredTrends::<5>::for_bandwidth(Scheme::Tustin, 0.001, 20.0);
/// ```
#[doc(alias = "state-variable filter")]
#[doc(alias = "SVF")]
#[doc(alias = "Poisson moment functional")]
#[derive(Debug, Clone, PartialEq)]
pub struct FilteredTrends<const M: usize> {
    design: Design<M>,
    integrators: Integrators<M>,
}

impl<const M: usize> FilteredTrends<M> {
    /// Trends behind a filter with the real poles `-poles[i]`.
    ///
    /// # Errors
    /// [`ConfigError::NotPositive`]; with forward rectangles [`ConfigError::OutOfRange`] for a pole
    /// above 1/Delta.
    pub fn try_new(scheme: Scheme, sample_time: f32, poles: [f32; M]) -> Result<Self, ConfigError> {
        check_positive("sample_time", sample_time)?;
        for (i, pole) in poles.into_iter().enumerate() {
            check_positive(("poles", i), pole)?;
            if let Scheme::Goodwin = scheme {
                check_range(("poles", i), pole, [0.0, 1.0 / sample_time])?;
            }
        }
        Self::from_polynomial(scheme, sample_time, polynomial_of_poles(poles))
    }

    /// Trends behind `1/A_f`, `A_f = s^m + filter[m-1] s^{m-1} + .. + filter[0]`.
    ///
    /// # Errors
    /// [`ConfigError::NotPositive`], also for a coefficient of the polynomial;
    /// [`ConfigError::Unstable`] where it breaks the Hurwitz conditions, and with forward
    /// rectangles for a pole outside the circle of radius 1/Delta about -1/Delta.
    pub fn from_polynomial(
        scheme: Scheme,
        sample_time: f32,
        filter: [f32; M],
    ) -> Result<Self, ConfigError> {
        const { assert_order(M) };
        check_positive("sample_time", sample_time)?;
        for (i, value) in filter.into_iter().enumerate() {
            check_positive(("filter", i), value)?;
        }
        let integrators = Integrators::new(scheme, sample_time, filter);
        if !integrators.is_stable() {
            let setting = "filter".into();
            return Err(ConfigError::Unstable { setting });
        }
        let Integrators { ahead, behind, .. } = integrators;
        let pole = slowest_rate(&filter);
        Ok(Self {
            design: Design {
                sample_time,
                scheme,
                feedthrough: integrators.feedthrough(),
                filter: Some(filter),
                noise_gain: NoiseGain::of(|states, y| integrators.step(states, &mut 0.0, y, 0.0)),
                slow_mode: (1.0 - pole * behind) / (1.0 + pole * ahead),
                warm_up: 1,
                size: Size::Unit,
                plane: match scheme {
                    Scheme::Goodwin => Plane::S,
                    Scheme::Tustin => Plane::Bent,
                },
            },
            integrators,
        })
    }

    /// The filter for a plant of rough bandwidth omega (rad/s):
    /// `(s + 0.11 omega) (s^2 + 1.54 omega s + 1.21 omega^2)` for m = 3.
    ///
    /// A pair of damping 0.7 at 1.1 omega, above which noise dominates the dynamics, and a slow
    /// real pole that keeps the position in the regressor (m = 1: the pole 1.1 omega; m = 2: two
    /// real poles; m = 4: a further pole 1.1 omega): measured to be within 1.4 times the Cramer-Rao
    /// bound under white noise, with [`Structure::SERVO`](crate::Structure::SERVO).
    ///
    /// # Errors
    /// As [`FilteredTrends::from_polynomial`].
    pub fn for_bandwidth(
        scheme: Scheme,
        sample_time: f32,
        bandwidth: f32,
    ) -> Result<Self, ConfigError> {
        const { assert_order(M) };
        check_positive("bandwidth", bandwidth)?;
        Self::from_polynomial(scheme, sample_time, for_bandwidth(bandwidth))
    }

    /// Coefficients f_0 .. f_{m-1} of the filter, in rad^(m-i)/s^(m-i).
    pub const fn filter(&self) -> [f32; M] {
        self.integrators.filter
    }

    /// The same trends read in another plane.
    pub(crate) fn with_plane(mut self, plane: Plane<M>) -> Self {
        self.design.plane = plane;
        self
    }
}

impl<const M: usize> sealed::Sealed for FilteredTrends<M> {}

impl<const M: usize> TrendOperator<M> for FilteredTrends<M> {
    type Memory = Chain<M>;

    #[inline(always)]
    fn output(&self, memory: &mut Chain<M>, y: f32, form: Form) -> Trends<M> {
        let (states, pending) = (&mut memory.states, &mut memory.pending);
        match form {
            Form::Position => self.integrators.step(states, &mut pending[0], y, 0.0),
            Form::Increment => {
                let increment = y - memory.last;
                memory.last = y;
                self.integrators.step_increment(states, pending, increment)
            }
        }
    }

    #[inline]
    fn input(&self, memory: &mut Chain<M>, u: f32, hold: Hold) -> [f32; M] {
        let (states, pending) = (&mut memory.states, &mut memory.pending);
        let (direct, held) = match hold {
            Hold::Zero => (0.0, self.design.sample_time * u),
            Hold::First => (u, 0.0),
            Hold::Mean => {
                // As if it had been held since the sample before.
                states[M - 1] += self.design.sample_time * u;
                (0.0, 0.0)
            }
        };
        self.integrators
            .step(states, &mut pending[0], direct, held)
            .lower
    }

    fn withdraw(&self, memory: &mut Chain<M>, u: f32) {
        memory.states[M - 1] -= self.design.sample_time * u;
    }

    fn design(&self) -> &Design<M> {
        &self.design
    }
}

#[cfg(test)]
mod tests;
