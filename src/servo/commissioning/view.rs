//! Which part of the record is read, and how.

/// Largest rate of a correction times the spacing of the points.
pub(crate) const STEP_MAX: f32 = 0.3;

/// Least velocity, in travels per s, that is distinguished from rest; the standard deviations of
/// the noise that it is above; the most points on each side over which it is the mean.
const REST_VELOCITY: f32 = 0.02;
const REST_SIGMAS: f32 = 6.0;
const REACH_MAX: f32 = 3.0;

/// What is read of the record, and how.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct View {
    /// First point, and the one after the last.
    pub(crate) begin: usize,
    pub(crate) end: usize,
    /// Spacing in s.
    pub(crate) time: f32,
    /// Points on each side over which a velocity is the mean, at most three.
    pub(crate) reach: usize,
    /// Movement over as many points on both sides, in travels, up to which an axis may be at rest.
    pub(crate) rest: f32,
    /// Velocity over the sum of two such movements, in 1/s.
    pub(crate) per_movement: f32,
    /// Sign of the valve.
    pub(crate) sign: f32,
}

impl View {
    /// Nothing of a record with this spacing yet, under noise of the standard deviation `sigma`,
    /// with the sign of the valve.
    ///
    /// The velocity is the mean over no more points than the noise requires: a mean sees a stop and
    /// a start late by as much as it reaches.
    pub(crate) fn of(time: f32, sigma: f32, sign: f32) -> Self {
        let noise = REST_SIGMAS * sigma;
        let least = 2.0 * time * REST_VELOCITY;
        let reach = (noise / least + 1.0).min(REACH_MAX) as usize;
        Self {
            time,
            reach,
            rest: noise.max(reach as f32 * least),
            per_movement: 0.25 / (reach as f32 * time),
            sign,
            ..Self::EMPTY
        }
    }

    /// Points behind the one of an interval that its motion needs.
    pub(crate) const fn beyond(&self) -> usize {
        self.reach + 1
    }

    /// Nothing.
    pub(crate) const EMPTY: Self = Self {
        begin: 0,
        end: 0,
        time: 1.0,
        reach: 1,
        rest: 0.0,
        per_movement: 0.0,
        sign: 1.0,
    };
}
