//! Filtered trends: the state-variable chain (sections 1-2 of the paper behind one stable filter).

use crate::error::{ConfigError, assert_order, check_positive, check_range};
use crate::math::polynomial::{is_hurwitz, slowest_rate, with_pole};
use crate::trends::filter::for_bandwidth;
use crate::trends::{Hold, NoiseGain, Scheme, TrendOperator, Trends};

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
/// Best poles: 1 to 1.5 times the natural frequency of the plant.
///
/// # Examples
/// ```
/// use trendid::{FilteredTrends, Hold, Scheme, TrendOperator};
/// let trends = FilteredTrends::<1>::try_new(Scheme::Tustin, 0.001, [20.0])?;
/// let mut memory = FilteredTrends::<1>::EMPTY;
/// let mut last = [0.0];
/// for _ in 0..2000 {
///     last = trends.input(&mut memory, 3.0, Hold::Zero);
/// }
/// assert!((last[0] - 3.0 / 20.0).abs() < 1e-6); // 1/(s+20) of a constant
/// # Ok::<(), trendid::ConfigError>(())
/// ```
/// An order outside 1..=4 does not compile:
/// ```compile_fail,E0080
/// use trendid::{FilteredTrends, Scheme};
/// let trends = FilteredTrends::<5>::for_bandwidth(Scheme::Tustin, 0.001, 20.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilteredTrends<const M: usize> {
    sample_time: f32,
    /// f_0 .. f_{m-1} of the filter.
    filter: [f32; M],
    /// Share of the newest value in one integration: Delta/2 (trapezoid) or 0 (forward rectangle).
    ahead: f32,
    /// Share of the value before: Delta/2 or Delta.
    behind: f32,
    /// 1 / (1 + sum f_i ahead^(m-i)): solves the loop that the trapezoids close within one sample.
    loop_gain: f32,
}

impl<const M: usize> FilteredTrends<M> {
    /// Chain with the real poles `-poles[i]`.
    ///
    /// # Errors
    /// [`ConfigError::NotPositive`]; with forward rectangles [`ConfigError::OutOfRange`] for a pole above 1/Delta.
    pub fn try_new(scheme: Scheme, sample_time: f32, poles: [f32; M]) -> Result<Self, ConfigError> {
        let mut filter = [0.0; M];
        check_positive("sample_time", sample_time)?;
        for (i, pole) in poles.into_iter().enumerate() {
            check_positive(("poles", i), pole)?;
            if let Scheme::Goodwin = scheme {
                check_range(("poles", i), pole, [0.0, 1.0 / sample_time])?;
            }
            filter = with_pole(filter, i, pole);
        }
        Self::from_polynomial(scheme, sample_time, filter)
    }

    /// Chain with `A_f = s^m + filter[m-1] s^{m-1} + .. + filter[0]`.
    ///
    /// # Errors
    /// [`ConfigError::NotPositive`], also for a coefficient of the polynomial; [`ConfigError::Unstable`] where it breaks
    /// the Hurwitz conditions.
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
        if !is_hurwitz(&filter) {
            let setting = "filter".into();
            return Err(ConfigError::Unstable { setting });
        }
        let (ahead, behind) = match scheme {
            Scheme::Tustin => (0.5 * sample_time, 0.5 * sample_time),
            Scheme::Goodwin => (0.0, sample_time),
        };
        let mut sum = 1.0;
        let mut weight = ahead;
        let mut i = M;
        while i > 0 {
            i -= 1;
            sum += filter[i] * weight;
            weight *= ahead;
        }
        Ok(Self {
            sample_time,
            filter,
            ahead,
            behind,
            loop_gain: 1.0 / sum,
        })
    }

    /// Coefficients f_0 .. f_{m-1} of the filter, in rad^(m-i)/s^(m-i).
    pub const fn filter(&self) -> [f32; M] {
        self.filter
    }

    /// The filter for a plant of rough bandwidth omega (rad/s): `(s + 0.11 omega) (s^2 + 1.54 omega s + 1.21 omega^2)` for m = 3.
    ///
    /// A pair of damping 0.7 at 1.1 omega, where the noise and the dynamics part, and a
    /// slow real pole that lets the position itself be seen (m = 1: the pole 1.1 omega;
    /// m = 2: two real poles; m = 4: a further pole 1.1 omega): measured to be within 1.4
    /// times the Cramer-Rao bound under white noise, with [`Structure::SERVO`](crate::Structure::servo).
    ///
    /// # Errors
    /// As [`FilteredTrends::try_new`].
    pub fn for_bandwidth(
        scheme: Scheme,
        sample_time: f32,
        bandwidth: f32,
    ) -> Result<Self, ConfigError> {
        const { assert_order(M) };
        check_positive("bandwidth", bandwidth)?;
        let filter = for_bandwidth(bandwidth);
        Self::from_polynomial(scheme, sample_time, filter)
    }

    /// One sample through the chain: `direct` enters at the top, `held` after the first integration.
    ///
    /// Memory i holds the part of trend i that is known before the sample comes.
    #[inline(always)]
    fn step(&self, memory: &mut [f32; M], direct: f32, held: f32) -> Trends<M> {
        // What the trends would be if the highest one were zero ...
        let mut known = *memory;
        for i in (0..M - 1).rev() {
            known[i] += self.ahead * known[i + 1];
        }
        // ... gives the highest one ...
        let mut feedback = 0.0;
        for i in 0..M {
            feedback += self.filter[i] * known[i];
        }
        let top = (direct - feedback) * self.loop_gain;
        // ... and with it all the others, each the integral of the one above.
        let mut lower = *memory;
        let mut above = top;
        let mut entering = held;
        for i in (0..M).rev() {
            lower[i] += self.ahead * above;
            memory[i] = lower[i] + self.behind * above + entering;
            above = lower[i];
            entering = 0.0;
        }
        Trends { lower, top }
    }
}

