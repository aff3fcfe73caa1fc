//! One structure: a candidate at its best filter and delay, or why it is none.

use super::alike::{Missing, Shorter, fit_x0c};
use super::candidate::Candidate;
use super::drop::{Drop, cancels, rests_on};
use crate::delay_choice::{DELAYS, Delays, LONGEST_DELAY, at_its_delay};
use crate::filter_choice::{self, Judged};
use crate::identification::{self, Behind, model_behind};
use crate::poor_input::PoorInput;
use crate::problem::{Options, Problem, Structure};
use crate::search::{Choice, Freedom};
use crate::signals::Signals;

/// Tries a structure, with what is known of the input where it is poor.
pub(super) fn candidate(
    signals: &Signals,
    structure: Structure,
    options: Options,
    (freedom, poor_input): (Freedom, Option<PoorInput>),
) -> Result<Candidate, Missing> {
    let problem = Problem::new(signals, structure, options).map_err(Drop::Failed)?;
    let poles = match freedom.pole {
        Choice::Given(Some(pole)) => vec![pole],
        _ => filter_choice::poles(problem.samples(), problem.signals.dt),
    };
    let at = |delay: usize| filter_choice::choose(&problem, &poles, delay as f64, &());
    let asked = Asked {
        freedom,
        poor_input,
        alike: None,
    };
    if let Choice::Given(delay) = freedom.delay {
        let candidate = passed(&problem, at(delay).map_err(|_| Drop::Unstable)?, asked)?;
        return Ok(Candidate {
            delay_at_end: false,
            ..candidate
        });
    }
    let near = at(0).or_else(|_| at(DELAYS / 2));
    let searched = Delays::of(&problem, &poles, near);
    let (first, found) = searched.map_err(|_| Drop::Unstable)?;
    let delays = [found.best, found.alike[0], found.usual];
    let asked = Asked {
        alike: Some(found.alike),
        ..asked
    };
    // A model at a whole delay beside that of the record makes up for the rest of a sample by a
    // zero or a pole, which then looks like one of the drive.
    let around = |delay: usize| {
        let near: Vec<f64> = poles
            .iter()
            .copied()
            .filter(|pole| (0.2..5.0).contains(&(pole / first.pole)))
            .collect();
        let judged = filter_choice::choose(&problem, &near, delay as f64, &());
        judged.map(|judged| at_its_delay(&problem, judged))
    };
    let Ok(best) = around(delays[0]) else {
        return Ok(passed(&problem, first, asked)?);
    };
    // A long delay takes the place of a lag, which then is not significant: that says nothing
    // against the structure at the delay of any loop. Whether it simulates as well is judged later.
    passed(&problem, best, asked).or_else(|reason| {
        let mut shorter = None;
        for pair in delays.windows(2).filter(|pair| pair[1] < pair[0]) {
            let Ok(judged) = around(pair[1]) else {
                continue;
            };
            let beside = Shorter::of(&problem, &judged);
            match passed(&problem, judged, asked) {
                Ok(found) => return Ok(found),
                Err(Drop::Insignificant { .. }) => shorter = Some(Box::new(beside)),
                Err(_) => {}
            }
        }
        Err(Missing { reason, shorter })
    })
}

/// What is asked of a fit.
#[derive(Clone, Copy)]
struct Asked {
    freedom: Freedom,
    poor_input: Option<PoorInput>,
    /// The shortest and the longest delay that simulate as well, where it is searched.
    alike: Option<[usize; 2]>,
}

/// A fit as a candidate, or why it is none.
fn passed(problem: &Problem, judged: Judged, asked: Asked) -> Result<Candidate, Drop> {
    let structure = problem.structure;
    let found = judged.fit.found().map_err(Drop::Failed)?;
    let model = judged.fit.model().ok_or(Drop::Unstable)?;
    if !model.is_stable(usize::from(structure.integrator)) {
        return Err(Drop::Unstable);
    }
    rests_on(problem, &found, &judged.folds)?;
    cancels(problem, &model, &judged.folds)?;
    // What it rests on is judged by blocks and folds; what delay and other filters make of it is
    // said of it, as of one structure.
    let behind = Behind {
        filter: judged.fit.filter(),
        pole: judged.pole,
        delay: judged.fit.delay(),
        method: judged.fit.method(),
    };
    let (model_delay, mut found) =
        model_behind(problem, behind, asked.alike, asked.poor_input).map_err(Drop::Failed)?;
    let elsewhere = match asked.freedom.pole {
        Choice::Auto => identification::elsewhere(
            problem,
            Behind {
                delay: model_delay,
                ..behind
            },
        ),
        Choice::Given(_) => None,
    };
    let filter_shifts = elsewhere.as_ref().map(|elsewhere| elsewhere.shifts);
    if let Some(elsewhere) = elsewhere {
        found.estimate = elsewhere.contained_in(problem, found.estimate);
    }
    let delay = judged.fit.delay().round() as usize;
    let delay_sigma = found.delay.as_ref().filter(|_| asked.alike.is_some());
    Ok(Candidate {
        structure,
        delay,
        compared_delay: judged.fit.delay(),
        model_delay,
        delay_sigma: delay_sigma.map(|delay| delay.sigma),
        delay_at_end: delay >= LONGEST_DELAY,
        pole: judged.pole,
        names: problem.parameter_names(),
        fit_x0c: fit_x0c(problem, &judged.folds),
        found,
        filter_shifts,
        folds: judged.folds,
    })
}
