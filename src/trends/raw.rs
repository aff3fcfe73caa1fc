//! The paper's trends, straight from the last samples (equations 4 and 8).

use crate::error::{ConfigError, assert_order, check_positive};
use crate::math::raised;
use crate::trends::design::{Design, Plane, Size};
use crate::trends::difference::{Scheme, Trends, goodwin, tustin};
use crate::trends::noise_gain::NoiseGain;
use crate::trends::operator::{Form, Hold, Memory, TrendOperator, sealed};

/// Trends without a filter, exactly as in the paper.
///
/// `Departs from (4), (8):` both sides of (5) are divided by `Delta^m` (Goodwin)
/// or `(2 Delta)^m` (Tustin), which changes no parameter and gives the trend of
/// order i the unit of the signal per s^i.
///
/// A third difference of measurement noise exceeds that of the signal by orders
/// of magnitude: use this on data without noise, and
/// [`FilteredTrends`](crate::trends::FilteredTrends) on a machine.
///
/// # Examples
/// ```
/// use trendid::trends::{Form, Memory, RawTrends, Scheme, TrendOperator, Window};
/// let trends = RawTrends::<2>::try_new(Scheme::Tustin, 0.5)?;
/// let mut memory = Window::output_at_rest(trends.design(), Form::Position, 0.0);
/// let _ = trends.output(&mut memory, 1.0, Form::Position);
/// let _ = trends.output(&mut memory, 2.0, Form::Position);
/// let ramp = trends.output(&mut memory, 3.0, Form::Position);
/// assert_eq!(ramp.lower, [2.0, 2.0]); // mean (1+2*2+3)/4, slope (3-1)/1 s
/// assert_eq!(ramp.top, 0.0); // no curvature
/// # Ok::<(), trendid::ConfigError>(())
/// ```
/// An order outside 1..=4 does not compile:
/// ```compile_fail,E0080
/// use trendid::trends::{RawTrends, Scheme};
/// let trends = RawTrends::<5>::try_new(Scheme::Tustin, 0.001);
/// ```
/// ```compile_fail,E0080
/// use trendid::trends::{RawTrends, Scheme};
/// let trends = RawTrends::<0>::try_new(Scheme::Tustin, 0.001);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RawTrends<const M: usize> {
    design: Design<M>,
    /// 1/Delta.
    rate: f32,
}

/// The last M samples of a signal, the newest first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window<const M: usize> {
    past: [f32; M],
}

impl<const M: usize> Window<M> {
    /// Moves the window one sample on.
    #[inline(always)]
    fn shift(&mut self, newest: f32) {
        for j in (1..M).rev() {
            self.past[j] = self.past[j - 1];
        }
        self.past[0] = newest;
    }
}

impl<const M: usize> sealed::Sealed for Window<M> {}

impl<const M: usize> Memory<M> for Window<M> {
    fn output_at_rest(_: &Design<M>, _: Form, value: f32) -> Self {
        Self { past: [value; M] }
    }

    fn input_at_rest(_: &Design<M>, _: Hold, value: f32) -> Self {
        Self { past: [value; M] }
    }
}

impl<const M: usize> RawTrends<M> {
    /// Trends of order `M` of samples taken every `sample_time` seconds.
    ///
    /// # Errors
    /// [`ConfigError::NotPositive`].
    pub fn try_new(scheme: Scheme, sample_time: f32) -> Result<Self, ConfigError> {
        const { assert_order(M) };
        check_positive("sample_time", sample_time)?;
        let rate = 1.0 / sample_time;
        Ok(Self {
            design: Design {
                sample_time,
                scheme,
                feedthrough: feedthrough(scheme, rate),
                filter: None,
                noise_gain: NoiseGain::ZERO,
                slow_mode: 0.0,
                warm_up: M as u32,
                size: Size::Derivative,
                plane: Plane::S,
            },
            rate,
        })
    }
}

/// Weight of the newest sample in each trend.
fn feedthrough<const M: usize>(scheme: Scheme, rate: f32) -> Trends<M> {
    let mut lower = [0.0; M];
    if let Scheme::Tustin = scheme {
        let mut weight = raised(0.5, M);
        for w in &mut lower {
            *w = weight;
            weight *= 2.0 * rate;
        }
    }
    Trends {
        lower,
        top: raised(rate, M),
    }
}

