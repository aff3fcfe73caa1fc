//! The choice of a structure: orders, integrator, zeros and delays compared on parts of the record
//! left out.
//!
//! Every structure is estimated by instruments at its own filter and its own delay; each fold is
//! simulated by the model without it, initial state and constant refitted. What is unstable, has a
//! parameter that is not significant where the structure rests on it, or a zero that is not told
//! from a pole, is dropped and says why. Among those that simulate about as well as the best, the
//! one with the fewest parameters is recommended.

mod alike;
mod candidate;
mod drop;
mod tried;

pub use alike::Shorter;
use alike::{Missing, simulates_alike};
pub use candidate::Candidate;
pub use drop::Drop;
use tried::candidate;

use crate::delay_choice::DELAYS;
use crate::error::Error;
use crate::folds::Refitted;
use crate::poor_input::PoorInput;
use crate::problem::{Options, Problem, Structure};
use crate::search::{Choice, Freedom, Progress};
use crate::side_by_side::side_by_side;
use crate::signals::Signals;

/// Errors of simulation up to this share of the movement say nothing about the structure where
/// friction is an input: it enters as a sign, which turns at once, and that of a drive takes some
/// way. A zero that lets the command lead the sign is found in any record that is clean enough.
const OF_FRICTION: f64 = 2e-3;

/// A structure that is no candidate.
#[derive(Debug, Clone)]
pub struct Dropped {
    /// The structure.
    pub structure: Structure,
    /// Why.
    pub reason: Drop,
    /// The same at the delay of any loop, where the reason is a parameter there, too.
    pub shorter: Option<Box<Shorter>>,
}

/// All structures and the recommended one.
#[derive(Debug, Clone)]
pub struct Selection {
    /// In the order of orders, integrators and zeros.
    pub candidates: Vec<Candidate>,
    /// Dropped structures, in the same order.
    pub dropped: Vec<Dropped>,
    /// Index of the recommended candidate.
    pub recommended: usize,
    /// Index of the smallest error.
    pub smallest: usize,
    /// Indices of all candidates that simulate about as well as the best.
    pub alike: Vec<usize>,
    /// What the input is where it says too little for a structure.
    pub poor_input: Option<PoorInput>,
}

impl Selection {
    /// The structure with a lag in the place of the recommended one's delay: one order more, at the
    /// delay of any loop, which simulates about as well but for a parameter that is not
    /// significant.
    pub fn lag(&self) -> Option<(&Dropped, &Shorter)> {
        let recommended = &self.candidates[self.recommended];
        let structure = recommended.structure;
        let one_more = |dropped: &&Dropped| {
            dropped.structure.order == structure.order + 1
                && dropped.structure.integrator == structure.integrator
        };
        let mut dropped = self.dropped.iter().filter(one_more);
        dropped.find_map(|dropped| {
            let shorter = dropped.shorter.as_deref()?;
            let alike = simulates_alike(&shorter.folds, &recommended.folds);
            (recommended.delay >= DELAYS && alike).then_some((dropped, shorter))
        })
    }
}

/// The structures that are compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Highest order, 1 to 4, the integrator included.
    pub max_order: usize,
    /// Only structures with an integrator.
    pub integrating: bool,
    /// Whether all have a constant input.
    pub constant: bool,
}

impl Range {
    fn structures(self) -> Vec<Structure> {
        let mut all = Vec::new();
        for order in 1..=self.max_order {
            for integrator in [true, false] {
                if integrator || !self.integrating {
                    all.extend((0..order).map(|zeros| Structure {
                        order,
                        integrator,
                        zeros,
                        constant: self.constant,
                    }));
                }
            }
        }
        all
    }
}

/// Compares the structures on the record.
///
/// # Errors
/// What is wrong with the signals; [`Error::OneSineForAll`]; [`Error::NoStructure`] when no
/// structure passes.
pub fn select(
    signals: &Signals,
    range: Range,
    options: Options,
    freedom: Freedom,
    progress: &dyn Progress,
) -> Result<Selection, Error> {
    let structures = range.structures();
    let Some(&simplest) = structures.first() else {
        return Err(Error::Order(range.max_order));
    };
    // What is wrong with the simplest structure is wrong with the record.
    Problem::new(signals, simplest, options)?;
    freedom.check(signals.dt)?;
    let poor_input = PoorInput::of(signals);
    let one_sine = poor_input == Some(PoorInput::Sine) && signals.inputs.len() == 1;
    if one_sine && freedom.delay == Choice::Auto {
        return Err(Error::OneSineForAll);
    }
    progress.begin(structures.len());
    let tried: Vec<Result<Candidate, Dropped>> = side_by_side(&structures, |&structure| {
        let tried = candidate(signals, structure, options, (freedom, poor_input));
        progress.step();
        tried.map_err(|Missing { reason, shorter }| Dropped {
            structure,
            reason,
            shorter,
        })
    });
    let (mut candidates, mut dropped) = (Vec::new(), Vec::new());
    for one in tried {
        match one {
            Ok(candidate) => candidates.push(candidate),
            Err(one) => dropped.push(one),
        }
    }
    let friction = signals.inputs.iter().any(|input| !input.delayed);
    let (smallest, alike) = alike(&candidates, friction).ok_or_else(|| Error::NoStructure {
        max_order: range.max_order,
        why: commonest(&dropped),
    })?;
    let error = |k: &usize| candidates[*k].folds.total(Refitted::StateAndConstant);
    // Every loop has a delay of some samples; one longer than those tried first is a parameter, and
    // of two structures with as many parameters the one without it describes a lag as a lag.
    let count = |k: &usize| (candidates[*k].parameters(), candidates[*k].long_delay());
    let simplest = alike.iter().copied().min_by(|i, j| {
        let counts = count(i).cmp(&count(j));
        counts.then(error(i).total_cmp(&error(j)))
    });
    Ok(Selection {
        recommended: simplest.unwrap_or(smallest),
        candidates,
        dropped,
        smallest,
        alike,
        poor_input,
    })
}

/// What most of the structures were dropped for, and how many of how many.
fn commonest(dropped: &[Dropped]) -> String {
    let kind = |d: &Dropped| std::mem::discriminant(&d.reason);
    let count = |d: &Dropped| dropped.iter().filter(|e| kind(e) == kind(d)).count();
    let most = dropped.iter().rev().max_by_key(|d| count(d));
    most.map_or(String::new(), |d| {
        format!("{} of {}: {}", count(d), dropped.len(), d.reason)
    })
}

/// The candidate with the smallest error and those that simulate about as well.
fn alike(candidates: &[Candidate], friction: bool) -> Option<(usize, Vec<usize>)> {
    let error = |k: &usize| candidates[*k].folds.total(Refitted::StateAndConstant);
    let smallest = (0..candidates.len()).min_by(|i, j| error(i).total_cmp(&error(j)))?;
    let best = &candidates[smallest].folds;
    let alike = |k: &usize| {
        (friction && candidates[*k].fit_x0c >= 100.0 * (1.0 - OF_FRICTION))
            || simulates_alike(&candidates[*k].folds, best)
    };
    Some((smallest, (0..candidates.len()).filter(alike).collect()))
}

#[cfg(test)]
mod tests;
