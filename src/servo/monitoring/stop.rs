//! How a fault stops the axis.

use crate::servo::supervision::state::Reason;

/// What the valve does after a fault.
///
/// While the position is known the controller brakes on its observer to velocity zero, for a bounded time. Otherwise, and
/// afterwards, the valve is in the middle of its dead zone: a drive whose velocity follows its valve comes to rest by
/// itself, within `2 xi v / w + a / w^2`. When the sign is wrong, the offset of the model means nothing and the valve is
/// at zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Stop {
    /// Samples of braking that are left.
    braking: u32,
}

impl Stop {
    /// Begins for a reason; `longest`: samples of a controlled stop.
    pub(crate) const fn begin(&mut self, reason: Reason, longest: u32) {
        let known = matches!(
            reason,
            Reason::TravelEnd | Reason::FollowingError | Reason::Saturated
        );
        self.braking = if known { longest } else { 0 };
    }

    /// Counts a sample; whether the controller brakes in it.
    pub(crate) const fn brakes(&mut self) -> bool {
        let brakes = self.braking > 0;
        self.braking = self.braking.saturating_sub(1);
        brakes
    }

    /// Ends a controlled stop: the position is no longer known, or the axis stands.
    pub(crate) const fn end(&mut self) {
        self.braking = 0;
    }
}
