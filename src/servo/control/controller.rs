//! Pole placement on a verified model, with observer, feedforward, valve inverse and limits.

use crate::error::positive;
use crate::math::within;
use crate::servo::control::observer::Observer;
use crate::servo::error::ServoError;
use crate::servo::model::ServoModel;
use crate::servo::motion::{Motion, Setpoint};

/// Range and rate of a command, enforced on every sample.
///
/// Guarantees: |u| <= range, |u(k) - u(k-1)| <= rate Delta, whatever comes in, NaN included.
///
/// # Examples
/// ```
/// let mut limiter = trendid::CommandLimiter::try_new(0.5, 100.0, 0.001)?;
/// assert_eq!(limiter.update(7.0), 0.1);
/// assert_eq!(limiter.update(f32::NAN), 0.0); // a wish that is no number is zero
/// # Ok::<(), trendid::ServoError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CommandLimiter {
    range: f32,
    step: f32,
    last: f32,
}

impl CommandLimiter {
    /// `range` of the command within 0..=1, `rate` per second.
    ///
    /// # Errors
    /// [`ServoError::CommandRange`], [`ServoError::CommandRate`], [`ServoError::SampleTime`].
    pub fn try_new(range: f32, rate: f32, sample_time: f32) -> Result<Self, ServoError> {
        if !(range > 0.0 && range <= 1.0) {
            return Err(ServoError::CommandRange(range));
        }
        if !positive(rate) {
            return Err(ServoError::CommandRate(rate));
        }
        if !positive(sample_time) {
            return Err(ServoError::SampleTime(sample_time));
        }
        Ok(Self {
            range,
            step: rate * sample_time,
            last: 0.0,
        })
    }

    /// The command nearest to `wish` that range and rate allow. Cost: about 15 instructions.
    #[inline]
    pub fn update(&mut self, wish: f32) -> f32 {
        let wish = if wish.is_nan() {
            0.0
        } else {
            within(wish, self.range)
        };
        // Against the bounds themselves, so that no rounding of a sum exceeds the range.
        let (low, high) = (self.last - self.step, self.last + self.step);
        self.last = if wish > high {
            high
        } else if wish < low {
            low
        } else {
            wish
        };
        self.last
    }

    /// The newest command.
    pub const fn last(&self) -> f32 {
        self.last
    }

    /// The largest change per sample.
    pub const fn step(&self) -> f32 {
        self.step
    }
}

/// Wanted closed loop and what the controller may do.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ControllerConfig {
    /// Wanted bandwidth w in rad/s.
    pub bandwidth: f32,
    /// Wanted damping zeta of the pair of poles.
    pub damping: f32,
    /// Rate of the observer in rad/s; four to six times the bandwidth.
    pub observer_rate: f32,
    /// Half width of the flow over which the inverse of the dead zone changes sign.
    pub blend: f32,
    /// Position error within which the valve rests at standstill, in units of y; 0 never rests.
    pub rest_window: f32,
    /// How far ahead a reversal is prepared, in s: the time in which the valve turns friction over.
    pub reversal: f32,
    /// Rate at which the drive force is moved while the axis sticks, in rad/s.
    pub stick_rate: f32,
    /// Movement that counts as breaking loose, in units of y; twice the standard deviation of the noise.
    pub start: f32,
    /// Growth of the push beside the target, flow per s.
    pub creep: f32,
    /// Friction at the smallest speed beyond Coulomb friction, in parts of it.
    pub stribeck: f32,
    /// Bandwidth at the end of a move over the wanted one: slow motion under friction asks for more.
    pub settle: f32,
    /// Speed, beside that of the reference, at which a position error is worked off at most, in units of y per s.
    pub catch_up: f32,
    /// Velocity below which friction rules the motion, in units of y per s.
    pub slow: f32,
    /// Time in which the trace of a change of gains disappears, in s.
    pub transition: f32,
}

impl ControllerConfig {
    /// Damping 0.8, observer 3.5 times as fast, transition 50 ms, no rest window.
    pub const fn new(bandwidth: f32) -> Self {
        Self {
            bandwidth,
            damping: 0.8,
            observer_rate: 3.5 * bandwidth,
            blend: 0.005,
            rest_window: 0.0,
            reversal: 0.006,
            stick_rate: 230.0,
            start: f32::MAX,
            creep: 0.045,
            stribeck: 0.8,
            settle: 2.8,
            catch_up: f32::MAX,
            slow: 0.0,
            transition: 0.05,
        }
    }
}

/// Largest change of the command per sample that the trace of a change of gains may make.
const TRANSITION_STEP: f32 = 0.005;

