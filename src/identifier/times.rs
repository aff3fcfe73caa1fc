//! How long things last, in samples.

use crate::identifier::config::Config;
use crate::identifier::start::StartPlan;
use crate::trends::Design;
use crate::trends::filter::settling_time;

/// Times in samples, all in proportion to one over the bandwidth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Times {
    /// For which the innovation gate stays open after a start.
    pub(crate) gate_open: u32,
    /// For which it stays open after a lasting change.
    pub(crate) gate_pause: u32,
    /// After which a standstill is certain.
    pub(crate) certain: u32,
    /// After which the trends have settled behind one.
    pub(crate) settled: u32,
    /// For which the trends carry a step of y.
    pub(crate) after_step: u32,
    /// Without y that the model bridges; after more the trends begin anew.
    pub(crate) longest_gap: u32,
    /// For which rows are left out behind a change of the drive.
    pub(crate) change_settling: u32,
    /// Without a look for changes at the start and behind one.
    pub(crate) change_blind: u32,
    /// Rows before a model is known, whatever P says of it; 0 for one that is given or
    /// tested.
    pub(crate) known_rows: f32,
    pub(crate) start: StartPlan,
}

impl Times {
    /// Behind the trends of this design.
    pub(crate) fn new<const M: usize, const N: usize, const I: usize>(
        config: &Config<M, N, I>,
        design: &Design<M>,
    ) -> Self {
        let (structure, bandwidth) = (&config.structure, config.bandwidth);
        let sample_time = design.sample_time;
        let angle = bandwidth * sample_time;
        let filtered = design.filter.is_some();
        Self {
            gate_open: (10.0 / angle) as u32,
            gate_pause: (0.5 / angle) as u32,
            certain: (1.0 / angle) as u32 + 10,
            settled: match structure.initial_state() {
                true => (12.0 / angle) as u32,
                false => (3.0 / (1.0 - design.slow_mode)).max(12.0 / angle) as u32,
            },
            after_step: (2.0 / angle) as u32,
            longest_gap: (5.0 / angle) as u32,
            change_settling: (settling_time(bandwidth) / sample_time) as u32,
            change_blind: (10.0 / angle) as u32,
            known_rows: match config.supervised || config.prior_std.is_some() {
                true => 0.0,
                false => known_rows(
                    config.known.iter().filter(|known| !**known).count(),
                    angle,
                    config.memory.map(|memory| memory / sample_time),
                ),
            },
            start: StartPlan::new(config.output_range, angle, filtered && !config.supervised),
        }
    }
}

/// As many rows as there are `unknown` parameters, of which one in 1/(omega Delta) samples tells
/// something new; half of the memory holds, where that is less. `angle` is omega Delta, `memory` in
/// samples.
fn known_rows(unknown: usize, angle: f32, memory: Option<f32>) -> f32 {
    let rows = unknown as f32 / angle;
    match memory {
        Some(memory) if 0.5 * memory < rows => 0.5 * memory,
        _ => rows,
    }
}
