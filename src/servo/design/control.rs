//! Design of the controller, its observer and the standstill.

use crate::servo::config::Config;
use crate::servo::design::clock::Clock;
use crate::servo::design::constants as c;
use crate::servo::design::{ControllerDesign, ObserverDesign, StandstillDesign, StickSlipDesign};
use crate::servo::error::Error;

impl Config {
    pub(crate) fn controller(&self, clock: Clock) -> Result<ControllerDesign, Error> {
        let (settings, length) = (&self.controller, self.travel.length());
        let w = settings
            .bandwidth
            .unwrap_or(c::CONTROLLER_RATIO * self.rough_bandwidth());
        let observer = self.observer(clock, w)?;
        let catch_up = settings.catch_up.unwrap_or(c::CATCH_UP_RATIO * length);
        Error::unless_positive("controller.damping", settings.damping)?;
        Error::unless_positive("controller.blend", settings.blend)?;
        Error::unless_positive("controller.transition", settings.transition)?;
        Error::unless_positive("controller.catch_up", catch_up)?;
        let ratio = settings.settling_bandwidth_ratio;
        Error::unless_positive("controller.settling_bandwidth_ratio", ratio)?;
        let lookahead = settings.reversal_lookahead;
        Error::unless_within("controller.reversal_lookahead", lookahead, 0.0, 1.0)?;
        Error::unless_within("controller.stribeck", settings.stribeck, 0.0, 100.0)?;
        let pair = 2.0 * settings.damping;
        let poles = |w: f32| [w * w * w, (1.0 + pair) * w * w, (1.0 + pair) * w];
        let slow = observer.stiction_velocity;
        Ok(ControllerDesign {
            wanted: poles(w),
            settling: poles(ratio * w),
            blend: settings.blend,
            catch_up,
            stribeck: settings.stribeck,
            stiction_velocity: slow,
            inverse_stiction_velocity: if slow > 0.0 { 1.0 / slow } else { 0.0 },
            reversal_lookahead: lookahead,
            fade: self.sample_time / settings.transition,
            transition_step: clock.step(c::TRANSITION_RATE_MAX),
            observer,
            standstill: self.standstill(clock)?,
        })
    }

    /// The observer of the controller, for a wanted bandwidth of `w`.
    fn observer(&self, clock: Clock, w: f32) -> Result<ObserverDesign, Error> {
        let (settings, length) = (&self.controller, self.travel.length());
        // A value that follows is refused by the name and in the size of the setting that it follows from.
        let (name, followed) = match settings.bandwidth {
            Some(_) => ("controller.bandwidth", 1.0),
            None => ("bandwidth", c::CONTROLLER_RATIO),
        };
        let per_sample = |limit: f32| limit / self.sample_time;
        let limit = per_sample(c::BANDWIDTH_STEP_MAX) / followed;
        Error::unless_positive(name, w / followed)?;
        Error::unless_within(name, w / followed, 0.0, limit)?;
        let (name, followed) = match settings.observer_rate {
            Some(_) => ("controller.observer_rate", 1.0),
            None => (name, followed * c::OBSERVER_RATIO),
        };
        let rate = settings.observer_rate.unwrap_or(c::OBSERVER_RATIO * w);
        let limit = per_sample(c::OBSERVER_STEP_MAX) / followed;
        Error::unless_positive(name, rate / followed)?;
        Error::unless_within(name, rate / followed, 0.0, limit)?;
        let distance = settings
            .breakaway_distance
            .unwrap_or(c::BREAKAWAY_DISTANCE_RATIO * length);
        Error::unless_positive("controller.breakaway_distance", distance)?;
        let slow = settings
            .stiction_velocity
            .unwrap_or(c::STICTION_VELOCITY_RATIO * length);
        Error::unless_within("controller.stiction_velocity", slow, 0.0, f32::MAX)?;
        Ok(ObserverDesign {
            rate,
            sample_time: self.sample_time,
            disturbed: true,
            disturbance_leak: c::DISTURBANCE_LEAK_RATIO * rate * self.sample_time,
            stiction_velocity: slow,
            friction: self.friction(clock, distance),
        })
    }

    pub(crate) fn friction(&self, clock: Clock, breakaway_distance: f32) -> StickSlipDesign {
        StickSlipDesign {
            sample_time: self.sample_time,
            breakaway_distance,
            finding: clock.samples(c::REST_FINDING_TIME),
            false_start: clock.samples(c::FALSE_START_TIME),
            mean_share: clock.share(c::REST_MEAN_RATE),
            finding_share: clock.share(c::REST_FINDING_RATE),
            drift_share: clock.share(c::REST_DRIFT_RATE),
        }
    }

    fn standstill(&self, clock: Clock) -> Result<StandstillDesign, Error> {
        let (settings, length) = (&self.controller, self.travel.length());
        let window = settings
            .rest_window
            .unwrap_or(c::REST_WINDOW_RATIO * length);
        Error::unless_within("controller.rest_window", window, 0.0, f32::MAX)?;
        let rate = settings.stick_rate;
        let limit = c::STICK_STEP_MAX / self.sample_time;
        Error::unless_positive("controller.stick_rate", rate)?;
        Error::unless_within("controller.stick_rate", rate, 0.0, limit)?;
        let ramp = settings.breakaway_ramp;
        Error::unless_within("controller.breakaway_ramp", ramp, 0.0, 1e3)?;
        Ok(StandstillDesign {
            rest_window: window,
            rest: clock.samples(c::REST_TIME),
            stick_rate: rate,
            push_growth: ramp * self.sample_time,
            push_haste: clock.step(c::PUSH_HASTE),
            ramp_haste: clock.step(c::STICTION_RAMP_GROWTH),
        })
    }
}
