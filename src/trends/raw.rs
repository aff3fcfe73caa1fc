//! The paper's trends, straight from the last samples (equations 4 and 8).

use crate::error::{ConfigError, assert_order, check_positive};
use crate::trends::{Hold, Scheme, TrendOperator, Trends, goodwin, tustin};

/// Trends without a filter, exactly as in the paper.
///
/// `Departs from (4), (8):` both sides of (5) are divided by `Delta^m` (Goodwin)
/// or `(2 Delta)^m` (Tustin), which changes no parameter and gives the trend of
/// order i the unit of the signal per s^i.
///
/// A third difference of measurement noise exceeds that of the signal by orders
/// of magnitude: use this on data without noise, and
/// [`FilteredTrends`](crate::FilteredTrends) on a machine.
///
/// # Examples
/// ```
/// use trendid::{RawTrends, Scheme, TrendOperator};
/// let trends = RawTrends::<2>::try_new(Scheme::Tustin, 0.5)?;
/// let mut memory = trends.settled(0.0);
/// let _ = trends.output(&mut memory, 1.0);
/// let _ = trends.output(&mut memory, 2.0);
/// let ramp = trends.output(&mut memory, 3.0);
/// assert_eq!(ramp.lower, [2.0, 2.0]); // mean (1+2*2+3)/4, slope (3-1)/1 s
/// assert_eq!(ramp.top, 0.0); // no curvature
/// # Ok::<(), trendid::ConfigError>(())
/// ```
/// An order outside 1..=4 does not compile:
/// ```compile_fail,E0080
/// use trendid::{RawTrends, Scheme};
/// let trends = RawTrends::<5>::try_new(Scheme::Tustin, 0.001);
/// ```
/// ```compile_fail,E0080
/// use trendid::{RawTrends, Scheme};
/// let trends = RawTrends::<0>::try_new(Scheme::Tustin, 0.001);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RawTrends<const M: usize> {
    scheme: Scheme,
    sample_time: f32,
    rate: f32,
}

impl<const M: usize> RawTrends<M> {
    /// Trends of order `M` of samples taken every `sample_time` seconds.
    ///
    /// # Errors
    /// [`ConfigError::NotPositive`].
    pub fn try_new(scheme: Scheme, sample_time: f32) -> Result<Self, ConfigError> {
        const { assert_order(M) };
        check_positive("sample_time", sample_time)?;
        Ok(Self {
            scheme,
            sample_time,
            rate: 1.0 / sample_time,
        })
    }
}

/// Moves the window one sample on: `past[0]` becomes the newest.
#[inline(always)]
fn shift<const M: usize>(past: &mut [f32; M], newest: f32) {
    for j in (1..M).rev() {
        past[j] = past[j - 1];
    }
    past[0] = newest;
}

impl<const M: usize> TrendOperator<M> for RawTrends<M> {
    type Memory = [f32; M];
    const EMPTY: [f32; M] = [0.0; M];

    fn sample_time(&self) -> f32 {
        self.sample_time
    }

    fn settled(&self, value: f32) -> [f32; M] {
        [value; M]
    }

    fn settled_input(&self, value: f32, _hold: Hold) -> [f32; M] {
        [value; M]
    }

    #[inline]
    fn output(&self, past: &mut [f32; M], y: f32) -> Trends<M> {
        let trends = match self.scheme {
            Scheme::Goodwin => goodwin(y, past, self.rate),
            Scheme::Tustin => tustin(y, past, M, self.rate),
        };
        shift(past, y);
        trends
    }

    #[inline]
    fn movement(&self, past: &mut [f32; M], y: f32, _before: f32) -> Trends<M> {
        self.output(past, y)
    }

    #[inline]
    fn input(&self, past: &mut [f32; M], u: f32, hold: Hold) -> [f32; M] {
        let lower = match (self.scheme, hold) {
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
        };
        shift(past, u);
        lower
    }

    fn lead(&self) -> Trends<M> {
        let mut lower = [0.0; M];
        let mut top = 1.0;
        for _ in 0..M {
            top *= self.rate;
        }
        if let Scheme::Tustin = self.scheme {
            let mut weight = 1.0;
            for _ in 0..M {
                weight *= 0.5;
            }
            for w in &mut lower {
                *w = weight;
                weight *= 2.0 * self.rate;
            }
        }
        Trends { lower, top }
    }

    fn gain(&self, bandwidth: f32) -> f32 {
        let mut gain = 1.0;
        for _ in 0..M {
            gain *= bandwidth;
        }
        gain
    }

    fn warm_up(&self) -> u32 {
        M as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lead_is_the_answer_to_a_unit_sample() {
        for scheme in [Scheme::Goodwin, Scheme::Tustin] {
            let trends = RawTrends::<4>::try_new(scheme, 0.25).unwrap();
            let mut memory = RawTrends::<4>::EMPTY;
            assert_eq!(trends.output(&mut memory, 1.0), trends.lead());
        }
    }

    #[test]
    fn a_parabola_has_its_derivatives() {
        // y = t^2 with Delta = 0.5: mean slope over the window and curvature 2, exact in f32.
        for scheme in [Scheme::Goodwin, Scheme::Tustin] {
            let trends = RawTrends::<2>::try_new(scheme, 0.5).unwrap();
            let mut memory = RawTrends::<2>::EMPTY;
            let mut last = trends.output(&mut memory, 0.0);
            for k in 1..5 {
                let t = 0.5 * k as f32;
                last = trends.output(&mut memory, t * t);
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
        let mut memory = RawTrends::<2>::EMPTY;
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
