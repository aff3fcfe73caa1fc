//! A window of free simulation: how far models follow later samples on the commands alone.

use crate::math::sqrt;
use crate::servo::control::observer::Observer;
use crate::servo::control::place::{MovedFlow, PlacedFlow};
use crate::servo::design::ValidationDesign;
use crate::servo::model::Model;
use crate::servo::motion::Motion;
use crate::servo::supervision::bank;
use crate::servo::supervision::unknown::{Errors, Responses, Unknown};

/// How well a model followed the drive in free simulation.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
#[doc(alias = "Verdict")]
pub struct FitReport {
    /// Sum of squared errors of the candidate, in units of y squared; of the model in use where
    /// there is no candidate.
    pub sse: f32,
    /// Sum of squared errors of the model in use, if there is one.
    pub incumbent_sse: Option<f32>,
    /// Sum of squares of the position about its mean.
    pub sst: f32,
    /// Samples of free simulation.
    pub samples: u32,
}

impl FitReport {
    /// R^2 = `1 - SSE/SST`: the share of the movement that the candidate explains; negative when it
    /// is worse than a constant.
    #[doc(alias = "explained")]
    pub fn r_squared(&self) -> f32 {
        if self.sst > 0.0 {
            1.0 - self.sse / self.sst
        } else {
            f32::NEG_INFINITY
        }
    }
}

/// A model in free simulation.
#[derive(Debug, Clone, PartialEq)]
struct Runner {
    observer: Observer,
    /// 1/C.
    inverse_gain: f32,
    errors: Errors,
    /// What the unknown does not explain of their squares.
    left: f32,
}

impl Runner {
    fn new(design: &ValidationDesign, model: Model, motion: Motion) -> Self {
        let mut observer = Observer::new(&design.observer, model);
        observer.place(motion);
        Self {
            observer,
            inverse_gain: model.a1 / model.b0,
            errors: Errors::default(),
            left: 0.0,
        }
    }

    /// The flow that moves it at its velocity.
    #[inline]
    fn flow(&self, driving: MovedFlow) -> f32 {
        driving.at(self.observer.motion().velocity, self.inverse_gain)
    }

    /// An observed sample, under the flow that was in force.
    #[inline(always)]
    fn observe(&mut self, driving: MovedFlow, y: f32) {
        self.observer.observe(self.flow(driving), y);
    }

    /// A sample of free simulation, with the responses to what is not known.
    #[inline(always)]
    fn simulate(&mut self, driving: MovedFlow, y: f32, responses: Responses) {
        self.observer.predict(self.flow(driving));
        let error = y - self.observer.motion().position;
        self.errors.add(error, responses);
    }
}

/// Runs the bank about the model in use and a challenger side by side: first observed to find their
/// state, then by themselves.
///
/// All get the same samples, newer than any of them. In the first phase an observer finds position,
/// velocity and acceleration; in the second the models run on the commands alone and the squared
/// errors of the position are summed, but for what explains them without another model: a flow and
/// a friction that the model in use may not know, and a grain at the begin. Models are of the
/// middle of the travel; they run at the stiffness that the axis has where it is, or a motion near
/// an end would speak for a model that is too stiff for the middle.
///
/// Known as: hold-out validation, cross-validation by simulation (Ljung 1999, chapter 16), of a
/// bank of models (multiple-model estimation, Li and Bar-Shalom 1996).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ValidationWindow {
    /// The bank, and behind it the challenger; how many of them run.
    runners: [Runner; bank::SIZE + 1],
    running: usize,
    unknown: Unknown,
    /// The flow in force until the next sample.
    flow: PlacedFlow,
    /// Samples of observation that are left, and of free simulation in all and so far.
    observe: u32,
    window: u32,
    samples: u32,
    /// Runners whose errors are explained.
    explained: usize,
    origin: f32,
    sum: f32,
    squares: f32,
}

/// Runners whose errors are explained in a sample.
const EXPLAINED: usize = 5;

/// Sums of squares of a window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WindowSums {
    /// Errors of the bank and of the challenger, beyond what needs no other model.
    pub(crate) bank: [f32; bank::SIZE],
    pub(crate) challenger: Option<f32>,
    /// The position about its mean.
    pub(crate) moved: f32,
    /// Its root over that of a whole window, at most 1.
    pub(crate) weight: f32,
}

impl WindowSums {
    /// Shares of the errors in errors and movement, times the weight: 0 is right, the weight is
    /// astray.
    pub(crate) fn shares(&self) -> Self {
        let Self { moved, weight, .. } = *self;
        let share = |sse: f32| {
            weight
                * if sse < f32::INFINITY {
                    sse / (sse + moved)
                } else {
                    1.0
                }
        };
        Self {
            bank: self.bank.map(share),
            challenger: self.challenger.map(share),
            moved: weight,
            weight,
        }
    }
}

