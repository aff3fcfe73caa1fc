//! What the user says about a drive, and which parameters a model has.

use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, ConfigError, Structure as CoreStructure};

use crate::error::{Error, code};
use crate::memory::write;

/// Most inputs that the caller may give.
pub const INPUTS_MAX: usize = 2;

/// Settings of an identifier, made by `trendid_settings_init`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Sample time in s.
    pub sample_time: f32,
    /// Rough bandwidth of the drive in rad/s, within a factor of three.
    pub bandwidth: f32,
    /// Typical size of each input, in its unit.
    pub input_range: [f32; INPUTS_MAX],
    /// Typical movement of the output, in its unit.
    pub output_range: f32,
    /// Expected standard deviation of the noise of the output, in its unit; 0: a thousandth of
    /// `output_range`.
    pub output_noise: f32,
    /// Memory in s; 0: nothing is forgotten. With a dead zone about two blocks of it.
    pub memory: f32,
    /// Time without estimation after the first sample, in s; default 0.
    pub settling: f32,
    /// Standard deviations below which the constant is insignificant and withdrawn; default 2, 0
    /// always keeps it.
    pub offset_significance: f32,
    /// Delay of each input in samples, at most `TRENDID_DELAY_MAX` (`TRENDID_ANY_DELAY_MAX` for a
    /// `trendid_any`).
    pub delay: [u32; INPUTS_MAX],
    /// Largest half width of the dead zone, in the unit of the first input; only for kinds with a
    /// dead zone. Commands below it tell no deviation until they are known to lie outside.
    pub dead_zone_max: f32,
    /// Samples between corrections of the dead zone; default 300.
    pub dead_zone_block: u32,
}

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
        settling: 0.0,
        offset_significance: 2.0,
        delay: [0; INPUTS_MAX],
        dead_zone_max: 0.25 * input_range,
        dead_zone_block: 300,
    };
    // SAFETY: by the contract of the header.
    code(unsafe { write(settings, defaults) })
}

impl Settings {
    /// The default filter.
    pub(crate) fn trends<const M: usize>(&self) -> Result<FilteredTrends<M>, ConfigError> {
        FilteredTrends::for_bandwidth(Scheme::Tustin, self.sample_time, self.bandwidth)
    }

    /// The settings of the core; `own` says which input of the caller an input of the model is,
    /// `None` for a sign.
    pub(crate) fn config<const M: usize, const N: usize, const I: usize>(
        &self,
        structure: CoreStructure<M, N, I>,
        own: [Option<usize>; I],
    ) -> Config<M, N, I> {
        let range = |input: Option<usize>| input.and_then(|input| self.input_range.get(input));
        let delay = |input: Option<usize>| self.delay.get(input.unwrap_or(0));
        let ranges = own.map(|input| range(input).copied().unwrap_or(1.0));
        let mut config = Config::new(structure, self.bandwidth, ranges, self.output_range);
        if self.output_noise != 0.0 {
            config.output_noise = self.output_noise;
        }
        config.memory = (self.memory != 0.0).then_some(self.memory);
        config.settling = self.settling;
        config.offset_significance = self.offset_significance;
        config.delays = own.map(|input| delay(input).map_or(0, |delay| *delay as usize));
        config
    }
}

/// Any structure `(b_{m-1} s^{m-1} + .. + b0) / (s^m + a_{m-1} s^{m-1} + .. + a0)` for a
/// `trendid_any`.
///
/// The parameters stand in this order: a_i with i ascending, b_i of each input, the constant, the
/// initial state.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Structure {
    /// Order m, 1 to 4.
    pub order: u8,
    /// Number of inputs, 1 or 2.
    pub inputs: u8,
    /// Bit i: a_i exists; an integrator has no a_0.
    pub output_terms: u8,
    /// Bit i: b_i of this input exists.
    pub input_terms: [u8; INPUTS_MAX],
    /// Not 0: there is a constant input, for the offset of a valve.
    pub constant: u8,
    /// Not 0: the error of the first position is a parameter.
    pub initial_state: u8,
}
