//! The report of one sample of the loop.

use crate::servo::monitoring::FaultCounters;
use crate::servo::motion::Setpoint;
use crate::servo::supervision::state::State;

/// Outcome of one sample of the loop.
#[must_use]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Report {
    /// State of the supervisor after the sample.
    pub state: State,
    /// Measured position; where the axis should be when the sensor failed.
    pub position: f32,
    /// The reference that the axis should have reached by now: a delay behind the trajectory. The
    /// position outside of control.
    pub setpoint: Setpoint,
    /// The command that was set.
    pub command: f32,
    /// Innovation of the identifier, if there was one.
    pub innovation: Option<f32>,
    /// Whether a model reached the controller in this sample.
    pub retuned: bool,
    /// Counters of the monitors since the start.
    pub faults: FaultCounters,
}