/// Samples within the rest window before the valve rests.
const REST_SAMPLES: u16 = 10;

/// Rate of the drive over friction, per s, with which a sticking axis is pushed behind its reference at least.
const INSIST: f32 = 25.0;

/// Growth of that rate per sample of sticking.
const IMPATIENCE: f32 = 0.03;

/// Hops beside a target after which the rest window grows, growth per hop, and number of hops that count.
const PATIENCE: u16 = 2;
const WIDER: f32 = 0.15;
const HUNT: u16 = 3;

/// Flow with which a resting axis beside its target is pushed: at first and at most.
const CREEP_LEAST: f32 = 0.01;
const CREEP_MOST: f32 = 0.05;

/// Growth of the growth of that push per sample of sticking.
const HASTE: f32 = 0.002;

/// Position controller by pole placement.
///
/// ```text
/// (s + w)(s^2 + 2 zeta w s + w^2) = s^3 + p2 s^2 + p1 s + p0
/// flow = ( r''' + p2 r'' + p1 r' + p0 (r - x) - (p1 - a1) v - (p2 - a2) a ) / b0 - d
/// u    = inverse of dead zone and offset (flow) + what is left of the last change of gains
/// ```
///
/// x, v, a and the disturbance d come from an [`Observer`] on the same model; the terms in r
/// are the inverse model. d is the integral action. A new model changes no command at
/// the sample of its arrival: the difference is kept and fades, at most 0.5 % of the full
/// command per sample.
///
/// # Examples
/// ```
/// use trendid::{Controller, ControllerConfig, Motion, ServoModel, Setpoint};
/// let model = ServoModel::linear(400.0, 20.0, 1.0e6);
/// let mut controller = Controller::try_new(&ControllerConfig::new(25.0), model, 0.001)?;
/// // The model is its own plant here.
/// let mut plant = Motion::default();
/// for _ in 0..1000 {
///     let u = controller.update(&Setpoint::at(10.0), plant.position);
///     let u = u.clamp(-1.0, 1.0);
///     controller.applied(u);
///     model.advance(&mut plant, u, 0.001);
/// }
/// assert!((plant.position - 10.0).abs() < 1e-3);
/// # Ok::<(), trendid::ServoError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Controller {
    observer: Observer,
    /// p0, p1, p2.
    wanted: [f32; 3],
    /// The same for slow motion at the target.
    settle: [f32; 3],
    slow: f32,
    /// Speed at which a position error is worked off at most.
    catch_up: f32,
    creep_growth: f32,
    stribeck: f32,
    inverse_gain: f32,
    blend: f32,
    /// Commands are predicted with this flow until the next sample.
    flow: f32,
    arriving: Option<ServoModel>,
    trace: f32,
    fade: f32,
    rest_window: f32,
    quiet: u16,
    creep: f32,
    creeping: bool,
    /// How often it broke loose beside the present target.
    hops: u16,
    /// Push at which a resting axis moved, downwards and upwards.
    edge: [f32; 2],
    inverse_slow: f32,
    /// How far ahead a reversal of the reference is prepared, in s.
    ahead: f32,
    /// Rate at which the drive is moved while the axis sticks, in rad/s.
    stick_rate: f32,
}

