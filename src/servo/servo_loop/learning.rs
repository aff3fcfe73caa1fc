//! What the identifier learns from in control.

use crate::servo::design::Design;
use crate::servo::identification::mean_stiffness::MeanStiffness;
use crate::servo::supervision::excitation_monitor::ExcitationMonitor;

/// Which samples the identifier learns from, and where the axis was in them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Learning {
    pub(crate) monitor: ExcitationMonitor,
    /// Samples after a breakaway in which the filtered signals still contain friction.
    pub(crate) settled: u32,
    pub(crate) stiffness: MeanStiffness,
}

impl Learning {
    pub(crate) fn new(design: &Design) -> Self {
        Self {
            monitor: ExcitationMonitor::new(&design.monitor),
            settled: design.identification.settled,
            stiffness: MeanStiffness::new(&design.identification, design.sample_time),
        }
    }
}
