//! Every number that follows from the settings, computed once, in seconds, and turned into samples
//! here.

mod clock;
pub(crate) mod constants;
mod control;
mod monitoring;
mod resolve;
mod supervision;

pub(crate) use clock::Clock;

use crate::servo::motion::{MotionLimits, Travel};

/// The settings after [`Config::resolve`](crate::servo::Config::resolve): checked, in samples,
/// ready to run.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    pub(crate) sample_time: f32,
    pub(crate) travel: Travel,
    pub(crate) motion: MotionLimits,
    /// Poles in rad/s of a motion that runs out, and of the alpha-beta-gamma filter.
    pub(crate) run_out_rate: f32,
    pub(crate) tracking_rate: f32,
    /// Consecutive sensor errors that stop the axis.
    pub(crate) sensor_errors: u32,
    pub(crate) identification: IdentificationDesign,
    pub(crate) limiter: LimiterDesign,
    pub(crate) controller: ControllerDesign,
    pub(crate) monitor: MonitorDesign,
    pub(crate) supervision: SupervisionDesign,
    pub(crate) monitoring: MonitoringDesign,
}

/// Numbers of the identifier.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct IdentificationDesign {
    pub(crate) bandwidth: f32,
    /// Poles of the trends in rad/s.
    pub(crate) trends_rate: f32,
    pub(crate) input_range: f32,
    pub(crate) output_range: f32,
    pub(crate) output_noise: f32,
    pub(crate) memory: f32,
    /// Samples after a breakaway in which the filtered signals still contain friction.
    pub(crate) settled: u32,
}

/// Numbers of the limiter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LimiterDesign {
    pub(crate) range: f32,
    /// Largest change per sample.
    pub(crate) step: f32,
}

/// Numbers of the controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ControllerDesign {
    pub(crate) estimator: EstimatorDesign,
    pub(crate) anchor: AnchorDesign,
    pub(crate) tuning: TuningDesign,
    /// Least window at rest; what was stated, if it was.
    pub(crate) rest_window: f32,
    pub(crate) stated_window: Option<f32>,
    /// What noise and resolution make of a position: one code and two standard deviations.
    pub(crate) grain: f32,
    /// Delay in s that the controller predicts over.
    pub(crate) delay: f32,
    /// Flow within which the inverse of the dead zone changes sign.
    pub(crate) blend: f32,
    /// Share of the trace of a change of gains that fades per sample, and the most that may.
    pub(crate) fade: f32,
    pub(crate) transition_step: f32,
}

/// Numbers of the anchor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AnchorDesign {
    /// Distance from the anchor that is motion: resolution and 3 sigma.
    pub(crate) band: f32,
    /// Time in s within the band after which friction holds; 0 before the poles are known.
    pub(crate) time: f32,
    pub(crate) sample_time: f32,
}

/// Numbers of the estimator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EstimatorDesign {
    pub(crate) sample_time: f32,
    /// Delay in samples.
    pub(crate) delay: usize,
    pub(crate) travel: Travel,
    pub(crate) dead_volume: f32,
    pub(crate) imbalance: f32,
}

/// What a tuning needs to know.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TuningDesign {
    pub(crate) sample_time: f32,
    /// Delay that the controller predicts over, in s.
    pub(crate) delay: f32,
    pub(crate) dead_volume: f32,
    /// Standard deviation of the position, resolution included.
    pub(crate) noise: f32,
    /// Largest bandwidth that the user allows, in rad/s.
    pub(crate) bandwidth_max: f32,
}

/// Numbers of an observer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ObserverDesign {
    /// Three poles, in rad/s.
    pub(crate) rate: f32,
    pub(crate) sample_time: f32,
}

/// Numbers of the excitation monitor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MonitorDesign {
    /// Share of a new sample in the means.
    pub(crate) share: f32,
    /// Least variance of the fast part of the command.
    pub(crate) min_power: f32,
}

/// Numbers of the fault monitors that need no model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MonitoringDesign {
    pub(crate) sample_time: f32,
    /// Delay of the valve in s, and in samples.
    pub(crate) delay: f32,
    pub(crate) delay_samples: usize,
    pub(crate) travel: Travel,
    /// Standard deviation of the noise, and length of one code.
    pub(crate) noise: f32,
    pub(crate) resolution: f32,
    /// Effect of noise and resolution on a displacement.
    pub(crate) grain: f32,
    /// Tracking error that the user tolerates.
    pub(crate) error: f32,
    /// Acceleration that the drive can give while there is no model.
    pub(crate) acceleration: f32,
    /// Lag of the motion from measured positions, as position over acceleration, in s^2.
    pub(crate) tracking_lag: f32,
    /// Implausible readings in a row that are a jump.
    pub(crate) jump: u32,
    /// Shares of a new sample in the mean residual, and in the share of missing readings.
    pub(crate) residual_share: f32,
    pub(crate) gap_share: f32,
    /// Expected motion of many codes, and the least run of equal ones.
    pub(crate) many_codes: f32,
    pub(crate) least_run: u32,
    /// Half wave of an oscillation at rest, longest time between two reversals, time to come to
    /// rest, in samples.
    pub(crate) cycle: f32,
    pub(crate) cycle_pause: u32,
    pub(crate) cycle_settling: u32,
    /// Command from which on it is full.
    pub(crate) full: f32,
    /// Share by which the axis is slower upwards, and faster downwards.
    pub(crate) imbalance: f32,
}

/// Numbers of the supervisor.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SupervisionDesign {
    pub(crate) screening: ScreeningDesign,
    pub(crate) validation: ValidationDesign,
    pub(crate) change: ChangeDesign,
    pub(crate) min_r_squared_adapting: f32,
    pub(crate) replace_ratio: f32,
    pub(crate) min_improvement: f32,
    pub(crate) min_speed: f32,
    pub(crate) min_travel: f32,
    /// What a grain at its begin makes of a free simulation.
    pub(crate) drift: f32,
    /// That over a grain.
    pub(crate) drift_ratio: f32,
    pub(crate) error_deadband: f32,
    /// The same in a slow motion, and the time behind the reference that counts there, in s.
    pub(crate) error_least: f32,
    pub(crate) lag: f32,
    /// Share of the largest tracking error that is forgotten per sample.
    pub(crate) peak_error_leak: f32,
    /// Samples: between two candidates, after a rejected estimate, without motion, without another
    /// alarm.
    pub(crate) look: u32,
    pub(crate) rejection: u32,
    pub(crate) still: u32,
    pub(crate) excite: u32,
}

/// Bounds of a candidate that need no samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ScreeningDesign {
    /// Square of the rough bandwidth, and of the factor about it.
    pub(crate) frequency_squared: f32,
    pub(crate) factor_squared: f32,
    pub(crate) max_gain: f32,
    /// Velocity gain with which the full command just counts as motion.
    pub(crate) min_gain: f32,
    /// Largest relative variance of a candidate in control.
    pub(crate) max_variance_adapting: f32,
}

/// Numbers of a validation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ValidationDesign {
    pub(crate) observer: ObserverDesign,
    /// Samples to find the state, and of free simulation.
    pub(crate) observe: u32,
    pub(crate) window: u32,
}

/// Numbers of the change detection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ChangeDesign {
    /// Shares of a new sample in the recent variance, and in the usual one.
    pub(crate) fast_share: f32,
    pub(crate) slow_share: f32,
    pub(crate) alarm_ratio: f32,
    /// Samples after an alarm without another.
    pub(crate) pause: u32,
}

#[cfg(test)]
mod tests;
