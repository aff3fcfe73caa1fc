//! The drive around the model.

use crate::servo::commissioning::Found;

/// What the commissioning finds beside the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Drive {
    /// Sign of the valve.
    pub(crate) sign: f32,
    /// Delay of the valve in s.
    pub(crate) delay: f32,
    /// Dead volume over the volume of the travel.
    pub(crate) dead_volume: f32,
    /// Share by which it is slower upwards, and faster downwards.
    pub(crate) imbalance: f32,
    /// Standard deviation of the position, in units of y.
    pub(crate) noise: f32,
}

impl Drive {
    /// What was found.
    pub(crate) const fn of(found: &Found) -> Self {
        Self {
            sign: found.sign,
            delay: found.delay,
            dead_volume: found.dead_volume,
            imbalance: found.imbalance,
            noise: found.noise,
        }
    }
}
