//! State feedback over the delay on a verified model, with feedforward, friction that sticks and the inverse of the valve.

use crate::error::positive;
use crate::math::{sqrt, within};
use crate::servo::control::anchor::{Anchor, Hold};
use crate::servo::control::estimator::{Estimator, State};
use crate::servo::control::poles::{Feedback, Poles};
use crate::servo::control::rest::{RestDesign, RestWindow};
use crate::servo::control::tuning::{Margins, OBSERVER_STEP, Tuning};
use crate::servo::design::{ControllerDesign, TuningDesign};
use crate::servo::model::Model;
use crate::servo::motion::{Motion, Setpoint};

/// Position controller whose bandwidth follows from margins.
///
/// ```text
/// r, x, v, p, d: reference and state when the command takes effect, a delay from now
/// flow = ( r''' + a2 r'' + a1 r' + friction s' + k2 (r'' + a2 r' + friction s - p) + k1 (r' - v) + k0 (r - x) - d ) / b0
/// u    = inverse of dead zone and offset (flow) + what is left of the last change of gains
/// ```
///
/// s is the sign of the next motion of the reference, filtered. The state comes from an observer on the delayed flow and its
/// prediction; a1 and b0 are those of the place. d is the integral action.
/// The poles are the fastest whose margins hold, see [`Margins`]. A new model changes no command at
/// the sample of its arrival: the difference is kept and fades, at most five full commands per s.
/// While friction holds the axis, the drive is brought to where it breaks away; at the target the valve rests.
///
/// Known as: state feedback with disturbance observer and Smith predictor; bumpless transfer (Astrom and Hagglund 2006).
///
/// # Examples
/// ```
/// use trendid::servo::{Config, Controller, Model, Motion, Setpoint, Travel};
/// let model = Model::linear(400.0, 20.0, 1.0e6);
/// let mut config = Config::new(0.001, 20.0, Travel { min: -200.0, max: 200.0 });
/// config.delay = 0.0;
/// config.controller.dead_volume = f32::INFINITY; // as stiff at the ends as in the middle
/// let mut controller = Controller::new(&config.resolve()?, model);
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
    estimator: Estimator,
    anchor: Anchor,
    rest: RestWindow,
    /// Poles without derating with the natural frequency that they were found for, and the factor on their bandwidth.
    poles: Poles,
    found_for: f32,
    margins: Option<Margins>,
    factor: f32,
    /// Natural frequency of the model in the middle.
    frequency: f32,
    /// Whether friction can hold more than the sensor sees.
    sticky: bool,
    /// Filtered sign of the next motion of the reference.
    heading: f32,
    /// Offset of the valve beyond that of the model, as sliding both ways shows it, and the mean disturbance of each.
    null: f32,
    means: [f32; 2],
    known: [f32; 2],
    /// Error and reference at the last breakaway.
    left: [f32; 2],
    arriving: Option<Model>,
    arriving_poles: Option<(Poles, Option<Margins>)>,
    arriving_factor: Option<f32>,
    /// What is left of the last change of gains, as a command.
    trace: f32,
}

/// Friction deflections `friction / a1` over resolution and noise from which friction counts as holding.
const STICKY: f32 = 10.0;
/// Largest speed over C at which an error of the position is worked off.
const CATCH_UP: f32 = 0.3;
/// Stopping deceleration over friction: below the first it is left to friction, beyond the second it would reverse the drive.
const NEED: [f32; 2] = [0.15, 3.0];
/// Rate at which the drive of a sticking axis is brought to its goal, per delay and per sample.
const QUICK: [f32; 2] = [1.0, 0.3];
/// Rate of the push over friction and bandwidth behind a moving reference and at rest, and its growth per 1/wc.
const PUSH: [f32; 2] = [2.0, 0.25];
const PUSH_GROWTH: [f32; 2] = [0.6, 0.3];
/// Integral action is frozen at rest within so many windows.
const FROZEN: f32 = 1.5;
/// Window over the deflection that friction holds: where the dead zone has room to rest in, and where not.
const WINDOW: [f32; 2] = [1.0, 0.2];
/// Errors of dead zone and offset over their values, for the window without friction.
const VALVE_ERROR: [f32; 2] = [0.3, 0.2];
/// Flows up to which the disturbance shows the offset of the valve, time over 1/wd for which both ways must have been seen,
/// rate of the correction over wd, and the most that a commissioning may be wrong by.
const NULL_FLOW: f32 = 0.5;
const NULL_KNOWN: f32 = 3.0;
const NULL_SHARE: f32 = 0.3;
const NULL_MAX: f32 = 0.08;
/// Time constants of the observer in which it settles.
const SETTLING: f32 = 6.0;
/// Drive over friction that waits for a reference which comes to the axis: it holds, and little is missing.
const READY: f32 = 0.8;
/// Time over 1/wc in which a push moves the axis.
const LATER: f32 = 1.5;
/// Distance over friction deflection within which a slow axis stops by its friction.
const NEAR: f32 = 3.0;

