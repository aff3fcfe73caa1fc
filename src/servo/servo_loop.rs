//! Sensor, identifier, supervisor, controller and valve in one call per sample.

mod begin;
mod reading;
mod requests;
mod skip;

use crate::hardware::{Axis, PositionSensor, Valve};
use crate::servo::building::Building;
use crate::servo::commissioning::{Commissioning, Progress};
use crate::servo::config::Config;
use crate::servo::control::controller::Controller;
use crate::servo::control::limiter::CommandLimiter;
use crate::servo::control::tuning::Tuned;
use crate::servo::design::constants::DELAY_MAX;
use crate::servo::identification::{LoopIdentifier, inputs_of_known};
use crate::servo::model::Model;
use crate::servo::monitoring::{Monitors, stop::Stop};
use crate::servo::motion::Setpoint;
use crate::servo::motion::alpha_beta_gamma::AlphaBetaGamma;
use crate::servo::motion::trajectory::Trajectory;
use crate::servo::report::Report;
use crate::servo::supervision::excitation_monitor::ExcitationMonitor;
use crate::servo::supervision::state::Reason;
use crate::servo::supervision::supervisor::Supervisor;

/// The adaptive position loop.
///
/// One call of [`ServoLoop::update`] per sample. Guarantees: the command never leaves
/// its range and never changes faster than its rate; no panic; only + - x / in the update.
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
/// for _ in 0..1000 { state = servo.update().state; }
/// assert!(matches!(state, State::Failed(_)), "a sensor that never changes is found");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ServoLoop<S, V> {
    pub(crate) sensor: S,
    pub(crate) valve: V,
    pub(crate) axis: Axis,
    pub(crate) adaptive: bool,
    sample_time: f32,
    pub(crate) run_out_rate: f32,
    sensor_errors: u32,
    /// Samples after a breakaway in which the filtered signals still contain friction.
    pub(crate) settled: u32,
    pub(crate) identifier: LoopIdentifier,
    pub(crate) supervisor: Supervisor,
    pub(crate) controller: Controller,
    pub(crate) config: Config,
    pub(crate) commissioning: Commissioning,
    /// Sign of the valve.
    pub(crate) sign: f32,
    /// Delay of the valve in s.
    pub(crate) delay: f32,
    pub(crate) dead_volume: f32,
    /// Standard deviation of the position, in units of y.
    pub(crate) noise: f32,
    /// What the commissioning made of the newest sample.
    pub(crate) progress: Progress,
    pub(crate) trajectory: Trajectory,
    pub(crate) limiter: CommandLimiter,
    pub(crate) tracking: AlphaBetaGamma,
    pub(crate) monitor: ExcitationMonitor,
    pub(crate) monitors: Monitors,
    pub(crate) stop: Stop,
    /// Factor on the bandwidth, 1 unless an oscillation was noticed.
    pub(crate) derating: f32,
    /// The model of the commissioning, and whether it is the next candidate.
    pub(crate) known_good: Option<Model>,
    pub(crate) reconsiders: bool,
    /// The loop for what was found, while it is being built.
    pub(crate) building: Option<Building>,
    /// The search of poles for the model that is being validated.
    pub(crate) tuning: Option<Tuned>,
    /// Samples in which the observer of the controller settles before it takes over.
    pub(crate) watching: u32,
    /// The latest commands: what is on its way when a controller takes over.
    pub(crate) commands: [f32; DELAY_MAX + 1],
    pub(crate) newest: usize,
    code: i32,
    pub(crate) position: f32,
    begun: bool,
    /// Consecutive sensor errors.
    errors: u32,
    start_requested: bool,
    /// The stopping distance to an end of the travel is used up.
    pub(crate) ends: bool,
    /// The axis moves against its commands.
    pub(crate) closes: bool,
}

impl<S: PositionSensor, V: Valve> ServoLoop<S, V> {
    /// One sample: reads the sensor, moves the valve, learns.
    ///
    /// Cost: see the table of instruction counts.
    pub fn update(&mut self) -> Report {
        // A position that is not finite is no reading.
        let read = self.sensor.counts().ok();
        let code = read.filter(|code| self.axis.position(*code).is_finite());
        let missed = self.errors;
        self.errors = match code {
            Some(_) => 0,
            None => self.errors.saturating_add(1),
        };
        let same_code = self.begun && code.is_none_or(|code| code == self.code);
        let Some(y) = self.reading(code, missed) else {
            return self.blind();
        };
        self.position = y;
        self.begin(y);
        self.tracking.update(y);
        let (setpoint, requested) = self.requested(y, same_code);
        let limited = self.limiter.update(requested);
        self.remember(limited);
        let Ok(command) = self.valve.drive(limited) else {
            self.fail(Reason::ValveFault);
            return self.report(setpoint, 0.0, None, false);
        };
        if self.supervisor.state().is_commissioning() {
            self.commissioning.applied(y, command);
            let retuned = self.commission_on(command);
            return self.report(setpoint, command, None, retuned);
        }
        let along = self.sign * command;
        self.refine_poles();
        self.controller.applied(along);
        let inputs = inputs_of_known(&self.controller);
        self.monitor.update(along);
        let outcome = self.identifier.update_inputs(inputs, y);
        let retuned = if self.is_stopped(&setpoint, y, along, same_code) {
            false
        } else {
            self.supervise(&setpoint, y, same_code, outcome)
        };
        self.report(setpoint, command, outcome.innovation(), retuned)
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
        } else if state.is_controlling() {
            let setpoint = self.trajectory.update();
            let command = self.controller.update(&setpoint, y);
            if core::mem::take(&mut self.closes) {
                return (setpoint, 0.0);
            }
            let ends = core::mem::take(&mut self.ends);
            let against = if self.tracking.motion().velocity > 0.0 {
                -1.0
            } else {
                1.0
            };
            (setpoint, self.sign * if ends { against } else { command })
        } else {
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
            state: self.supervisor.state(),
            position: self.position,
            setpoint,
            command,
            innovation,
            retuned,
            faults: self.monitors.counters(),
        }
    }
}
