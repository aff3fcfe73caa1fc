//! What the user says about an axis.

use trendid::hardware::{Axis, Scale};
use trendid::servo::{Config, MotionLimits, Travel};

use crate::detail::Detail;
use crate::error::{Error, code};
use crate::memory::write;

/// Requested dynamics of a closed loop.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopController {
    /// Largest bandwidth in rad/s; 0 (default) for what the margins allow.
    pub bandwidth: f32,
    /// Half width of the flow over which the inverse of the dead zone changes sign; default 0.01.
    pub blend: f32,
    /// Least position error within which the valve rests at standstill, in units of y; 0 (default)
    /// for one code and two standard deviations of the noise.
    pub rest_window: f32,
    /// Dead volume of a chamber over that of the stroke: how much stiffer the axis gets towards its
    /// ends. Infinite for a drive that is as stiff everywhere; 0 (default) for what the
    /// commissioning finds. With a model that is installed it is to be stated: a stiff drive that
    /// is taken for a cylinder may swing near its ends.
    pub dead_volume: f32,
    /// Share by which the axis is slower towards larger y, and faster towards smaller ones, within
    /// -0.5..=0.5; default 0. What the commissioning finds replaces it; with a model that is
    /// installed it is to be stated. A rod that leaves the share r of the area makes
    /// (1 - sqrt(r)) / (1 + sqrt(r)) with oil and (1 - r) / (1 + r) with air, negative where the
    /// axis extends towards larger y.
    pub imbalance: f32,
    /// Time in s in which the offset of a bumpless change of gains fades; default 0.01.
    pub transition: f32,
}

/// Settings of a position loop, made by `trendid_loop_settings_init`; a setting of 0 follows from
/// the others unless said.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopSettings {
    /// Sample time in s.
    pub sample_time: f32,
    /// Lowest position, in the unit of y (mm).
    pub travel_min: f32,
    /// Highest position, in the unit of y.
    pub travel_max: f32,
    /// Unit of y per count of the sensor; negative when the sensor counts against the axis.
    pub units_per_count: f32,
    /// Code of the sensor at position zero.
    pub reference_code: i32,
    /// Rough bandwidth of the drive in rad/s, if it is known.
    pub bandwidth: f32,
    /// 1 or -1: a positive command moves towards larger or smaller positions; 0: not known, the
    /// commissioning finds it.
    pub direction: i32,
    /// Standard deviation of the position noise, in the unit of y.
    pub noise: f32,
    /// Largest command, within 0..=1; default 1.
    pub range: f32,
    /// Largest rate of the command per s; default 400.
    pub rate: f32,
    /// Steps of the output between zero and full command, e.g. 2047 of a DAC with 12 bits; 0: the
    /// output has no steps.
    pub command_steps: u32,
    /// Delay of the valve in s; default 0.002. What the commissioning finds replaces it.
    pub delay: f32,
    /// Memory of the identifier in s; default 1.5.
    pub memory: f32,
    /// Whether the model follows the drive after the commissioning: 1 (default) or 0.
    pub adaptive: i32,
    /// Largest velocity of a move, in units of y per s; 0 with the next two for the defaults of all
    /// three.
    pub velocity: f32,
    /// Largest acceleration of a move, in units of y per s^2.
    pub acceleration: f32,
    /// Largest jerk of a move, in units of y per s^3.
    pub jerk: f32,
    /// Requested dynamics.
    pub controller: LoopController,
    /// Largest command of the commissioning, within 0..=1; default 0.5.
    pub excitation: f32,
    /// Longest commissioning in s; default 6.
    pub time_limit: f32,
}

