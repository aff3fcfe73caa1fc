//! What is said of a file that was read.

use super::alone::Alone;
use super::resample::Resampling;

/// What is said of a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Notes {
    /// What was taken for granted of the time stamps, in one sentence.
    pub granted: Option<String>,
    /// What was done to have equal intervals.
    pub resampling: Resampling,
    /// The step in s of a coarse clock that the stamps are rounded to.
    pub clock: Option<f64>,
    /// Numbers that do not go with those around them, one of each signal at most.
    pub alone: Vec<Alone>,
}
