//! What a model says of an axis that stays or goes its own way.

use crate::math::sqrt;
use crate::servo::commissioning::predictor::Theta;

/// Coulomb frictions that hold an axis: both sides of a breakaway of 2.5 times as much.
const FRICTIONS: f32 = 5.0;
/// Displacement in movements that count which it must exceed beside.
const MOVEMENTS: f32 = 2.0;
/// Angle of the natural frequency after which a drive without friction has moved by most of what
/// its flow leads to.
pub(super) const LAG_RADIANS: f32 = 2.0;
/// A period, within which a swing is furthest against the drive; times `a2/a1`, by which an
/// overdamped axis is slower.
const SWING_RADIANS: f32 = core::f32::consts::TAU;
const SLOW_TIMES: f32 = 1.0;

/// What a model says of friction and time. It changes seldom and takes a root and three divisions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Known {
    /// Of which model.
    pub(super) a1: f32,
    /// Drive that friction holds in s; times in s by which motion comes late, and of a swing.
    pub(super) held: f32,
    pub(super) late: f32,
    pub(super) swing: f32,
}

impl Known {
    pub(super) fn of(m: &Theta, detection: f32) -> Self {
        let period = 1.0 / sqrt(m.a1);
        Self {
            a1: m.a1,
            held: (FRICTIONS * m.friction + MOVEMENTS * detection * m.a1) / m.b0,
            late: m.delay + LAG_RADIANS * period,
            swing: m.delay + SWING_RADIANS * period + SLOW_TIMES * m.a2 / m.a1,
        }
    }
}
