//! What the user says about a drive, and which parameters a model has.

mod check;
mod structure;

pub(crate) use check::{Takes, of_caller};
pub use structure::*;

use trendid::trends::{FilteredTrends, Hold as CoreHold, Scheme};
use trendid::{Config, Structure as CoreStructure};

use crate::detail::Detail;
use crate::error::{Error, code};
use crate::identifier::PARAMETERS_MAX;
use crate::memory::write;

/// Course of an input between two samples.
#[repr(i32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// Held until the next sample: a command that this controller gives.
    Zero = 0,
    /// Straight from sample to sample: a measured quantity.
    First = 1,
    /// The mean since the sample before: what is known only when it is over, as that of
    /// `trendid_friction_update`.
    Mean = 2,
}

/// Settings of an identifier, made by `trendid_settings_init`.
///
/// A setting that means nothing for a kind must be as `trendid_settings_init` left it: that of an
/// input or a parameter that the kind does not have, a dead zone of a kind without one, a delay of
/// a bank that looks for it, a change to be followed without a memory, a significance without a
/// constant.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Sample time in s.
    pub sample_time: f32,
    /// Rough bandwidth of the drive in rad/s, within a factor of three.
    pub bandwidth: f32,
    /// Typical size of each input, in its unit; default 1 of the second one.
    pub input_range: [f32; INPUTS_MAX],
    /// Typical movement of the output, in its unit.
    pub output_range: f32,
    /// Expected standard deviation of the noise of the output, in its unit; 0: a thousandth of
    /// `output_range`.
    pub output_noise: f32,
    /// Memory in s; 0: nothing is forgotten. With a dead zone about two blocks of it.
    pub memory: f32,
    /// With a memory: 1 makes it short where the drive changes, until the new drive is known; so
    /// long the deviations are infinite. 0 (default) forgets as fast as always. A drive with a
    /// friction or a dead zone that the model does not have shows itself as a change now and then.
    pub follow_changes: i32,
    /// Time without estimation after the first sample, in s; default 0, for a drive at rest.
    pub settling: f32,
    /// Standard deviations below which the constant is insignificant and withdrawn; default 2, 0
    /// always keeps it.
    pub offset_significance: f32,
    /// Course of each input between samples, a `trendid_hold`; default `TRENDID_HOLD_ZERO`.
    pub hold: [i32; INPUTS_MAX],
    /// Delay of each input in samples, also between two of them, at most `TRENDID_DELAY_MAX`
    /// (`TRENDID_ANY_DELAY_MAX` for a `trendid_any`); default 0.
    pub delay: [f32; INPUTS_MAX],
    /// Each input in equilibrium before the first sample, in its unit; default 0.
    pub initial_input: [f32; INPUTS_MAX],
    /// The input that is the sign of the velocity, counted from 0: while it is 0 the axis may
    /// stick, and the estimate is held. 1 for the kinds with Coulomb friction; -1 (default): none.
    pub friction_input: i32,
    /// The parameters before the first sample, in the order and the units of `theta` of
    /// `trendid_estimate`; default 0.
    pub initial: [f32; PARAMETERS_MAX],
    /// Standard deviations of `initial`, in the same units: all 0 (default) for those that follow
    /// from the ranges, or each above 0 but for known parameters.
    pub prior_std: [f32; PARAMETERS_MAX],
    /// Bit i: parameter i is known to be `initial[i]`; default 0.
    pub known: u32,
    /// Half width of the dead zone to begin with, in the unit of the first input, at most
    /// `dead_zone_max`; default 0. Too small is good, too large may confirm itself.
    pub dead_zone: f32,
    /// Largest half width of the dead zone, in the unit of the first input; 0 (default): a quarter
    /// of `input_range[0]`. Commands below it tell no deviation until they are known to lie
    /// outside.
    pub dead_zone_max: f32,
    /// Samples between corrections of the dead zone; 0 (default): 300.
    pub dead_zone_block: u32,
}

/// Share of the range of the command that a dead zone has at most where nothing is said.
const DEAD_ZONE: f32 = 0.25;

/// Samples between corrections of a dead zone where nothing is said.
const DEAD_ZONE_BLOCK: u32 = 300;

