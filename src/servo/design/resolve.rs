//! From settings to numbers: checks, defaults, samples.

use crate::servo::config::Config;
use crate::servo::design::constants as c;
use crate::servo::design::{
    ChangeDesign, ControllerDesign, Design, ExcitationDesign, IdentificationDesign, LimiterDesign,
    MonitorDesign, ObserverDesign, ScreeningDesign, StandstillDesign, StickSlipDesign,
    SupervisionDesign, ValidationDesign,
};
use crate::servo::error::Error;
use crate::servo::motion::MotionLimits;

/// Turns seconds into samples and rates per s into steps per sample.
#[derive(Clone, Copy)]
struct Clock {
    sample_time: f32,
}

impl Clock {
    /// The nearest number of samples, at least one.
    fn samples(self, seconds: f32) -> u32 {
        let samples = (seconds / self.sample_time + 0.5) as u32;
        if samples > 0 { samples } else { 1 }
    }

    /// The whole samples that fit into a time.
    fn whole(self, seconds: f32) -> u32 {
        (seconds / self.sample_time) as u32
    }

    /// What a rate per s makes in a sample; by way of 1 ms, where it is exact.
    fn step(self, rate: f32) -> f32 {
        rate / 1000.0 * (self.sample_time / 1e-3)
    }

    /// The same as a share of a first-order lag, at most all of it.
    fn share(self, rate: f32) -> f32 {
        let step = self.step(rate);
        if step < 1.0 { step } else { 1.0 }
    }
}

impl Config {
    /// Checks every setting and computes what follows from it. Cost: some 300 instructions, not for the 1 ms path.
    ///
    /// # Errors
    /// An [`Error`] that names the setting. The settings of the identifier are checked when the loop is built.
    pub fn resolve(&self) -> Result<Design, Error> {
        self.check()?;
        let clock = Clock {
            sample_time: self.sample_time,
        };
        let length = self.travel.length();
        let excitation = self.excitation(clock)?;
        Ok(Design {
            sample_time: self.sample_time,
            travel: self.travel,
            adaptive: self.adaptive,
            motion: self.motion_limits()?,
            run_out_rate: c::RUN_OUT_RATIO * self.bandwidth,
            tracking_rate: c::TRACKING_RATIO * self.bandwidth,
            sensor_errors: clock.samples(c::SENSOR_ERROR_TIME),
            identification: IdentificationDesign {
                bandwidth: self.bandwidth,
                trends_rate: c::TRENDS_RATIO * self.bandwidth,
                input_range: self.excitation.amplitude,
                output_range: c::OUTPUT_RANGE_RATIO * length,
                output_noise: self.noise.unwrap_or(c::NOISE_RATIO * length),
                memory: self.memory,
                information_floor: self.information_floor,
                delay: (self.delay / self.sample_time + 0.5) as usize,
                friction_velocity: c::FRICTION_VELOCITY_RATIO * self.min_speed(),
                settled: (c::SETTLED_RATIO / (self.bandwidth * self.sample_time)) as u32,
            },
            limiter: LimiterDesign {
                range: self.range,
                step: self.rate * self.sample_time,
            },
            controller: self.controller(clock)?,
            excitation,
            monitor: MonitorDesign {
                share: self.sample_time / c::MONITOR_TIME,
                min_power: self.min_excitation * self.min_excitation,
            },
            supervision: self.supervision(clock)?,
        })
    }

    /// What belongs to no part alone.
    fn check(&self) -> Result<(), Error> {
        Error::unless_positive("sample_time", self.sample_time)?;
        Error::unless_positive("bandwidth", self.bandwidth)?;
        self.travel.check()?;
        let acceleration = self.bandwidth * self.bandwidth * self.travel.length();
        if acceleration > c::ACCELERATION_MAX {
            return Err(Error::Unit { acceleration });
        }
        Error::unless_positive("range", self.range)?;
        Error::unless_within("range", self.range, 0.0, 1.0)?;
        Error::unless_positive("rate", self.rate)?;
        let delay_max = c::DELAY_MAX as f32 * self.sample_time;
        Error::unless_within("delay", self.delay, 0.0, delay_max)?;
        Error::unless_within("min_excitation", self.min_excitation, 0.0, 1.0)
    }

