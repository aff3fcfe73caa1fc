//! From settings to numbers: checks, defaults, samples.

use crate::identifier::config::NOISE;
use crate::math::larger;
use crate::servo::config::Config;
use crate::servo::design::Clock;
use crate::servo::design::constants as c;
use crate::servo::design::constants::DELAY_MAX;
use crate::servo::design::{Design, IdentificationDesign, LimiterDesign, MonitorDesign};
use crate::servo::error::Error;
use crate::servo::motion::MotionLimits;

impl Config {
    /// Checks every setting and computes the design. Cost: some 300 instructions, not for the 1 ms
    /// path.
    ///
    /// # Errors
    /// An [`Error`] that names the setting. The settings of the identifier are checked when the
    /// loop is built.
    pub fn resolve(&self) -> Result<Design, Error> {
        self.check()?;
        let clock = Clock {
            sample_time: self.sample_time,
        };
        let length = self.travel.length();
        self.check_excitation()?;
        let w = self.rough_bandwidth();
        let tracking_rate = (c::TRACKING_RATIO * w).min(c::TRACKING_STEP_MAX / self.sample_time);
        Ok(Design {
            sample_time: self.sample_time,
            travel: self.travel,
            motion: self.motion_limits(w)?,
            run_out_rate: c::RUN_OUT_RATIO * w,
            tracking_rate,
            sensor_errors: clock.samples(c::SENSOR_ERROR_TIME),
            identification: IdentificationDesign {
                bandwidth: self.rough_bandwidth(),
                trends_rate: c::TRENDS_RATIO * self.rough_bandwidth(),
                input_range: self.excitation.amplitude,
                output_range: c::OUTPUT_RANGE_RATIO * length,
                output_noise: self.noise_beside(0.0),
                memory: self.memory,
                settled: (c::SETTLED_RATIO / (c::TRENDS_RATIO * w * self.sample_time)) as u32,
            },
            limiter: LimiterDesign {
                range: self.range,
                step: self.rate * self.sample_time,
            },
            controller: self.controller(clock)?,
            monitor: MonitorDesign {
                share: self.sample_time / c::MONITOR_TIME,
                min_power: self.min_excitation * self.min_excitation,
            },
            supervision: self.supervision(clock)?,
            monitoring: self.monitoring(clock, tracking_rate),
        })
    }

    /// The part of the design that several parts share.
    fn check(&self) -> Result<(), Error> {
        Error::unless_positive("sample_time", self.sample_time)?;
        if let Some(bandwidth) = self.bandwidth {
            Error::unless_positive("bandwidth", bandwidth)?;
        }
        self.travel.check()?;
        let acceleration = self.rough_bandwidth() * self.rough_bandwidth() * self.travel.length();
        if acceleration > c::ACCELERATION_MAX {
            return Err(Error::Unit {
                acceleration,
                limit: c::ACCELERATION_MAX,
            });
        }
        Error::unless_positive("range", self.range)?;
        Error::unless_within("range", self.range, 0.0, 1.0)?;
        Error::unless_positive("rate", self.rate)?;
        if let Some(noise) = self.noise {
            let range = c::OUTPUT_RANGE_RATIO * self.travel.length();
            let [least, most] = NOISE.map(|share| share * range);
            Error::unless_within("noise", noise, least, most)?;
        }
        Error::unless_positive("memory", self.memory)?;
        let delay_max = DELAY_MAX as f32 * self.sample_time;
        Error::unless_within("delay", self.delay, 0.0, delay_max)?;
        Error::unless_within("min_excitation", self.min_excitation, 0.0, 1.0)
    }

