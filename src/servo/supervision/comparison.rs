//! What the next sample is for, of those that compare models.

use crate::servo::supervision::evidence::Challenger;
use crate::servo::supervision::validation::Window;

/// The steps from a window to another model; one sample has no time for two of them.
#[derive(Debug, Clone, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "nothing is allocated")]
pub(crate) enum Comparison {
    /// None; a candidate would be heard.
    Rests,
    /// A window begins.
    Begins,
    /// The window goes on, and behind its last sample becomes part of the evidence.
    Runs(Window),
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

    /// Whether the next sample is for a step from one of them to another, not for another sample of
    /// a window.
    pub(crate) const fn steps(&self) -> bool {
        match self {
            Self::Rests => false,
            Self::Runs(window) => window.is_over(),
            Self::Begins | Self::Decides | Self::Replaces(_) => true,
        }
    }

    /// The window that goes on.
    #[cfg(test)]
    pub(crate) const fn window(&self) -> Option<&Window> {
        match self {
            Self::Runs(window) => Some(window),
            _ => None,
        }
    }
}
