//! Forgetting that stays bounded: without excitation the covariance stops, and the estimate with
//! it.
//!
//! Known as: stabilised forgetting (Kulhavy & Zarrop 1993), here one parameter per sample;
//! covariance limiting and leakage (Astrom & Wittenmark 1995, ch. 11) are its cruder relatives.
//!
//! Exponential forgetting alone multiplies P by 1/lambda in every direction that the data do not
//! show, without end: an hour at constant speed overflows f32. So every second sample brings one
//! observation that was not made: parameter i has its nominal value c_i, with the variance r/2 in
//! units of the noise of psi, one parameter after the other:
//!
//! ```text
//! k odd, i = (k-1)/2 mod N
//! P_ii > s :      U, D, theta <- one step of least squares with the row e_i, the value c_i, the variance r/2; no forgetting
//! c_i <- theta_i  while P_ii < 0.1 N r eps, unless the nominal values were set           eps = 1 - lambda
//! ```
//!
//! A nominal value that no data supported yet is the mean of a prior, and counts for no more: until
//! the data have once shown parameter i (P_ii < 0.1 N r eps), its r is that which leaves the prior
//! variance s_i^2 where there are no data, r_i = max(r, s_i^2 / (N eps)). With a smaller one the
//! first samples of a motion that shows only some of the parameters would find the others well
//! known, at the prior mean.
//!
//! # What holds
//! For any finite rows, in any order, with lambda = 1 - eps or, before any of them, 1 (see
//! `postponed`), and r_i for r until the data have shown parameter i:
//!
//! ```text
//! D_j > 0,    P_ii <= N r eps lambda^-2N / (1 - lambda^t)       t samples in whole rounds of 2N after a start, for ever
//! ```
//!
//! Proof. Let q = 1/P_ii just after turn i. A row and an observation of another parameter only add
//! information, so they do not increase P_ii; forgetting multiplies it by at most 1/lambda. One
//! round of 2N samples later, before the turn, 1/P_ii >= lambda^2N q. The observation adds 2/r:
//! q' >= lambda^2N q + 2/r, from any q >= 0; hence after n rounds q >= (1 - lambda^(2nN)) 2 /
//! (r (1 - lambda^2N)) >= (1 - lambda^(2nN)) / (N r eps). Where the turn is skipped P_ii <= s is
//! already smaller. Between two turns P_ii grows by at most lambda^-2N. D_j is multiplied by
//! alpha_(j-1)/alpha_j, a quotient of positive numbers. P is positive semidefinite, so every other
//! entry is bounded by the diagonal.
//!
//! For theta, with nominal values c that were set and e_k = psi_k - phi_k' c, theta - c = P sum
//! lambda^(k) phi e. As the minimum is no larger than the cost at c, (theta - c)' P^-1 (theta - c)
//! <= max e^2 / eps, and so, after the start,
//!
//! ```text
//! |theta_i - c_i| <= sqrt(N r lambda^-2N) max |e_k|
//! ```
//!
//! Nominal values that follow are former estimates, each taken while its standard deviation was
//! below a third of the one that the observations alone leave: without data they stand still, and
//! theta with them. They do too while f32 resolves the position worse than its noise and than at
//! the start: what such rows teach is forgotten, not kept for ever.
//!
//! # In two parts
//! An observation passes through the columns of U and D one by one, from i to N-1. All but the last
//! follow the row of sample k; the last, and the step of theta with it, goes before the row of
//! sample k+1, so that no sample has to do it all. Nothing comes between the two: whatever changes
//! P or theta finishes the observation first, so that the proof above, which looks at whole ones,
//! is not touched. Who reads in between finds P behind an observation of another row z with the
//! same variance,
//!
//! ```text
//! f = U' e_i,   U' z = (0.., f_i, .., f_(N-2), 0),   sigma = z' P z = z' P e_i <= P_ii
//! P_ii <- P_ii - sigma^2 / (r/2 + sigma)
//! ```
//!
//! for a column whose f_j is 0 changes nothing. So D > 0, no P_jj is larger than before, P_ii lies
//! between what it was and what it will be, and theta is still the one before.
//!
//! The initial state of a structure that has one begins again with the trends, behind a standstill
//! or a change: P_ii of that parameter is then the one of the prior, and t counts from there.
//!
//! # What does not hold
//! Bounded is not right: rows that contradict the model move theta as far as the bound allows, and
//! P knows nothing of it. After a change of the drive, directions without excitation keep the old
//! values. In f32 the proof holds up to rounding: the property tests attack it with rows of 1e-6 to
//! 1e6 and memories of 10^2 to 10^5 samples.

