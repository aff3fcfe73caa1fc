//! The state `Adapting`: changes of the drive are found, and better models replace the one in use.

use crate::servo::supervision::event::{Event, Observation};
use crate::servo::supervision::state::State;
use crate::servo::supervision::supervisor::Supervisor;

impl Supervisor {
    /// One sample of [`State::Adapting`].
    pub(crate) fn adapt(&mut self, seen: &Observation) -> Event {
        let error = seen.error.abs();
        self.peak_error -= self.design.peak_error_leak * self.peak_error;
        if error > self.peak_error {
            self.peak_error = error;
        }
        if self.still_for > self.design.still {
            self.enter(State::Frozen);
            return Event::None;
        }
        let settled = self.ticks > self.design.look;
        if let Some(innovation) = seen.innovation
            && self.change.update(innovation, settled)
        {
            self.window = None;
            self.window_due = false;
            self.evidence.forget();
            return Event::Changed;
        }
        if seen.sticks {
            // What was learnt before stays.
            self.window = None;
            self.window_due = false;
            return Event::None;
        }
        self.compare(seen)
    }
}

#[cfg(test)]
mod tests;
