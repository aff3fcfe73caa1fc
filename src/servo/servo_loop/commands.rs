//! The latest commands: what is on its way when a controller takes over.

use crate::servo::design::constants::DELAY_MAX;

/// The newest `DELAY_MAX + 1` commands, 0 before the first.
#[derive(Debug, Clone)]
pub(crate) struct Commands {
    latest: [f32; DELAY_MAX + 1],
    newest: usize,
}

impl Commands {
    /// The valve has been at 0.
    pub(crate) const fn new() -> Self {
        Self {
            latest: [0.0; DELAY_MAX + 1],
            newest: 0,
        }
    }

    /// The command of this sample.
    #[inline]
    pub(crate) fn push(&mut self, command: f32) {
        self.newest += 1;
        if self.newest >= self.latest.len() {
            self.newest = 0;
        }
        if let Some(slot) = self.latest.get_mut(self.newest) {
            *slot = command;
        }
    }

    /// The commands times the sign of the valve, newest first.
    pub(crate) fn along(&self, sign: f32) -> impl Iterator<Item = f32> {
        let length = self.latest.len();
        (0..length).map(move |age| {
            let at = (self.newest + length - age).checked_rem(length);
            let command = at.and_then(|at| self.latest.get(at));
            sign * command.copied().unwrap_or(0.0)
        })
    }
}
