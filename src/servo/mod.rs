//! Sensor, identifier, supervisor, controller and valve in one call per sample.

pub(crate) mod config;
pub(crate) mod control;
pub(crate) mod error;
pub(crate) mod model;
pub(crate) mod motion;
pub(crate) mod supervision;

use crate::estimation::structure::Structure;
use crate::estimation::terms::Terms;
use crate::hardware::{Axis, PositionSensor, Valve};
use crate::identifier::inputs::{coulomb, dead_zone};
use crate::servo::config::LoopConfig;
use crate::servo::control::controller::{CommandLimiter, Controller};
use crate::servo::error::ServoError;
use crate::servo::model::ServoModel;
use crate::servo::motion::alpha_beta_gamma::AlphaBetaGamma;
use crate::servo::motion::trajectory::Trajectory;
use crate::servo::motion::{Motion, Setpoint, Travel};
use crate::servo::supervision::excitation::Excitation;
use crate::servo::supervision::excitation_monitor::Richness;
use crate::servo::supervision::state::{Reason, State};
use crate::servo::supervision::supervisor::{Candidate, Event, Observation, Supervisor};
use crate::trends::Scheme;
use crate::trends::filtered::FilteredTrends;
use crate::{Config, Identifier, Outcome};

/// The identifier of the loop: order 3, theta = (a1, a2, b0 of u, b0 of sgn u, b1 of sgn v, constant).
pub type ServoIdentifier = Identifier<FilteredTrends<3>, 3, 6, 3, 8>;

/// The third input is sgn v times s: Coulomb friction acts on the acceleration, one integration behind the valve.
const STRUCTURE: Structure<3, 6, 3> = Structure::new(
    Terms::of(&[1, 2]),
    [Terms::of(&[0]), Terms::of(&[0]), Terms::of(&[1])],
    true,
);

/// What one sample of the loop did.
#[must_use]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
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

/// Errors of the sensor in a row with which the axis stops; fewer are bridged by where it should be.
const SENSOR_ERRORS: u8 = 3;

/// The adaptive position loop.
///
/// ```text
/// sensor -> y -> [commissioning] excitation ------------------> limiter -> valve -> u
///             `-> [control] reference -> controller ---------'                   |
/// (u, y) -> identifier -> candidate -> supervisor -> verified model -> controller
/// ```
///
/// One call of [`ServoLoop::update`] per sample. Guarantees: the command never leaves
/// its range and never changes faster than its rate; no panic; only + - x / in the update.
///
/// # Examples
/// ```
/// use trendid::hardware::{Axis, PositionSensor, Scale, Valve};
/// use trendid::{LoopConfig, ServoLoop, State, Travel};
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
/// let config = LoopConfig::new(20.0, Travel { begin: 0.0, end: 400.0 });
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
    /// Velocity below which the direction of friction is open.
    slow: f32,
    /// Samples after a start in which the filters still tell of friction.
    settling: u16,
    identifier: ServoIdentifier,
    supervisor: Supervisor,
    controller: Controller,
    excitation: Excitation,
    trajectory: Trajectory,
    limiter: CommandLimiter,
    tracking: AlphaBetaGamma,
    richness: Richness,
    code: i32,
    position: f32,
    begun: bool,
    errors: u8,
    beyond: u16,
    start_requested: bool,
}

impl<S: PositionSensor, V: Valve> ServoLoop<S, V> {
    /// A loop in the state [`State::Idle`].
    ///
    /// # Errors
    /// A [`ServoError`] that names the setting.
    pub fn try_new(
        config: &LoopConfig,
        axis: Axis,
        sensor: S,
        valve: V,
    ) -> Result<Self, ServoError> {
        config.travel.check()?;
        let time = config.sample_time;
        let length = config.travel.length();
        let trends = FilteredTrends::try_new(Scheme::Tustin, time, [2.0 * config.bandwidth; 3])?;
        let mut identify = Config::new(
            STRUCTURE,
            config.bandwidth,
            [config.excitation.amplitude, 1.0, 1.0],
            0.1 * length,
        );
        identify.output_noise = config.noise;
        identify.memory = Some(config.memory);
        identify.delays = [config.delay, config.delay, 0];
        identify.pull = config.pull;
        let square = config.bandwidth * config.bandwidth;
        // Friction, as an acceleration, is an input of the identifier and must stay within its reach.
        if square * length > 1e7 {
            return Err(ServoError::Unit(square * length));
        }
        // Until a model is verified the controller is never asked; any stable model will do.
        let nominal = ServoModel::linear(square, config.bandwidth, square * length);
        Ok(Self {
            sensor,
            valve,
            axis,
            travel: config.travel,
            adaptive: config.adaptive,
            sample_time: time,
            run_out_rate: config.bandwidth,
            slow: 0.1 * config.supervisor.slow,
            settling: (0.75 / (config.bandwidth * time)) as u16,
            identifier: Identifier::try_new(&identify, trends)?,
            supervisor: Supervisor::try_new(&config.supervisor, time)?,
            controller: Controller::try_new(&config.controller, nominal, time)?,
            excitation: Excitation::try_new(&config.excitation, config.travel, time)?,
            trajectory: Trajectory::try_new(config.motion, time, 0.0)?,
            limiter: CommandLimiter::try_new(config.range, config.rate, time)?,
            tracking: AlphaBetaGamma::new(12.0 * config.bandwidth, time),
            richness: Richness::new(config.rich, time),
            code: 0,
            position: 0.0,
            begun: false,
            errors: 0,
            beyond: 0,
            start_requested: false,
        })
    }

