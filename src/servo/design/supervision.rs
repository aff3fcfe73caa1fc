//! Design of the supervisor, its screening and its validation.

use crate::servo::config::Config;
use crate::servo::design::Clock;
use crate::servo::design::constants as c;
use crate::servo::design::{
    ChangeDesign, ObserverDesign, ScreeningDesign, SupervisionDesign, ValidationDesign,
};
use crate::servo::error::Error;

/// Root mean square of a ramp over its end.
const ROOT_THIRD: f32 = 0.577;

impl SupervisionDesign {
    /// The same for a sensor whose codes are so far apart.
    ///
    /// An observer finds the velocity within the time of its rate: of a position that is wrong by a
    /// grain, one code and two standard deviations, it is wrong by `rate grain`, and the simulation
    /// that begins there drifts off at that velocity.
    pub(crate) fn with_resolution(mut self, resolution: f32) -> Self {
        self.drift += self.drift_ratio * resolution;
        self
    }
}

impl Config {
    pub(crate) fn supervision(&self, clock: Clock) -> Result<SupervisionDesign, Error> {
        let settings = &self.supervision;
        let (min_travel, deadband) = (self.min_travel(), self.error_deadband());
        let window = settings
            .validation_time
            .unwrap_or(c::VALIDATION_TIME_RATIO / self.rough_bandwidth());
        for (name, value) in [
            (
                "supervision.min_r_squared_adapting",
                settings.min_r_squared_adapting,
            ),
            ("supervision.replace_ratio", settings.replace_ratio),
            ("supervision.min_improvement", settings.min_improvement),
            ("supervision.min_speed", self.min_speed()),
            ("supervision.min_travel", min_travel),
            ("supervision.error_deadband", deadband),
            ("supervision.alarm_ratio", settings.alarm_ratio),
        ] {
            Error::unless_positive(name, value)?;
        }
        let count = |name, seconds: f32| {
            Error::unless_positive(name, seconds)?;
            Error::unless_within(name, seconds, 0.0, 1e5)?;
            Ok::<u32, Error>(clock.whole(seconds))
        };
        count("supervision.time_limit", settings.time_limit)?;
        let excite = count("supervision.excite_time", settings.excite_time)?;
        let observer = self.validation_observer();
        let drift_ratio = observer.rate * window * ROOT_THIRD;
        Ok(SupervisionDesign {
            screening: self.screening()?,
            validation: ValidationDesign {
                observer,
                observe: clock.whole(c::SETTLING_RATIO / observer.rate),
                window: count("supervision.validation_time", window)?,
            },
            change: self.change(excite),
            min_r_squared_adapting: settings.min_r_squared_adapting,
            replace_ratio: settings.replace_ratio,
            min_improvement: settings.min_improvement,
            min_speed: self.min_speed(),
            min_travel,
            drift: drift_ratio * 2.0 * self.noise_beside(0.0),
            drift_ratio,
            error_deadband: deadband,
            error_least: match settings.error_deadband {
                Some(stated) => stated,
                None => c::ERROR_LEAST_RATIO * deadband,
            },
            lag: c::LAG_RATIO / self.rough_bandwidth(),
            peak_error_leak: self.sample_time / c::PEAK_ERROR_TIME,
            look: clock.samples(c::LOOK_TIME),
            rejection: clock.samples(c::REJECTION_TIME),
            still: clock.samples(c::STILL_TIME),
            excite,
        })
    }

    const fn change(&self, pause: u32) -> ChangeDesign {
        ChangeDesign {
            fast_share: self.sample_time / c::INNOVATION_FAST_TIME,
            slow_share: self.sample_time / c::INNOVATION_SLOW_TIME,
            alarm_ratio: self.supervision.alarm_ratio,
            pause,
        }
    }

    fn screening(&self) -> Result<ScreeningDesign, Error> {
        let settings = &self.supervision;
        let max_gain = settings
            .max_gain
            .unwrap_or(c::GAIN_MAX_RATIO * self.travel.length());
        let adapting = settings.max_relative_std_adapting;
        Error::unless_positive("supervision.frequency_factor", settings.frequency_factor)?;
        Error::unless_positive("supervision.max_gain", max_gain)?;
        Error::unless_positive("supervision.max_relative_std_adapting", adapting)?;
        Ok(ScreeningDesign {
            frequency_squared: self.rough_bandwidth() * self.rough_bandwidth(),
            factor_squared: settings.frequency_factor * settings.frequency_factor,
            max_gain,
            min_gain: self.min_speed(),
            max_variance_adapting: adapting * adapting,
        })
    }

    /// An observer of the motion alone: what remains is the error of the model.
    fn validation_observer(&self) -> ObserverDesign {
        let rate = c::VALIDATION_OBSERVER_RATIO * self.rough_bandwidth();
        let rate = rate.min(c::VALIDATION_STEP_MAX / self.sample_time);
        ObserverDesign {
            rate,
            sample_time: self.sample_time,
        }
    }
}