impl Controller {
    /// A controller on `model`, at rest in zero; searches its poles: not for the 1 ms path.
    pub fn new(design: &crate::servo::Design, model: Model) -> Self {
        let mut controller = Self::provisional(&design.controller, model);
        controller.search(&model);
        controller.tune(model);
        controller
    }

    /// Searches the poles for a model at once: not for the 1 ms path.
    pub(crate) fn search(&mut self, model: &Model) {
        let mut tuning = Tuning::new(&self.design.tuning, model);
        while !tuning.step() {}
        (self.poles, self.margins) = tuning.poles();
        self.found_for = sqrt(model.a1);
    }

    /// A controller on `model` with these poles, at rest in zero.
    pub(crate) fn with_poles(
        design: &ControllerDesign,
        model: Model,
        poles: Poles,
        margins: Option<Margins>,
    ) -> Self {
        let mut controller = Self {
            design: *design,
            estimator: Estimator::new(&design.estimator, model, poles),
            anchor: Anchor::new(&design.anchor),
            rest: RestWindow::new(&RestDesign {
                least: design.rest_window,
                most: design.rest_window,
            }),
            poles,
            found_for: sqrt(model.a1),
            margins,
            factor: 1.0,
            frequency: 1.0,
            sticky: false,
            heading: 0.0,
            null: 0.0,
            means: [0.0; 2],
            known: [0.0; 2],
            left: [0.0; 2],
            arriving: None,
            arriving_poles: None,
            arriving_factor: None,
            trace: 0.0,
        };
        controller.tune(model);
        controller
    }

    /// Goes over to a model.
    fn tune(&mut self, model: Model) {
        self.frequency = sqrt(model.a1);
        let fastest = OBSERVER_STEP / self.design.estimator.sample_time;
        let poles = self
            .poles
            .on(self.frequency / self.found_for, self.frequency, fastest);
        self.estimator.tune(model, derated(&poles, self.factor));
        self.anchor.tune(poles.observer);
        let deflection = model.friction / model.a1;
        let grain = self.design.grain;
        self.sticky = deflection > STICKY * grain;
        let room = model.dead_zone > 0.3 * model.offset.abs() + 0.002;
        let most = if self.sticky {
            WINDOW[usize::from(!room)] * deflection
        } else {
            let [dead_zone, offset] = VALVE_ERROR;
            let flow = dead_zone * model.dead_zone + offset * model.offset.abs();
            2.0 * flow * model.b0 / (model.a1 * poles.bandwidth)
        };
        let least = self.design.rest_window;
        self.rest.redesign(&RestDesign {
            least,
            most: if most > least { most } else { least },
        });
    }

    /// Multiplies the bandwidth by a factor of 0 to 1 from the next sample on, without a step of the command.
    pub(crate) const fn derate(&mut self, factor: f32) {
        self.arriving_factor = Some(factor);
    }

    /// The command that brakes to velocity zero, wherever that is; [`Controller::applied`] must follow.
    pub(crate) fn brake(&mut self, y: f32) -> f32 {
        self.observe(y, y, true);
        let model = self.estimator.model();
        if self.anchor.holds() {
            return -model.offset - self.null;
        }
        let feedback = self.feedback();
        let [_, k1, k2] = feedback.k;
        let State {
            velocity: v,
            drive: p,
            disturbance: d,
            ..
        } = *self.estimator.ahead();
        let friction = model.friction * sign(v);
        let flow = (k2 * (friction - p) - k1 * v - d) / self.estimator.step().b0;
        within(
            model.valve_command(flow, self.design.blend) - self.null,
            1.0,
        )
    }

    /// Begins at a motion, without an offset of earlier gains.
    pub fn place(&mut self, motion: Motion) {
        self.begin_at(motion, core::iter::empty());
    }

    fn begin_at(&mut self, motion: Motion, flows: impl Iterator<Item = f32>) {
        self.estimator.place(motion, flows);
        self.anchor.restart();
        self.trace = 0.0;
        self.heading = 0.0;
        self.rest.wake();
    }

