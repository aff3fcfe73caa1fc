//! The motion of the axis before there is a model of it.

use crate::servo::model::Motion;

/// Tracks the motion without a model, for the time before there is one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Tracker {
    pub(crate) motion: Motion,
    gain: [f32; 3],
    pub(crate) sample_time: f32,
}

impl Tracker {
    /// Three poles at `-rate`; exact for a constant acceleration.
    pub(crate) fn new(rate: f32, sample_time: f32) -> Self {
        let x = rate * sample_time;
        Self {
            motion: Motion::default(),
            gain: [
                3.0 * x,
                3.0 * x * x / sample_time,
                x * x * x / (sample_time * sample_time),
            ],
            sample_time,
        }
    }

    #[inline]
    pub(crate) fn update(&mut self, y: f32) {
        let m = &mut self.motion;
        m.position += self.sample_time * (m.velocity + 0.5 * self.sample_time * m.acceleration);
        m.velocity += self.sample_time * m.acceleration;
        let error = y - m.position;
        m.position += self.gain[0] * error;
        m.velocity += self.gain[1] * error;
        m.acceleration += self.gain[2] * error;
    }
}
