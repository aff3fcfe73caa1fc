//! The chain of m integrators with feedback `1/A_f` behind the filtered trends.

use crate::math::polynomial::is_hurwitz;
use crate::math::sum::EMPTY;
use crate::trends::design::Design;
use crate::trends::difference::{Scheme, Trends};
use crate::trends::operator::{Form, Hold, Memory, sealed};

/// The states of the filter for one signal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chain<const M: usize> {
    /// State i is the part of trend i that is known before the sample comes.
    pub(crate) states: [f32; M],
    /// y(k-1), for increments.
    pub(crate) last: f32,
    /// Second words of states 0 and 1: what their last digits could not take is carried over to the
    /// next sample.
    pub(crate) pending: [f32; 2],
}

impl<const M: usize> sealed::Sealed for Chain<M> {}

impl<const M: usize> Memory<M> for Chain<M> {
    fn output_at_rest(design: &Design<M>, form: Form, value: f32) -> Self {
        let mut states = [0.0; M];
        if let (Form::Position, Some(filter)) = (form, &design.filter) {
            states[0] = value / filter[0];
        }
        Self {
            states,
            last: value,
            pending: [0.0; 2],
        }
    }

    fn input_at_rest(design: &Design<M>, hold: Hold, value: f32) -> Self {
        let mut memory = Self::output_at_rest(design, Form::Position, value);
        let ahead = shares(design.scheme, design.sample_time).0;
        match hold {
            // The exact integral of the last held value is already on its way in.
            Hold::Zero => memory.states[M - 1] += ahead * value,
            Hold::Mean => memory.states[M - 1] -= (design.sample_time - ahead) * value,
            Hold::First => {}
        }
        memory
    }

    fn add(&mut self, unit: &Self, weight: f32) {
        for (state, unit) in self.states.iter_mut().zip(&unit.states) {
            *state += weight * unit;
        }
        for (pending, unit) in self.pending.iter_mut().zip(&unit.pending) {
            *pending += weight * unit;
        }
    }

    #[inline(never)]
    fn flush(&mut self) {
        let [pending, waiting] = &mut self.pending;
        for (i, state) in self.states.iter_mut().enumerate() {
            if state.abs() < NEGLIGIBLE {
                *state = 0.0;
                if i == 1 {
                    // Half a last digit of the state at most.
                    *waiting = 0.0;
                }
            }
        }
        if pending.abs() < NEGLIGIBLE {
            *pending = 0.0;
        }
    }
}

/// States below this change no digit of any trend.
const NEGLIGIBLE: f32 = 1e-25;

/// Shares of the newest value and of the one before in one integration.
fn shares(scheme: Scheme, sample_time: f32) -> (f32, f32) {
    match scheme {
        Scheme::Tustin => (0.5 * sample_time, 0.5 * sample_time),
        Scheme::Goodwin => (0.0, sample_time),
    }
}

/// The coefficients of the chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Integrators<const M: usize> {
    /// f_0 .. f_{m-1} of the filter.
    pub(crate) filter: [f32; M],
    /// Share of the newest value in one integration: Delta/2 (trapezoid) or 0 (forward rectangle).
    pub(crate) ahead: f32,
    /// Share of the value before: Delta/2 or Delta.
    pub(crate) behind: f32,
    /// 1 / (1 + sum f_i ahead^(m-i)): solves the loop that the trapezoids close within one sample.
    pub(crate) loop_gain: f32,
    /// Weight of the trend of order 1 in the highest one, of increments: f_1 + f_0 `ahead`; 0 for
    /// m = 1.
    damping: f32,
}

impl<const M: usize> Integrators<M> {
    pub(crate) fn new(scheme: Scheme, sample_time: f32, filter: [f32; M]) -> Self {
        let (ahead, behind) = shares(scheme, sample_time);
        let mut sum = 1.0;
        let mut weight = ahead;
        for f in filter.iter().rev() {
            sum += f * weight;
            weight *= ahead;
        }
        Self {
            filter,
            ahead,
            behind,
            loop_gain: 1.0 / sum,
            damping: filter.get(1).map_or(0.0, |f| f + filter[0] * ahead),
        }
    }

