//! Counters of the monitors.

/// Events counted by the monitors since the start; every number stops at its largest value.
///
/// The order is part of the link's protocol: new counters come last.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct FaultCounters {
    /// Readings that failed.
    pub failed_readings: u32,
    /// Readings that the axis cannot have reached; each was replaced by the expected position.
    pub implausible_readings: u32,
    /// Samples at the full command.
    pub saturated_samples: u32,
    /// Oscillations at rest that were noticed.
    pub oscillations: u32,
    /// Faults that stopped the axis; a commissioning that gives up is none.
    pub stops: u32,
    /// Factor on the bandwidth of the controller; 1 unless an oscillation was noticed.
    pub derating: f32,
    /// Departures from where the axis was while its reference rests: slips, creep and every half
    /// wave of a cycle.
    pub moves_at_rest: u32,
}

impl FaultCounters {
    pub(crate) const NONE: Self = Self {
        failed_readings: 0,
        implausible_readings: 0,
        saturated_samples: 0,
        oscillations: 0,
        stops: 0,
        derating: 1.0,
        moves_at_rest: 0,
    };
}