impl Controller {
    /// A controller on `model`, at rest in zero.
    ///
    /// # Errors
    /// A [`ServoError`] that names the setting.
    pub fn try_new(
        config: &ControllerConfig,
        model: ServoModel,
        sample_time: f32,
    ) -> Result<Self, ServoError> {
        let w = config.bandwidth;
        if !positive(sample_time) {
            return Err(ServoError::SampleTime(sample_time));
        }
        if !(positive(w) && w * sample_time < 0.2) {
            return Err(ServoError::Bandwidth(w));
        }
        if !positive(config.damping) {
            return Err(ServoError::Damping(config.damping));
        }
        if !(positive(config.observer_rate) && config.observer_rate * sample_time <= 0.3) {
            return Err(ServoError::ObserverRate(config.observer_rate));
        }
        if !positive(config.blend) {
            return Err(ServoError::Bound(config.blend));
        }
        if !positive(config.transition) {
            return Err(ServoError::Time(config.transition));
        }
        if !(config.rest_window >= 0.0 && config.rest_window.is_finite()) {
            return Err(ServoError::RestWindow(config.rest_window));
        }
        if !(model.is_finite() && positive(model.b0)) {
            return Err(ServoError::Model);
        }
        if !(config.reversal >= 0.0 && config.reversal < 1.0) {
            return Err(ServoError::Time(config.reversal));
        }
        if !(positive(config.stick_rate) && config.stick_rate * sample_time < 0.5) {
            return Err(ServoError::Bandwidth(config.stick_rate));
        }
        if !positive(config.start) {
            return Err(ServoError::Bound(config.start));
        }
        let pair = 2.0 * config.damping;
        let s = config.settle * w;
        let mut observer = Observer::new(model, config.observer_rate, sample_time);
        observer.set_start(config.start, config.slow);
        Ok(Self {
            observer,
            wanted: [w * w * w, (1.0 + pair) * w * w, (1.0 + pair) * w],
            settle: [s * s * s, (1.0 + pair) * s * s, (1.0 + pair) * s],
            slow: config.slow,
            catch_up: config.catch_up,
            creep_growth: config.creep * sample_time,
            stribeck: config.stribeck,
            inverse_gain: 1.0 / model.b0,
            blend: config.blend,
            flow: model.flow(0.0),
            arriving: None,
            trace: 0.0,
            fade: sample_time / config.transition,
            rest_window: config.rest_window,
            quiet: 0,
            creep: 0.0,
            creeping: false,
            hops: 0,
            edge: [CREEP_LEAST; 2],
            inverse_slow: if config.slow > 0.0 {
                1.0 / config.slow
            } else {
                0.0
            },
            ahead: config.reversal,
            stick_rate: config.stick_rate,
        })
    }

    /// Begins at a motion, with no trace of earlier gains.
    pub fn place(&mut self, motion: Motion) {
        self.observer.place(motion);
        self.trace = 0.0;
        self.quiet = 0;
    }

    /// Goes over to another verified model at the next sample; ignored unless finite with a positive gain.
    pub fn retune(&mut self, model: ServoModel) {
        if model.is_finite() && positive(model.b0) {
            self.arriving = Some(model);
        }
    }

    /// The command for a setpoint and a measured position; [`Controller::applied`] must follow.
    ///
    /// Cost: see the table of instruction counts.
    #[inline]
    pub fn update(&mut self, setpoint: &Setpoint, y: f32) -> f32 {
        self.observer.predict(self.flow);
        self.observer.correct(y);
        self.rest(setpoint);
        self.trace -= within(self.fade * self.trace, TRANSITION_STEP);
        let mut command = self.law(setpoint) + self.trace;
        if let Some(model) = self.arriving.take() {
            self.observer.tune(model);
            self.inverse_gain = 1.0 / model.b0;
            // Within the full command on both sides: beyond it is saturation and no difference.
            let changed = self.law(setpoint);
            self.trace = within(command, 1.0) - changed;
            command = changed + self.trace;
        }
        command
    }

    /// Tells the controller what was set, after range, rate and resolution of the valve.
    #[inline]
    pub fn applied(&mut self, command: f32) {
        self.flow = self.observer.model().flow(command);
    }

    /// The control law at the present state, within the full command.
    #[inline]
    fn law(&self, r: &Setpoint) -> f32 {
        let model = self.observer.model();
        if self.rests() {
            // The middle of the dead zone.
            return -model.offset;
        }
        let flow = if self.observer.sticks() {
            self.loosen(r)
        } else {
            self.follow(r)
        };
        within(model.command(flow, self.blend), 1.0)
    }

    /// Pole placement while the axis moves.
    #[inline]
    fn follow(&self, r: &Setpoint) -> f32 {
        let model = self.observer.model();
        let Motion {
            position: x,
            velocity: v,
            acceleration: a,
        } = self.observer.motion();
        let slow = self.slow;
        let creeps = self.observer.coulomb() > 0.0 && within(v, slow) == v;
        let [p0, p1, p2] = if creeps && r.is_rest() {
            self.settle
        } else {
            self.wanted
        };
        // A large error is worked off at a limited speed: beyond it the valve only saturates.
        let pull = within(p0 * (r.position - x), p1 * self.catch_up);
        // About to reverse: the drive has to bring up friction in the other direction.
        let direction = self.wanted_direction(r);
        let reversal = if direction == 0.0 || self.observer.coulomb() == 0.0 {
            0.0
        } else {
            self.observer.drive() - self.observer.coulomb() * direction - a
        };
        let jerk = r.jerk
            + self.extra_friction(r)
            + p2 * (r.acceleration - a - reversal)
            + p1 * (r.velocity - v)
            + pull
            + model.a1 * v
            + model.a2 * a;
        jerk * self.inverse_gain - self.observer.disturbance()
    }

