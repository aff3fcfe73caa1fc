//! What the controller follows from.

use crate::servo::config::Config;
use crate::servo::design::Clock;
use crate::servo::design::constants as c;
use crate::servo::design::{AnchorDesign, ControllerDesign, EstimatorDesign, TuningDesign};
use crate::servo::error::Error;

/// Least dead volume over the stroke: at its end a cylinder is then 50 times as stiff as in the
/// middle.
const DEAD_VOLUME_MIN: f32 = 0.005;
/// Largest imbalance: three times as fast one way as the other.
const IMBALANCE_MAX: f32 = 0.5;
/// Dead volume of a usual cylinder.
const DEAD_VOLUME: f32 = 0.06;

impl Config {
    /// The resolution is that of a sensor, see [`ControllerDesign::with_resolution`].
    pub(crate) fn controller(&self, clock: Clock) -> Result<ControllerDesign, Error> {
        let settings = &self.controller;
        if let Some(bandwidth) = settings.bandwidth {
            Error::unless_positive("controller.bandwidth", bandwidth)?;
        }
        if let Some(window) = settings.rest_window {
            Error::unless_within("controller.rest_window", window, 0.0, f32::MAX)?;
        }
        Error::unless_positive("controller.blend", settings.blend)?;
        Error::unless_positive("controller.transition", settings.transition)?;
        let volume = settings.dead_volume.unwrap_or(DEAD_VOLUME);
        if volume != f32::INFINITY {
            Error::unless_within("controller.dead_volume", volume, DEAD_VOLUME_MIN, f32::MAX)?;
        }
        let imbalance = settings.imbalance;
        Error::unless_within(
            "controller.imbalance",
            imbalance,
            -IMBALANCE_MAX,
            IMBALANCE_MAX,
        )?;
        let delay = clock.delay(self.delay);
        let predicted = delay as f32 * self.sample_time;
        let design = ControllerDesign {
            estimator: EstimatorDesign {
                sample_time: self.sample_time,
                delay,
                travel: self.travel,
                dead_volume: volume,
                imbalance,
            },
            anchor: AnchorDesign {
                band: 0.0,
                time: 0.0,
                sample_time: self.sample_time,
            },
            tuning: TuningDesign {
                sample_time: self.sample_time,
                delay: predicted,
                dead_volume: volume,
                noise: self.noise_beside(0.0),
                bandwidth_max: settings.bandwidth.unwrap_or(f32::INFINITY),
            },
            rest_window: 0.0,
            stated_window: settings.rest_window,
            grain: 0.0,
            delay: predicted,
            blend: settings.blend,
            // All of it within a sample, and no more: a larger share would come back the other way.
            fade: (self.sample_time / settings.transition).min(1.0),
            transition_step: clock.step(c::TRANSITION_RATE_MAX),
        };
        Ok(design.with_resolution(0.0))
    }
}

impl ControllerDesign {
    /// The same for a sensor whose codes are so far apart.
    pub(crate) fn with_resolution(mut self, resolution: f32) -> Self {
        let noise = self.tuning.noise;
        self.grain = resolution + 2.0 * noise;
        self.anchor.band = resolution + 3.0 * noise;
        self.rest_window = self
            .stated_window
            .unwrap_or(c::REST_WINDOW_GRAINS * self.grain);
        self
    }
}
