//! Change detection on the innovation.

use crate::servo::design::ChangeDesign;

/// Compares the variance of the innovation over 30 ms with that over 2 s.
///
/// Known as: variance-ratio test, a one-sided change detector (Basseville and Nikiforov 1993).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct VarianceRatio {
    design: ChangeDesign,
    /// Recent variance, and the usual one.
    fast: f32,
    usual: f32,
    /// Samples without another alarm.
    pause: u32,
}

impl VarianceRatio {
    pub(crate) const fn new(design: &ChangeDesign) -> Self {
        Self {
            design: *design,
            fast: 0.0,
            usual: 0.0,
            pause: 0,
        }
    }

    /// Knows no variance yet.
    pub(crate) const fn restart(&mut self) {
        self.fast = 0.0;
        self.usual = 0.0;
    }

    /// Takes an innovation; whether the drive has changed. `settled` is false right after a change
    /// of state. Cost: about 20 instructions.
    #[inline]
    pub(crate) fn update(&mut self, innovation: f32, settled: bool) -> bool {
        let square = innovation * innovation;
        self.fast += self.design.fast_share * (square - self.fast);
        self.pause = self.pause.saturating_sub(1);
        if self.usual == 0.0 {
            self.usual = square;
        }
        if self.pause == 0 && settled && self.fast > self.design.alarm_ratio * self.usual {
            self.pause = self.design.pause;
            self.usual = self.fast;
            return true;
        }
        self.usual += self.design.slow_share * (square - self.usual);
        false
    }
}

#[cfg(test)]
mod tests;