    /// Rate of the extra friction at low speed, which the drive has to meet on the way to rest and sheds when it starts.
    ///
    /// `f = (breakaway - friction) sgn(v) / (1 + (v/slow)^2)`, along the reference.
    #[inline]
    fn extra_friction(&self, r: &Setpoint) -> f32 {
        let extra = self.stribeck * self.observer.coulomb();
        let ratio = r.velocity * self.inverse_slow;
        let magnitude = if ratio < 0.0 { -ratio } else { ratio };
        let share = 1.0 / (1.0 + ratio * ratio);
        -2.0 * extra * magnitude * r.acceleration * self.inverse_slow * share * share
    }

    /// The direction that the reference has, or is about to have; 0 at rest.
    #[inline]
    fn wanted_direction(&self, r: &Setpoint) -> f32 {
        let ahead = r.velocity + self.ahead * r.acceleration;
        if ahead > 0.0 {
            1.0
        } else if ahead < 0.0 {
            -1.0
        } else {
            0.0
        }
    }

    /// The axis sticks: the drive p is brought to where it breaks loose in the wanted direction.
    #[inline]
    fn loosen(&self, r: &Setpoint) -> f32 {
        let friction = self.observer.coulomb();
        let error = r.position - self.observer.motion().position;
        let [p0, p1, p2] = self.wanted;
        let direction = self.wanted_direction(r);
        if direction != 0.0 {
            let push = r.acceleration + (p1 * r.velocity + p0 * error) / p2;
            let goal = self.observer.breakaway() * direction + push;
            let rate = (goal - self.observer.drive()) * self.stick_rate;
            // Where the drive is already there and the axis still sticks, the drive is not what it seems.
            let least = INSIST * friction * (1.0 + IMPATIENCE * f32::from(self.observer.since()));
            let rate = if rate * direction > least {
                rate
            } else if error * direction > 0.0 {
                least * direction
            } else {
                rate
            };
            return rate * self.inverse_gain;
        }
        // At rest beside the target: quickly to the friction, then slowly until it moves.
        let direction = if error > 0.0 { 1.0 } else { -1.0 };
        let missing = friction - direction * self.observer.drive();
        let quick = if missing > 0.0 {
            missing * self.stick_rate * self.inverse_gain
        } else {
            0.0
        };
        direction * (quick + self.creep)
    }

    /// Counts the samples in the window at standstill, and lets the push grow outside of it.
    #[inline]
    fn rest(&mut self, r: &Setpoint) {
        let sticks = self.observer.sticks();
        let error = r.position - self.observer.motion().position;
        if !r.is_rest() {
            self.hops = 0;
        }
        let side = usize::from(error > 0.0);
        if sticks && r.is_rest() {
            self.observer.doubt_drive();
            if !self.creeping {
                self.creep = 0.8 * self.edge[side];
            }
            // The longer it sticks, the less is the dead zone what it seems.
            let haste = 1.0 + HASTE * f32::from(self.observer.since());
            let next = self.creep + self.creep_growth * haste;
            self.creep = if next < CREEP_MOST { next } else { CREEP_MOST };
            self.creeping = true;
        } else {
            if self.creeping && r.is_rest() {
                self.hops = self.hops.saturating_add(1);
                // It moved: what the dead zone really is on this side, to begin there next time.
                self.edge[side] += 0.5 * (self.creep - self.edge[side]);
            }
            self.creeping = false;
        }
        let still = sticks || self.observer.model().friction == 0.0;
        if !(self.rest_window > 0.0 && r.is_rest() && still) {
            self.quiet = 0;
            return;
        }
        // An axis whose hops are longer than the window would hunt for ever.
        let hops = self.hops.saturating_sub(PATIENCE).min(HUNT);
        let wide = self.rest_window * (1.0 + WIDER * f32::from(hops));
        // Wider while it rests, so that noise does not wake it.
        let window = if self.quiet >= REST_SAMPLES {
            wide
        } else {
            0.9 * wide
        };
        if within(error, window) != error {
            self.quiet = 0;
        } else if self.quiet < REST_SAMPLES {
            self.quiet += 1;
        }
    }

    /// Whether the valve rests because the axis stands within the window.
    pub const fn rests(&self) -> bool {
        self.quiet >= REST_SAMPLES
    }

    /// The observer.
    pub const fn observer(&self) -> &Observer {
        &self.observer
    }

    /// The observed motion.
    pub const fn motion(&self) -> Motion {
        self.observer.motion()
    }

    /// The observed disturbance, as a flow.
    pub const fn disturbance(&self) -> f32 {
        self.observer.disturbance()
    }

    /// The model in use.
    pub const fn model(&self) -> &ServoModel {
        self.observer.model()
    }
}