impl<const M: usize> sealed::Sealed for RawTrends<M> {}

impl<const M: usize> TrendOperator<M> for RawTrends<M> {
    type Memory = Window<M>;

    #[inline]
    fn output(&self, memory: &mut Window<M>, y: f32, _: Form) -> Trends<M> {
        let trends = match self.design.scheme {
            Scheme::Goodwin => goodwin(y, &memory.past, self.rate),
            Scheme::Tustin => tustin(y, &memory.past, M, self.rate),
        };
        memory.shift(y);
        trends
    }

    #[inline]
    fn input(&self, memory: &mut Window<M>, u: f32, hold: Hold) -> [f32; M] {
        let past = &memory.past;
        let lower = match (self.design.scheme, hold) {
            (Scheme::Goodwin, _) => goodwin(u, past, self.rate).lower,
            (Scheme::Tustin, Hold::First) => tustin(u, past, M, self.rate).lower,
            // P_i of (8): one factor 2 q^-1/(1+q^-1) less, so one average less on past inputs.
            (Scheme::Tustin, Hold::Zero) => {
                let mut before = [0.0; M];
                for j in 1..M {
                    before[j - 1] = past[j];
                }
                tustin(past[0], &before, M - 1, self.rate).lower
            }
            (Scheme::Tustin, Hold::Mean) => tustin(u, past, M - 1, self.rate).lower,
        };
        memory.shift(u);
        lower
    }

    fn withdraw(&self, memory: &mut Window<M>, u: f32) {
        memory.past[0] -= u;
    }

    fn design(&self) -> &Design<M> {
        &self.design
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at_rest<const M: usize>(trends: &RawTrends<M>) -> Window<M> {
        Window::output_at_rest(trends.design(), Form::Position, 0.0)
    }

    #[test]
    fn the_feedthrough_is_the_answer_to_a_unit_sample() {
        for scheme in [Scheme::Goodwin, Scheme::Tustin] {
            let trends = RawTrends::<4>::try_new(scheme, 0.25).unwrap();
            let mut memory = at_rest(&trends);
            let response = trends.output(&mut memory, 1.0, Form::Position);
            assert_eq!(response, trends.design().feedthrough);
        }
    }

    #[test]
    fn a_parabola_has_its_derivatives() {
        // y = t^2 with Delta = 0.5: mean slope over the window and curvature 2, exact in f32.
        for scheme in [Scheme::Goodwin, Scheme::Tustin] {
            let trends = RawTrends::<2>::try_new(scheme, 0.5).unwrap();
            let mut memory = at_rest(&trends);
            let mut last = trends.output(&mut memory, 0.0, Form::Position);
            for k in 1..5 {
                let t = 0.5 * k as f32;
                last = trends.output(&mut memory, t * t, Form::Position);
            }
            assert_eq!(last.top, 2.0);
            // Goodwin looks back by two samples for y and one for y', Tustin at the middle sample.
            let (value, slope) = match scheme {
                Scheme::Goodwin => (1.0, 2.5),
                Scheme::Tustin => ((1.0 + 2.0 * 2.25 + 4.0) / 4.0, 3.0),
            };
            assert_eq!(last.lower, [value, slope]);
        }
    }

    #[test]
    fn a_held_input_counts_from_the_next_sample_on() {
        let trends = RawTrends::<2>::try_new(Scheme::Tustin, 0.5).unwrap();
        let mut memory = at_rest(&trends);
        assert_eq!(trends.input(&mut memory, 1.0, Hold::Zero), [0.0, 0.0]);
        assert_eq!(trends.input(&mut memory, 1.0, Hold::Zero), [0.5, 2.0]);
        assert_eq!(trends.input(&mut memory, 1.0, Hold::Zero), [1.0, 0.0]);
    }

    #[test]
    fn the_sample_time_is_positive() {
        for time in [0.0, -1.0, f32::INFINITY] {
            let setting = "sample_time".into();
            assert_eq!(
                RawTrends::<2>::try_new(Scheme::Tustin, time),
                Err(ConfigError::NotPositive {
                    setting,
                    value: time
                })
            );
        }
    }
}
