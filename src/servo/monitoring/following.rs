//! An error between reference and axis that a loop that works would not leave.

use crate::math::{larger, smaller};
use crate::servo::design::constants::LAG_TIME_RATIO;
use crate::servo::monitoring::bounds::{Bounds, FollowingBounds};
use crate::servo::motion::Setpoint;

/// The following error against what the motion of the reference explains.
///
/// A loop whose bandwidth wc is above w / 4 lags behind its reference by less than four time
/// constants 1/w of the drive itself, a slower one by 1/wc: more than so many times the largest
/// recent speed is no lag. Nor is what a loop waits for that leaves a sticking axis where it is
/// until as much is missing as a hop is long. An error that shrinks is being worked off. What stays
/// for 10/w, more than a period of the drive, and for the time in which a push becomes as large as
/// it usually must, stays; of a loop that is slower than its drive these are times over wc. While
/// friction holds the axis and the push still grows, the error is being worked off, however slowly;
/// the time then counts a tenth, so that it ends. Cost: about 30 instructions.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Following {
    /// Largest recent speed of the reference.
    speed: f32,
    /// Hundredths of samples with too large an error that does not shrink.
    hundredths: u32,
    /// Smallest error since it was too large.
    least: f32,
}

/// What a loop makes of the error to its reference.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Efforts {
    /// Bandwidth in force.
    pub(crate) bandwidth: f32,
    /// Whether friction holds the axis and the push that shall move it still grows.
    pub(crate) pushes: bool,
    /// The error for which it waits, 0 while it does not.
    pub(crate) awaited: f32,
}

/// Least bandwidth over w that counts: below any that poles are found for, and the time ends
/// whatever a loop says of itself.
const PACE_LEAST: f32 = 0.01;
/// Hundredths that a sample counts, and one while the push grows.
const WHOLE: f32 = 100.0;
const PUSHED: f32 = 10.0;

impl Following {
    /// One sample; whether the axis does not follow.
    #[inline]
    pub(crate) fn update(
        &mut self,
        r: &Setpoint,
        y: f32,
        efforts: &Efforts,
        bounds: &Bounds,
    ) -> bool {
        let speed = r.velocity.abs();
        // The memory of a speed is as long as the window of the expectation.
        self.speed -= 0.25 * bounds.share * self.speed;
        if speed > self.speed {
            self.speed = speed;
        }
        let error = (r.position - y).abs();
        let FollowingBounds {
            error: left,
            lag,
            hundredths,
        } = bounds.following;
        if error <= left + lag * self.speed {
            self.hundredths = 0;
            self.least = error;
            return false;
        }
        let pace = smaller(
            larger(efforts.bandwidth / bounds.frequency, PACE_LEAST),
            1.0,
        );
        let slower = larger(1.0 / (LAG_TIME_RATIO * pace), 1.0);
        let most = larger(efforts.awaited, left) + slower * lag * self.speed;
        if error <= most || error < 0.9 * self.least {
            self.hundredths = 0;
            self.least = error;
            return false;
        }
        if self.hundredths == 0 && error > self.least {
            self.least = error;
        }
        let part = larger(pace * if efforts.pushes { PUSHED } else { WHOLE }, 1.0);
        self.hundredths = self.hundredths.saturating_add(part as u32);
        self.hundredths > hundredths
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::model::Model;
    use crate::servo::monitoring::bounds::example;

    #[test]
    fn a_speed_fades_within_four_windows_of_the_expectation() {
        let bounds = example::bounds(&Model::linear(400.0, 16.0, 4e5));
        let mut following = Following::default();
        let efforts = Efforts::default();
        let moves = Setpoint {
            velocity: -100.0,
            ..Setpoint::at(0.0)
        };
        let _ = following.update(&moves, 0.0, &efforts, &bounds);
        assert_eq!(following.speed, 100.0);
        for k in 1..=600 {
            let _ = following.update(&Setpoint::at(0.0), 0.0, &efforts, &bounds);
            let exact = 100.0 * libm::powf(1.0 - 0.25 * bounds.share, k as f32);
            assert!((following.speed - exact).abs() < 1e-2, "{k}");
        }
        assert!(following.speed < 50.0);
    }
}
