//! The answers to an alarm: the axis stops, or the loop becomes slower or goes back first.

use crate::hardware::{PositionSensor, Valve};
use crate::servo::design::constants::{DERATING, DERATING_MIN, REOPENED_STD};
use crate::servo::model::Model;
use crate::servo::monitoring::{Alarm, Efforts, Seen};
use crate::servo::motion::Setpoint;
use crate::servo::servo_loop::ServoLoop;
use crate::servo::supervision::state::{Reason, State};

impl<S: PositionSensor, V: Valve> ServoLoop<S, V> {
    /// Lets the monitors see a sample in control; whether they stop the axis.
    pub(crate) fn is_stopped(
        &mut self,
        setpoint: &Setpoint,
        y: f32,
        command: f32,
        same_code: bool,
    ) -> bool {
        if !self.supervisor.state().is_controlling() {
            return false;
        }
        let seen = Seen {
            setpoint,
            y,
            velocity: self.moves.tracking.motion().velocity,
            command,
            same_code,
            efforts: Efforts {
                bandwidth: self.controller.bandwidth(),
                pushes: self.controller.pushes(),
                awaited: self.controller.awaited(setpoint),
            },
            hunts: self.controller.hunts(),
        };
        match self.guard.monitors.update(&seen) {
            None => false,
            Some(Alarm::Oscillates) => {
                self.calm();
                false
            }
            closes @ Some(Alarm::Close) => {
                self.guard.alarm = closes;
                true
            }
            brakes @ Some(Alarm::Brake) => {
                self.guard.alarm = brakes;
                false
            }
            Some(Alarm::Stop(Reason::FollowingError)) if self.goes_back() => false,
            Some(Alarm::Stop(reason)) => {
                self.fail(reason);
                true
            }
        }
    }

    /// A fault of the machine: the axis stops and the verified model is kept.
    ///
    /// The first reason stays until somebody acknowledges it, as the request for a commissioning
    /// does; one that waits for its sample is refused for the fault. It would begin when the fault
    /// is gone, and with it somebody who is at the plug.
    pub(crate) fn fail(&mut self, reason: Reason) {
        let requested = core::mem::take(&mut self.start_requested);
        if matches!(self.supervisor.state(), State::Failed(_)) && !requested {
            return;
        }
        if self.supervisor.state().is_controlling() {
            self.guard.stop.begin(reason, self.guard.monitors.bounds());
        }
        self.guard.monitors.stopped();
        self.supervisor.fail(reason);
    }

    /// The answer to an oscillation: less bandwidth at once, and the model of the commissioning is
    /// a candidate again.
    ///
    /// Either the model in use is wrong, or, after a heavier load, that of the commissioning: an
    /// oscillation does not distinguish them, and less bandwidth calms both. Which model describes
    /// the axis is decided as between any two models, by how well they follow later samples.
    pub(crate) fn calm(&mut self) {
        let fallback = &mut self.fallback;
        fallback.reconsiders = fallback.known_good != self.supervisor.verified_model();
        let slower = DERATING * fallback.derating;
        if slower > DERATING_MIN {
            self.derate(slower);
        } else {
            self.derate(DERATING_MIN);
        }
    }

    /// The answer to an axis that does not follow on a model that was accepted in control: once
    /// more on that of the commissioning; whether that is another one.
    ///
    /// Whether the model or the axis is to blame is not known. On the model of the commissioning
    /// the axis has followed; a fault that stays stops it on that one, as late again.
    pub(crate) fn goes_back(&mut self) -> bool {
        let Some(model) = self.fallback.known_good else {
            return false;
        };
        if !self.supervisor.goes_back(model) {
            return false;
        }
        self.identify_from(&model, REOPENED_STD);
        self.retune(model);
        self.guard.monitors.waits_again();
        self.fallback.went_back = true;
        true
    }

    /// Multiplies the bandwidth of the controller by `factor`.
    pub(crate) fn derate(&mut self, factor: f32) {
        if factor != self.fallback.derating {
            self.fallback.derating = factor;
            self.controller.derate(factor);
            self.guard.monitors.derated(factor);
        }
    }

    /// The controller and the monitors go on with another model; nothing happens when they have it
    /// already.
    pub(crate) fn retune(&mut self, model: Model) {
        if model == *self.controller.model() {
            return;
        }
        self.controller.retune(model);
        (self.takeover.tuning, self.takeover.unsearched) = (None, Some(model));
        self.guard.monitors.retune(model, self.controller.motion());
    }

    /// The command outside of commissioning and control: a brake for a while after a fault, then
    /// the middle of the valve.
    ///
    /// Whatever the model says, a flow along the motion is never right while the speed grows: it
    /// adds to what drives the axis. In such a sample the valve is in its middle. While the speed
    /// falls the same flow takes back a brake that would reverse the axis.
    pub(crate) fn stopping(&mut self, y: f32) -> f32 {
        let motion = self.moves.tracking.motion();
        self.guard.stop.look(motion.velocity);
        if !self.guard.stop.brakes() {
            return self.centre();
        }
        let (command, middle) = (self.controller.brake(y), self.controller.middle());
        let along = (command - middle) * motion.velocity > 0.0;
        let grows = motion.acceleration * motion.velocity > 0.0;
        self.drive.sign * if along && grows { middle } else { command }
    }

    /// The command at which a valve of the verified model is closed, why ever it closes. Of a valve
    /// that was found stuck nothing is known, of one with the wrong sign what the
    /// [`Stop`](crate::servo::monitoring::stop::Stop) finds.
    pub(crate) fn centre(&self) -> f32 {
        let closes = matches!(self.supervisor.state(), State::Idle | State::Failed(_));
        let Some(model) = self.supervisor.verified_model().filter(|_| closes) else {
            return 0.0;
        };
        match self.supervisor.fault() {
            Some(Reason::ValveStuck) => 0.0,
            // Within the dead zone, zero is closed whatever the sign.
            Some(Reason::WrongSign) if model.offset.abs() > model.dead_zone => {
                self.drive.sign * self.guard.stop.creeps() * model.offset.abs()
            }
            Some(Reason::WrongSign) => 0.0,
            _ => -self.drive.sign * model.offset,
        }
    }
}