mod variances;

use crate::estimation::rls::Estimator;

/// r/2: variance of each observation of a nominal value, relative to the noise of psi.
///
/// A power of two, so that U and D of the parameters before the one observed keep their bits. The
/// information that forgetting cannot take away is that of memory/(N r) samples of full excitation:
/// 1 in 10^5 of what the memory holds.
const VARIANCE: f32 = 16_384.0;

/// s: below this P_ii the observation would change nothing that f32 shows.
const CERTAIN: f32 = 2e-6 * VARIANCE;

/// A nominal value follows while P_ii is below this share of what the observations alone leave.
const FOLLOWS: f32 = 0.1;

/// Observes one parameter every other sample at its nominal value: forgetting stays bounded.
///
/// | symbol | argument | shape |
/// |---|---|---|
/// | c | `nominal`, normalised | N |
/// | lambda | `forgetting`, as that of the estimator | (0, 1) |
///
/// # Examples
/// ```
/// use trendid::estimation::{Estimator, StabilisedForgetting};
/// let mut estimator = Estimator::<2>::new([0.0; 2], [100.0; 2], 0.99);
/// let mut forgetting = StabilisedForgetting::new([0.0; 2], 0.99);
/// for k in 0..10_000 {
///     // The second parameter is seen in the first thousand samples only.
///     let phi = [1.0, if k < 1000 { (k % 7) as f32 - 3.0 } else { 0.0 }];
///     let _ = estimator.update(&phi, 2.0 * phi[0] - phi[1]);
///     forgetting.apply(&mut estimator);
/// }
/// assert!((estimator.theta()[1] + 1.0).abs() < 1e-3);
/// assert!(estimator.covariance(1, 1) < forgetting.bound());
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct StabilisedForgetting<const N: usize> {
    nominal: [f32; N],
    /// Variance of nominal values that no data support, relative to the noise of psi as in the
    /// prior.
    unsupported: [f32; N],
    /// Variance of nominal values that were set, in the same unit; 0 for those that follow.
    own: [f32; N],
    /// How many nominal values were set, the first ones; the others follow the estimate where it is
    /// well known.
    set: usize,
    /// Samples within the round of 2N.
    turn: usize,
    /// Rounds, modulo 2^32: a row of U and of what the caller has is flushed by turns.
    rounds: u32,
    /// N r eps: P_ii right after turn i, without data.
    left: f32,
    /// The same before the turn.
    bound: f32,
    /// P_ii below which data have shown a parameter; 0 where none of the present can.
    follows: f32,
    /// 1/(2 N eps); 0 where nothing is forgotten.
    inverse_share: f32,
}

impl<const N: usize> StabilisedForgetting<N> {
    /// Nominal values that follow the estimate, from `nominal` on.
    pub const fn new(nominal: [f32; N], forgetting: f32) -> Self {
        let share = 2.0 * N as f32 * (1.0 - forgetting);
        let mut growth = 1.0;
        let mut k = 0;
        while k < 2 * N {
            growth /= forgetting;
            k += 1;
        }
        let bound = VARIANCE * share * growth;
        Self {
            nominal,
            unsupported: [0.0; N],
            own: [0.0; N],
            set: 0,
            turn: 0,
            rounds: 0,
            left: VARIANCE * share,
            bound,
            follows: FOLLOWS * bound,
            inverse_share: if share > 0.0 { 1.0 / share } else { 0.0 },
        }
    }

