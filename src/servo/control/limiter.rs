//! Range and rate of a command.

use crate::math::within;
use crate::servo::design::LimiterDesign;

/// Range and rate of a command, enforced on every sample.
///
/// Guarantees: |u| <= range, |u(k) - u(k-1)| <= rate Delta, whatever comes in; NaN is treated as 0.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CommandLimiter {
    design: LimiterDesign,
    last: f32,
}

impl CommandLimiter {
    /// A limiter whose last command is zero.
    pub(crate) const fn new(design: &LimiterDesign) -> Self {
        Self {
            design: *design,
            last: 0.0,
        }
    }

    /// Goes on from the last command with another range and rate; a range that it is outside of is
    /// reached at that rate.
    pub(crate) const fn redesign(&mut self, design: &LimiterDesign) {
        self.design = *design;
    }

    /// The newest command.
    pub(crate) const fn last(&self) -> f32 {
        self.last
    }

    /// The command nearest to `requested` that range and rate allow. Cost: about 15 instructions.
    #[inline]
    pub(crate) fn update(&mut self, requested: f32) -> f32 {
        let requested = if requested.is_nan() {
            0.0
        } else {
            within(requested, self.design.range)
        };
        // Against the bounds themselves, so that no rounding of a sum exceeds the range.
        let (low, high) = (self.last - self.design.step, self.last + self.design.step);
        self.last = if requested > high {
            high
        } else if requested < low {
            low
        } else {
            requested
        };
        self.last
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn range_and_rate_are_kept_and_nan_is_zero() {
        let mut limiter = CommandLimiter::new(&LimiterDesign {
            range: 0.5,
            step: 0.1,
        });
        assert_eq!(limiter.update(7.0), 0.1);
        assert_eq!(limiter.last(), 0.1);
        assert_eq!(limiter.update(f32::NAN), 0.0);
        for _ in 0..9 {
            let _ = limiter.update(f32::NEG_INFINITY);
        }
        assert_eq!(limiter.update(f32::NEG_INFINITY), -0.5);
    }

    #[test]
    fn a_range_that_the_last_command_is_outside_of_is_reached_at_the_new_rate() {
        let mut limiter = CommandLimiter::new(&LimiterDesign {
            range: 1.0,
            step: 1.0,
        });
        assert_eq!(limiter.update(0.875), 0.875);
        limiter.redesign(&LimiterDesign {
            range: 0.5,
            step: 0.25,
        });
        assert_eq!(limiter.last(), 0.875);
        for expected in [0.625, 0.5, 0.5] {
            assert_eq!(limiter.update(1.0), expected);
        }
    }
}
