//! Sensor, identifier, supervisor, controller and valve in one call per sample.

use crate::Outcome;
use crate::hardware::{Axis, PositionSensor, Valve};
use crate::servo::config::Config;
use crate::servo::control::controller::Controller;
use crate::servo::control::limiter::CommandLimiter;
use crate::servo::design::Design;
use crate::servo::design::constants::{CHANGED_STD, REOPENED_STD};
use crate::servo::error::Error;
use crate::servo::identification::{
    LoopIdentifier, candidate, identifier, inputs_of_known, inputs_of_unknown, reopen,
};
use crate::servo::model::Model;
use crate::servo::motion::alpha_beta_gamma::AlphaBetaGamma;
use crate::servo::motion::trajectory::Trajectory;
use crate::servo::motion::{Motion, Setpoint, Travel};
use crate::servo::supervision::excitation::Excitation;
use crate::servo::supervision::excitation_monitor::ExcitationMonitor;
use crate::servo::supervision::screening::Candidate;
use crate::servo::supervision::state::{Reason, State};
use crate::servo::supervision::supervisor::{Event, Observation, Supervisor};

/// What one sample of the loop did.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Report {
    /// State of the supervisor after the sample.
    pub state: State,
    /// Measured position; where the axis should be when the sensor failed.
    pub position: f32,
    /// The reference; the position outside of control.
    pub setpoint: Setpoint,
    /// The command that was set.
    pub command: f32,
    /// Innovation of the identifier, if there was one.
    pub innovation: Option<f32>,
    /// Whether a model reached the controller in this sample.
    pub retuned: bool,
}

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
    sensor: S,
    valve: V,
    axis: Axis,
    travel: Travel,
    adaptive: bool,
    sample_time: f32,
    run_out_rate: f32,
    sensor_errors: u32,
    /// Velocity below which the direction of friction is open.
    friction_velocity: f32,
    /// Samples after a breakaway in which the filtered signals still contain friction.
    settled: u32,
    identifier: LoopIdentifier,
    supervisor: Supervisor,
    controller: Controller,
    excitation: Excitation,
    trajectory: Trajectory,
    limiter: CommandLimiter,
    tracking: AlphaBetaGamma,
    monitor: ExcitationMonitor,
    code: i32,
    position: f32,
    begun: bool,
    /// Consecutive sensor errors.
    errors: u32,
    start_requested: bool,
}

impl<S: PositionSensor, V: Valve> ServoLoop<S, V> {
    /// A loop in the state [`State::Idle`].
    ///
    /// # Errors
    /// An [`Error`] that names the setting.
    pub fn try_new(config: &Config, axis: Axis, sensor: S, valve: V) -> Result<Self, Error> {
        let design = config.resolve()?;
        let Design {
            sample_time,
            identification,
            ..
        } = &design;
        Ok(Self {
            sensor,
            valve,
            axis,
            travel: design.travel,
            adaptive: design.adaptive,
            sample_time: *sample_time,
            run_out_rate: design.run_out_rate,
            sensor_errors: design.sensor_errors,
            friction_velocity: identification.friction_velocity,
            settled: identification.settled,
            identifier: identifier(identification, *sample_time)?,
            supervisor: Supervisor::new(&design.supervision),
            controller: Controller::new(&design, placeholder(config)),
            excitation: Excitation::new(&design.excitation),
            trajectory: Trajectory::new(design.motion, *sample_time, 0.0),
            limiter: CommandLimiter::new(&design.limiter),
            tracking: AlphaBetaGamma::new(design.tracking_rate, *sample_time),
            monitor: ExcitationMonitor::new(&design.monitor),
            code: 0,
            position: 0.0,
            begun: false,
            errors: 0,
            start_requested: false,
        })
    }

    /// Takes a model that is known to be good: control begins with the next sample, at the actual position.
    ///
    /// # Errors
    /// [`Error::Model`] when it is not finite or not stable.
    pub fn install(&mut self, model: Model) -> Result<(), Error> {
        if !model.is_finite() {
            return Err(Error::Model(Reason::NotFinite));
        }
        if !(model.a1 > 0.0 && model.a2 > 0.0 && model.b0 > 0.0) {
            return Err(Error::Model(Reason::Unstable));
        }
        self.supervisor.install(model);
        self.controller.retune(model);
        reopen(&mut self.identifier, &model, REOPENED_STD);
        self.start_requested = false;
        if self.begun {
            self.take_over(Motion::at(self.position));
        }
        Ok(())
    }

