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
