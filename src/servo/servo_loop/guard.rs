//! What stops the axis.

use crate::servo::monitoring::{Alarm, Monitors, stop::Stop};

/// The monitors, and how far what they ask for has come.
#[derive(Debug, Clone)]
pub(crate) struct Guard {
    pub(crate) monitors: Monitors,
    /// Their demand on the next command.
    pub(crate) alarm: Option<Alarm>,
    /// The way to standstill after a fault.
    pub(crate) stop: Stop,
}

impl Guard {
    /// Nothing is left of a fault before: control, a commissioning or the user has the axis.
    pub(crate) fn release(&mut self) {
        self.alarm = None;
        self.stop = Stop::default();
    }
}