    /// Commissions the axis with the next sample, around the position it then has.
    pub fn commission(&mut self) {
        self.start_requested = true;
    }

    /// Stops commissioning or control: the command goes to zero at its rate limit, the verified model is kept.
    pub fn abort(&mut self) {
        self.start_requested = false;
        self.supervisor.abort();
    }

    /// Moves to `target`, limited to the travel, as fast as the limits of motion allow; may be called in any sample.
    pub fn move_to(&mut self, target: f32) {
        self.trajectory.move_to(self.travel.nearest(target));
    }

    /// Oscillates about the present reference with `frequency` in Hz; the amplitude grows over one period.
    pub fn oscillate(&mut self, amplitude: f32, frequency: f32) {
        self.trajectory.oscillate(amplitude, frequency);
    }

    /// One sample: reads the sensor, moves the valve, learns.
    ///
    /// Cost: see the table of instruction counts.
    pub fn update(&mut self) -> Report {
        let code = self.sensor.counts().ok();
        self.errors = match code {
            Some(_) => 0,
            None => self.errors.saturating_add(1),
        };
        let same_code = self.begun && code.is_none_or(|code| code == self.code);
        let y = match code {
            Some(code) => {
                self.code = code;
                self.axis.position(code)
            }
            None if self.begun && self.errors < self.sensor_errors => self.expected(),
            None => return self.blind(),
        };
        self.position = y;
        self.begin(y);
        self.tracking.update(y);
        let (setpoint, requested) = self.requested(y);
        let Ok(command) = self.valve.drive(self.limiter.update(requested)) else {
            self.supervisor.fail(Reason::ValveFault);
            return self.report(setpoint, 0.0, None, false);
        };
        self.controller.applied(command);
        let inputs = self.inputs(command);
        self.monitor.update(command);
        let outcome = self.identifier.update_inputs(inputs, y);
        let retuned = self.supervise(&setpoint, y, command, same_code, outcome);
        self.report(setpoint, command, outcome.innovation(), retuned)
    }

    /// The first sample, and the first one of a commissioning.
    fn begin(&mut self, y: f32) {
        if !self.begun {
            self.begun = true;
            self.tracking.place(y);
            self.trajectory.hold(y);
            self.controller.place(Motion::at(y));
        }
        if self.start_requested {
            self.start_requested = false;
            self.supervisor.begin(y);
            self.excitation.begin(y);
            self.identifier.reset();
        }
    }

    /// The setpoint, and the command before its limits.
    fn requested(&mut self, y: f32) -> (Setpoint, f32) {
        let state = self.supervisor.state();
        if state.is_commissioning() {
            let velocity = self.tracking.motion().velocity;
            (Setpoint::at(y), self.excitation.update(y, velocity))
        } else if state.is_controlling() {
            let setpoint = self.trajectory.update();
            (setpoint, self.controller.update(&setpoint, y))
        } else {
            (Setpoint::at(y), 0.0)
        }
    }