impl ValidationWindow {
    /// No window: one that is over.
    pub(crate) fn none(design: &ValidationDesign) -> Self {
        let nothing = Model::linear(0.0, 0.0, 1.0);
        let runner = Runner::new(design, nothing, Motion::default());
        Self {
            runners: core::array::from_fn(|_| runner.clone()),
            running: bank::SIZE,
            unknown: Unknown::new(&nothing),
            flow: PlacedFlow::in_the_middle(0.0),
            observe: 0,
            window: 0,
            samples: 0,
            explained: 0,
            origin: 0.0,
            sum: 0.0,
            squares: 0.0,
        }
    }

    /// Begins at `motion`, with `flow` in force.
    pub(crate) fn begin(
        &mut self,
        design: &ValidationDesign,
        used: &Model,
        challenger: Option<Model>,
        motion: Motion,
        flow: PlacedFlow,
    ) {
        for (runner, model) in self.runners.iter_mut().zip(bank::about(used)) {
            *runner = Runner::new(design, model, motion);
        }
        self.running = bank::SIZE;
        if let Some(model) = challenger {
            let [.., last] = &mut self.runners;
            *last = Runner::new(design, model, motion);
            self.running += 1;
        }
        self.unknown = Unknown::new(used);
        self.flow = flow;
        (self.observe, self.window) = (design.observe, design.window);
        (self.samples, self.explained) = (0, 0);
        self.origin = motion.position;
        (self.sum, self.squares) = (0.0, 0.0);
    }

    /// Takes the position y(k), the velocity of the axis and the flow in force from now on.
    ///
    /// Cost: about 60 instructions per model.
    pub(crate) fn update(&mut self, flow: PlacedFlow, y: f32, velocity: f32) {
        let before = core::mem::replace(&mut self.flow, flow);
        let driving = before.moved();
        let used = &self.runners[bank::USED].observer;
        if self.observe > 0 {
            self.unknown.observe(used, before, velocity);
            for run in self.runners.iter_mut().take(self.running) {
                run.observe(driving, y);
            }
            self.observe -= 1;
            return;
        }
        let responses = self.unknown.update(used, before, velocity);
        for run in self.runners.iter_mut().take(self.running) {
            run.simulate(driving, y, responses);
        }
        let moved = y - self.origin;
        self.sum += moved;
        self.squares += moved * moved;
        self.samples += 1;
    }

    fn challenger(&self) -> Option<&Runner> {
        let [.., last] = &self.runners;
        (self.running > bank::SIZE).then_some(last)
    }

    /// Whether that was the last sample.
    pub(crate) const fn is_over(&self) -> bool {
        self.samples >= self.window
    }

    /// Explains some errors by what is not known, behind the last sample; whether it was all of
    /// them. Cost: about 100 instructions for each of 5 models.
    pub(crate) fn explain(&mut self) -> bool {
        let unknown = &self.unknown;
        let runners = self.runners.iter_mut().take(self.running);
        for run in runners.skip(self.explained).take(EXPLAINED) {
            run.left = unknown.left(&run.errors);
        }
        self.explained += EXPLAINED;
        self.explained > bank::SIZE
    }

    /// What it showed when all errors are explained; `None` when the axis moved by less than
    /// `least` about its mean. One that moved by `whole` or more is a whole window; errors of
    /// `grain` rms say nothing.
    pub(crate) fn sums(&self, least: f32, whole: f32, grain: f32) -> Option<WindowSums> {
        let count = self.samples as f32;
        let moved = self.squares - self.sum * self.sum / count;
        let part = moved / (whole * whole * count);
        let explained = grain * grain * count;
        let beyond = |run: &Runner| {
            let left = run.left - explained;
            // NaN stays: such a model is astray.
            if left < 0.0 { 0.0 } else { left }
        };
        let [bank @ .., _] = &self.runners;
        (moved > least * least * count).then(|| WindowSums {
            bank: bank.each_ref().map(beyond),
            challenger: self.challenger().map(beyond),
            moved,
            weight: if part < 1.0 { sqrt(part) } else { 1.0 },
        })
    }

    /// How well the challenger has followed, or the model in use where there is none.
    pub(crate) fn report(&self, sums: &WindowSums) -> FitReport {
        let used = &self.runners[bank::USED];
        FitReport {
            sse: self.challenger().unwrap_or(used).errors.squares,
            incumbent_sse: Some(used.errors.squares),
            sst: sums.moved,
            samples: self.samples,
        }
    }
}

#[cfg(test)]
mod tests;
