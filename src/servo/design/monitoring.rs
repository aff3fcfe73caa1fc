//! Design of the fault monitors, the part that needs no model.

use crate::servo::config::Config;
use crate::servo::design::Clock;
use crate::servo::design::MonitoringDesign;
use crate::servo::design::constants as c;

impl Config {
    /// The resolution is that of a sensor, see [`MonitoringDesign::with_resolution`].
    pub(crate) fn monitoring(&self, clock: Clock, tracking_rate: f32) -> MonitoringDesign {
        let length = self.travel.length();
        let noise = self.noise_beside(0.0);
        let fastest = self.bandwidth.unwrap_or(c::BANDWIDTH_MAX);
        MonitoringDesign {
            sample_time: self.sample_time,
            delay: self.delay,
            delay_samples: clock.delay(self.delay),
            travel: self.travel,
            noise,
            resolution: 0.0,
            grain: 8.0 * noise,
            error: self.error_deadband(),
            acceleration: c::FIRST_ACCELERATION_RATIO * length * fastest * fastest,
            tracking_lag: 0.27 / (tracking_rate * tracking_rate),
            jump: clock.samples(c::JUMP_TIME),
            residual_share: clock.share(1.0 / c::RESIDUAL_TIME),
            gap_share: clock.share(1.0 / c::GAP_TIME),
            many_codes: 16.0 * noise,
            least_run: clock.samples(c::LEAST_RUN_TIME),
            cycle: 8.0 * noise + 2.0 * self.controller.rest_window.unwrap_or(0.0),
            cycle_pause: clock.samples(c::CYCLE_PAUSE),
            cycle_settling: clock.samples(c::CYCLE_SETTLING),
            full: c::FULL_COMMAND * self.range,
        }
    }
}

impl MonitoringDesign {
    /// The same for a sensor whose codes are so far apart.
    pub(crate) fn with_resolution(mut self, resolution: f32) -> Self {
        self.resolution = resolution;
        self.grain += 2.0 * resolution;
        self.many_codes += 10.0 * resolution;
        self.cycle += 2.0 * resolution;
        self
    }
}
