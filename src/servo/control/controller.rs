//! Pole placement on a verified model, with feedforward, inverse of the valve and a bumpless change of gains.

use crate::error::positive;
use crate::math::within;
use crate::servo::control::observer::Observer;
use crate::servo::control::standstill::Standstill;
use crate::servo::design::ControllerDesign;
use crate::servo::model::Model;
use crate::servo::motion::{Motion, Setpoint};

/// Position controller by pole placement.
///
/// ```text
/// (s + w)(s^2 + 2 zeta w s + w^2) = s^3 + p2 s^2 + p1 s + p0
/// flow = ( r''' + p2 r'' + p1 r' + p0 (r - x) - (p1 - a1) v - (p2 - a2) a ) / b0 - d
/// u    = inverse of dead zone and offset (flow) + remainder of the last change of gains
/// ```
///
/// x, v, a and the disturbance d come from an observer on the same model; the terms in r
/// are the inverse model. d is the integral action. A new model changes no command at
/// the sample of its arrival: the difference is kept and fades, at most five full commands per s.
/// While the axis sticks, the standstill has the valve.
///
/// Known as: pole placement by state feedback with disturbance observer; bumpless transfer (Astrom and Hagglund 2006).
///
/// # Examples
/// ```
/// use trendid::servo::{Config, Controller, Model, Motion, Setpoint, Travel};
/// let model = Model::linear(400.0, 20.0, 1.0e6);
/// let design = Config::new(0.001, 10.0, Travel { min: 0.0, max: 400.0 }).resolve()?;
/// let mut controller = Controller::new(&design, model);
/// // The model is its own plant here.
/// let mut plant = Motion::default();
/// for _ in 0..1000 {
///     let u = controller.update(&Setpoint::at(10.0), plant.position);
///     let u = u.clamp(-1.0, 1.0);
///     controller.applied(u);
///     model.advance(&mut plant, u, 0.001);
/// }
/// assert!((plant.position - 10.0).abs() < 0.05);
/// # Ok::<(), trendid::servo::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    design: ControllerDesign,
    observer: Observer,
    standstill: Standstill,
    inverse_gain: f32,
    /// The flow in force until the next sample.
    flow: f32,
    arriving: Option<Model>,
    /// A factor on the bandwidth that comes into force with the next sample, and the coefficients with the present one.
    arriving_factor: Option<f32>,
    wanted: [f32; 3],
    settling: [f32; 3],
    /// Remainder of the last change of gains, as a command.
    trace: f32,
}

impl Controller {
    /// A controller on `model`, at rest in zero.
    pub fn new(design: &crate::servo::Design, model: Model) -> Self {
        let design = &design.controller;
        Self {
            design: design.clone(),
            observer: Observer::new(&design.observer, model),
            standstill: Standstill::new(&design.standstill),
            inverse_gain: 1.0 / model.b0,
            flow: model.flow(0.0),
            arriving: None,
            arriving_factor: None,
            wanted: design.wanted,
            settling: design.settling,
            trace: 0.0,
        }
    }

    /// Multiplies the wanted bandwidth by a factor of 0 to 1 from the next sample on, without a step of the command.
    pub(crate) const fn derate(&mut self, factor: f32) {
        self.arriving_factor = Some(factor);
    }

    fn slow_down(&mut self, factor: f32) {
        let slower = |[p0, p1, p2]: [f32; 3]| {
            let square = factor * factor;
            [p0 * square * factor, p1 * square, p2 * factor]
        };
        self.wanted = slower(self.design.wanted);
        self.settling = slower(self.design.settling);
    }

    /// The command that brakes to velocity zero, wherever that is; [`Controller::applied`] must follow.
    pub(crate) fn brake(&mut self, y: f32) -> f32 {
        self.observer.predict(self.flow);
        self.observer.correct(y);
        let model = self.observer.model();
        if self.observer.sticks() {
            return -model.offset;
        }
        let Motion {
            velocity: v,
            acceleration: a,
            ..
        } = self.observer.motion();
        let [_, p1, p2] = self.wanted;
        let jerk = (model.a1 - p1) * v + (model.a2 - p2) * a;
        let flow = jerk * self.inverse_gain - self.observer.disturbance();
        within(model.command(flow, self.design.blend), 1.0)
    }

    /// Begins at a motion, without an offset of earlier gains.
    pub fn place(&mut self, motion: Motion) {
        self.observer.place(motion);
        self.trace = 0.0;
        self.standstill.wake();
    }

