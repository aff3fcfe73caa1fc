//! Slots in which the loop was not called.

use crate::hardware::{PositionSensor, Valve};
use crate::identifier::Outcome;
use crate::servo::servo_loop::ServoLoop;
use crate::servo::supervision::event::Spare;
use crate::servo::supervision::state::Reason;

impl<S: PositionSensor, V: Valve> ServoLoop<S, V> {
    /// Lets `samples` sample times pass in which nothing was read and the valve kept its command,
    /// as after an overrun.
    ///
    /// The time passes for the reference, the observer, the commissioning and the identifier, on
    /// the position that the model expects, as it does while readings fail; as many as may fail in
    /// a row may be missing, more end in [`Reason::SensorFault`].
    ///
    /// Cost: that of so many [updates](Self::update); no more than three or so count.
    pub fn skip(&mut self, samples: u32) {
        for _ in 0..samples.min(self.sensed.errors_max) {
            self.pass();
        }
    }

    /// One sample time.
    fn pass(&mut self) {
        if !self.sensed.begun {
            return;
        }
        let _ = self.sensed.count(None);
        let missing = self.guard.monitors.count_reading(true, true);
        if self.is_active() && (missing || self.sensed.is_lost()) {
            self.fail(Reason::SensorFault);
        }
        let y = self.expected();
        self.sensed.position = y;
        self.moves.tracking.update(y);
        // What the loop would have commanded has reached no valve.
        let (setpoint, _) = self.requested(y, true);
        let command = self.limiter.last();
        if self.supervisor.state().is_commissioning() {
            self.commissioning.applied(y, command);
            self.commands.push(command);
            let _ = self.commission_on(command);
            return;
        }
        let along = self.drive.sign * command;
        self.commands.push(command);
        if self.awaits_motion() {
            return self.watch_motion();
        }
        self.controller.applied(along);
        self.learning.monitor.update(along);
        self.identifier.skip(1);
        let outcome = Outcome::Replaced { innovation: 0.0 };
        if !self.is_stopped(&setpoint, y, along, true) {
            // Several of them may come in one slot: what can wait does.
            let flow = self.controller.flow_in_force();
            self.supervise(&setpoint, y, true, flow, outcome, Spare::Nothing);
        }
    }
}