    /// Whether every mode of the samples decays.
    ///
    /// With `sigma = (2/Delta)(z-1)/(z+1)`, whose left half plane is the unit circle, an integrator
    /// is `1/gamma`, `gamma = sigma/(1 - d sigma)`, `d = (behind - ahead)/2`. What is left is the
    /// condition of Hurwitz on
    ///
    /// ```text
    /// sum_i f_i sigma^i (1 - d sigma)^(m-i)        f_m = 1; A_f itself for trapezoids
    /// ```
    pub(crate) fn is_stable(&self) -> bool {
        let d = 0.5 * (self.behind - self.ahead);
        let mut mapped = [0.0; M];
        let mut top = 1.0;
        for i in 0..M {
            // The binomial coefficients of order m - i, times powers of -d.
            let mut weight = 1.0;
            for j in i..M {
                mapped[j] += self.filter[i] * weight;
                weight *= -d * (M - j) as f32 / (j - i + 1) as f32;
            }
            top += self.filter[i] * weight;
        }
        // NaN fails.
        top > 0.0 && is_hurwitz(&mapped.map(|value| value / top))
    }

    /// Weight of the newest sample in each trend.
    pub(crate) fn feedthrough(&self) -> Trends<M> {
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

    /// One sample through the filter: `direct` enters at the top, `held` after the first
    /// integration.
    ///
    /// State 0 has a second word, `pending`. Under a steady signal its increments shrink below half
    /// its last digit, where one word would stop: 0.5 ulp over Delta times the slow pole away from
    /// its end, 4e-5 of it at 20 rad/s and 1 kHz. What is the same in every row does not average
    /// out.
    #[inline(always)]
    pub(crate) fn step(
        &self,
        states: &mut [f32; M],
        pending: &mut f32,
        direct: f32,
        held: f32,
    ) -> Trends<M> {
        // The trends as if the highest one were zero ...
        let mut known = *states;
        for i in (0..M - 1).rev() {
            known[i] += self.ahead * known[i + 1];
        }
        // ... give the highest one ...
        let mut feedback = EMPTY;
        for i in 0..M {
            feedback += self.filter[i] * known[i];
        }
        let top = (direct - feedback) * self.loop_gain;
        // ... and with it all the others, each the integral of the one above.
        let mut lower = *states;
        let mut above = top;
        let mut entering = held;
        for i in (1..M).rev() {
            lower[i] += self.ahead * above;
            states[i] = lower[i] + self.behind * above + entering;
            above = lower[i];
            entering = EMPTY;
        }
        let change = (self.ahead + self.behind) * above + (entering + *pending);
        lower[0] += self.ahead * above;
        let sum = states[0] + change;
        *pending = change - (sum - states[0]);
        states[0] = sum;
        Trends { lower, top }
    }

    /// One increment of y through the filter.
    ///
    /// State 0 holds `y - f_0 S_0` in place of S_0: the part of the position that the filter has
    /// not followed yet. At rest it goes to zero, where f32 is finest; S_0 would stay at the
    /// position over f_0 and round every increment to its own last digit. In motion it is the speed
    /// over the slow pole, and its last digit, each time the same, would pass for a speed. In its
    /// second word, `pending`, what the filter follows until the next sample waits for the next
    /// increment: the two nearly cancel.
    ///
    /// State 1 is then the one that stays with a steady speed, and has a second word: in one, the
    /// trend above could stand at half its last digit over Delta, 1e-5 of the row at 5 rad/s, for
    /// ever.
    #[inline(always)]
    pub(crate) fn step_increment(
        &self,
        states: &mut [f32; M],
        [pending, waiting]: &mut [f32; 2],
        increment: f32,
    ) -> Trends<M> {
        let mut known = *states;
        for i in (1..M - 1).rev() {
            known[i] += self.ahead * known[i + 1];
        }
        let change = increment + *pending;
        let left = states[0] + change;
        let rest = change - (left - states[0]);
        let mut top = left;
        for i in 1..M {
            let weight = if i == 1 { self.damping } else { self.filter[i] };
            top -= weight * known[i];
        }
        top *= self.loop_gain;
        let mut lower = *states;
        let mut above = top;
        for i in (1..M).rev() {
            lower[i] += self.ahead * above;
            if i == 1 {
                let change = (self.ahead + self.behind) * above + *waiting;
                let sum = states[1] + change;
                *waiting = change - (sum - states[1]);
                states[1] = sum;
            } else {
                states[i] = lower[i] + self.behind * above;
            }
            above = lower[i];
        }
        lower[0] = 0.0;
        states[0] = left;
        *pending = rest - self.filter[0] * (self.ahead + self.behind) * above;
        Trends { lower, top }
    }
}

#[cfg(test)]
mod tests;