    /// Begins at a motion with a verified model and the command in force, with no trace of earlier gains.
    pub(crate) fn begin(&mut self, model: Model, motion: Motion, command: f32) {
        self.arriving = None;
        self.observer.tune(model);
        self.inverse_gain = 1.0 / model.b0;
        self.place(motion);
        self.applied(command);
    }

    /// Goes over to another verified model at the next sample; ignored unless finite with a positive gain.
    pub fn retune(&mut self, model: Model) {
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
        if self.observer.sticks() && setpoint.is_rest() {
            self.observer.friction_mut().limit_drive();
        }
        self.standstill.update(setpoint, &self.observer);
        self.trace -= within(self.design.fade * self.trace, self.design.transition_step);
        let mut command = self.law(setpoint) + self.trace;
        let arriving = self.arriving.take();
        if let Some(model) = arriving {
            self.observer.tune(model);
            self.inverse_gain = 1.0 / model.b0;
        }
        let factor = self.arriving_factor.take();
        if let Some(factor) = factor {
            self.slow_down(factor);
        }
        if arriving.is_some() || factor.is_some() {
            // Within the full command on both sides: beyond it the valve saturates anyway.
            let changed = self.law(setpoint);
            self.trace = within(command, 1.0) - changed;
            command = changed + self.trace;
        }
        command
    }

    /// Takes the command that was set, after range, rate and resolution of the valve.
    #[inline]
    pub fn applied(&mut self, command: f32) {
        self.flow = self.observer.model().flow(command);
    }

    /// The control law at the present state, within the full command.
    #[inline]
    fn law(&self, r: &Setpoint) -> f32 {
        let model = self.observer.model();
        if self.standstill.rests() {
            // The middle of the dead zone.
            return -model.offset;
        }
        let flow = if self.observer.sticks() {
            self.break_away(r)
        } else {
            self.follow(r)
        };
        within(model.command(flow, self.design.blend), 1.0)
    }

    /// The axis sticks: the standstill moves it, toward the reference or toward the target at rest.
    #[inline]
    fn break_away(&self, r: &Setpoint) -> f32 {
        let error = r.position - self.observer.motion().position;
        let direction = self.wanted_direction(r);
        if direction == 0.0 {
            return self
                .standstill
                .approach(error, &self.observer, self.inverse_gain);
        }
        let [p0, p1, p2] = self.wanted;
        let needed = r.acceleration + (p1 * r.velocity + p0 * error) / p2;
        self.standstill
            .follow(direction, error, needed, &self.observer, self.inverse_gain)
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
        let coulomb = self.observer.friction().coulomb();
        let slow = coulomb > 0.0 && within(v, self.design.stiction_velocity) == v;
        let [p0, p1, p2] = if slow && r.is_rest() {
            self.settling
        } else {
            self.wanted
        };
        // A large error is worked off at a limited speed: beyond it the valve only saturates.
        let pull = within(p0 * (r.position - x), p1 * self.design.catch_up);
        // About to reverse: the drive has to bring up friction in the other direction.
        let direction = self.wanted_direction(r);
        let reversal = if direction == 0.0 || coulomb == 0.0 {
            0.0
        } else {
            self.observer.drive() - coulomb * direction - a
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
    /// Known as: Stribeck effect.
    #[inline]
    fn extra_friction(&self, r: &Setpoint) -> f32 {
        let extra = self.design.stribeck * self.observer.friction().coulomb();
        let ratio = r.velocity * self.design.inverse_stiction_velocity;
        let magnitude = if ratio < 0.0 { -ratio } else { ratio };
        let share = 1.0 / (1.0 + ratio * ratio);
        -2.0 * extra
            * magnitude
            * r.acceleration
            * self.design.inverse_stiction_velocity
            * share
            * share
    }

    /// The present or next direction of the reference; 0 at rest.
    #[inline]
    fn wanted_direction(&self, r: &Setpoint) -> f32 {
        let ahead = r.velocity + self.design.reversal_lookahead * r.acceleration;
        if ahead > 0.0 {
            1.0
        } else if ahead < 0.0 {
            -1.0
        } else {
            0.0
        }
    }

    /// The observer.
    pub(crate) const fn observer(&self) -> &Observer {
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
    pub const fn model(&self) -> &Model {
        self.observer.model()
    }
}
