//! The full command that does not end.

use crate::servo::monitoring::bounds::Bounds;

/// Samples in a row at the full command, in one direction.
///
/// At a quarter of the velocity that the model gives to the full command, the axis would have
/// crossed all of its travel: no target on the travel explains a longer saturation. Cost: about 6
/// instructions.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Saturation {
    samples: u32,
    direction: f32,
}

impl Saturation {
    /// One sample; whether the command is full for too long.
    #[inline]
    pub(crate) fn update(&mut self, command: f32, full: f32, bounds: &Bounds) -> bool {
        let direction = if command >= full {
            1.0
        } else if command <= -full {
            -1.0
        } else {
            0.0
        };
        self.samples = if direction != 0.0 && direction == self.direction {
            self.samples.saturating_add(1)
        } else {
            0
        };
        self.direction = direction;
        self.samples > bounds.saturated
    }

    /// Whether the command is full now.
    pub(crate) fn is_full(&self) -> bool {
        self.direction != 0.0
    }
}
