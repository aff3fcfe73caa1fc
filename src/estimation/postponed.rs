//! Forgetting waits for information: what a row does not bring is not taken either.
//!
//! Forgetting takes the share eps = 1 - lambda of all information before a row, in every direction.
//! A row brings phi' P phi, in one direction. Where one direction alone is shown the two balance at
//! phi' P phi = eps; below, P grows with every row: a small step of the reference, seconds behind
//! the one before, costs more than it brings. So
//!
//! ```text
//! phi' P phi > 1.5 eps    forgetting before the next row
//! otherwise               before every eighth row only
//! no row                  none: the drive does not move, a sample is missing
//! ```
//!
//! The limit lies above the balance, so that a motion that shows one direction is not taken for
//! more. Below it the memory is eight times as long, and N directions balance at N eps/8 in the
//! mean: such a motion remains what it is. Row k decides on row k+1, so that phi' P phi is that of
//! its own step and costs nothing.
//!
//! # The bound
//! The observations of nominal values go on with every row, as
//! [`forgetting`](crate::estimation::forgetting) has them. Its proof needs no more of a row than
//! that forgetting multiplies P by at most 1/lambda; here it is that or 1. With k counting rows it
//! holds word by word: samples without a row change nothing. Nominal values that follow stand still
//! behind rows that bring little, and are observed down to an eighth of the P_ii: over the longer
//! memory the rows, whose regressors are noise in directions that are not shown, weigh against them
//! as before. What no data support keeps between an eighth and all of its prior variance.
//!
//! # The debt
//! What was postponed is owed: n counts the samples whose forgetting did not happen. Rows that
//! bring enough pay it back one by one: after n of them what was learnt before has lost the share
//! lambda^n in the usual way, and counts no more than if nothing had been postponed. But a drive
//! may have changed meanwhile, and what was not forgotten on time stands against what is new. A row
//! that contradicts calls the debt in:
//!
//! ```text
//! called  <=>  e^2 / (1 + phi' P phi) > 36 sigma^2    and    lambda^n < 1/2
//!              sigma^2: mean of the rows before it, and what is allowed for
//!
//! P^-1 <- P^-1 + sum over i of lambda^-n / (N r_i eps) e_i e_i'        each parameter observed at its own value: theta stays
//! P    <- lambda^-n P,   n <- 0
//! ```
//!
//! The result is `(lambda^n P^-1 + diag(1 / (N r_i eps)))^-1`: what forgetting on time would have
//! left beside what the nominal values leave without data, right after a turn. So
//! `P_ii <= N r_i eps`, and the bound goes on to hold in every sample. n stops at 20/eps:
//! 1/lambda^n = 5e8 leaves nothing of what rows have brought. Before the noise is known (no more
//! rows than parameters) nothing contradicts.
//!
//! No sample has to do it all: each of the next N observes one parameter, and the last of them
//! multiplies. They take no row, as those of the onset of a motion are noise above all, and nothing
//! else touches P. An observation makes P smaller or leaves it, so that until the product every
//! P_ii is at most what it was, below the bound, with D > 0; behind it P is what is written above,
//! as if done at once. Who reads in between finds that already.
//!
//! Where a filter is exchanged what is owed is called in. Then, and where the drive was found to be
//! another one, every sample forgets for five memories: old rows are not to be held.
//!
//! # What does not hold
//! A change that happens at rest and stays below six standard deviations in every row is not found
//! at once: the old drive counts what it counted before the rest, and loses the share eps with
//! every row that brings enough, eps/8 with others. The bias falls with the memory, in samples of
//! motion, and no single row shows it. The variance reported is that of the drive before the rest.

use crate::estimation::rls::Estimator;
use crate::math::power;

/// Share of what forgetting takes that a row has to bring.
const ENOUGH: f32 = 1.5;

/// Rows without forgetting between two with it, where they bring little.
pub(crate) const PAUSE: u32 = 7;

/// Standard deviations of the innovation that contradict, squared.
const CONTRADICTS: f32 = 36.0;

