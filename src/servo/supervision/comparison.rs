//! What the next sample is for, of those that compare models.

use crate::servo::supervision::evidence::Challenger;

/// The steps from a window to another model; one sample has no time for two of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Comparison {
    /// None; a candidate would be heard.
    Rests,
    /// A window begins.
    Begins,
    /// The window goes on, and behind its last sample becomes part of the evidence.
    Runs,
    /// The evidence decides.
    Decides,
    /// This model replaces the one in use.
    Replaces(Challenger),
}

impl Comparison {
    /// Whether the next sample is for none of it.
    pub(crate) const fn rests(&self) -> bool {
        matches!(self, Self::Rests)
    }
}
