//! The way to a controller that takes over, and the way back.

use crate::servo::building::Building;
use crate::servo::control::tuning::Tuned;
use crate::servo::identification::Looked;
use crate::servo::model::Model;

/// From what was found to a controller that works with it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Takeover {
    /// The loop for what was found, while it is being built.
    pub(crate) building: Option<Building>,
    /// The search of poles for the model that is being validated.
    pub(crate) tuning: Option<Tuned>,
    /// A model for which the poles are still to be searched.
    pub(crate) unsearched: Option<Model>,
    /// The estimate that the next sample makes a candidate of.
    pub(crate) looked: Option<Looked>,
    /// Samples in which the observer of the controller settles behind a commissioning, before
    /// control begins.
    pub(crate) watching: u32,
    pub(crate) halt: Halt,
}

/// An axis comes to rest before its commissioning: samples since the valve closed or the reference
/// rested, and for which it has stood about a place.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Halt {
    pub(crate) since: u32,
    pub(crate) stood: u32,
    pub(crate) place: f32,
}

#[cfg(test)]
impl Takeover {
    /// Whether poles are searched, or will be.
    pub(crate) const fn is_searching(&self) -> bool {
        self.tuning.is_some() || self.unsearched.is_some()
    }
}

/// What the loop goes back to when it oscillates or does not follow.
#[derive(Debug, Clone)]
pub(crate) struct Fallback {
    /// Factor on the bandwidth, 1 unless an oscillation was noticed.
    pub(crate) derating: f32,
    /// The model of the commissioning.
    pub(crate) known_good: Option<Model>,
    /// Whether that one is the next candidate.
    pub(crate) reconsiders: bool,
    /// Whether the controller went back to it since the last report.
    pub(crate) went_back: bool,
}

impl Fallback {
    /// The whole bandwidth on the model that control begins with.
    pub(crate) const fn new(known_good: Option<Model>) -> Self {
        Self {
            derating: 1.0,
            known_good,
            reconsiders: false,
            went_back: false,
        }
    }
}