/// Debts below this are not called in, and none grows above: in memories, -ln(lambda^n).
const DEBTS: [f32; 2] = [0.7, 20.0];

/// When to forget, and what is owed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Postponed {
    /// Rows before the next one that is forgotten for.
    wait: u32,
    /// n.
    owed: u32,
    /// Samples that are forgotten for whatever they bring.
    suspect: u32,
    /// 1.5 eps.
    enough: f32,
    /// The debts in samples.
    debts: [u32; 2],
    /// 1/lambda.
    growth: f32,
}

impl Postponed {
    /// Nothing owed; `forgetting` is lambda in (0, 1).
    pub(crate) const fn new(forgetting: f32) -> Self {
        let share = 1.0 - forgetting;
        Self {
            wait: 0,
            owed: 0,
            suspect: 0,
            enough: ENOUGH * share,
            // A conversion that saturates: without forgetting nothing is ever called in.
            debts: [(DEBTS[0] / share) as u32, (DEBTS[1] / share) as u32],
            growth: 1.0 / forgetting,
        }
    }

    /// Whether the next row is one that is forgotten for.
    #[inline(always)]
    pub(crate) const fn forgets(&self) -> bool {
        self.wait == 0
    }

    /// A sample without a row; whether it is one that forgets all the same.
    #[inline(always)]
    pub(crate) const fn pass(&mut self) -> bool {
        if self.suspect > 0 {
            self.suspect -= 1;
            return true;
        }
        self.postpone();
        false
    }

    /// One more sample is owed.
    #[inline(always)]
    pub(crate) const fn postpone(&mut self) {
        if self.owed < self.debts[1] {
            self.owed += 1;
        }
    }

    /// Whether a row is the usual one: its `spread` phi' P phi is enough, it was forgotten for, and
    /// nothing is owed.
    #[inline(always)]
    pub(crate) const fn is_usual(&self, spread: f32) -> bool {
        spread > self.enough && self.wait | self.owed == 0
    }

    /// Takes a row that is not the usual one; whether it brings enough.
    #[inline(always)]
    pub(crate) const fn take<const N: usize>(
        &mut self,
        spread: f32,
        estimator: &mut Estimator<N>,
    ) -> bool {
        let mut brings = spread > self.enough;
        if !brings && self.suspect > 0 {
            self.suspect -= 1;
            brings = true;
        }
        if self.wait > 0 {
            self.postpone();
            self.wait = if brings { 0 } else { self.wait - 1 };
        } else if !brings {
            self.wait = PAUSE;
        } else if self.owed > 0 {
            self.owed -= 1;
        }
        estimator.forget(self.wait == 0);
        brings
    }

    /// What was learnt up to now is of another filter, or another drive: for some memories nothing
    /// is postponed.
    pub(crate) const fn suspect(&mut self) {
        self.suspect = self.debts[1] / 4;
    }

    /// Whether enough is owed to be called in.
    #[inline(always)]
    pub(crate) const fn is_owed(&self) -> bool {
        self.owed > self.debts[0]
    }

    /// Whether the row that was just folded in contradicts; `least` is a variance of the innovation
    /// that is always allowed for.
    pub(crate) fn contradicted<const N: usize>(
        estimator: &Estimator<N>,
        innovation: f32,
        spread: f32,
        least: f32,
    ) -> bool {
        let [square, before] = estimator.surprise(innovation, spread);
        before >= 0.0 && square > CONTRADICTS * before && square > CONTRADICTS * least
    }

    /// Begins to call the debt in; `left` is what forgetting for ever leaves of each P_jj. The
    /// estimator has to be inflated N times before it takes the next row.
    pub(crate) fn call<const N: usize>(&mut self, estimator: &mut Estimator<N>, left: [f32; N]) {
        estimator.begin_inflation(power(self.growth, self.owed), left);
        estimator.forget(true);
        (self.owed, self.wait) = (0, 0);
    }
}

#[cfg(test)]
mod tests;
