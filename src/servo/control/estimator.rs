//! The state of the axis now, and when the next command takes effect.

use crate::math::{sign, within};
use crate::servo::control::axis_state::{AxisState, Step};
use crate::servo::control::place::Place;
use crate::servo::control::poles::Poles;
use crate::servo::design::EstimatorDesign;
use crate::servo::design::constants::DELAY_MAX;
use crate::servo::model::Model;
use crate::servo::motion::Motion;

/// Largest rate of the disturbance over b0: more than the full command is no disturbance.
const DISTURBANCE_MAX: f32 = 1.0;

/// Observer on the delayed flow, and its prediction over the delay.
///
/// The measured position belongs to the flow of a delay ago. There it corrects the state; the flows
/// that are still on their way then lead to the state that the next command meets. The stiffness is
/// that of the place.
///
/// Known as: Luenberger observer with disturbance (Luenberger 1964; Han 2009), Smith predictor in
/// state space, finite spectrum assignment (Manitius and Olbrot 1979).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StateEstimator {
    design: EstimatorDesign,
    model: Model,
    poles: Poles,
    place: Place,
    step: Step,
    /// Gains for the innovation, times the sample time, of a drive without stiffness.
    gain: [f32; 4],
    flows: [f32; DELAY_MAX + 1],
    next: usize,
    now: AxisState,
    ahead: AxisState,
    /// Whether friction holds the axis.
    held: bool,
}

/// Largest drive at rest over the friction: the largest breakaway, and a dead zone that is not
/// known so well.
pub(super) const DRIVE_MAX_RATIO: f32 = 4.0;

impl StateEstimator {
    pub(crate) fn new(design: &EstimatorDesign, model: Model, poles: Poles) -> Self {
        let mut design = *design;
        design.delay = design.delay.min(DELAY_MAX);
        let place = Place::new(design.travel, design.dead_volume);
        let mut estimator = Self {
            step: Step::of(&model, design.sample_time),
            design,
            model,
            poles,
            place,
            gain: [0.0; 4],
            flows: [0.0; DELAY_MAX + 1],
            next: 0,
            now: AxisState::default(),
            ahead: AxisState::default(),
            held: false,
        };
        estimator.tune(model, poles);
        estimator
    }

    /// Goes on with another model and other poles; the state stays.
    pub(crate) fn tune(&mut self, model: Model, poles: Poles) {
        self.model = model;
        self.poles = poles;
        let t = self.design.sample_time;
        self.step = Step::of(&model, t);
        self.gain = poles.correction(0.0, model.a2).map(|l| t * l);
        self.schedule();
    }

    /// Begins at a motion, with the flows that were set, newest first; what is missing was as the
    /// last.
    pub(crate) fn place(&mut self, motion: Motion, flows: impl Iterator<Item = f32>) {
        let friction = self.model.friction;
        let sliding = friction * sign(motion.velocity);
        self.now = AxisState {
            position: motion.position,
            velocity: motion.velocity,
            drive: motion.acceleration + self.model.a2 * motion.velocity + sliding,
            disturbance: 0.0,
        };
        self.next = 0;
        let mut flow = 0.0;
        let mut flows = flows;
        for slot in self.flows.iter_mut().rev() {
            flow = flows.next().unwrap_or(flow);
            *slot = flow;
        }
        self.held = false;
        self.place.jump(motion.position);
        self.schedule();
        self.foresee();
    }

    /// Whether friction holds the axis and the drive may still grow.
    pub(crate) fn pushes(&self) -> bool {
        self.held && self.now.drive.abs() < DRIVE_MAX_RATIO * self.model.friction
    }

    /// Coefficients at the present place.
    #[inline]
    fn schedule(&mut self) {
        self.step.go(&self.model, self.place.stiffness());
    }

    /// Gains at the present place: see [`Poles::correction`].
    #[inline]
    fn correction(&self) -> [f32; 4] {
        let [l1, l2, l3, l4] = self.gain;
        [l1, l2 - self.step.pull, l3 - self.step.a1 * l1, l4]
    }

    fn flow_of(&self, age: usize) -> f32 {
        let length = self.flows.len();
        let at = self.next + length - age;
        let at = if at < length { at } else { at - length };
        self.flows.get(at).copied().unwrap_or(0.0)
    }