/// The defaults for an axis of which sample time (s), travel, scale and reference of the sensor are
/// known.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn trendid_loop_settings_init(
    settings: *mut LoopSettings,
    sample_time: f32,
    travel_min: f32,
    travel_max: f32,
    units_per_count: f32,
    reference_code: i32,
) -> Error {
    let core = Config::minimal(
        sample_time,
        Travel {
            min: travel_min,
            max: travel_max,
        },
    );
    let defaults = LoopSettings {
        sample_time,
        travel_min,
        travel_max,
        units_per_count,
        reference_code,
        bandwidth: 0.0,
        direction: 0,
        noise: 0.0,
        range: core.range,
        rate: core.rate,
        command_steps: 0,
        delay: core.delay,
        memory: core.memory,
        adaptive: i32::from(core.adaptive),
        velocity: 0.0,
        acceleration: 0.0,
        jerk: 0.0,
        controller: LoopController {
            bandwidth: 0.0,
            blend: core.controller.blend,
            rest_window: 0.0,
            dead_volume: 0.0,
            imbalance: 0.0,
            transition: core.controller.transition,
        },
        excitation: core.excitation.amplitude,
        time_limit: core.supervision.time_limit,
    };
    // SAFETY: by the contract of the header.
    code(unsafe { write(settings, defaults) })
}

/// `None` for 0.
fn stated(value: f32) -> Option<f32> {
    (value != 0.0).then_some(value)
}

impl LoopSettings {
    /// The settings of the core.
    pub(crate) fn config(&self) -> Result<Config, Detail> {
        let travel = Travel {
            min: self.travel_min,
            max: self.travel_max,
        };
        // The core would name their difference.
        let ends = [travel.min, f32::MAX];
        if travel.min.is_finite() && !(travel.max > travel.min && travel.length().is_finite()) {
            return Err(Detail::out_of_range("travel_max", travel.max, ends));
        }
        let mut config = Config::minimal(self.sample_time, travel);
        config.bandwidth = stated(self.bandwidth);
        config.reversed = match self.direction {
            0 => None,
            1 => Some(false),
            -1 => Some(true),
            other => return Err(Detail::out_of_range("direction", other as f32, [-1.0, 1.0])),
        };
        config.noise = stated(self.noise);
        config.range = self.range;
        config.rate = self.rate;
        config.delay = self.delay;
        config.memory = self.memory;
        config.adaptive = match self.adaptive {
            0 => false,
            1 => true,
            other => return Err(Detail::out_of_range("adaptive", other as f32, [0.0, 1.0])),
        };
        let limits = [self.velocity, self.acceleration, self.jerk];
        if limits != [0.0; 3] {
            let [velocity, acceleration, jerk] = limits;
            config.motion = Some(MotionLimits {
                velocity,
                acceleration,
                jerk,
            });
        }
        let LoopController {
            bandwidth,
            blend,
            rest_window,
            dead_volume,
            imbalance,
            transition,
        } = self.controller;
        config.controller.bandwidth = stated(bandwidth);
        config.controller.blend = blend;
        config.controller.rest_window = stated(rest_window);
        config.controller.dead_volume = stated(dead_volume);
        config.controller.imbalance = imbalance;
        config.controller.transition = transition;
        config.excitation.amplitude = self.excitation;
        config.supervision.time_limit = self.time_limit;
        Ok(config)
    }

    /// Scale and reference of the sensor.
    pub(crate) fn axis(&self) -> Result<Axis, Detail> {
        let refused = || Detail::not_positive("units_per_count", self.units_per_count);
        let scale = Scale::new(self.units_per_count).ok_or_else(refused)?;
        Ok(Axis {
            scale,
            reference: self.reference_code,
        })
    }

    /// The steps of the output.
    pub(crate) fn steps(&self) -> Result<f32, Detail> {
        // Beyond, f32 has no halves of a step.
        const MOST: u32 = 1 << 22;
        let steps = self.command_steps as f32;
        if self.command_steps > MOST {
            return Err(Detail::out_of_range(
                "command_steps",
                steps,
                [0.0, MOST as f32],
            ));
        }
        Ok(steps)
    }
}
