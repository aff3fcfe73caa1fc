//! The trial of a model on samples that it was not made from: free simulation beside the model in use.

use crate::servo::control::observer::Observer;
use crate::servo::model::ServoModel;
use crate::servo::motion::Motion;

/// How well a model followed the drive by itself.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Verdict {
    /// Sum of squared errors of the candidate.
    pub candidate: f32,
    /// Sum of squared errors of the model in use, if there is one.
    pub incumbent: Option<f32>,
    /// Sum of squares of the position about its mean.
    pub total: f32,
    /// Samples in the window.
    pub samples: u32,
}

impl Verdict {
    /// `1 - SSE/SST`: the share of the movement that the candidate explains; negative when it is worse than a constant.
    pub fn explained(&self) -> f32 {
        if self.total > 0.0 {
            1.0 - self.candidate / self.total
        } else {
            f32::NEG_INFINITY
        }
    }
}

/// Runs candidate and incumbent side by side: first observed to find their state, then by themselves.
///
/// Both get the same samples, all of them newer than the candidate. In the first phase an
/// observer finds position, velocity and acceleration; in the second
/// the models run on the commands alone and the squared errors of the position are summed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    candidate: Observer,
    incumbent: Option<Observer>,
    observe: u32,
    window: u32,
    count: u32,
    verdict: Verdict,
    origin: f32,
    sum: f32,
    squares: f32,
    candidate_flow: f32,
    incumbent_flow: f32,
}

/// Times and speed of a trial.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrialConfig {
    /// Rate of the observers in rad/s.
    pub observer_rate: f32,
    /// Samples to find the state.
    pub observe: u32,
    /// Samples of free simulation.
    pub window: u32,
    /// Sample time in s.
    pub sample_time: f32,
}

impl Trial {
    /// A trial that begins at the position `y` with the flow of `command`.
    pub fn new(
        config: &TrialConfig,
        candidate: ServoModel,
        incumbent: Option<ServoModel>,
        motion: Motion,
        command: f32,
    ) -> Self {
        let observed = |model: ServoModel| {
            let mut observer =
                Observer::undisturbed(model, config.observer_rate, config.sample_time);
            observer.place(motion);
            observer
        };
        Self {
            candidate: observed(candidate),
            incumbent: incumbent.map(observed),
            observe: config.observe,
            window: config.window,
            count: 0,
            verdict: Verdict::default(),
            origin: motion.position,
            sum: 0.0,
            squares: 0.0,
            candidate_flow: candidate.flow(command),
            incumbent_flow: incumbent.map_or(0.0, |model| model.flow(command)),
        }
    }

    /// Takes the position y(k) and the command u(k) in force from now on; gives the verdict at the end.
    ///
    /// Cost: about 130 instructions.
    pub fn update(&mut self, u: f32, y: f32) -> Option<Verdict> {
        let observing = self.count < self.observe;
        self.count += 1;
        self.candidate.predict(self.candidate_flow);
        let error = if observing {
            self.candidate.correct(y)
        } else {
            y - self.candidate.motion().position
        };
        self.candidate_flow = self.candidate.model().flow(u);
        let mut beside = None;
        if let Some(incumbent) = &mut self.incumbent {
            incumbent.predict(self.incumbent_flow);
            beside = Some(if observing {
                incumbent.correct(y)
            } else {
                y - incumbent.motion().position
            });
            self.incumbent_flow = incumbent.model().flow(u);
        }
        if observing {
            return None;
        }
        let moved = y - self.origin;
        self.sum += moved;
        self.squares += moved * moved;
        self.verdict.candidate += error * error;
        if let Some(error) = beside {
            let sum = self.verdict.incumbent.unwrap_or(0.0);
            self.verdict.incumbent = Some(sum + error * error);
        }
        self.verdict.samples += 1;
        if self.verdict.samples < self.window {
            return None;
        }
        let count = self.verdict.samples as f32;
        self.verdict.total = self.squares - self.sum * self.sum / count;
        Some(self.verdict)
    }

    /// The observer of the candidate.
    pub const fn candidate(&self) -> &Observer {
        &self.candidate
    }
}
