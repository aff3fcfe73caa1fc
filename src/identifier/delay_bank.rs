//! Which delay the drive has: one identifier per candidate, compared by their prediction errors.

use crate::error::ConfigError;
use crate::identifier::Identifier;
use crate::identifier::config::Config;
use crate::identifier::outcome::Outcome;
use crate::trends::TrendOperator;

/// Identifiers of the same structure with the delays 0, 1, .. `K-1` of one input, side by side.
///
/// An unmodelled delay does not show in theta, which bends to it, but in what is left: the candidate with the smallest
/// normalised prediction error, `sqrt(sum e e_post / (n - N)) / beta` in the unit of y, has the right delay. The same
/// noise enters all candidates, so that small differences count.
///
/// | symbol | parameter | meaning |
/// |---|---|---|
/// | d | `K` | candidates 0..K-1, in samples |
/// | - | `D` | length of the delay lines, at least `K - 1` |
///
/// Guarantees: as [`Identifier`]. Cost: `K` times the identifier in time and memory, for commissioning; afterwards
/// go on with [`DelayBank::chosen`] alone.
///
/// # Examples
/// ```
/// use trendid::{Config, DelayBank, FilteredTrends, Scheme, Structure};
/// let trends = FilteredTrends::try_new(Scheme::Tustin, 0.001, [25.0; 1])?;
/// let config = Config::new(Structure::<1, 2, 1>::FULL, 25.0, [1.0], 1.0);
/// let mut bank = DelayBank::<_, 1, 2, 1, 3, 4>::try_new(&config, trends, 0)?;
/// // y' = -10 y + 50 u, with u two samples late.
/// let (mut y, mut line) = (0.0_f32, [0.0_f32; 2]);
/// for k in 0..500 {
///     let u = if (k / 70) % 2 == 0 { 1.0 } else { -1.0 };
///     let _ = bank.update_inputs([u], y);
///     let acting = line[1];
///     line = [u, line[0]];
///     let decay = (-0.01_f32).exp();
///     y = 5.0 * acting + (y - 5.0 * acting) * decay;
/// }
/// assert_eq!(bank.best(), Some(2));
/// # Ok::<(), trendid::ConfigError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DelayBank<
    T: TrendOperator<M>,
    const M: usize,
    const N: usize,
    const I: usize,
    const D: usize,
    const K: usize,
> {
    candidates: [Identifier<T, M, N, I, D>; K],
}

impl<
    T: TrendOperator<M>,
    const M: usize,
    const N: usize,
    const I: usize,
    const D: usize,
    const K: usize,
> DelayBank<T, M, N, I, D, K>
{
    /// Candidates for the delay of `input`; the other inputs keep the delays of `config`.
    ///
    /// # Errors
    /// As [`Identifier::try_new`]; [`ConfigError::OutOfRange`] where the delay line is shorter than the longest candidate;
    /// [`ConfigError::NoInput`] where there is no such input.
    pub fn try_new(config: &Config<M, N, I>, trends: T, input: usize) -> Result<Self, ConfigError> {
        const { assert!(K > 0, "a bank has at least one candidate") };
        let with = |delay: usize| {
            let mut config = *config;
            match config.delays.get_mut(input) {
                Some(slot) => *slot = delay,
                None => return Err(ConfigError::NoInput),
            }
            Identifier::try_new(&config, trends)
        };
        let mut candidates = [with(0)?; K];
        for (delay, candidate) in candidates.iter_mut().enumerate() {
            *candidate = with(delay)?;
        }
        Ok(Self { candidates })
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
        // K > 0: there always is a first.
        first.unwrap_or(Outcome::WarmingUp { remaining: 0 })
    }

    /// Prediction error of each candidate in the unit of y; `None` until there are more samples than parameters.
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

    /// Prediction error of the next best candidate over that of the best, at least 1: how clear the choice is.
    pub fn margin(&self) -> Option<f32> {
        let best = self.best()?;
        let errors = self.errors();
        let mut next = f32::INFINITY;
        for (delay, error) in errors.into_iter().enumerate() {
            if delay != best {
                next = next.min(error?);
            }
        }
        Some(next / errors[best]?)
    }

    /// The identifier with the best delay, to go on with.
    pub fn chosen(&self) -> Option<Identifier<T, M, N, I, D>> {
        self.candidates.get(self.best()?).copied()
    }

    /// The candidate with this delay.
    pub fn candidate(&self, delay: usize) -> Option<&Identifier<T, M, N, I, D>> {
        self.candidates.get(delay)
    }
}