    /// After every sample: each second time the first part of one observation; [`Estimator`]
    /// finishes it before its next row.
    ///
    /// Cost: see the table of instruction counts.
    #[inline(always)]
    pub fn apply(&mut self, estimator: &mut Estimator<N>) {
        let _ = self.turn(estimator, true);
    }

    /// As [`apply`](Self::apply), nominal values following only behind a row that `brings` enough;
    /// gives `k` once in each second round, in a sample with little else to do: k counts them.
    #[inline(always)]
    pub(crate) fn turn(&mut self, estimator: &mut Estimator<N>, brings: bool) -> Option<u32> {
        let (turn, observes) = (self.turn / 2, !self.turn.is_multiple_of(2));
        self.advance();
        if !observes {
            return None;
        }
        self.observe(estimator, turn, brings);
        if turn + 1 < N {
            return None;
        }
        self.rounds = self.rounds.wrapping_add(1);
        let half = self.rounds / 2;
        if self.rounds.is_multiple_of(2) {
            return Some(half);
        }
        estimator.flush(half as usize % N);
        None
    }

    /// The first part of the observation of parameter `turn`, where that is not known so well that
    /// it changes nothing.
    #[inline(always)]
    fn observe(&mut self, estimator: &mut Estimator<N>, turn: usize, brings: bool) {
        let (Some(nominal), Some(unsupported)) =
            (self.nominal.get_mut(turn), self.unsupported.get_mut(turn))
        else {
            return;
        };
        let own = *unsupported * self.inverse_share;
        // Not max(), which is a call of a library on the target.
        let assumed = || if own > VARIANCE { own } else { VARIANCE };
        let variance = estimator.begin_observation(turn, *nominal, assumed, CERTAIN);
        if brings && variance < self.follows {
            if turn >= self.set {
                *nominal = estimator.theta().get(turn).copied().unwrap_or(*nominal);
            }
            *unsupported = 0.0;
        }
    }

    /// Whether the next turn is one between two observations.
    #[inline(always)]
    pub(crate) const fn rests(&self) -> bool {
        self.turn.is_multiple_of(2)
    }

    #[inline(always)]
    fn advance(&mut self) {
        let next = self.turn + 1;
        self.turn = if next < 2 * N { next } else { 0 };
    }

    /// Sets the nominal values, to which the estimate returns where nothing is excited.
    pub const fn set_nominal(&mut self, nominal: [f32; N]) {
        self.nominal = nominal;
        self.set = N;
    }

    /// Lets the last nominal value follow the estimate whatever was set: that of an initial state,
    /// of which each beginning has another one.
    pub(crate) const fn let_last_follow(&mut self) {
        if let Some(own) = self.own.last_mut() {
            *own = 0.0;
        }
        if self.set == N {
            self.set = N.saturating_sub(1);
        }
    }

    /// Lets the nominal values follow the estimate again, from `nominal` on.
    pub const fn follow(&mut self, nominal: [f32; N]) {
        self.nominal = nominal;
        self.own = [0.0; N];
        self.set = 0;
    }

    /// Whether the present rows may move nominal values that follow.
    pub(crate) const fn heed(&mut self, rows: bool) {
        self.follows = if rows { FOLLOWS * self.bound } else { 0.0 };
    }

    /// The nominal values, normalised.
    pub(crate) const fn nominal(&self) -> &[f32; N] {
        &self.nominal
    }

    /// Puts `nominal` in place of the nominal values, which go on as they were, set or following.
    pub(crate) const fn replace_nominal(&mut self, nominal: [f32; N]) {
        self.nominal = nominal;
    }

    /// Upper limit of every P_ii once the start is forgotten, relative to the noise of psi.
    pub const fn bound(&self) -> f32 {
        self.bound
    }
}

#[cfg(test)]
mod tests;
