//! What a model must satisfy before it may control.

use crate::error::positive;
use crate::servo::error::ServoError;

/// Bounds a model must keep.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SupervisorConfig {
    /// Rough bandwidth of the plant in rad/s; the natural frequency must lie within a factor of `spread`.
    pub bandwidth: f32,
    /// Factor about the rough bandwidth that is still believed.
    pub spread: f32,
    /// Largest believable velocity gain, units of y per s and unit of u.
    pub largest_gain: f32,
    /// Largest relative standard deviation of gain and natural frequency; damping may have four times as much.
    pub certainty: f32,
    /// The same while the model follows the drive; there the trial against the model in use decides.
    pub certainty_adapting: f32,
    /// Least share of the movement that a free simulation must explain, `1 - SSE/SST`.
    pub explained: f32,
    /// The same while the model follows the drive, in shorter movements.
    pub explained_adapting: f32,
    /// A model replaces another when its squared error is below this share of the other's.
    pub better: f32,
    /// ... and the difference is at least this share of the movement: there is something to gain.
    pub worth: f32,
    /// Least excitation before a model is tried, in s.
    pub excite: f32,
    /// Time of free simulation in a trial, in s.
    pub window: f32,
    /// Longest commissioning, in s.
    pub time_limit: f32,
    /// Slower than this the drive does not count as moving, units of y per s.
    pub slow: f32,
    /// Movement below this within the time of excitation is none, units of y.
    pub still: f32,
    /// Rise of the innovation's variance that counts as a change of the drive.
    pub change: f32,
    /// Tracking error up to which a model in use stays in use, units of y: what works is not changed.
    pub tolerable: f32,
}

impl SupervisorConfig {
    /// The defaults for a rough `bandwidth` (rad/s) and a travel of `length`.
    pub fn new(bandwidth: f32, length: f32) -> Self {
        Self {
            bandwidth,
            spread: 4.0,
            largest_gain: 50.0 * length,
            certainty: 0.1,
            certainty_adapting: 0.2,
            explained: 0.975,
            explained_adapting: 0.9,
            better: 0.7,
            worth: 0.3,
            excite: 0.26,
            window: 0.12,
            time_limit: 3.0,
            slow: 0.05 * length,
            still: 2e-3 * length,
            change: 5.0,
            tolerable: 5e-3 * length,
        }
    }

    pub(crate) fn check(&self) -> Result<(), ServoError> {
        for bound in [
            self.bandwidth,
            self.spread,
            self.largest_gain,
            self.certainty,
            self.certainty_adapting,
            self.explained,
            self.explained_adapting,
            self.better,
            self.worth,
            self.slow,
            self.still,
            self.change,
            self.tolerable,
        ] {
            if !positive(bound) {
                return Err(ServoError::Bound(bound));
            }
        }
        for time in [self.excite, self.window, self.time_limit] {
            if !(positive(time) && time < 1e5) {
                return Err(ServoError::Time(time));
            }
        }
        Ok(())
    }
}