    /// The inputs of the identifier: everything is unknown while commissioning, valve and friction are known in control.
    fn inputs(&self, command: f32) -> [f32; 3] {
        if self.supervisor.state().is_controlling() {
            return inputs_of_known(command, &self.controller);
        }
        let velocity = self.tracking.motion().velocity;
        inputs_of_unknown(command, velocity, self.friction_velocity)
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
        }
    }

    /// The motion as far as it is known: by the observer in control, else by the measured positions alone.
    fn motion(&self) -> Motion {
        if self.supervisor.state().is_controlling() {
            self.controller.motion()
        } else {
            self.tracking.motion()
        }
    }

    /// Where the axis should be now: what bridges a reading that failed.
    fn expected(&self) -> f32 {
        let (m, t) = (self.motion(), self.sample_time);
        m.position + t * (m.velocity + 0.5 * t * m.acceleration)
    }

    /// A sample without a position and nothing to bridge it: the valve goes to zero.
    fn blind(&mut self) -> Report {
        if self.errors >= self.sensor_errors {
            self.supervisor.fail(Reason::SensorFault);
        }
        let requested = self.limiter.update(0.0);
        let command = match self.valve.drive(requested) {
            Ok(command) => command,
            Err(_) => {
                self.supervisor.fail(Reason::ValveFault);
                0.0
            }
        };
        self.identifier.restart_trends();
        self.report(Setpoint::at(self.position), command, None, false)
    }

    /// Everything between the identifier and the controller; whether a model reached the controller.
    fn supervise(
        &mut self,
        setpoint: &Setpoint,
        y: f32,
        command: f32,
        same_code: bool,
        outcome: Outcome,
    ) -> bool {
        let state = self.supervisor.state();
        let motion = self.motion();
        let seen = Observation {
            motion,
            y,
            u: command,
            same_code,
            sticks: state.is_controlling() && self.controller.observer().sticks(),
            error: setpoint.position - motion.position,
            innovation: outcome.innovation(),
        };
        let mut event = if state.is_commissioning() && self.excitation.runs_away(y) {
            let reason = self.runaway_reason();
            self.supervisor.give_up(reason)
        } else {
            self.supervisor.update(&seen)
        };
        let learns = self.adaptive || self.supervisor.state().is_commissioning();
        if learns && event == Event::None && self.supervisor.wants_candidate() {
            let candidate = self.candidate();
            event = self.supervisor.submit(&candidate, &seen);
        }
        self.identifier.adapt(self.learns());
        self.follow(event, state)
    }

    /// Whether the identifier learns from this sample.
    fn learns(&self) -> bool {
        let state = self.supervisor.state();
        state.is_commissioning()
            || (self.adaptive
                && state == State::Adapting
                && self.monitor.is_exciting()
                && self.slides())
    }

    /// Whether the axis slides, and has slid for a while: a start shows more of friction than of the model.
    fn slides(&self) -> bool {
        let observer = self.controller.observer();
        !observer.sticks() && observer.friction().since() > self.settled
    }

    /// Carries out what the supervisor decided; whether a model reached the controller.
    fn follow(&mut self, event: Event, before: State) -> bool {
        match event {
            Event::None | Event::Stopped => false,
            Event::Accepted(model) => {
                self.controller.retune(model);
                if before.is_commissioning() {
                    reopen(&mut self.identifier, &model, REOPENED_STD);
                    self.take_over(self.tracking.motion());
                } else {
                    self.identifier.trust();
                }
                true
            }
            Event::Restored(model) => {
                reopen(&mut self.identifier, &model, REOPENED_STD);
                self.controller.retune(model);
                if before.is_commissioning() {
                    self.take_over(self.tracking.motion());
                }
                true
            }
            Event::Changed => {
                if self.adaptive
                    && let Some(model) = self.supervisor.verified_model()
                {
                    reopen(&mut self.identifier, &model, CHANGED_STD);
                }
                false
            }
        }
    }

    /// The controller takes the axis over in motion and lets it run out.
    fn take_over(&mut self, motion: Motion) {
        self.controller.place(motion);
        self.trajectory.run_out(motion, self.run_out_rate);
    }

    /// Why the axis left its band.
    fn runaway_reason(&self) -> Reason {
        let candidate = self.candidate();
        if self.supervisor.commissioning().is_one_way() || !candidate.has_certain_sign() {
            Reason::ValveStuck
        } else if candidate.model.b0 < 0.0 {
            Reason::WrongSign
        } else {
            Reason::TravelEnd
        }
    }

    /// The present estimate; in control with the valve and the friction of the controller.
    fn candidate(&self) -> Candidate {
        let controlling = self.supervisor.state().is_controlling();
        candidate(&self.identifier, controlling.then_some(&self.controller))
    }

    /// The supervisor, for its state, its reasons and the fit of models.
    pub const fn supervisor(&self) -> &Supervisor {
        &self.supervisor
    }

    /// The identifier, for its estimate.
    pub const fn identifier(&self) -> &LoopIdentifier {
        &self.identifier
    }

    /// The controller, for its model and what it observes.
    pub const fn controller(&self) -> &Controller {
        &self.controller
    }

    /// The sensor, e.g. of a simulation.
    pub const fn sensor_mut(&mut self) -> &mut S {
        &mut self.sensor
    }

    /// The valve, e.g. of a simulation.
    pub const fn valve_mut(&mut self) -> &mut V {
        &mut self.valve
    }
}

/// A stable model for the controller until one is verified.
fn placeholder(config: &Config) -> Model {
    let square = config.bandwidth * config.bandwidth;
    Model::linear(square, config.bandwidth, square * config.travel.length())
}
