//! The motion that the commands let expect.

use crate::servo::control::load::balanced;
use crate::servo::control::observer::Observer;
use crate::servo::design::constants::DELAY_MAX;
use crate::servo::design::{MonitoringDesign, ObserverDesign};
use crate::servo::model::Model;
use crate::servo::monitoring::bounds::Bounds;
use crate::servo::motion::Motion;

/// The model in free simulation on the commands, and the displacement that it shows beside the
/// measured one.
///
/// The velocity part of a verified model is stable (a1 and a2 are positive), so its simulation
/// forgets how it began and needs no measurement: whatever the sensor shows, the expectation stays
/// bounded by C |flow|, of the flow that an imbalance lets arrive. Only the position drifts;
/// therefore displacements over a window of a few 1/w are compared, of model and sensor with the
/// same high-pass filter
///
/// ```text
/// h' = v - h / window        measured: y minus its low-pass of the same time constant
/// ```
///
/// A wrong dead zone or offset of the flow by `q` moves h by at most `C q window`, friction by its
/// deflection `friction / a1`: this is the slack of the bounds. A command that takes effect half a
/// delay sooner or later than in the model moves h by `C |change| delay / 2`: the slack grows
/// with the changes of the command within the window.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Twin {
    observer: Observer,
    imbalance: f32,
    commands: [f32; DELAY_MAX],
    next: usize,
    delay: usize,
    sample_time: f32,
    expected: f32,
    low_pass: f32,
    measured: f32,
    /// Leaky sum of the changes of the command, and what a change may move the expectation by.
    activity: f32,
    last: f32,
    late: f32,
    flow: f32,
}

/// Least `a2 / w` of the expectation.
const DAMPING: f32 = 0.3;

/// The model with a damping of at least 0.15: the phase of an oscillation that lasts longer is not
/// known.
const fn damped(model: Model, frequency: f32) -> Model {
    let least = DAMPING * frequency;
    Model {
        a2: if model.a2 > least { model.a2 } else { least },
        ..model
    }
}

impl Twin {
    #[inline(always)]
    pub(crate) fn new(design: &MonitoringDesign, observer: &ObserverDesign, model: Model) -> Self {
        Self {
            observer: Observer::new(observer, model),
            imbalance: design.imbalance,
            commands: [0.0; DELAY_MAX],
            next: 0,
            delay: design.delay_samples,
            sample_time: design.sample_time,
            expected: 0.0,
            low_pass: 0.0,
            measured: 0.0,
            activity: 0.0,
            last: 0.0,
            late: 0.5 * design.delay + design.sample_time,
            flow: 0.0,
        }
    }

    /// Goes on with another model of this natural frequency.
    pub(crate) fn tune(&mut self, model: Model, frequency: f32) {
        self.observer.tune(damped(model, frequency));
    }

    /// Begins at a position with a motion and the command in force.
    pub(crate) fn place(&mut self, motion: Motion, command: f32) {
        self.go_on(motion);
        self.commands = [command; DELAY_MAX];
        self.activity = 0.0;
        self.last = command;
    }

    /// Goes on from a motion, with the commands that are on their way.
    pub(crate) fn go_on(&mut self, motion: Motion) {
        self.observer.place(motion);
        self.low_pass = motion.position;
        self.expected = 0.0;
        self.measured = 0.0;
    }

    /// The command of so many samples ago as the delay has.
    #[inline]
    fn delayed(&mut self, command: f32) -> f32 {
        if self.delay == 0 {
            return command;
        }
        let at = if self.next < self.delay { self.next } else { 0 };
        let Some(slot) = self.commands.get_mut(at) else {
            return command;
        };
        let old = *slot;
        *slot = command;
        self.next = at + 1;
        old
    }

    /// One sample with the measured position and the command in force from now on. Cost: about 80
    /// instructions.
    #[inline]
    pub(crate) fn update(&mut self, y: f32, command: f32, bounds: &Bounds) {
        self.activity += (command - self.last).abs() - bounds.share * self.activity;
        self.last = command;
        let delayed = self.delayed(command);
        let flow = balanced(self.observer.model().valve_flow(delayed), self.imbalance);
        self.flow = flow;
        self.observer.predict(flow);
        self.observer.forget_position();
        let step = self.sample_time * self.observer.motion().velocity;
        self.expected += step - bounds.share * self.expected;
        self.low_pass += bounds.share * (y - self.low_pass);
        self.measured = y - self.low_pass;
    }

    /// Displacement by which expectation and measurement of a sound axis differ at most.
    #[inline]
    pub(crate) fn slack(&self, bounds: &Bounds) -> f32 {
        bounds.slack + bounds.gain * self.late * self.activity
    }

    /// Displacement that the commands let expect.
    pub(crate) const fn expected(&self) -> f32 {
        self.expected
    }

    /// Displacement that the sensor shows.
    pub(crate) const fn measured(&self) -> f32 {
        self.measured
    }

    /// The flow that takes effect now.
    pub(crate) const fn flow(&self) -> f32 {
        self.flow
    }

    /// Expected velocity.
    pub(crate) const fn velocity(&self) -> f32 {
        self.observer.motion().velocity
    }
}
