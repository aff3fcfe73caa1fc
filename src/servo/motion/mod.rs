//! The requested motion: setpoints, profiles, and the filter that follows a measured motion.

pub(crate) mod alpha_beta_gamma;
pub(crate) mod brake;
pub(crate) mod ends;
pub(crate) mod followed;
pub(crate) mod profile;
pub(crate) mod returning;
pub(crate) mod run_out;
pub(crate) mod search;
pub(crate) mod segment;
pub(crate) mod sine;
pub(crate) mod trajectory;

use crate::servo::error::Error;

/// Position over that of the ends of the travel beyond which it is none.
const FARTHEST: f32 = 1e3;
/// Share of the travel by which an axis may stand beyond an end: what a soft stop or an overshoot
/// leaves.
const SOFT: f32 = 0.01;

/// Position and its first two derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Motion {
    /// Position, in the unit of y.
    pub position: f32,
    /// Velocity, in the unit of y per s.
    pub velocity: f32,
    /// Acceleration, in the unit of y per s^2.
    pub acceleration: f32,
}

impl Motion {
    /// A standstill at `position`.
    pub const fn at(position: f32) -> Self {
        Self {
            position,
            velocity: 0.0,
            acceleration: 0.0,
        }
    }

    /// The position `time` later under the same acceleration.
    pub(crate) fn after(&self, time: f32) -> f32 {
        self.position + time * (self.velocity + 0.5 * time * self.acceleration)
    }
}

/// The reference at one instant: position and its first three derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Setpoint {
    /// r.
    pub position: f32,
    /// r'.
    pub velocity: f32,
    /// r''.
    pub acceleration: f32,
    /// r''', in force until the next sample.
    pub jerk: f32,
}

impl Setpoint {
    /// A standstill at `position`.
    pub const fn at(position: f32) -> Self {
        Self {
            position,
            velocity: 0.0,
            acceleration: 0.0,
            jerk: 0.0,
        }
    }

    /// A point of a motion, with the jerk from here to the next sample.
    pub(crate) const fn of(motion: &Motion, jerk: f32) -> Self {
        Self {
            position: motion.position,
            velocity: motion.velocity,
            acceleration: motion.acceleration,
            jerk,
        }
    }

    /// The requested motion at this instant.
    pub const fn motion(&self) -> Motion {
        Motion {
            position: self.position,
            velocity: self.velocity,
            acceleration: self.acceleration,
        }
    }

    /// Whether the setpoint stands still.
    #[inline]
    pub fn is_rest(&self) -> bool {
        self.velocity == 0.0 && self.acceleration == 0.0 && self.jerk == 0.0
    }
}

/// Largest derivatives of a move, in units of y and s.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MotionLimits {
    /// Largest velocity.
    pub velocity: f32,
    /// Largest acceleration.
    pub acceleration: f32,
    /// Largest jerk.
    pub jerk: f32,
}

/// Travel of the axis, in units of y.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Travel {
    /// Lowest position.
    pub min: f32,
    /// Highest position.
    pub max: f32,
}

impl Travel {
    /// The travel without a tenth at each end: where an excitation may go.
    ///
    /// # Examples
    /// ```
    /// let inner = trendid::servo::Travel { min: 0.0, max: 400.0 }.inner();
    /// assert_eq!((inner.min, inner.max), (40.0, 360.0));
    /// ```
    pub fn inner(&self) -> Self {
        let margin = 0.1 * self.length();
        Self {
            min: self.min + margin,
            max: self.max - margin,
        }
    }

    /// Distance between the ends.
    pub fn length(&self) -> f32 {
        self.max - self.min
    }

    /// The position within the travel that is nearest to `position`; NaN is the lower end.
    pub(crate) fn nearest(&self, position: f32) -> f32 {
        if position > self.max {
            self.max
        } else if position > self.min {
            position
        } else {
            self.min
        }
    }

    /// Whether `position` is within the travel; NaN is not.
    pub(crate) fn contains(&self, position: f32) -> bool {
        position >= self.min && position <= self.max
    }

    /// Refuses control of an axis that stands where neither a soft stop nor an overshoot leaves it:
    /// its sensor has lost its zero, or it was moved by hand.
    pub(crate) fn admits(&self, position: f32) -> Result<(), Error> {
        let soft = SOFT * self.length();
        Error::unless_within("position", position, self.min - soft, self.max + soft)
    }

    /// Whether an axis may have this position, even with its zero lost: what is further away than a
    /// thousand times the ends, or no number, is an error of the sensor, and what follows from it
    /// would not be finite.
    #[inline]
    pub(crate) fn may_have(&self, position: f32) -> bool {
        position.abs() <= FARTHEST * (self.min.abs() + self.max.abs())
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        Error::unless_within("travel.min", self.min, f32::MIN, f32::MAX)?;
        Error::unless_positive("travel.max - travel.min", self.length())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_position_is_one_that_an_axis_may_have() {
        let travel = Travel {
            min: -100.0,
            max: 300.0,
        };
        for position in [0.0, -100.0, 3e5, -4e5, 4e5] {
            assert!(travel.may_have(position), "{position}");
        }
        for position in [4.01e5, -4.01e5, f32::INFINITY, f32::NAN] {
            assert!(!travel.may_have(position), "{position}");
        }
    }

    #[test]
    fn an_axis_may_stand_a_hundredth_of_the_travel_beyond_an_end() {
        let travel = Travel {
            min: -100.0,
            max: 300.0,
        };
        for position in [-103.9, -100.0, 0.0, 303.9] {
            assert_eq!(travel.admits(position), Ok(()), "{position}");
        }
        for position in [-104.1, 304.1, f32::NAN] {
            assert!(travel.admits(position).is_err(), "{position}");
        }
    }

    #[test]
    fn a_travel_has_a_length_and_ends_that_are_numbers() {
        let is_one = |min: f32, max: f32| Travel { min, max }.check().is_ok();
        assert!(is_one(-100.0, 300.0) && is_one(300.0, 300.5));
        let inner = Travel {
            min: -100.0,
            max: 300.0,
        }
        .inner();
        assert_eq!((inner.min, inner.max), (-60.0, 260.0));
        for (min, max) in [
            (300.0, 300.0),
            (300.0, -100.0),
            (f32::NAN, 300.0),
            (-100.0, f32::NAN),
            (f32::NEG_INFINITY, 300.0),
            (-100.0, f32::INFINITY),
        ] {
            assert!(!is_one(min, max), "{min} {max}");
        }
    }
}
