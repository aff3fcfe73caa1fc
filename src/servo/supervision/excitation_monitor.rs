//! The excitation monitor of the loop.

use crate::servo::design::MonitorDesign;

/// How much the command moves within some 50 ms.
///
/// A slow motion fits any model of the right gain: gain, frequency and damping can
/// grow or shrink together. Only commands that are fast against the drive separate them.
#[derive(Debug, Clone, PartialEq)]
#[doc(alias = "Richness")]
pub(crate) struct ExcitationMonitor {
    design: MonitorDesign,
    mean: f32,
    power: f32,
}

impl ExcitationMonitor {
    pub(crate) const fn new(design: &MonitorDesign) -> Self {
        Self {
            design: *design,
            mean: 0.0,
            power: 0.0,
        }
    }

    /// Takes a command. Cost: about 10 instructions.
    #[inline]
    pub(crate) fn update(&mut self, command: f32) {
        let fast = command - self.mean;
        self.mean += self.design.share * fast;
        self.power += self.design.share * (fast * fast - self.power);
    }

    /// Whether the variance of the fast part of the command reaches its least value.
    #[inline]
    pub(crate) fn is_exciting(&self) -> bool {
        self.power > self.design.min_power
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest and smallest power of a sine of 1 with this frequency in rad per sample.
    fn power(frequency: f32) -> [f32; 2] {
        let design = MonitorDesign {
            share: 0.02,
            min_power: 0.01,
        };
        let mut monitor = ExcitationMonitor::new(&design);
        let mut found = [f32::INFINITY, 0.0_f32];
        for k in 0..20_000 {
            monitor.update(libm::sinf(frequency * k as f32) + 0.3);
            assert_eq!(monitor.is_exciting(), monitor.power > 0.01);
            if k > 10_000 {
                found = [found[0].min(monitor.power), found[1].max(monitor.power)];
            }
        }
        found
    }

    #[test]
    fn what_is_fast_against_the_mean_counts() {
        // A first-order high-pass with a corner of 0.02 rad per sample: half the power there, all
        // of it far above, next to nothing far below.
        for (frequency, share) in [(0.02_f32, 0.5), (0.5, 1.0), (1e-3, 0.0025)] {
            let [low, high] = power(frequency);
            let middle = 0.5 * (low + high);
            assert!(
                (middle / (0.5 * share) - 1.0).abs() < 0.1,
                "{frequency}: {low} to {high}"
            );
        }
    }

    #[test]
    fn the_least_variance_itself_is_not_enough() {
        let design = MonitorDesign {
            share: 1.0,
            min_power: 0.25,
        };
        let mut monitor = ExcitationMonitor::new(&design);
        monitor.update(0.5);
        assert!(!monitor.is_exciting());
        monitor.update(1.5);
        assert!(monitor.is_exciting());
    }
}
