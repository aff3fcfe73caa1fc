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
            self.validation = None;
            return Event::Changed;
        }
        if seen.sticks {
            self.validation = None;
            return Event::None;
        }
        let Some(report) = self.validate(seen) else {
            return Event::None;
        };
        match self.design.compare(&report) {
            Ok(true) => self.accept(),
            Ok(false) => {
                self.validation = None;
                Event::None
            }
            Err(reason) => {
                self.validation = None;
                self.refuse(reason)
            }
        }
    }
}

#[cfg(test)]
mod tests;