    /// Begins at a motion with a verified model and the latest commands, newest first, with no trace of earlier gains.
    pub(crate) fn begin(
        &mut self,
        model: Model,
        motion: Motion,
        commands: impl Iterator<Item = f32>,
    ) {
        self.arriving = None;
        self.tune(model);
        let blend = self.design.blend;
        self.begin_at(motion, commands.map(|u| model.valve_flow_of(u, blend)));
    }

    /// Goes over to another verified model at the next sample; ignored unless finite with a positive gain.
    pub fn retune(&mut self, model: Model) {
        if model.is_finite() && positive(model.b0) && positive(model.a1) {
            self.arriving = Some(model);
        }
    }

    /// Samples in which the observer settles: six of its time constants.
    pub(crate) fn settling(&self) -> u32 {
        let samples = SETTLING / (self.estimator.poles().observer * self.sample_time());
        1 + samples as u32
    }

    /// One sample in which somebody else controls: the observer settles.
    pub(crate) fn watch(&mut self, y: f32, command: f32) {
        self.observe(y, y, false);
        self.applied(command);
    }

    /// Control begins where the observer is.
    pub(crate) fn engage(&mut self) {
        self.trace = 0.0;
        self.heading = sign(self.estimator.now().velocity);
        self.rest.wake();
    }

    const fn sample_time(&self) -> f32 {
        self.design.estimator.sample_time
    }

    /// Goes over to other poles for the model in use at the next sample.
    pub(crate) const fn replace_poles(&mut self, poles: Poles, margins: Option<Margins>) {
        self.arriving_poles = Some((poles, margins));
    }

    /// What a search for poles needs to know.
    pub(crate) const fn tuning_design(&self) -> &TuningDesign {
        &self.design.tuning
    }

    /// One sample of the observer, with what friction holds.
    fn observe(&mut self, y: f32, reference: f32, frozen: bool) {
        let now = *self.estimator.now();
        let slow = now.velocity.abs() < self.design.anchor.band * self.estimator.poles().observer;
        let hold = if self.sticky {
            self.anchor.update(y, slow)
        } else {
            Hold::Sliding
        };
        if let Hold::Left(direction) = hold {
            let friction = self.estimator.model().friction;
            self.estimator.release(direction, y, friction);
            self.left = [reference - y, reference];
        }
        if hold == Hold::Stuck {
            let (error, [before, from]) = (reference - y, self.left);
            let hop = error - before - (reference - from);
            let still = 2.0 * (reference - from).abs() < hop.abs();
            if error * before < 0.0 && still {
                self.rest.overshot(error);
            }
            self.left[0] = 0.0;
        }
        let held = self.anchor.holds().then(|| self.anchor.place());
        let _ = self.estimator.update(y, held, frozen);
        if held.is_none() && !frozen {
            self.learn_null();
        }
    }

    /// The offset of the valve from sliding both ways.
    ///
    /// Behind a dead zone that is wrong by e and an offset that is wrong by o the disturbance is `o - e` upwards and `o + e`
    /// downwards: half of their sum is o, whatever e is. It goes from the disturbance to the valve without a step.
    fn learn_null(&mut self) {
        let flow = self.estimator.flow_in_force();
        let time = self.sample_time();
        if within(flow, self.design.blend) == flow || within(flow, NULL_FLOW) != flow {
            return;
        }
        let side = usize::from(flow > 0.0);
        let share = time * self.estimator.poles().disturbance;
        let now = self.disturbance();
        self.means[side] += share * (now - self.means[side]);
        self.known[side] += share;
        if self.known[0] < NULL_KNOWN || self.known[1] < NULL_KNOWN {
            return;
        }
        let step = NULL_SHARE * share * 0.5 * (self.means[0] + self.means[1]);
        let next = within(self.null + step, NULL_MAX);
        let step = next - self.null;
        self.null = next;
        self.means = self.means.map(|mean| mean - step);
        self.estimator.disturb(-step);
    }

