//! What an error of y(0) does to an estimate with an initial state, beside the recursion.
//!
//! The trends begin at rest at y(0), which is off by nu: behind the filter all rows hold nu times
//! the trends `t_i` of a step from 1 to 0. The column of the initial state takes what the slow pole
//! keeps of them. What the other poles make of them, `t_i - t_i,slow`, is in the first rows alone,
//! with the same nu in each: no residual shows it. To first order in nu, for whatever model is
//! found at last, with P of the recursion,
//!
//! ```text
//! theta - theta_0 = nu P q        q = Q_m + sum over i: a_i Q_i        Q_i = sum phi (t_i - t_i,slow)
//! ```
//!
//! A drive that integrates has no a_0. The sums are forgotten as rows are. The trends of the step
//! are smooth on the scale of one over the bandwidth: a filter of their own takes a hundred long
//! steps of a tenth of it, and one row stands for all samples of a step. The work is in two rows,
//! first the filter, then the sums.
//!
//! # What does not hold
//! Samples without a row among the first, as of a drive that stands, are counted as rows: the sums
//! are as much too large.
//!
//! Known as: consider covariance. Schmidt, Advances in Control Systems 3 (1966).

use crate::trends::Design;
use crate::trends::fading_step::FadingStep;

/// Sums with less weight than this, of the one they had, count for nothing.
const NEGLIGIBLE: f32 = 1e-3;

/// Samples to the next look where rows change nothing.
const SLEEP: u32 = 1 << 30;

/// Steps of the filter.
const STEPS: u32 = 100;

/// The sums of a beginning; the rows normalised, the trends of the step in the user's units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StartError<const M: usize, const N: usize> {
    /// Q_1 .. Q_m.
    sums: [[f32; N]; M],
    /// What is not forgotten of them.
    share: f32,
    /// Variance of nu over that of the noise of y.
    pub(crate) variance: f32,
    step: FadingStep<M>,
    /// The trends that are not in the sums yet, with their weight.
    fresh: Option<[f32; M]>,
    /// Steps that are left, and the turn of the next one.
    steps: u32,
    due: u32,
    /// Whether rows change anything.
    pub(crate) lasts: bool,
}

impl<const M: usize, const N: usize> StartError<M, N> {
    /// Nothing seen, a row in `pace` samples; 0 where there is nothing to be seen.
    #[inline(never)]
    pub(crate) fn new(design: &Design<M>, pace: u32) -> Self {
        let counts = pace > 0;
        Self {
            sums: [[0.0; N]; M],
            share: 1.0,
            variance: 1.0,
            step: FadingStep::new(design, pace as f32 * design.sample_time),
            fresh: None,
            steps: if counts { STEPS } else { 0 },
            // A row in the middle of its step.
            due: if counts { pace / 2 } else { SLEEP },
            lasts: counts,
        }
    }

    /// The rows of before count no more.
    pub(crate) fn clear(&mut self) {
        self.sums = [[0.0; N]; M];
        self.share = 1.0;
    }

    /// The trends begin anew: no further row is summed. What is known counts for `1/scale` of
    /// before, and stays so where nothing `forgets`.
    pub(crate) fn end(&mut self, scale: f32, forgets: bool) {
        (self.steps, self.fresh) = (0, None);
        self.lasts &= forgets;
        self.share /= scale;
    }

    /// Whether this `turn` has a part for it.
    #[inline(always)]
    pub(crate) const fn is_due(&self, turn: u32) -> bool {
        // By the sign of the difference: turns go round.
        turn.wrapping_sub(self.due) < 1 << 31
    }

    /// Whether a row is to be taken, rather than a step.
    #[inline(always)]
    pub(crate) const fn wants_row(&self) -> bool {
        self.fresh.is_some()
    }

    /// Goes on with the filter by `pace` samples, each of which forgets as much.
    ///
    /// Cost: of [`FadingStep::advance`].
    #[inline(always)]
    pub(crate) fn advance(&mut self, design: &Design<M>, forgetting: f32, pace: u32) {
        if !self.lasts {
            self.due = self.due.wrapping_add(SLEEP);
            return;
        }
        let lost = pace as f32 * (1.0 - forgetting);
        self.share *= 1.0 - lost;
        if !(self.share > NEGLIGIBLE) {
            (self.share, self.lasts) = (0.0, false);
        } else if let (Some(filter), true) = (&design.filter, self.steps > 0) {
            self.due = self.due.wrapping_add(1);
            self.steps -= 1;
            // What is forgotten from here on is in the share, which is not 0.
            let weight = pace as f32 / self.share;
            self.fresh = Some(self.step.advance(filter).map(|trend| weight * trend));
        } else {
            self.due = self.due.wrapping_add(pace);
        }
    }

    /// Takes a row in the place of `pace` samples; where nothing `forgets` the last one ends it.
    ///
    /// Cost: 5 instructions per parameter and order.
    #[inline(always)]
    pub(crate) fn take(&mut self, phi: &[f32; N], pace: u32, forgets: bool) {
        self.due = self.due.wrapping_add(pace - 1);
        self.lasts = forgets || self.steps > 0;
        let Some(trends) = self.fresh.take() else {
            return;
        };
        for (sums, weight) in self.sums.iter_mut().zip(&trends) {
            for (sum, phi) in sums.iter_mut().zip(phi) {
                *sum += weight * phi;
            }
        }
    }

    /// q of a model with the denominator `a`, both in the user's units; zeros where there is
    /// nothing.
    pub(crate) fn score(&self, a: &[f32; M]) -> [f32; N] {
        let mut score = [0.0; N];
        // a_0 stands for nothing.
        let weights = a.iter().skip(1).chain(&[1.0]);
        for (sums, weight) in self.sums.iter().zip(weights) {
            for (score, sum) in score.iter_mut().zip(sums) {
                *score += self.share * weight * sum;
            }
        }
        score
    }
}
