//! The delay of a drive: one identifier per candidate, compared by their prediction errors.

use crate::error::ConfigError;
use crate::identifier::Identifier;
use crate::identifier::config::Config;
use crate::identifier::outcome::Outcome;
use crate::identifier::servo::Servo;
use crate::math::within;
use crate::trends::TrendOperator;

/// Identifiers of the same structure with the delays 0, 1, .. `K-1` of one input, side by side.
///
/// An unmodelled delay biases theta and enlarges the residual: the candidate with the smallest
/// normalised prediction error, `sqrt(sum e e_post / (n - N)) / beta` in the unit of y, has the
/// right delay. All candidates see the same noise, so small differences count.
///
/// | parameter | meaning |
/// |---|---|
/// | `C` | the [`Identifier`]; its delay lines `D` hold at least `K - 1` samples |
/// | `K` | number of candidates, with delays of 0 to `K-1` samples |
///
/// It is laid out as the array of its candidates: who has memory for one can make them in their
/// places.
///
/// Guarantees: as [`Identifier`]. Cost: `K` times the identifier in time and memory, for
/// commissioning; afterwards go on with [`DelayBank::chosen`] alone.
///
/// # Examples
/// ```
/// # let (mut y, mut v, mut a, mut line) = (0.0_f64, 0.0, 0.0, [0.0_f32; 3]);
/// # let mut drive = |u: f32| {
/// #     let (now, late) = (y as f32, f64::from(line[2]));
/// #     line = [u, line[0], line[1]];
/// #     for _ in 0..10 {
/// #         y += 1e-4 * v;
/// #         v += 1e-4 * a;
/// #         a += 1e-4 * (1e6 * late - 400.0 * v - 20.0 * a);
/// #     }
/// #     now
/// # };
/// use trendid::Servo;
/// use trendid::identifier::DelayBank;
/// let mut bank = DelayBank::<Servo<7>, 8>::new(0.001, 20.0, 1.0, 50.0)?; // as Servo::new, for delays of 0 to 7
/// for k in 0..1000 {
///     let u = if k % 300 < 150 { 0.4 } else { -0.4 };
///     let _ = bank.update(u, drive(u));
/// }
/// assert_eq!(bank.best(), Some(3));
/// let servo = bank.chosen().unwrap();
/// assert!((servo.estimate().physical().omega0.unwrap() - 20.0).abs() < 0.2);
/// # Ok::<(), trendid::ConfigError>(())
/// ```
/// Delay lines that are too short for the longest candidate do not compile, and neither does an
/// empty bank:
/// ```compile_fail,E0080
/// use trendid::{Servo, identifier::DelayBank};
/// let bank = DelayBank::<Servo<6>, 8>::new(0.001, 20.0, 1.0, 50.0);
/// ```
/// ```compile_fail,E0080
/// use trendid::{Servo, identifier::DelayBank};
/// let bank = DelayBank::<Servo<7>, 0>::new(0.001, 20.0, 1.0, 50.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
#[repr(transparent)]
pub struct DelayBank<C, const K: usize> {
    candidates: [C; K],
}

/// Fails the build where there is no candidate, or the delay lines do not hold the longest one.
const fn assert_bank(line: usize, candidates: usize) {
    assert!(candidates > 0, "a bank has at least one candidate");
    assert!(
        candidates <= line + 1,
        "the delay lines are shorter than the longest candidate"
    );
}

impl<const D: usize, const K: usize> DelayBank<Servo<D>, K> {
    /// A bank of [`Servo`]s, with the arguments of [`Servo::new`].
    ///
    /// # Errors
    /// As [`Servo::new`].
    pub fn new(
        sample_time: f32,
        bandwidth: f32,
        input_range: f32,
        output_range: f32,
    ) -> Result<Self, ConfigError> {
        const { assert_bank(D, K) };
        Self::from_candidates(|delay| {
            Servo::with_delay(sample_time, bandwidth, input_range, output_range, delay)
        })
    }

    /// As [`DelayBank::update_inputs`] for the one input.
    pub fn update(&mut self, u: f32, y: f32) -> Outcome {
        self.update_inputs([u], y)
    }
}