    fn motion_limits(&self) -> Result<MotionLimits, Error> {
        let (length, w) = (self.travel.length(), self.bandwidth);
        let limits = self.motion.unwrap_or(MotionLimits {
            velocity: c::VELOCITY_RATIO * length,
            acceleration: c::ACCELERATION_RATIO * length * w * w,
            jerk: c::ACCELERATION_RATIO * length * w * w * w,
        });
        Error::unless_positive("motion.velocity", limits.velocity)?;
        Error::unless_positive("motion.acceleration", limits.acceleration)?;
        Error::unless_positive("motion.jerk", limits.jerk)?;
        Ok(limits)
    }

    /// Velocity below which the axis does not count as moving.
    fn min_speed(&self) -> f32 {
        let settings = &self.supervision;
        settings
            .min_speed
            .unwrap_or(c::SPEED_MIN_RATIO * self.travel.length())
    }

    fn controller(&self, clock: Clock) -> Result<ControllerDesign, Error> {
        let (settings, length) = (&self.controller, self.travel.length());
        let w = settings
            .bandwidth
            .unwrap_or(c::CONTROLLER_RATIO * self.bandwidth);
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

    fn friction(&self, clock: Clock, breakaway_distance: f32) -> StickSlipDesign {
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

    fn excitation(&self, clock: Clock) -> Result<ExcitationDesign, Error> {
        let (settings, w) = (&self.excitation, self.bandwidth);
        let amplitude = settings.amplitude;
        Error::unless_positive("excitation.amplitude", amplitude)?;
        Error::unless_within("excitation.amplitude", amplitude, 0.0, 1.0)?;
        let hold = settings.hold.unwrap_or(c::HOLD_RATIO / w);
        Error::unless_positive("excitation.hold", hold)?;
        Error::unless_within("excitation.hold", hold, 0.0, 1e6 * self.sample_time)?;
        let stroke = settings
            .stroke
            .unwrap_or(c::STROKE_RATIO * self.travel.length());
        Error::unless_positive("excitation.stroke", stroke)?;
        let stopping_time = settings.stopping_time.unwrap_or(c::STOPPING_RATIO / w);
        Error::unless_positive("excitation.stopping_time", stopping_time)?;
        Ok(ExcitationDesign {
            amplitude,
            hold: clock.whole(hold),
            stroke,
            stopping_time,
            travel: self.travel,
            runaway: clock.samples(c::RUNAWAY_TIME),
        })
    }

    fn supervision(&self, clock: Clock) -> Result<SupervisionDesign, Error> {
        let (settings, length) = (&self.supervision, self.travel.length());
        let min_travel = settings.min_travel.unwrap_or(c::TRAVEL_MIN_RATIO * length);
        let deadband = settings
            .error_deadband
            .unwrap_or(c::ERROR_DEADBAND_RATIO * length);
        for (name, value) in [
            ("supervision.min_r_squared", settings.min_r_squared),
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
        let excite = count("supervision.excite_time", settings.excite_time)?;
        Ok(SupervisionDesign {
            screening: self.screening()?,
            validation: ValidationDesign {
                observer: self.validation_observer(clock),
                observe: clock.whole(c::VALIDATION_OBSERVE_RATIO / self.bandwidth),
                window: count("supervision.validation_time", settings.validation_time)?,
            },
            change: ChangeDesign {
                fast_share: self.sample_time / c::INNOVATION_FAST_TIME,
                slow_share: self.sample_time / c::INNOVATION_SLOW_TIME,
                alarm_ratio: settings.alarm_ratio,
                pause: excite,
            },
            min_r_squared: settings.min_r_squared,
            min_r_squared_adapting: settings.min_r_squared_adapting,
            replace_ratio: settings.replace_ratio,
            min_improvement: settings.min_improvement,
            min_speed: self.min_speed(),
            min_travel,
            error_deadband: deadband,
            peak_error_leak: self.sample_time / c::PEAK_ERROR_TIME,
            look: clock.samples(c::LOOK_TIME),
            rejection: clock.samples(c::REJECTION_TIME),
            stuck: clock.samples(c::STUCK_TIME),
            still: clock.samples(c::STILL_TIME),
            excite,
            limit: count("supervision.time_limit", settings.time_limit)?,
        })
    }

    fn screening(&self) -> Result<ScreeningDesign, Error> {
        let settings = &self.supervision;
        let max_gain = settings
            .max_gain
            .unwrap_or(c::GAIN_MAX_RATIO * self.travel.length());
        let (std, adapting) = (
            settings.max_relative_std,
            settings.max_relative_std_adapting,
        );
        Error::unless_positive("supervision.frequency_factor", settings.frequency_factor)?;
        Error::unless_positive("supervision.max_gain", max_gain)?;
        Error::unless_positive("supervision.max_relative_std", std)?;
        Error::unless_positive("supervision.max_relative_std_adapting", adapting)?;
        Ok(ScreeningDesign {
            frequency_squared: self.bandwidth * self.bandwidth,
            factor_squared: settings.frequency_factor * settings.frequency_factor,
            max_gain,
            max_variance: std * std,
            max_variance_adapting: adapting * adapting,
        })
    }

    /// An observer of the motion alone: what remains is the error of the model.
    fn validation_observer(&self, clock: Clock) -> ObserverDesign {
        let rate = c::VALIDATION_OBSERVER_RATIO * self.bandwidth;
        ObserverDesign {
            rate,
            sample_time: self.sample_time,
            disturbed: false,
            disturbance_leak: c::DISTURBANCE_LEAK_RATIO * rate * self.sample_time,
            stiction_velocity: 0.0,
            friction: self.friction(clock, f32::INFINITY),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::motion::Travel;

    const TRAVEL: Travel = Travel {
        min: 0.0,
        max: 400.0,
    };

    #[test]
    fn at_1_khz_the_times_are_these_samples() -> Result<(), Error> {
        let design = Config::new(1e-3, 25.0, TRAVEL).resolve()?;
        let (friction, standstill) = (
            design.controller.observer.friction,
            design.controller.standstill,
        );
        assert_eq!((friction.finding, friction.false_start), (6, 25));
        let shares = [
            friction.mean_share,
            friction.finding_share,
            friction.drift_share,
        ];
        assert_eq!(shares, [0.2, 0.3, 0.02]);
        assert_eq!(
            (
                standstill.rest,
                standstill.push_haste,
                standstill.ramp_haste
            ),
            (10, 0.002, 0.03)
        );
        assert_eq!(design.controller.transition_step, 0.005);
        let s = &design.supervision;
        assert_eq!((s.look, s.rejection, s.stuck, s.still), (16, 64, 150, 200));
        assert_eq!((design.excitation.runaway, design.sensor_errors), (100, 3));
        assert_eq!(design.identification.delay, 2);
        Ok(())
    }

    #[test]
    fn at_2_khz_a_time_is_twice_as_many_samples_and_a_rate_half_as_much() -> Result<(), Error> {
        let slow = Config::new(1e-3, 25.0, TRAVEL).resolve()?;
        let fast = Config::new(5e-4, 25.0, TRAVEL).resolve()?;
        let (a, b) = (&slow.supervision, &fast.supervision);
        for (a, b) in [
            (a.look, b.look),
            (a.rejection, b.rejection),
            (a.stuck, b.stuck),
            (a.still, b.still),
            (slow.excitation.runaway, fast.excitation.runaway),
            (slow.sensor_errors, fast.sensor_errors),
            (
                slow.controller.standstill.rest,
                fast.controller.standstill.rest,
            ),
        ] {
            assert_eq!(2 * a, b);
        }
        let (a, b) = (&slow.controller, &fast.controller);
        assert_eq!(a.transition_step, 2.0 * b.transition_step);
        let (a, b) = (a.observer.friction, b.observer.friction);
        assert_eq!(a.mean_share, 2.0 * b.mean_share);
        assert_eq!(2 * a.false_start, b.false_start);
        assert_eq!(fast.identification.delay, 4);
        Ok(())
    }

    #[test]
    fn what_follows_from_a_setting_follows_a_change_of_it() -> Result<(), Error> {
        let other = Travel {
            min: -10.0,
            max: 150.0,
        };
        let mut changed = Config::new(1e-3, 25.0, TRAVEL);
        changed.sample_time = 5e-4;
        changed.bandwidth = 15.0;
        changed.travel = other;
        let fresh = Config::new(5e-4, 15.0, other);
        assert_eq!(changed.resolve()?, fresh.resolve()?);
        Ok(())
    }
}
