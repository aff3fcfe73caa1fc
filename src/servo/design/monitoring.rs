//! Design of the fault monitors, the part that needs no model.

use crate::servo::config::Config;
use crate::servo::design::Clock;
use crate::servo::design::MonitoringDesign;
use crate::servo::design::constants as c;

/// Deviations of the noise, and codes, by which two readings may differ without a motion between
/// them; the same of one that moves by many codes.
const GRAIN: [f32; 2] = [8.0, 2.0];
const MANY: [f32; 2] = [16.0, 10.0];

/// Lag of the filter of the measured positions over its rate, squared: behind a step of the
/// acceleration three equal poles p are off by `t^2/2 e^(-p t)`, at most `2 e^-2 / p^2`.
const LAG: f32 = 0.27;

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
            grain: GRAIN[0] * noise,
            error: self.error_deadband(),
            acceleration: c::FIRST_ACCELERATION_RATIO * length * fastest * fastest,
            tracking_lag: LAG / (tracking_rate * tracking_rate),
            jump: clock.samples(c::JUMP_TIME),
            residual_share: clock.share(1.0 / c::RESIDUAL_TIME),
            gap_share: clock.share(1.0 / c::GAP_TIME),
            many_codes: MANY[0] * noise,
            least_run: clock.samples(c::LEAST_RUN_TIME),
            cycle: GRAIN[0] * noise + 2.0 * self.controller.rest_window.unwrap_or(0.0),
            cycle_pause: clock.samples(c::CYCLE_PAUSE),
            cycle_settling: clock.samples(c::CYCLE_SETTLING),
            full: c::FULL_COMMAND * self.range,
            imbalance: self.controller.imbalance,
        }
    }
}

impl MonitoringDesign {
    /// The same for a sensor whose codes are so far apart.
    pub(crate) fn with_resolution(mut self, resolution: f32) -> Self {
        self.resolution = resolution;
        self.grain += GRAIN[1] * resolution;
        self.many_codes += MANY[1] * resolution;
        self.cycle += GRAIN[1] * resolution;
        self
    }
}