impl<C: Clone, const K: usize> DelayBank<C, K> {
    fn from_candidates(
        candidate: impl Fn(usize) -> Result<C, ConfigError>,
    ) -> Result<Self, ConfigError> {
        let first = candidate(0)?;
        let mut candidates = core::array::from_fn(|_| first.clone());
        for (delay, slot) in candidates.iter_mut().enumerate() {
            *slot = candidate(delay)?;
        }
        Ok(Self { candidates })
    }
}

impl<
    T: TrendOperator<M>,
    const M: usize,
    const N: usize,
    const I: usize,
    const D: usize,
    const K: usize,
> DelayBank<Identifier<T, M, N, I, D>, K>
{
    /// Candidates for the delay of `input`, in whole samples whatever `config` says of it; the
    /// other inputs keep the delays of `config`.
    ///
    /// # Errors
    /// As [`Identifier::try_new`]; [`ConfigError::NoInput`] where there is no such input.
    pub fn try_new(config: &Config<M, N, I>, trends: T, input: usize) -> Result<Self, ConfigError> {
        const { assert_bank(D, K) };
        Self::from_candidates(|delay| {
            if input >= I {
                return Err(ConfigError::NoInput);
            }
            let mut config = config.clone();
            config.set_delay(input, delay as f32);
            Identifier::try_new(&config, trends.clone())
        })
    }

    /// Takes all inputs u(k) and the output y(k); gives the outcome of the candidate without delay.
    ///
    /// A refused sample is refused by all.
    pub fn update_inputs(&mut self, u: [f32; I], y: f32) -> Outcome {
        let mut first = None;
        for candidate in &mut self.candidates {
            let outcome = candidate.update_inputs(u, y);
            first = first.or(Some(outcome));
        }
        // K > 0, so there is a first.
        first.unwrap_or(Outcome::WarmingUp { remaining: 0 })
    }

    /// Prediction error of each candidate in the unit of y; `None` until there are more samples
    /// than parameters.
    pub fn errors(&self) -> [Option<f32>; K] {
        core::array::from_fn(|delay| self.candidates[delay].noise_std())
    }

    /// The delay with the smallest prediction error, in samples; `None` until all can be compared.
    pub fn best(&self) -> Option<usize> {
        let mut best = None;
        let mut least = f32::INFINITY;
        for (delay, error) in self.errors().into_iter().enumerate() {
            let error = error?;
            if error < least {
                least = error;
                best = Some(delay);
            }
        }
        best
    }

    /// The delay between the samples, by a parabola through the squared errors of the best
    /// candidate and its neighbours.
    ///
    /// Half a sample at most from [`DelayBank::best`], which it is for the first and the last
    /// candidate. An identifier for it is made by [`Config::set_delay`].
    pub fn refined(&self) -> Option<f32> {
        let best = self.best()?;
        let errors = self.errors();
        let square = |delay: Option<usize>| -> Option<f32> {
            let error = (*errors.get(delay?)?)?;
            Some(error * error)
        };
        let (Some(before), Some(at), Some(after)) = (
            square(best.checked_sub(1)),
            square(Some(best)),
            square(best.checked_add(1)),
        ) else {
            return Some(best as f32);
        };
        let curvature = before - 2.0 * at + after;
        let step = match curvature > 0.0 {
            true => 0.5 * (before - after) / curvature,
            false => 0.0,
        };
        Some(best as f32 + within(step, 0.5))
    }

    /// Prediction error of the second best candidate over that of the best: at least 1, larger for
    /// a clearer choice. `None` until every candidate has an error, with one candidate, and where
    /// the best has no error at all, as at rest without noise.
    pub fn margin(&self) -> Option<f32> {
        let best = self.best()?;
        let errors = self.errors();
        let mut next = f32::INFINITY;
        for (delay, error) in errors.into_iter().enumerate() {
            if delay != best {
                next = next.min(error?);
            }
        }
        let margin = next / (*errors.get(best)?)?;
        margin.is_finite().then_some(margin)
    }

    /// The identifier with the best delay, to go on with a clone of it.
    pub fn chosen(&self) -> Option<&Identifier<T, M, N, I, D>> {
        self.candidates.get(self.best()?)
    }

    /// The candidate with this delay.
    pub fn candidate(&self, delay: usize) -> Option<&Identifier<T, M, N, I, D>> {
        self.candidates.get(delay)
    }
}

#[cfg(test)]
mod tests;
