//! An error between reference and axis that a loop that works would not leave.

use crate::servo::monitoring::bounds::Bounds;
use crate::servo::motion::Setpoint;

/// The following error against what the motion of the reference explains.
///
/// A loop of any bandwidth above w / 4 lags behind its reference by less than four time constants
/// 1/w of the drive itself: more than `lag` times the largest recent speed is no lag. An error that
/// shrinks is being worked off. What stays for 10/w, more than a period of the drive, and for the
/// time in which a push becomes as large as it usually must, stays. While friction holds the axis
/// and the push still grows, the error is being worked off, however slowly; the time then counts a
/// tenth, so that it ends. Cost: about 20 instructions.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Following {
    /// Largest recent speed of the reference.
    speed: f32,
    /// Tenths of samples with too large an error that does not shrink.
    tenths: u32,
    /// Smallest error since it was too large.
    least: f32,
}

impl Following {
    /// One sample; whether the axis does not follow. `pushes`: friction holds it, and the push
    /// still grows.
    #[inline]
    pub(crate) fn update(&mut self, r: &Setpoint, y: f32, pushes: bool, bounds: &Bounds) -> bool {
        let speed = r.velocity.abs();
        // The memory of a speed is as long as the window of the expectation.
        self.speed -= 0.25 * bounds.share * self.speed;
        if speed > self.speed {
            self.speed = speed;
        }
        let error = (r.position - y).abs();
        if error <= bounds.following.error + bounds.following.lag * self.speed {
            self.tenths = 0;
            self.least = error;
            return false;
        }
        if error < 0.9 * self.least {
            self.least = error;
            self.tenths = 0;
            return false;
        }
        if self.tenths == 0 && error > self.least {
            self.least = error;
        }
        self.tenths = self.tenths.saturating_add(if pushes { 1 } else { 10 });
        self.tenths > bounds.following.tenths
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
        let moves = Setpoint {
            velocity: -100.0,
            ..Setpoint::at(0.0)
        };
        let _ = following.update(&moves, 0.0, false, &bounds);
        assert_eq!(following.speed, 100.0);
        for k in 1..=600 {
            let _ = following.update(&Setpoint::at(0.0), 0.0, false, &bounds);
            let exact = 100.0 * libm::powf(1.0 - 0.25 * bounds.share, k as f32);
            assert!((following.speed - exact).abs() < 1e-2, "{k}");
        }
        assert!(following.speed < 50.0);
    }
}