/// The defaults for a drive sampled every `sample_time` (s), of rough `bandwidth` (rad/s), with the
/// typical sizes of command and position. The values are checked where an identifier is made of
/// them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_settings_init(
    settings: *mut Settings,
    sample_time: f32,
    bandwidth: f32,
    input_range: f32,
    output_range: f32,
) -> Error {
    let defaults = Settings {
        sample_time,
        bandwidth,
        input_range: [input_range, 1.0],
        output_range,
        output_noise: 0.0,
        memory: 0.0,
        follow_changes: 0,
        settling: 0.0,
        offset_significance: 2.0,
        hold: [Hold::Zero as i32; INPUTS_MAX],
        delay: [0.0; INPUTS_MAX],
        initial_input: [0.0; INPUTS_MAX],
        friction_input: -1,
        initial: [0.0; PARAMETERS_MAX],
        prior_std: [0.0; PARAMETERS_MAX],
        known: 0,
        dead_zone: 0.0,
        dead_zone_max: 0.0,
        dead_zone_block: 0,
    };
    // SAFETY: by the contract of the header.
    code(unsafe { write(settings, defaults) })
}

impl Settings {
    /// The default filter.
    pub(crate) fn trends<const M: usize>(&self) -> Result<FilteredTrends<M>, Detail> {
        let made = FilteredTrends::for_bandwidth(Scheme::Tustin, self.sample_time, self.bandwidth);
        made.map_err(|error| self.no_filter(error))
    }

    /// The largest half width of the dead zone, and the samples of a block.
    pub(crate) fn dead_zone_limits(&self) -> (f32, u32) {
        let largest = match self.dead_zone_max == 0.0 {
            true => DEAD_ZONE * self.input_range[0],
            false => self.dead_zone_max,
        };
        let block = match self.dead_zone_block {
            0 => DEAD_ZONE_BLOCK,
            block => block,
        };
        (largest, block)
    }

    /// The settings of the core, once they are checked; `own` says which input of the caller an
    /// input of the model is, `None` for the sign of the command.
    pub(crate) fn config<const M: usize, const N: usize, const I: usize>(
        &self,
        structure: CoreStructure<M, N, I>,
        own: [Option<usize>; I],
    ) -> Config<M, N, I> {
        // The sign of a command is as late as the command, and goes on like it.
        let of = |input: Option<usize>, list: [f32; INPUTS_MAX]| {
            let value = list.get(input.unwrap_or(0)).copied();
            value.unwrap_or(0.0)
        };
        let ranges = own.map(|input| match input {
            Some(_) => of(input, self.input_range),
            None => 1.0,
        });
        let mut config = Config::new(structure, self.bandwidth, ranges, self.output_range);
        if self.output_noise != 0.0 {
            config.output_noise = self.output_noise;
        }
        config.memory = (self.memory != 0.0).then_some(self.memory);
        config.follow_changes = self.follow_changes != 0;
        config.settling = self.settling;
        config.offset_significance = self.offset_significance;
        config.holds = own.map(|input| self.course(input.unwrap_or(0)));
        config.initial_input = own.map(|input| of(input, self.initial_input));
        for (input, own) in own.into_iter().enumerate() {
            config.set_delay(input, of(own, self.delay));
        }
        config.friction_input = usize::try_from(self.friction_input)
            .ok()
            .and_then(|friction| own.iter().position(|input| *input == Some(friction)));
        config.initial = fill(self.initial);
        config.prior_std = (self.prior_std != [0.0; PARAMETERS_MAX]).then(|| fill(self.prior_std));
        config.known = core::array::from_fn(|parameter| self.is_known(parameter));
        config
    }

    /// Whether a parameter is known.
    fn is_known(&self, parameter: usize) -> bool {
        let bit = u32::try_from(parameter).ok();
        bit.and_then(|bit| self.known.checked_shr(bit))
            .is_some_and(|bits| bits & 1 != 0)
    }

    /// The course of an input of the caller.
    fn course(&self, input: usize) -> CoreHold {
        const FIRST: i32 = Hold::First as i32;
        const MEAN: i32 = Hold::Mean as i32;
        match self.hold.get(input) {
            Some(&FIRST) => CoreHold::First,
            Some(&MEAN) => CoreHold::Mean,
            _ => CoreHold::Zero,
        }
    }
}

/// The first numbers of a list.
fn fill<const N: usize>(list: [f32; PARAMETERS_MAX]) -> [f32; N] {
    core::array::from_fn(|k| list.get(k).copied().unwrap_or(0.0))
}