fn multiply<const M: usize>(a: &[[f32; M]; M], b: &[[f32; M]; M]) -> [[f32; M]; M] {
    core::array::from_fn(|i| core::array::from_fn(|j| (0..M).map(|k| a[i][k] * b[k][j]).sum()))
}

fn transpose<const M: usize>(a: &[[f32; M]; M]) -> [[f32; M]; M] {
    core::array::from_fn(|i| core::array::from_fn(|j| a[j][i]))
}

impl<const M: usize> TrendOperator<M> for FilteredTrends<M> {
    type Memory = [f32; M];
    const EMPTY: [f32; M] = [0.0; M];

    fn sample_time(&self) -> f32 {
        self.sample_time
    }

    fn settled(&self, value: f32) -> [f32; M] {
        let mut memory = [0.0; M];
        memory[0] = value / self.filter[0];
        memory
    }

    fn settled_input(&self, value: f32, hold: Hold) -> [f32; M] {
        let mut memory = self.settled(value);
        if let Hold::Zero = hold {
            // The exact integral of the last held value is already on its way in.
            memory[M - 1] += self.ahead * value;
        }
        memory
    }

    #[inline]
    fn output(&self, memory: &mut [f32; M], y: f32) -> Trends<M> {
        self.step(memory, y, 0.0)
    }

    /// Memory 0 holds `y - f_0 S_0` in place of S_0: what is left of the position after
    /// the chain has followed it. At rest it goes to zero, where f32 is finest; S_0 would
    /// stand at the position over f_0 and round every movement to its own last digit.
    #[inline(always)]
    fn movement(&self, memory: &mut [f32; M], y: f32, before: f32) -> Trends<M> {
        let mut known = *memory;
        for i in (1..M - 1).rev() {
            known[i] += self.ahead * known[i + 1];
        }
        let left = memory[0] + (y - before);
        let mut top = left;
        for i in 1..M {
            let weight = if i == 1 {
                self.filter[1] + self.filter[0] * self.ahead
            } else {
                self.filter[i]
            };
            top -= weight * known[i];
        }
        top *= self.loop_gain;
        let mut lower = *memory;
        let mut above = top;
        for i in (1..M).rev() {
            lower[i] += self.ahead * above;
            memory[i] = lower[i] + self.behind * above;
            above = lower[i];
        }
        lower[0] = 0.0;
        memory[0] = left - self.filter[0] * (self.ahead + self.behind) * above;
        Trends { lower, top }
    }

    #[inline]
    fn input(&self, memory: &mut [f32; M], u: f32, hold: Hold) -> [f32; M] {
        match hold {
            Hold::Zero => self.step(memory, 0.0, self.sample_time * u).lower,
            Hold::First => self.step(memory, u, 0.0).lower,
        }
    }

    fn lead(&self) -> Trends<M> {
        let mut lower = [0.0; M];
        let mut weight = self.loop_gain;
        for w in lower.iter_mut().rev() {
            weight *= self.ahead;
            *w = weight;
        }
        Trends {
            lower,
            top: self.loop_gain,
        }
    }

    fn gain(&self, _bandwidth: f32) -> f32 {
        1.0
    }

    fn filter_polynomial(&self) -> Option<[f32; M]> {
        Some(self.filter)
    }

    /// Sum of g g' over the response g to one unit sample, in closed form.
    ///
    /// The memory after the sample is b, and F moves it on: X = sum F^k b b' F'^k
    /// doubles its number of terms with `X + F^n X F^n'`, F^2n = F^n F^n.
    fn noise_gain(&self) -> NoiseGain<M> {
        let mut gain = NoiseGain::ZERO;
        let mut memory = [0.0; M];
        let first = self.output(&mut memory, 1.0);
        gain.add(&first, 1.0);
        // Columns of F, and the trends that each unit of memory makes.
        let mut step = [[0.0; M]; M];
        let mut seen = [first; M];
        for i in 0..M {
            let mut unit = [0.0; M];
            unit[i] = 1.0;
            seen[i] = self.output(&mut unit, 0.0);
            for j in 0..M {
                step[j][i] = unit[j];
            }
        }
        let mut sum: [[f32; M]; M] =
            core::array::from_fn(|i| core::array::from_fn(|j| memory[i] * memory[j]));
        // 2^24 samples: longer than any filter that f32 can hold.
        for _ in 0..24 {
            let half = multiply(&step, &sum);
            let turned = transpose(&step);
            let more = multiply(&half, &turned);
            for i in 0..M {
                for j in 0..M {
                    sum[i][j] += more[i][j];
                }
            }
            step = multiply(&step, &step);
        }
        // C X C', one pair of memories at a time.
        for i in 0..M {
            for j in 0..M {
                for k in 0..M {
                    for l in 0..M {
                        gain.lower[k][l] += seen[i].lower[k] * sum[i][j] * seen[j].lower[l];
                    }
                    gain.mixed[k] += seen[i].lower[k] * sum[i][j] * seen[j].top;
                }
                gain.top += seen[i].top * sum[i][j] * seen[j].top;
            }
        }
        gain
    }