    /// The command for a setpoint and a measured position; [`Controller::applied`] must follow.
    ///
    /// Cost: see the table of instruction counts.
    #[inline]
    pub fn update(&mut self, setpoint: &Setpoint, y: f32) -> f32 {
        let rests = setpoint.is_rest();
        let error = setpoint.position - self.estimator.now().position;
        let frozen = rests && within(error, FROZEN * self.rest.window()) == error;
        self.observe(y, setpoint.position, frozen);
        let r = self.ahead(setpoint);
        let changes = self.head(&r);
        if rests {
            let still = self.is_still();
            let error = setpoint.position - self.estimator.now().position;
            self.rest.update(error, still);
        } else {
            self.rest.wake();
        }
        self.trace -= within(self.design.fade * self.trace, self.design.transition_step);
        let mut command = self.law(&r, rests, changes) + self.trace;
        let arriving = self.arriving.take();
        let factor = self.arriving_factor.take();
        let poles = self.arriving_poles.take();
        if arriving.is_some() || factor.is_some() || poles.is_some() {
            if let Some((poles, margins)) = poles {
                (self.poles, self.margins, self.found_for) = (poles, margins, self.frequency);
            }
            self.factor = factor.unwrap_or(self.factor);
            self.tune(arriving.unwrap_or(*self.estimator.model()));
            // Within the full command on both sides: beyond it the valve saturates anyway.
            let changed = self.law(&r, rests, changes);
            self.trace = within(command, 1.0) - changed;
            command = changed + self.trace;
        }
        command
    }

    /// Whether the axis stands: friction holds it. Without friction a closed valve lets it creep.
    fn is_still(&self) -> bool {
        self.sticky && self.anchor.holds()
    }

    /// The reference a delay from now.
    #[inline]
    fn ahead(&self, r: &Setpoint) -> Setpoint {
        let t = self.design.delay;
        let (half, third) = (0.5 * t, t * (1.0 / 3.0));
        Setpoint {
            position: r.position + t * (r.velocity + half * (r.acceleration + third * r.jerk)),
            velocity: r.velocity + t * (r.acceleration + half * r.jerk),
            acceleration: r.acceleration + t * r.jerk,
            jerk: r.jerk,
        }
    }

    /// Follows the sign of the next motion; its rate per s.
    #[inline]
    fn head(&mut self, r: &Setpoint) -> f32 {
        let poles = self.estimator.poles();
        let next = self.next_direction(r, 1.0 / poles.observer);
        let rate = 0.5 * poles.observer * (next - self.heading);
        self.heading += self.design.estimator.sample_time * rate;
        rate
    }

    /// Direction of the reference a time from now; 0 at rest.
    #[inline]
    fn next_direction(&self, r: &Setpoint, time: f32) -> f32 {
        sign(r.velocity + time * r.acceleration)
    }

    fn feedback(&self) -> Feedback {
        let (step, poles) = (self.estimator.step(), self.estimator.poles());
        let w = self.frequency * self.estimator.frequency_ratio();
        poles.feedback(step.a1, step.a2, w)
    }

    /// Takes the command that was set, after range, rate and resolution of the valve.
    #[inline]
    pub fn applied(&mut self, command: f32) {
        let flow = self.believed(self.estimator.model(), command);
        self.estimator.applied(flow);
    }

    /// The flow that the law meant by a command.
    fn believed(&self, model: &Model, command: f32) -> f32 {
        model.valve_flow_of(command + self.null, self.design.blend)
    }

    /// The control law at the present state, within the full command.
    #[inline]
    fn law(&self, r: &Setpoint, at_rest: bool, heading_rate: f32) -> f32 {
        let model = self.estimator.model();
        if self.rest.rests() {
            // The middle of the dead zone.
            return -model.offset - self.null;
        }
        let rate = if self.anchor.holds() {
            self.break_away(r, at_rest)
        } else {
            self.slide(r, at_rest, heading_rate)
        };
        let flow = (rate - self.estimator.ahead().disturbance) / self.estimator.step().b0;
        within(
            model.valve_command(flow, self.design.blend) - self.null,
            1.0,
        )
    }

    fn quick(&self) -> f32 {
        let [per_delay, per_sample] = QUICK;
        let t = self.design.estimator.sample_time;
        let (slow, fast) = (per_delay / (self.design.delay + t), per_sample / t);
        if slow < fast { slow } else { fast }
    }

    /// Rate of the drive that moves a sticking axis.
    #[inline]
    fn break_away(&self, r: &Setpoint, at_rest: bool) -> f32 {
        let model = self.estimator.model();
        let state = self.estimator.ahead();
        let error = r.position - state.position;
        // Where the reference will be when a push has moved the axis: a hop that overshoots it is none.
        let later = LATER / self.estimator.poles().bandwidth;
        let coming = error + later * (r.velocity + 0.5 * later * r.acceleration);
        let direction = sign(coming);
        if within(coming, self.rest.window()) == coming {
            return 0.0;
        }
        if direction * error < -self.rest.window() {
            // The reference comes to the axis, which is held until then.
            let missing = READY * model.friction - direction * state.drive;
            let rate = self.quick() * missing;
            return if rate > 0.0 { direction * rate } else { 0.0 };
        }
        let wc = self.estimator.poles().bandwidth;
        let stuck = self.design.estimator.sample_time * self.anchor.since() as f32;
        let (share, growth) = (
            PUSH[usize::from(at_rest)],
            PUSH_GROWTH[usize::from(at_rest)],
        );
        let least = share * model.friction * wc * (1.0 + growth * wc * stuck);
        let quick = self.quick() * (model.friction - direction * state.drive);
        direction * if quick > least { quick } else { least }
    }

