//! The trends of a step from 1 to 0, in long steps of time.
//!
//! What the slow pole -p keeps of them is left out of the states in which they begin. By the
//! residue there, s = -p,
//!
//! ```text
//! t_i,slow = -s^(i-1) / A_f'(s) e^(s t)        i = 1 .. m
//! ```
//!
//! Trapezoids are stable however long the steps are, and 0.1 % off at `omega` times 0.1 of one.

use crate::math::polynomial::value_and_slope;
use crate::math::raised;
use crate::trends::chain::Integrators;
use crate::trends::design::Design;
use crate::trends::difference::Scheme;

/// The filter at work on the step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FadingStep<const M: usize> {
    states: [f32; M],
    /// Half a step of time, and what solves the loop of the trapezoids.
    half: f32,
    loop_gain: f32,
}

impl<const M: usize> FadingStep<M> {
    /// Before the step, for steps of `time`; 0 for trends without a filter. The slow pole stays in
    /// where no other pole is as far from it as it is from 0, and where it is 0 in f32.
    #[inline(never)]
    pub(crate) fn new(design: &Design<M>, time: f32) -> Self {
        let filter = design.filter.unwrap_or([1.0; M]);
        let trapezoids = Integrators::new(Scheme::Tustin, time, filter);
        let pole = design.slow_pole();
        let [_, slope] = value_and_slope(&filter, pole);
        let mut states = [0.0; M];
        if design.filter.is_some() {
            states[0] = 1.0 / filter[0];
            let mut slow = match pole < 0.0 && slope.abs() >= raised(-pole, M - 1) {
                true => 1.0 / (pole * slope),
                false => 0.0,
            };
            for state in &mut states {
                *state += slow;
                slow *= pole;
            }
        }
        Self {
            states,
            half: trapezoids.ahead,
            loop_gain: trapezoids.loop_gain,
        }
    }

    /// The trends 1 .. m of the next step of time, in its middle; `filter` as it was.
    ///
    /// Cost: about 20 m instructions.
    #[inline(always)]
    pub(crate) fn advance(&mut self, filter: &[f32; M]) -> [f32; M] {
        // As `Integrators::step` of zero.
        let (mut known, mut feedback) = (0.0, 0.0);
        for (state, f) in self.states.iter().zip(filter).rev() {
            known = state + self.half * known;
            feedback += f * known;
        }
        let mut trends = [0.0; M];
        let mut trend = -feedback * self.loop_gain;
        for (state, found) in self.states.iter_mut().zip(&mut trends).rev() {
            *found = trend;
            let change = self.half * trend;
            trend = *state + change;
            *state = trend + change;
        }
        trends
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trends::{FilteredTrends, Form, Memory, TrendOperator};

    #[test]
    fn it_is_the_step_without_what_the_slow_pole_keeps() {
        for scheme in [Scheme::Tustin, Scheme::Goodwin] {
            let trends = FilteredTrends::<3>::for_bandwidth(scheme, 0.001, 20.0).unwrap();
            let design = trends.design();
            let mut memory = Memory::output_at_rest(design, Form::Position, 1.0);
            let mut step = FadingStep::new(design, 0.005);
            // A_f' = (-2.2)^2 - 2.2 30.8 + 484
            let kept = -1.0 / (2.2 * 2.2 - 2.2 * 30.8 + 484.0);
            for long in 0..100 {
                let found = step.advance(&trends.filter());
                let mut all = trends.output(&mut memory, 0.0, Form::Position);
                for _ in 0..2 {
                    all = trends.output(&mut memory, 0.0, Form::Position);
                }
                let time = 0.005 * long as f32 + 0.0025;
                let mut slow = kept * libm::expf(-2.2 * time);
                let sizes = [1.0 / 400.0, 1.0 / 20.0, 1.0];
                for (i, all) in [all.lower[1], all.lower[2], all.top]
                    .into_iter()
                    .enumerate()
                {
                    let off = (found[i] - (all - slow)) / sizes[i];
                    assert!(off.abs() < 0.05, "{scheme:?} {long} {i}: {off}");
                    slow *= -2.2;
                }
                for _ in 0..2 {
                    let _ = trends.output(&mut memory, 0.0, Form::Position);
                }
            }
            // The pair has faded.
            assert!(
                step.advance(&trends.filter())
                    .iter()
                    .all(|t| t.abs() < 1e-3)
            );
        }
    }

    #[test]
    fn a_slow_pole_that_is_zero_in_f32_stays_in() {
        for bandwidth in [1e-4_f32, 1e-3, 0.1] {
            let Ok(trends) = FilteredTrends::<3>::for_bandwidth(Scheme::Tustin, 1e-4, bandwidth)
            else {
                continue;
            };
            let mut step = FadingStep::new(trends.design(), 0.1 / bandwidth);
            for _ in 0..10 {
                let found = step.advance(&trends.filter());
                assert!(
                    found.iter().all(|t| t.is_finite()),
                    "{bandwidth}: {found:?}"
                );
            }
        }
    }

    #[test]
    fn where_all_poles_are_equal_nothing_is_left_out() {
        let trends = FilteredTrends::<2>::try_new(Scheme::Tustin, 0.001, [25.0; 2]).unwrap();
        let step = FadingStep::new(trends.design(), 0.005);
        assert_eq!(step.states, [1.0 / 625.0, 0.0]);
    }
}