    /// Takes a model that is known to be good: control begins with the next sample, at the actual position.
    ///
    /// # Errors
    /// [`ServoError::Model`] when it is not finite or not stable.
    pub fn install(&mut self, model: ServoModel) -> Result<(), ServoError> {
        if !(model.is_finite() && model.a1 > 0.0 && model.a2 > 0.0 && model.b0 > 0.0) {
            return Err(ServoError::Model);
        }
        self.supervisor.install(model);
        self.controller.retune(model);
        self.open_memory(&model, 0.1);
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

    /// Stops commissioning or control: the command goes to zero at its rate limit, the last good gains are kept.
    pub fn abort(&mut self) {
        self.start_requested = false;
        self.supervisor.abort();
    }

    /// Moves to `target`, limited to the travel; may be called in any sample, as fast as the limits of motion allow.
    pub fn move_to(&mut self, target: f32) {
        let target = if target < self.travel.begin {
            self.travel.begin
        } else if target > self.travel.end {
            self.travel.end
        } else {
            target
        };
        self.trajectory.move_to(target);
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
            None if self.begun && self.errors < SENSOR_ERRORS => self.expected(),
            None => return self.blind(),
        };
        self.position = y;
        if !self.begun {
            self.begun = true;
            self.tracking.place(y);
            self.trajectory.hold(y);
            self.controller.place(Motion::at(y));
        }
        self.tracking.update(y);
        if self.start_requested {
            self.start_requested = false;
            self.supervisor.begin(y);
            self.excitation.begin(y);
            self.identifier.reset();
            self.beyond = 0;
        }
        let state = self.supervisor.state();
        let mut setpoint = Setpoint::at(y);
        let wish = if state.is_commissioning() {
            self.excitation.update(y, self.tracking.motion().velocity)
        } else if state.is_controlling() {
            setpoint = self.trajectory.update();
            self.controller.update(&setpoint, y)
        } else {
            0.0
        };
        let command = self.limiter.update(wish);
        let Ok(command) = self.valve.drive(command) else {
            self.supervisor.fail(Reason::ValveFault);
            return self.report(setpoint, 0.0, None, false);
        };
        self.controller.applied(command);
        let inputs = self.inputs(command);
        self.richness.update(command);
        let outcome = self.identifier.update_inputs(inputs, y);
        let retuned = self.supervise(&setpoint, y, command, same_code, outcome);
        self.report(setpoint, command, outcome.innovation(), retuned)
    }