    /// Limits of motion: stated, or those of an axis of the bandwidth `w` (rad/s).
    pub(crate) fn motion_limits(&self, w: f32) -> Result<MotionLimits, Error> {
        let length = self.travel.length();
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

    /// Standard deviation of the position noise: stated, or `found`, 0 where it was not; what is
    /// taken for it until then. No less than the identifier resolves.
    pub(crate) fn noise_beside(&self, found: f32) -> f32 {
        let length = self.travel.length();
        let [least, _] = NOISE.map(|share| share * (c::OUTPUT_RANGE_RATIO * length));
        self.noise.unwrap_or(match found > 0.0 {
            true => larger(found, least),
            false => c::NOISE_RATIO * length,
        })
    }

    /// Tracking error that the user tolerates.
    pub(crate) fn error_deadband(&self) -> f32 {
        let least = c::ERROR_DEADBAND_RATIO * self.travel.length();
        self.supervision.error_deadband.unwrap_or(least)
    }

    /// Movement within the time of excitation below which there is none.
    pub(crate) fn min_travel(&self) -> f32 {
        let least = c::TRAVEL_MIN_RATIO * self.travel.length();
        self.supervision.min_travel.unwrap_or(least)
    }

    /// Velocity below which the axis does not count as moving.
    pub(crate) fn min_speed(&self) -> f32 {
        let settings = &self.supervision;
        settings
            .min_speed
            .unwrap_or(c::SPEED_MIN_RATIO * self.travel.length())
    }

    /// Velocity with which the axis has not moved: less than what counts within the time of
    /// excitation.
    pub(crate) fn creep(&self) -> f32 {
        self.min_travel() / self.supervision.excite_time
    }

    fn check_excitation(&self) -> Result<(), Error> {
        let amplitude = self.excitation.amplitude;
        Error::unless_positive("excitation.amplitude", amplitude)?;
        Error::unless_within("excitation.amplitude", amplitude, 0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::string::ToString;

    use super::*;
    use crate::servo::motion::Travel;

    const TRAVEL: Travel = Travel {
        min: 0.0,
        max: 400.0,
    };

    #[test]
    fn at_1_khz_the_times_are_these_samples() -> Result<(), Error> {
        let design = Config::new(1e-3, 25.0, TRAVEL).resolve()?;
        assert_eq!(design.controller.transition_step, 0.05);
        let s = &design.supervision;
        assert_eq!((s.look, s.rejection, s.still), (16, 64, 200));
        assert_eq!(design.sensor_errors, 3);
        assert_eq!(design.controller.estimator.delay, 2);
        Ok(())
    }

    #[test]
    fn an_axis_of_which_nothing_else_is_known_may_be_sampled_at_any_rate() {
        for sample_time in [2e-5, 5e-5, 1e-4, 2.5e-4, 5e-4, 1e-3, 2e-3, 5e-3] {
            for length in [0.4, 10.0, 100.0, 400.0, 1000.0, 6000.0] {
                let travel = Travel {
                    min: 0.0,
                    max: length,
                };
                let config = Config::minimal(sample_time, travel);
                assert!(config.resolve().is_ok(), "{sample_time} {length}");
                // Up to 2 kHz 300 samples in a period, beyond as at 2 kHz.
                let samples = config.rough_bandwidth() * sample_time;
                let wanted = if sample_time < 5e-4 {
                    40.0 * sample_time
                } else {
                    0.02
                };
                assert!((samples / wanted - 1.0).abs() < 1e-5, "{sample_time}");
            }
        }
    }

    #[test]
    fn at_2_khz_a_time_is_twice_as_many_samples_and_a_rate_half_as_much() -> Result<(), Error> {
        let slow = Config::new(1e-3, 25.0, TRAVEL).resolve()?;
        let fast = Config::new(5e-4, 25.0, TRAVEL).resolve()?;
        let (a, b) = (&slow.supervision, &fast.supervision);
        for (a, b) in [
            (a.look, b.look),
            (a.rejection, b.rejection),
            (a.still, b.still),
            (slow.sensor_errors, fast.sensor_errors),
        ] {
            assert_eq!(2 * a, b);
        }
        let (a, b) = (&slow.controller, &fast.controller);
        assert_eq!(a.transition_step, 2.0 * b.transition_step);
        assert_eq!(2 * a.estimator.delay, b.estimator.delay);
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
        changed.bandwidth = Some(15.0);
        changed.travel = other;
        let fresh = Config::new(5e-4, 15.0, other);
        assert_eq!(changed.resolve()?, fresh.resolve()?);
        Ok(())
    }

    #[test]
    fn a_delay_is_as_long_as_the_commands_that_are_remembered() {
        let resolved = |samples: f32| {
            let mut config = Config::new(1e-3, 25.0, TRAVEL);
            config.delay = 1e-3 * samples;
            config.resolve().is_ok()
        };
        let most = DELAY_MAX as f32;
        assert!(resolved(0.0) && resolved(most));
        assert!(!resolved(most + 0.5) && !resolved(-0.5));
    }

    #[test]
    fn noise_is_what_was_stated_or_found_and_no_less_than_is_resolved() {
        let mut config = Config::new(1e-3, 25.0, TRAVEL);
        for (found, noise) in [
            (0.0, 400.0 * c::NOISE_RATIO),
            (3e-3, 3e-3),
            (1e-9, 40.0 * 1e-7),
        ] {
            let error = config.noise_beside(found) / noise - 1.0;
            assert!(error.abs() < 1e-6, "{found}");
        }
        for (stated, accepted) in [(2e-4, true), (1e-9, false), (1e3, false), (f32::NAN, false)] {
            config.noise = Some(stated);
            let resolved = config.resolve();
            assert_eq!(resolved.is_ok(), accepted, "{stated}");
            if let Err(Error::Setting(error)) = resolved {
                assert!(error.to_string().starts_with("noise"), "{error}");
            }
        }
    }

    #[test]
    fn an_amplitude_is_more_than_nothing_and_at_most_the_full_command() {
        let resolved = |amplitude: f32| {
            let mut config = Config::new(1e-3, 25.0, TRAVEL);
            config.excitation.amplitude = amplitude;
            config.resolve()
        };
        for amplitude in [0.01, 1.0] {
            assert!(resolved(amplitude).is_ok(), "{amplitude}");
        }
        for amplitude in [0.0, -0.5, 1.01, f32::NAN] {
            let refused = matches!(
                resolved(amplitude),
                Err(Error::Setting(error)) if error.to_string().starts_with("excitation.amplitude")
            );
            assert!(refused, "{amplitude}");
        }
    }

    #[test]
    fn trends_are_settled_when_a_tenth_of_what_they_held_is_left() -> Result<(), Error> {
        for (sample_time, w) in [(1e-3, 25.0), (5e-4, 25.0), (1e-3, 10.0)] {
            let design = Config::new(sample_time, w, TRAVEL)
                .resolve()?
                .identification;
            // Three equal poles, so many of their time constants later.
            let x = design.settled as f32 * sample_time * design.trends_rate;
            let left = libm::expf(-x) * (1.0 + x + 0.5 * x * x);
            assert!((left - 0.1).abs() < 0.01, "{sample_time} {w}: {left}");
        }
        Ok(())
    }
}
