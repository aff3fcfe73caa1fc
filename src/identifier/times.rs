//! How long things last, in samples.

use crate::estimation::terms::Parameter;
use crate::identifier::config::Config;
use crate::identifier::start::StartPlan;
use crate::math::sqrt;
use crate::trends::Design;
use crate::trends::filter::{settling_time, time_constant};

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
    /// The same before a model is known.
    pub(crate) unknown_gap: u32,
    /// Until the pair of the filter carries less than noise; and time constants in which the slow
    /// pole does, 0 where an initial state stands for it.
    pair: u32,
    folds: f32,
    /// Without rows behind trends that begin anew in motion: until what they carry of the beginning
    /// is below noise, or an initial state stands for it.
    pub(crate) anew: u32,
    /// For which rows are left out behind a change of the drive.
    pub(crate) change_settling: u32,
    /// Without a look for changes at the start and behind one.
    pub(crate) change_blind: u32,
    /// Rows before a model is known, whatever P says of it; 0 for one that is given or
    /// tested.
    pub(crate) known_rows: f32,
    pub(crate) start: StartPlan,
    /// In which an error of y(0) takes a step on its way through the filter; 0 where the initial
    /// state takes all of it, or another column.
    pub(crate) start_pace: u32,
}

impl Times {
    /// Behind the trends of this design.
    pub(crate) fn new<const M: usize, const N: usize, const I: usize>(
        config: &Config<M, N, I>,
        design: &Design<M>,
        smooth: bool,
    ) -> Self {
        let (structure, bandwidth) = (&config.structure, config.bandwidth);
        let sample_time = design.sample_time;
        let angle = bandwidth * sample_time;
        let filtered = design.filter.is_some();
        let (noise, range) = (config.output_noise, config.output_range);
        Self {
            gate_open: (10.0 / angle) as u32,
            gate_pause: (0.5 / angle) as u32,
            certain: (1.0 / angle) as u32 + 10,
            settled: match structure.initial_state() {
                true => (12.0 / angle) as u32,
                false => (3.0 / (1.0 - design.slow_mode)).max(12.0 / angle) as u32,
            },
            after_step: ((2.0 / angle) as u32).max(1),
            longest_gap: (5.0 / angle) as u32,
            unknown_gap: unknown_gap(noise / range, angle),
            pair: match config.supervised {
                true => 0,
                false => (folds(range / noise) * time_constant(bandwidth) / sample_time) as u32,
            },
            folds: match config.supervised || structure.initial_state() {
                true => 0.0,
                false => folds(range / noise),
            },
            anew: 0,
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
            start: StartPlan::new(
                config.output_range,
                angle,
                filtered && smooth && !config.supervised,
            ),
            start_pace: match filtered
                && structure.initial_state()
                && structure.integrators() > 0
                && !config.supervised
            {
                true => ((0.1 / angle) as u32).max(2),
                false => 0,
            },
        }
    }

    /// Waits behind trends of this design that begin anew, for `warm_up` at least.
    pub(crate) fn begin_anew<const M: usize>(&mut self, design: &Design<M>, warm_up: u32) {
        self.anew = self.pair.max(self.fading(design)).max(warm_up);
    }

    /// Samples in which what the slow pole carries falls below noise, 0 where an initial state
    /// stands for it.
    pub(crate) fn fading<const M: usize>(&self, design: &Design<M>) -> u32 {
        (self.folds / (1.0 - design.slow_mode)) as u32
    }
}

/// Samples without rows at the beginning of a drive whose offset begins with the record and kicks
/// it through a zero: `b_1` times a step of the offset is an impulse, and the column of the
/// constant, `b_0` times the step, has none. It leaves the trends as the filter fades, three time
/// constants; what the slow pole keeps is in the column of the initial state.
pub(crate) fn kicked<const M: usize, const N: usize, const I: usize>(
    config: &Config<M, N, I>,
    angle: f32,
) -> u32 {
    let structure = &config.structure;
    let zero = |parameter| matches!(parameter, Parameter::Input { power: 1.., .. });
    let kicks = structure.constant() && structure.integrators() > 0 && !config.supervised;
    match kicks && structure.parameters().into_iter().any(zero) {
        true => (3.0 / angle) as u32,
        false => 0,
    }
}

/// Samples for which a drive of the design size moves the trends by less than white noise does:
/// `(n omega Delta)^2 / 2 < sigma / R sqrt(omega Delta)`, and one in any case.
fn unknown_gap(noise: f32, angle: f32) -> u32 {
    ((sqrt(2.0 * noise * sqrt(angle)).min(5.0) / angle) as u32).max(1)
}

/// Time constants in which a motion falls below the noise, from three on; `ratio` is motion over
/// noise.
fn folds(ratio: f32) -> f32 {
    let (mut left, mut folds) = (ratio, 0.0);
    while left > 1.0 {
        left *= core::f32::consts::E.recip();
        folds += 1.0;
    }
    if folds > 3.0 { folds } else { 3.0 }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::structure::Structure;
    use crate::estimation::terms::Terms;

    #[test]
    fn an_offset_kicks_an_integrating_drive_through_a_zero_alone() {
        type OneZero = Structure<2, 5, 1>;
        let with = |structure: OneZero, supervised| {
            let mut config = Config::new(structure, 20.0, [1.0], 50.0);
            config.supervised = supervised;
            kicked(&config, 0.02)
        };
        // a_1, b_0, b_1, constant, initial state
        let integrates = Terms::between(1, 2);
        let drive = OneZero::try_with_initial_state(integrates, [Terms::up_to(2)], true).unwrap();
        assert_eq!(with(drive, false), 150);
        assert_eq!(with(drive, true), 0);
        // a_0, a_1, b_0, b_1, constant: nothing integrates
        let still = OneZero::try_new(Terms::up_to(2), [Terms::up_to(2)], true).unwrap();
        assert_eq!(with(still, false), 0);
        // a_1, b_0, b_1, initial state: no constant
        let alone =
            Structure::<2, 4, 1>::try_with_initial_state(integrates, [Terms::up_to(2)], false);
        let config = Config::new(alone.unwrap(), 20.0, [1.0], 50.0);
        assert_eq!(kicked(&config, 0.02), 0);
        let servo = Config::new(Structure::<3, 5, 1>::SERVO, 20.0, [1.0], 50.0);
        assert_eq!(kicked(&servo, 0.02), 0);
    }

    #[test]
    fn a_gap_is_unknown_for_as_long_as_motion_is_below_the_noise() {
        // sqrt(2 noise sqrt(angle)) / angle
        assert_eq!(unknown_gap(0.5, 0.02), 18);
        assert_eq!(unknown_gap(0.5, 0.01), 31);
        assert_eq!(unknown_gap(1e6, 0.02), 250);
        assert_eq!(unknown_gap(1e-9, 0.02), 1);
    }

    #[test]
    fn a_motion_falls_below_the_noise_in_the_logarithm_of_their_ratio() {
        let found = [0.0, 1.0, 10.0, 30.0, 1000.0, 1e6].map(folds);
        assert_eq!(found, [3.0, 3.0, 3.0, 4.0, 7.0, 14.0]);
    }
}
