//! Sensor, identifier, supervisor, controller and valve in one call per sample.

mod begin;
mod beginning;
pub(crate) mod commands;
pub(crate) mod drive;
mod guard;
pub(crate) mod learning;
mod moves;
mod reading;
mod requests;
pub(crate) mod sensed;
mod skip;
pub(crate) mod takeover;

use crate::hardware::{Axis, PositionSensor, Valve};
use crate::servo::commissioning::{Commissioning, Progress};
use crate::servo::config::Config;
use crate::servo::control::controller::Controller;
use crate::servo::control::limiter::CommandLimiter;
use crate::servo::identification::{LoopIdentifier, inputs_of_known};
use crate::servo::monitoring::Alarm;
use crate::servo::motion::Setpoint;
use crate::servo::report::Report;
use crate::servo::servo_loop::commands::Commands;
use crate::servo::servo_loop::drive::Drive;
use crate::servo::servo_loop::guard::Guard;
use crate::servo::servo_loop::learning::Learning;
use crate::servo::servo_loop::moves::Moves;
use crate::servo::servo_loop::sensed::Sensed;
use crate::servo::servo_loop::takeover::{Fallback, Takeover};
use crate::servo::supervision::state::Reason;
use crate::servo::supervision::supervisor::Supervisor;

/// The adaptive position loop.
///
/// One call of [`ServoLoop::update`] per sample. Guarantees: the command never leaves
/// its range and never changes faster than its rate; no panic; + - x / in the update, and square
/// roots and powers by libm, with the same bits on every machine, where the commissioning looks how
/// far an axis may swing and where poles are searched.
///
/// # Examples
/// ```
/// use trendid::hardware::{Axis, PositionSensor, Scale, Valve};
/// use trendid::servo::{Config, ServoLoop, State, Travel};
/// struct Still;
/// impl PositionSensor for Still {
///     type Error = ();
///     fn counts(&mut self) -> Result<i32, ()> { Ok(20_000) }
/// }
/// struct Nothing;
/// impl Valve for Nothing {
///     type Error = ();
///     fn drive(&mut self, command: f32) -> Result<f32, ()> { Ok(command) }
/// }
/// let axis = Axis { scale: Scale::new(0.01).ok_or("scale")?, reference: 0 };
/// let config = Config::new(0.001, 20.0, Travel { min: 0.0, max: 400.0 });
/// let mut servo = ServoLoop::try_new(&config, axis, Still, Nothing)?;
/// servo.commission();
/// let mut state = State::Idle;
/// for _ in 0..2000 { state = servo.update().state; }
/// assert!(matches!(state, State::Failed(_)), "a sensor that never changes is found");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ServoLoop<S, V> {
    pub(crate) sensor: S,
    pub(crate) valve: V,
    pub(crate) axis: Axis,
    pub(crate) config: Config,
    pub(crate) identifier: LoopIdentifier,
    pub(crate) learning: Learning,
    pub(crate) supervisor: Supervisor,
    pub(crate) controller: Controller,
    pub(crate) commissioning: Commissioning,
    /// What the commissioning made of the newest sample.
    pub(crate) progress: Progress,
    /// What belongs to the model: the drive around it.
    pub(crate) drive: Drive,
    pub(crate) moves: Moves,
    pub(crate) limiter: CommandLimiter,
    pub(crate) commands: Commands,
    pub(crate) sensed: Sensed,
    pub(crate) guard: Guard,
    pub(crate) takeover: Takeover,
    pub(crate) fallback: Fallback,
    pub(crate) start_requested: bool,
}

impl<S: PositionSensor, V: Valve> ServoLoop<S, V> {
    /// One sample: reads the sensor, moves the valve, learns.
    ///
    /// Cost: see the table of instruction counts.
    pub fn update(&mut self) -> Report {
        // A position that no axis has is no reading.
        let read = self.sensor.counts().ok();
        let code = read.filter(|code| self.config.travel.may_have(self.axis.position(*code)));
        let missed = self.sensed.errors;
        let same_code = self.sensed.count(code);
        let Some(y) = self.reading(code, missed) else {
            return self.blind();
        };
        self.sensed.position = y;
        self.begin(y);
        self.moves.tracking.update(y);
        let spare = self.spare();
        let (setpoint, requested) = self.requested(y, same_code);
        let Some(command) = self.command_valve(requested) else {
            return self.report(setpoint, 0.0, None, false);
        };
        let state = self.supervisor.state();
        if state.is_commissioning() {
            self.commissioning.applied(y, command);
            let retuned = self.commission_on(command);
            return self.report(setpoint, command, None, retuned);
        }
        if self.moves.unsettled > 0 && state.is_controlling() {
            self.watch_motion();
            return self.report(setpoint, command, None, false);
        }
        let along = self.drive.sign * command;
        self.controller.applied(along);
        let inputs = inputs_of_known(&self.controller);
        let [flow, ..] = inputs;
        self.learning.monitor.update(along);
        let outcome = self.identifier.update_inputs(inputs, y);
        let retuned = if self.is_stopped(&setpoint, y, along, same_code) {
            false
        } else {
            self.supervise(&setpoint, y, same_code, flow, outcome, spare)
        };
        let went_back = core::mem::take(&mut self.fallback.went_back);
        self.report(
            setpoint,
            command,
            outcome.innovation(),
            retuned || went_back,
        )
    }

    /// Moves the valve by a command within its limits, which is on its way from now on; `None` when
    /// the valve has failed.
    #[inline(always)]
    fn command_valve(&mut self, requested: f32) -> Option<f32> {
        let limited = self.limiter.update(requested);
        self.commands.push(limited);
        let command = self.valve.drive(limited).ok();
        if command.is_none() {
            self.fail(Reason::ValveFault);
        }
        command
    }

    /// The setpoint, and the command before its limits.
    fn requested(&mut self, y: f32, same_code: bool) -> (Setpoint, f32) {
        let state = self.supervisor.state();
        if state.is_commissioning() {
            self.progress = self.commissioning.update(y, same_code);
            let command = match self.progress {
                Progress::Command(command) | Progress::Found(_, command) => command,
                Progress::Failed(_) => 0.0,
            };
            (Setpoint::at(y), command)
        } else if state.is_controlling() && self.moves.unsettled > 0 {
            (Setpoint::at(y), self.drive.sign * self.controller.middle())
        } else if state.is_controlling() {
            let newest = self.moves.trajectory.update();
            let setpoint = self.moves.followed.pass(newest);
            self.controller.head_for(self.moves.trajectory.goal());
            let command = self.controller.update(&newest, y);
            let against = if self.moves.tracking.motion().velocity > 0.0 {
                -1.0
            } else {
                1.0
            };
            let command = match self.guard.alarm.take() {
                Some(Alarm::Close) => 0.0,
                Some(Alarm::Brake) => against,
                _ => command,
            };
            (setpoint, self.drive.sign * command)
        } else {
            self.moves.settle();
            (Setpoint::at(y), self.stopping(y))
        }
    }

    fn report(
        &self,
        setpoint: Setpoint,
        command: f32,
        innovation: Option<f32>,
        retuned: bool,
    ) -> Report {
        Report {
            state: self.reported_state(),
            position: self.sensed.position,
            setpoint,
            command,
            innovation,
            retuned,
            faults: self.guard.monitors.counters(),
        }
    }
}
