//! Everything that the position loop must be told.

use crate::servo::control::controller::ControllerConfig;
use crate::servo::motion::{MotionLimits, Travel};
use crate::servo::supervision::config::SupervisorConfig;
use crate::servo::supervision::excitation::ExcitationConfig;

/// Everything the user says about an axis.
///
/// # Examples
/// ```
/// use trendid::{LoopConfig, Travel};
/// let mut config = LoopConfig::new(20.0, Travel { begin: 0.0, end: 400.0 });
/// config.controller.bandwidth = 30.0;
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopConfig {
    /// Sample time in s.
    pub sample_time: f32,
    /// Travel of the axis.
    pub travel: Travel,
    /// Rough bandwidth of the plant in rad/s.
    pub bandwidth: f32,
    /// Standard deviation of the position noise.
    pub noise: f32,
    /// Largest command, within 0..=1.
    pub range: f32,
    /// Largest rate of the command per s.
    pub rate: f32,
    /// Delay of the valve in samples, at most 8.
    pub delay: usize,
    /// Memory of the identifier in s.
    pub memory: f32,
    /// Pull of the identifier toward the verified model; weaker than that of [`Config`](crate::Config), or a tripled mass is followed too late.
    pub pull: f32,
    /// Least standard deviation of the fast part of the command with which the model follows the drive.
    pub rich: f32,
    /// Whether the model follows the drive after the commissioning.
    pub adaptive: bool,
    /// Limits of moves.
    pub motion: MotionLimits,
    /// Wanted dynamics.
    pub controller: ControllerConfig,
    /// The commissioning.
    pub excitation: ExcitationConfig,
    /// What a model must satisfy.
    pub supervisor: SupervisorConfig,
}

impl LoopConfig {
    /// The defaults at 1 kHz for a plant of a rough `bandwidth` (rad/s) on a `travel`.
    pub fn new(bandwidth: f32, travel: Travel) -> Self {
        let length = travel.length();
        let excitation = ExcitationConfig::new(bandwidth, travel);
        Self {
            sample_time: 1e-3,
            travel,
            bandwidth,
            noise: 2.5e-5 * length,
            range: 1.0,
            rate: 400.0,
            delay: 2,
            memory: 1.5,
            pull: 1e-5,
            rich: 0.1,
            adaptive: true,
            motion: MotionLimits {
                velocity: 2.0 * length,
                acceleration: 0.04 * length * bandwidth * bandwidth,
                jerk: 0.04 * length * bandwidth * bandwidth * bandwidth,
            },
            controller: ControllerConfig {
                rest_window: 1.15e-4 * length,
                start: 4e-5 * length,
                catch_up: 0.08 * length,
                slow: 0.14 * length,
                ..ControllerConfig::new(2.5 * bandwidth)
            },
            excitation,
            supervisor: SupervisorConfig {
                time_limit: excitation.time_limit,
                ..SupervisorConfig::new(bandwidth, length)
            },
        }
    }
}
