//! Readings that fail again and again.

use crate::servo::design::MonitoringDesign;

/// The share of readings, within some 50 ms, that failed or were replaced.
///
/// A bridged sample takes its position from the model: with more than half of them bridged the loop
/// runs on the model more than on the sensor, for whatever pattern of failures. A burst that the
/// bridging allows never comes to a half. Cost: about 6 instructions.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Gaps {
    share: f32,
    missing: f32,
}

impl Gaps {
    pub(crate) const fn new(design: &MonitoringDesign) -> Self {
        Self {
            share: design.gap_share,
            missing: 0.0,
        }
    }

    /// Takes a sample; whether too many readings are missing.
    #[inline]
    pub(crate) fn update(&mut self, missing: bool) -> bool {
        let now = if missing { 1.0 } else { 0.0 };
        self.missing += self.share * (now - self.missing);
        self.missing > 0.5
    }

    /// Begins again.
    pub(crate) const fn restart(&mut self) {
        self.missing = 0.0;
    }
}
