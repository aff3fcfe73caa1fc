//! The excitation monitor of the loop.

/// The excitation monitor: how much the command moves within some 50 ms.
///
/// A slow motion fits any model of the right gain: gain, frequency and damping can
/// grow or shrink together. Only what is fast against the drive tells them apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Richness {
    mean: f32,
    power: f32,
    least: f32,
    share: f32,
}

impl Richness {
    pub(crate) fn new(least: f32, sample_time: f32) -> Self {
        Self {
            mean: 0.0,
            power: 0.0,
            least: least * least,
            share: sample_time / 0.05,
        }
    }

    #[inline]
    pub(crate) fn update(&mut self, command: f32) {
        let fast = command - self.mean;
        self.mean += self.share * fast;
        self.power += self.share * (fast * fast - self.power);
    }

    #[inline]
    pub(crate) fn is_rich(&self) -> bool {
        self.power > self.least
    }
}