    /// One sample with a measured position; `held` while friction holds the axis at `anchor`,
    /// `frozen` while the disturbance stays. Cost: about 150 instructions and 30 per sample of
    /// delay.
    #[inline]
    pub(crate) fn update(&mut self, y: f32, held: Option<f32>, frozen: bool) -> f32 {
        self.place.go(self.now.position);
        self.schedule();
        let flow = self.flow_of(self.design.delay + 1);
        let innovation;
        self.held = held.is_some();
        if let Some(anchor) = held {
            self.now.hold(flow, &self.step);
            let most = DRIVE_MAX_RATIO * self.model.friction;
            self.now.drive = within(self.now.drive, most);
            self.now.position = anchor;
            self.now.velocity = 0.0;
            innovation = y - anchor;
        } else {
            self.now.advance(flow, &self.step);
            innovation = y - self.now.position;
            let [l1, l2, l3, l4] = self.correction();
            self.now.position += l1 * innovation;
            self.now.velocity += l2 * innovation;
            self.now.drive += l3 * innovation;
            if !frozen {
                let most = DISTURBANCE_MAX * self.step.b0;
                let d = self.now.disturbance + l4 * innovation;
                self.now.disturbance = within(d, most);
            }
        }
        // Numbers that are not finite would stay for ever.
        let AxisState {
            position,
            velocity,
            drive,
            disturbance,
        } = self.now;
        if !(position.abs() + velocity.abs() + drive.abs() + disturbance.abs()).is_finite() {
            self.now = AxisState {
                position: y,
                ..AxisState::default()
            };
        }
        self.foresee();
        innovation
    }

    /// Friction lets go: the drive is at least as large, in the direction of the motion.
    pub(crate) fn release(&mut self, direction: f32, y: f32, drive: f32) {
        let drive_now = direction * self.now.drive;
        let least = if drive_now > drive { drive_now } else { drive };
        self.now.drive = direction * least;
        self.now.position = y;
        self.held = false;
        self.foresee();
    }

    /// The flows that are on their way.
    #[inline]
    fn foresee(&mut self) {
        let mut ahead = self.now;
        let length = self.flows.len();
        let mut at = self.next + length - self.design.delay;
        for _ in 0..self.design.delay {
            if at >= length {
                at -= length;
            }
            let flow = self.flows.get(at).copied().unwrap_or(0.0);
            at += 1;
            if self.held {
                ahead.hold(flow, &self.step);
            } else {
                ahead.advance(flow, &self.step);
            }
        }
        self.ahead = ahead;
    }

    /// Takes the flow that is in force from now on, behind the delay.
    #[inline]
    pub(crate) fn applied(&mut self, flow: f32) {
        if let Some(slot) = self.flows.get_mut(self.next) {
            *slot = flow;
        }
        self.next += 1;
        if self.next >= self.flows.len() {
            self.next = 0;
        }
    }

    /// Moves a flow between the valve and the disturbance.
    pub(crate) fn disturb(&mut self, flow: f32) {
        self.now.disturbance += flow * self.step.b0;
    }

    /// No disturbance is known.
    pub(crate) fn forget_disturbance(&mut self) {
        self.now.disturbance = 0.0;
        self.foresee();
    }

    /// The flow that the axis feels from now on.
    pub(crate) fn flow_in_force(&self) -> f32 {
        self.flow_of(self.design.delay + 1)
    }

    /// The state now.
    pub(crate) const fn now(&self) -> &AxisState {
        &self.now
    }

    /// The state when the next command takes effect.
    pub(crate) const fn ahead(&self) -> &AxisState {
        &self.ahead
    }

    /// The coefficients at the present place.
    pub(crate) const fn step(&self) -> &Step {
        &self.step
    }

    /// Natural frequency at the present place over that in the middle.
    pub(crate) const fn frequency_ratio(&self) -> f32 {
        self.place.frequency()
    }

    /// Stiffness at the present place over that in the middle.
    pub(crate) const fn stiffness(&self) -> f32 {
        self.place.stiffness()
    }

    pub(crate) const fn model(&self) -> &Model {
        &self.model
    }

    pub(crate) const fn poles(&self) -> &Poles {
        &self.poles
    }

    /// The observed motion now.
    pub(crate) fn motion(&self) -> Motion {
        self.now.motion(&self.model, self.held)
    }

    /// The motion when the next command takes effect.
    pub(crate) fn motion_ahead(&self) -> Motion {
        self.ahead.motion(&self.model, self.held)
    }
}