    /// The inputs of the identifier: everything is unknown while commissioning, valve and friction are known in control.
    fn inputs(&self, command: f32) -> [f32; 3] {
        if self.supervisor.state().is_controlling() {
            let flow = self.controller.model().flow(command);
            return [flow, 0.0, self.controller.observer().friction()];
        }
        let [active, sign] = dead_zone(command, 0.0);
        [
            active,
            sign,
            coulomb(self.tracking.motion().velocity, self.slow),
        ]
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

    /// Where the axis should be now: what bridges a reading that failed.
    fn expected(&self) -> f32 {
        let m = if self.supervisor.state().is_controlling() {
            self.controller.motion()
        } else {
            self.tracking.motion()
        };
        let t = self.sample_time;
        m.position + t * (m.velocity + 0.5 * t * m.acceleration)
    }

    /// A sample without a position and nothing to bridge it: the valve goes to zero.
    fn blind(&mut self) -> Report {
        if self.errors >= SENSOR_ERRORS {
            self.supervisor.fail(Reason::SensorFault);
        }
        let wish = self.limiter.update(0.0);
        let command = match self.valve.drive(wish) {
            Ok(command) => command,
            Err(_) => {
                self.supervisor.fail(Reason::ValveFault);
                0.0
            }
        };
        self.identifier.restart_trends();
        self.report(Setpoint::at(self.position), command, None, false)
    }

    /// Everything between the identifier and the controller.
    fn supervise(
        &mut self,
        setpoint: &Setpoint,
        y: f32,
        command: f32,
        same_code: bool,
        outcome: Outcome,
    ) -> bool {
        let state = self.supervisor.state();
        let motion = if state.is_controlling() {
            self.controller.motion()
        } else {
            self.tracking.motion()
        };
        let seen = Observation {
            motion,
            y,
            u: command,
            same_code,
            sticks: state.is_controlling() && self.controller.observer().sticks(),
            error: setpoint.position - motion.position,
            innovation: outcome.innovation(),
        };
        let event = if state.is_commissioning() && self.runs_away(y) {
            let reason = self.runaway_reason();
            self.supervisor.give_up(reason)
        } else {
            self.supervisor.update(&seen)
        };
        let learns = self.adaptive || self.supervisor.state().is_commissioning();
        let event = if learns && event == Event::None && self.supervisor.wants_candidate() {
            let candidate = self.candidate();
            self.supervisor.consider(&candidate, &seen)
        } else {
            event
        };
        let now = self.supervisor.state();
        let learns = now.is_commissioning()
            || (self.adaptive
                && now == State::Adapting
                && self.richness.is_rich()
                && self.slides());
        self.identifier.adapt(learns);
        self.follow(event, state)
    }

    /// Whether the axis slides, and has slid for a while: a start tells more of friction than of the model.
    fn slides(&self) -> bool {
        let observer = self.controller.observer();
        !observer.sticks() && observer.since() > self.settling
    }

    /// Carries out what the supervisor decided; whether a model reached the controller.
    fn follow(&mut self, event: Event, before: State) -> bool {
        match event {
            Event::None | Event::Stopped => false,
            Event::Accepted(model) => {
                self.controller.retune(model);
                if before.is_commissioning() {
                    self.open_memory(&model, 0.1);
                    self.take_over(self.tracking.motion());
                } else {
                    self.identifier.trust();
                }
                true
            }
            Event::Restored(good) => {
                self.open_memory(&good, 0.1);
                self.controller.retune(good);
                if before.is_commissioning() {
                    self.take_over(self.tracking.motion());
                }
                true
            }
            Event::Changed => {
                if self.adaptive
                    && let Some(good) = self.supervisor.good()
                {
                    self.open_memory(&good, 0.5);
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

    /// Identifies on from `model` with `share` of a1, a2 and b0 as standard deviation.
    ///
    /// Dead zone, offset and friction stay as they are: they enter by the inputs. In closed loop, on
    /// slow motion, six parameters would trade places; three do not.
    fn open_memory(&mut self, model: &ServoModel, share: f32) {
        let ServoModel { a1, a2, b0, .. } = *model;
        let theta = [a1, a2, b0, 0.0, -1.0, 0.0];
        let std = [share * a1, share * a2, share * b0, 0.0, 0.0, 0.0];
        // The model was verified, so every number is finite and this cannot be refused.
        let _ = self.identifier.warm_start(theta, std);
    }

    /// Whether the axis left the band of the excitation by more than the way back takes.
    fn runs_away(&mut self, y: f32) -> bool {
        let band = self.excitation.band();
        let slack = 0.5 * band.length();
        let outside = y > band.end + slack || y < band.begin - slack;
        let at_end = y >= self.travel.end || y <= self.travel.begin;
        self.beyond = if outside || at_end {
            self.beyond.saturating_add(1)
        } else {
            0
        };
        self.beyond > 100
    }

    fn runaway_reason(&self) -> Reason {
        let candidate = self.candidate();
        let b0 = candidate.model.b0;
        let sure = b0 * b0 > 9.0 * candidate.b0_variance;
        if self.supervisor.is_one_way() || !sure {
            Reason::ValveStuck
        } else if b0 < 0.0 {
            Reason::WrongSign
        } else {
            Reason::TravelEnd
        }
    }

    /// The present estimate with its relative variances, to first order and as the recursion has them.
    ///
    /// Without the correction for noise bias of [`Identifier::theta`], which costs more
    /// than a sample has; the trial judges the model in any case.
    pub fn candidate(&self) -> Candidate {
        let found = self.identifier.recursion();
        let mut theta = found.theta();
        let covariance = found.covariance();
        // Nothing is certain before the noise is known.
        let known = match self.identifier.noise_std() {
            Some(_) => 1.0,
            None => f32::INFINITY,
        };
        let p = |i: usize, j: usize| known * covariance[i][j];
        let [a1, a2, b0, _, coulomb, _] = theta;
        if coulomb * coulomb < 4.0 * p(4, 4) {
            // Friction by mistake would let the observer stick without cause.
            theta[4] = 0.0;
        }
        let mut model = ServoModel::from_parameters(&theta);
        if self.supervisor.state().is_controlling() {
            let ServoModel {
                dead_zone, offset, ..
            } = *self.controller.model();
            let friction = self.controller.observer().coulomb();
            model = ServoModel {
                dead_zone,
                offset,
                friction,
                ..model
            };
        }
        let b0_variance = p(2, 2);
        let r11 = p(0, 0) / (a1 * a1);
        let r22 = p(1, 1) / (a2 * a2);
        let r12 = p(0, 1) / (a1 * a2);
        let rbb = b0_variance / (b0 * b0);
        let rb1 = p(0, 2) / (a1 * b0);
        Candidate {
            model,
            gain_variance: rbb + r11 - 2.0 * rb1,
            frequency_variance: 0.25 * r11,
            damping_variance: r22 + 0.25 * r11 - r12,
            b0_variance,
        }
    }

    /// The supervisor, for its state, reasons and verdicts.
    pub const fn supervisor(&self) -> &Supervisor {
        &self.supervisor
    }

    /// The identifier, for its estimate.
    pub const fn identifier(&self) -> &ServoIdentifier {
        &self.identifier
    }

    /// The controller, for its model and its observer.
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