    fn decay(&self) -> f32 {
        let pole = slowest_rate(&self.filter);
        (1.0 - pole * self.behind) / (1.0 + pole * self.ahead)
    }

    fn warm_up(&self) -> u32 {
        1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poles_and_polynomial_say_the_same() {
        let by_poles =
            FilteredTrends::<3>::try_new(Scheme::Tustin, 0.001, [2.0, 3.0, 4.0]).unwrap();
        // (s + 2)(s + 3)(s + 4)
        assert_eq!(by_poles.filter(), [24.0, 26.0, 9.0]);
        let again = FilteredTrends::from_polynomial(Scheme::Tustin, 0.001, [24.0, 26.0, 9.0]);
        assert_eq!(again, Ok(by_poles));
    }

    #[test]
    fn the_default_filter_as_documented() {
        let trends = FilteredTrends::<3>::for_bandwidth(Scheme::Tustin, 0.001, 20.0).unwrap();
        // (s + 2.2)(s^2 + 30.8 s + 484)
        for (found, wanted) in trends.filter().into_iter().zip([1064.8, 551.76, 33.0]) {
            assert!((found / wanted - 1.0).abs() < 1e-6, "{found}");
        }
        assert!((trends.decay() - (1.0 - 0.0011) / (1.0 + 0.0011)).abs() < 1e-6);
    }

    #[test]
    fn what_is_not_a_filter_is_named() {
        let pole = |poles| FilteredTrends::<2>::try_new(Scheme::Tustin, 0.001, poles);
        for (index, poles) in [(0, [0.0, 1.0]), (1, [1.0, -1.0]), (1, [1.0, f32::INFINITY])] {
            let (setting, value) = (("poles", index).into(), poles[index]);
            let expected = ConfigError::NotPositive { setting, value };
            assert_eq!(pole(poles), Err(expected));
        }
        assert!(pole([f32::NAN, 1.0]).is_err());
        // Forward rectangles are unstable above 1/Delta.
        assert!(FilteredTrends::<1>::try_new(Scheme::Goodwin, 0.001, [1001.0]).is_err());
        assert!(FilteredTrends::<1>::try_new(Scheme::Tustin, 0.001, [1001.0]).is_ok());
        // (s - 1)(s^2 + 4 s + 9) fails in its own signs, s^3 + s^2 + s + 2 in the Hurwitz condition.
        let polynomial = |f| FilteredTrends::<3>::from_polynomial(Scheme::Tustin, 0.001, f);
        let not_positive = ConfigError::NotPositive {
            setting: ("filter", 0).into(),
            value: -9.0,
        };
        assert_eq!(polynomial([-9.0, 5.0, 3.0]), Err(not_positive));
        let unstable = ConfigError::Unstable {
            setting: "filter".into(),
        };
        assert_eq!(polynomial([2.0, 1.0, 1.0]), Err(unstable));
        assert!(polynomial([1.0, 2.0, 2.0]).is_ok());
        assert_eq!(
            FilteredTrends::<2>::for_bandwidth(Scheme::Tustin, 0.001, 0.0),
            Err(ConfigError::NotPositive {
                setting: "bandwidth".into(),
                value: 0.0
            })
        );
    }

    #[test]
    fn lead_is_the_answer_to_a_unit_sample() {
        for scheme in [Scheme::Goodwin, Scheme::Tustin] {
            let trends = FilteredTrends::<3>::for_bandwidth(scheme, 0.001, 20.0).unwrap();
            let mut memory = FilteredTrends::<3>::EMPTY;
            assert_eq!(trends.output(&mut memory, 1.0), trends.lead());
        }
    }

    #[test]
    fn settled_signals_stay() {
        let trends = FilteredTrends::<3>::for_bandwidth(Scheme::Tustin, 0.001, 20.0).unwrap();
        let mut y = trends.settled(5.0);
        let mut u = trends.settled_input(5.0, Hold::Zero);
        let rest = 5.0 / trends.filter()[0];
        for _ in 0..1000 {
            let output = trends.output(&mut y, 5.0);
            let input = trends.input(&mut u, 5.0, Hold::Zero);
            for found in [output.lower[0], input[0]] {
                assert!((found / rest - 1.0).abs() < 1e-5);
            }
            assert!(output.top.abs() < 1e-4 && output.lower[1].abs() < 1e-4);
        }
    }
}
