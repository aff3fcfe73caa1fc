//! Input and output of the supervisor.

use crate::servo::control::place::PlacedFlow;
use crate::servo::model::Model;
use crate::servo::motion::Motion;

/// One sample, as the supervisor sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LoopSample {
    /// The motion, measured or observed.
    pub(crate) motion: Motion,
    /// Measured position.
    pub(crate) y: f32,
    /// The flow that the axis feels from now on.
    pub(crate) flow: PlacedFlow,
    /// Whether the position code is the same as in the sample before.
    pub(crate) same_code: bool,
    /// Whether the axis sticks: then no model can be validated.
    pub(crate) sticks: bool,
    /// Reference minus observed position; 0 without control.
    pub(crate) error: f32,
    /// Velocity of the reference.
    pub(crate) speed: f32,
    /// Innovation of the identifier, if there was one.
    pub(crate) innovation: Option<f32>,
    /// What there is time for in this sample.
    pub(crate) spare: Spare,
}

/// What a sample has time for beside what every one needs and a sample of a window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Spare {
    /// Nothing: a move is planned.
    Nothing,
    /// A step from a window to another model, or gains that come into force.
    Step,
    /// What can wait for such a sample: a look at the estimate, the search for poles.
    Thought,
}

/// Consequence of a sample for the loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Event {
    /// Nothing.
    None,
    /// A model passed: the controller takes it.
    Accepted(Model),
    /// The estimate is rejected: the identifier begins again from this model, which stays in force.
    Restored(Model),
    /// The drive changed: the identifier discounts the samples before.
    Changed,
    /// The axis must stop.
    Stopped,
}
