//! What a relay makes of an axis that stays.

use crate::servo::commissioning::ends::at_end;
use crate::servo::commissioning::relay::{GROWTH_AFTER, Relay};
use crate::servo::commissioning::standstill::Standing;

impl Relay {
    /// Takes what the last sample has shown at a position: a direction in which nothing moves makes
    /// way for the other one.
    ///
    /// An axis on a stop that stayed under all the flow inwards that should have moved it, and
    /// comes off under one outwards, obeys the other sign: a drift had passed for the answer to the
    /// first movement. With the first sign the command would drive it back into the stop.
    pub(crate) fn take(&mut self, standing: Standing, y: f32) {
        match standing {
            Standing::Moved if self.turned < 0.0 && self.leaves_stop(y) => {
                self.command = self.command.max(0.5 * self.largest);
                self.come_off();
            }
            Standing::Moved => self.turned = 1.0,
            Standing::Exhausted => {
                self.turned = -self.turned;
                self.since = 0.0;
                self.stood = y;
            }
            Standing::HeldByFriction | Standing::Unresponsive => {}
        }
    }

    /// Whether it goes inwards from an end where it stood under another direction than now, which
    /// has had the time to act.
    fn leaves_stop(&self, y: f32) -> bool {
        let inwards = (y > self.stood) == (self.stood < 0.5);
        at_end(self.stood) && inwards && self.since > GROWTH_AFTER
    }

    /// The sign is the other one, so that the command keeps its direction; what moves now has come
    /// off what held it.
    const fn come_off(&mut self) {
        self.sign = -self.sign;
        self.turned = 1.0;
        self.shown = true;
        self.flips += 1;
        self.switches = 1;
        self.since = 0.0;
        self.half = 0.0;
        self.time = 0.0;
    }
}
