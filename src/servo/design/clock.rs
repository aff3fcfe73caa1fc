//! From seconds to samples.

use crate::servo::design::constants::DELAY_MAX;

/// Turns seconds into samples and rates per s into steps per sample.
#[derive(Clone, Copy)]
pub(crate) struct Clock {
    pub(crate) sample_time: f32,
}

impl Clock {
    /// The nearest number of samples, at least one.
    pub(crate) fn samples(self, seconds: f32) -> u32 {
        let samples = (seconds / self.sample_time + 0.5) as u32;
        if samples > 0 { samples } else { 1 }
    }

    /// The nearest number of samples to a delay, at most as many as commands are remembered.
    pub(crate) fn delay(self, seconds: f32) -> usize {
        ((seconds / self.sample_time + 0.5) as usize).min(DELAY_MAX)
    }

    /// The whole samples that fit into a time.
    pub(crate) fn whole(self, seconds: f32) -> u32 {
        (seconds / self.sample_time) as u32
    }

    /// A rate per s as a rate per sample; by way of 1 ms, where it is exact.
    pub(crate) fn step(self, rate: f32) -> f32 {
        rate / 1000.0 * (self.sample_time / 1e-3)
    }

    /// The same as a share of a first-order lag, at most all of it.
    pub(crate) fn share(self, rate: f32) -> f32 {
        let step = self.step(rate);
        if step < 1.0 { step } else { 1.0 }
    }
}