    /// Rate of the drive while the axis slides.
    #[inline]
    fn slide(&self, r: &Setpoint, at_rest: bool, heading_rate: f32) -> f32 {
        let model = self.estimator.model();
        let step = self.estimator.step();
        let state = self.estimator.ahead();
        let error = r.position - state.position;
        if at_rest && self.sticky && self.stops_by_friction(error, state) {
            let goal = stopping_drive(error, state.velocity, model.friction);
            return self.quick() * (goal - state.drive) + step.a1 * state.velocity;
        }
        let Feedback { k: [k0, k1, k2], p } = self.feedback();
        let friction = model.friction * self.heading;
        let pull = within(k0 * error, p[1] * CATCH_UP * model.b0 / model.a1);
        r.jerk
            + step.a2 * r.acceleration
            + step.a1 * r.velocity
            + model.friction * heading_rate
            + k2 * (r.acceleration + step.a2 * r.velocity + friction - state.drive)
            + k1 * (r.velocity - state.velocity)
            + pull
    }

    /// Whether friction rules the rest of the way to a target at rest.
    #[inline]
    fn stops_by_friction(&self, error: f32, state: &State) -> bool {
        let model = self.estimator.model();
        let wc = self.estimator.poles().bandwidth;
        let slow = within(state.velocity * wc, model.friction) == state.velocity * wc;
        slow && within(error * model.a1, NEAR * model.friction) == error * model.a1
    }

    /// A controller on `model` that does little, until there are poles for it.
    pub(crate) fn provisional(design: &ControllerDesign, model: Model) -> Self {
        let (poles, margins) = Tuning::new(&design.tuning, &model).poles();
        Self::with_poles(design, model, poles, margins)
    }

    /// The flow that the axis feels from now on, behind the delay.
    pub(crate) fn flow_in_force(&self) -> f32 {
        self.estimator.flow_in_force()
    }

    /// Whether friction holds the axis.
    pub(crate) const fn sticks(&self) -> bool {
        self.anchor.holds()
    }

    /// Samples since the axis began to stick, or to slide.
    pub(crate) const fn since(&self) -> u32 {
        self.anchor.since()
    }

    /// Acceleration lost to friction, with the sign of the motion: at rest, all of the drive.
    pub(crate) fn friction_force(&self) -> f32 {
        if self.anchor.holds() {
            return self.estimator.now().drive;
        }
        self.estimator.model().friction * sign(self.estimator.now().velocity)
    }

    /// The observed motion.
    pub fn motion(&self) -> Motion {
        self.estimator.motion()
    }

    /// The observed disturbance, as a flow.
    pub fn disturbance(&self) -> f32 {
        self.estimator.now().disturbance / self.estimator.step().b0
    }

    /// The model in use.
    pub const fn model(&self) -> &Model {
        self.estimator.model()
    }

    /// Bandwidth in rad/s, derating included.
    pub const fn bandwidth(&self) -> f32 {
        self.estimator.poles().bandwidth
    }

    /// Margins of the loop in the middle of the travel; `None` when no poles have the wanted ones and the slowest are in use.
    pub const fn margins(&self) -> Option<Margins> {
        self.margins
    }
}

fn derated(poles: &Poles, factor: f32) -> Poles {
    Poles {
        bandwidth: factor * poles.bandwidth,
        disturbance: factor * poles.disturbance,
        ..*poles
    }
}

/// The sign of a value; 0 of zero.
#[inline]
fn sign(value: f32) -> f32 {
    if value > 0.0 {
        1.0
    } else if value < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// The drive with which friction stops the axis at the target: `friction - v^2/(2 distance)` along the motion.
#[inline]
fn stopping_drive(error: f32, velocity: f32, friction: f32) -> f32 {
    let direction = sign(velocity);
    let distance = direction * error;
    let [least, most] = NEED;
    let need = if distance > 0.0 {
        let need = velocity * velocity / (2.0 * distance);
        if need < least * friction {
            0.0
        } else if need < most * friction {
            need
        } else {
            most * friction
        }
    } else {
        most * friction
    };
    let along = if direction == 0.0 {
        sign(error)
    } else {
        direction
    };
    along * (friction - need)
}
