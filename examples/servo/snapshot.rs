//! What the interrupt shows the idle loop.

use trendid::servo::State;
use trendid_example_support::machine::{Trace, Verified};

/// Samples between two lines of the log.
pub(crate) const EVERY: u64 = 500;

/// Messages from the interrupt to the idle loop.
#[derive(Clone)]
pub(crate) struct Snapshot {
    pub tick: u64,
    pub state: State,
    pub position: f32,
    pub setpoint: f32,
    pub command: f32,
    /// Slots that ended after their time.
    pub overruns: u32,
    /// Slots that passed without a call, of which the loop was told.
    pub missed: u32,
    /// Slots that could not be logged because the queue was full.
    pub dropped: u32,
    /// Safe output until a person has acknowledged the fault.
    pub stopped: bool,
    /// Requests that came while it was stopped.
    pub refused: u32,
    /// Longest update so far in us; in the emulator in thousands of instructions.
    pub longest: u32,
    /// What the loop did, in the emulator.
    pub trace: Trace,
    /// The verified model and what was found with it.
    pub verified: Option<Verified>,
    /// Whether it shall be stored, and the slot told what came of it.
    pub store: bool,
}
