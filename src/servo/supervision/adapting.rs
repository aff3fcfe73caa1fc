//! The state `Adapting`: changes of the drive are found, and better models replace the one in use.

use crate::math::sqrt;
use crate::servo::design::constants::UNKNOWN_PART;
use crate::servo::model::Model;
use crate::servo::supervision::comparison::Comparison;
use crate::servo::supervision::event::{Event, LoopSample, Spare};
use crate::servo::supervision::evidence::Challenger;
use crate::servo::supervision::state::State;
use crate::servo::supervision::supervisor::Supervisor;
use crate::servo::supervision::unknown::unknown_flow;
#[cfg(test)]
use crate::servo::supervision::validation::ValidationWindow;

impl Supervisor {
    /// One sample of [`State::Adapting`].
    pub(crate) fn adapt(&mut self, seen: &LoopSample) -> Event {
        let leak = self.design.peak_error_leak;
        for (peak, value) in [
            (&mut self.peak_error, seen.error.abs()),
            (&mut self.peak_speed, seen.speed.abs()),
        ] {
            *peak -= leak * *peak;
            if value > *peak {
                *peak = value;
            }
        }
        if self.still_for > self.design.still {
            self.enter(State::Frozen);
            return Event::None;
        }
        let settled = self.ticks > self.design.look;
        if let Some(innovation) = seen.innovation
            && self.change.update(innovation, settled)
        {
            self.comparison = Comparison::Rests;
            self.evidence.forget();
            return Event::Changed;
        }
        if seen.sticks {
            // What was learnt before stays.
            self.comparison = Comparison::Rests;
            return Event::None;
        }
        self.compare(seen)
    }

    /// Whether the axis follows so badly that the model may be wrong: by more than the deadband, or
    /// in a slow motion by more than the reference moves in the time of the lag.
    pub(crate) fn is_astray(&self) -> bool {
        let design = &self.design;
        let lag = design.lag * self.peak_speed;
        let error = self.peak_error;
        error > design.error_deadband || error > design.error_least && error > lag
    }

    /// What this sample is for, of those that compare models.
    pub(crate) fn compare(&mut self, seen: &LoopSample) -> Event {
        if matches!(self.comparison, Comparison::Runs) && !self.window.is_over() {
            (self.window).update(seen.flow, seen.y, seen.motion.velocity);
            return Event::None;
        }
        if self.comparison.rests() || seen.spare == Spare::Nothing {
            return Event::None;
        }
        let Some(used) = self.verified_model else {
            return Event::None;
        };
        match self.comparison {
            Comparison::Rests => {}
            Comparison::Begins => {
                let challenger = self.evidence.challenger();
                let design = &self.design.validation;
                (self.window).begin(design, &used, challenger, seen.motion, seen.flow);
                self.comparison = Comparison::Runs;
            }
            Comparison::Runs => {
                if self.window.explain() {
                    self.weigh(&used);
                }
            }
            Comparison::Decides => {
                self.comparison = Comparison::Rests;
                match self.evidence.verdict(&self.design, &used) {
                    Ok(None) => {}
                    Ok(Some(winner)) => self.comparison = Comparison::Replaces(winner),
                    Err(reason) => return self.refuse(reason),
                }
            }
            Comparison::Replaces(winner) => {
                self.comparison = Comparison::Rests;
                return self.replace(&used, &winner);
            }
        }
        Event::None
    }

    /// Adds what a window showed to the evidence.
    #[inline]
    fn weigh(&mut self, used: &Model) {
        let grain = self.design.drift;
        let sums = (self.window).sums(self.design.min_travel, unknown(used) + grain, grain);
        self.comparison = if let Some(sums) = sums {
            self.report = self.window.report(&sums);
            self.evidence.add(&sums);
            Comparison::Decides
        } else {
            Comparison::Rests
        };
    }

    /// Whether the next sample is for a step from a window to another model, not for another sample
    /// of a window.
    pub(crate) const fn steps(&self) -> bool {
        match self.comparison {
            Comparison::Rests => false,
            Comparison::Runs => self.window.is_over(),
            Comparison::Begins | Comparison::Decides | Comparison::Replaces(_) => true,
        }
    }

    /// The window that goes on.
    #[cfg(test)]
    pub(crate) fn running(&self) -> Option<&ValidationWindow> {
        (self.comparison == Comparison::Runs).then_some(&self.window)
    }

    /// Another model becomes the verified one, unless it may not control.
    fn replace(&mut self, used: &Model, winner: &Challenger) -> Event {
        // What was screened was the estimate, not the simpler change in its place.
        if let Err(reason) = self.design.screening.admits(&winner.model) {
            return self.refuse(reason);
        }
        self.accepted = self.accepted.saturating_add(1);
        self.verified_model = Some(winner.model);
        self.variances = winner.variances;
        self.evidence.replaced(used, &winner.model);
        self.refusal = None;
        Event::Accepted(winner.model)
    }
}

/// By how much a model may be wrong about the position without being another one: the part of the
/// friction and of the dead zone that nobody knows, as what the one holds against the stiffness and
/// the flow of the other moves within 1/w0.
fn unknown(model: &Model) -> f32 {
    let friction = UNKNOWN_PART * model.friction;
    (friction + model.b0 * unknown_flow(model) / sqrt(model.a1)) / model.a1
}

#[cfg(test)]
mod tests;
