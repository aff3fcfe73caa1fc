//! Stages 3 and 4: fits from several starts, free simulation of later samples, two that agree.

use crate::math::sqrt;
use crate::servo::commissioning::fit::Fit;
use crate::servo::commissioning::predictor::Theta;
use crate::servo::commissioning::record::{MotionRecord, POINTS};
use crate::servo::commissioning::regression::Regression;
use crate::servo::commissioning::simulation::Simulation;
use crate::servo::commissioning::verdict::{Refusals, verdict};
use crate::servo::commissioning::view::View;
use crate::servo::supervision::state::Reason;

/// Points of the ring that a fit reads; the others come while it does.
const WINDOW: usize = 384;
/// Points of a fit and of a simulation per s: some 3 and 2.4 million instructions.
const FIT_POINTS: f32 = 4e3;
const SIMULATION_POINTS: f32 = 1e4;
/// Natural frequencies in rad/s at which a fit starts, beside what is known.
const STARTS: [f32; 3] = [80.0, 40.0, 17.0];
/// Error over movement, squared, of a start that need not be compared with others.
const START_MISFIT: f32 = 0.2 * 0.2;
/// Most passes of a refinement.
const REFINE_PASSES: u32 = 8;
/// Rate of the correction over w0, and time over 1/rate before a simulation runs by itself.
const CORRECTION: f32 = 2.0;
const CORRECTED: f32 = 12.0;
/// Standard deviation of the position in travels below which a movement shows nothing.
const MOVEMENT_MIN: f32 = 0.005;
/// Length of a free simulation over 1/w0, and its range in s.
const HOLD_OUT: f32 = 4.5;
const HOLD_OUT_RANGE: [f32; 2] = [0.1, 0.4];

#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    /// Until the record has this many points.
    Waiting(usize),
    /// A fit from a start; its free simulation.
    Trying(usize),
    Ranking(usize),
    Refining,
    /// Until the certainty of what was found is known; with the numbers of what follows.
    Weighing(usize, usize),
    /// Until the record has this many points; then those from the first number on are simulated.
    Holding(usize, usize),
    Validating,
}

/// The search for a model.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Search {
    phase: Phase,
    regression: Regression,
    fit: Fit,
    simulation: Option<Simulation>,
    starts: [f32; STARTS.len() + 1],
    best: Option<(Theta, f32)>,
    previous: Option<Theta>,
    failures: u32,
    view: View,
    /// Of the noise of the position.
    variance: f32,
    dead_zone: f32,
    refusals: Refusals,
    latest: Option<Theta>,
    /// Result of the present start.
    started: Option<Theta>,
    /// Points of a fit and of a simulation per sample.
    pace: [usize; 2],
    is_busy: bool,
}

impl Search {
    #[inline(always)]
    pub(crate) fn new(sample_time: f32, delay: f32, stiffening: Option<f32>) -> Self {
        let pace = [FIT_POINTS, SIMULATION_POINTS].map(|rate| (rate * sample_time + 0.6) as usize);
        Self {
            pace: pace.map(|points| points.clamp(1, WINDOW)),
            phase: Phase::Waiting(usize::MAX),
            regression: Regression::new(delay, stiffening.unwrap_or(0.0)),
            fit: Fit::new(stiffening.is_some()),
            simulation: None,
            starts: [0.0; STARTS.len() + 1],
            best: None,
            previous: None,
            failures: 0,
            view: View::EMPTY,
            variance: 0.0,
            dead_zone: 0.0,
            refusals: Refusals::NONE,
            latest: None,
            started: None,
            is_busy: false,
        }
    }

    /// Searches nothing until it begins.
    pub(crate) const fn stop(&mut self) {
        self.phase = Phase::Waiting(usize::MAX);
        self.refusals = Refusals::NONE;
        self.latest = None;
    }

    /// Begins when the record has `points`, with a first guess of the natural frequency.
    pub(crate) fn begin(
        &mut self,
        points: usize,
        view: View,
        sigma: f32,
        [frequency, dead_zone]: [f32; 2],
    ) {
        self.phase = Phase::Waiting(points);
        self.view = view;
        self.variance = sigma * sigma;
        self.starts[0] = frequency;
        self.starts[1..].copy_from_slice(&STARTS);
        self.dead_zone = dead_zone;
        self.best = None;
        self.previous = None;
        self.latest = None;
        self.failures = 0;
        self.refusals = Refusals::NONE;
    }

    /// Whether a fit, a simulation or their end took the time of this sample.
    pub(crate) const fn is_busy(&self) -> bool {
        self.is_busy
    }

    /// Why most estimates were not accepted.
    pub(crate) const fn refusal(&self) -> Option<Reason> {
        self.refusals.most
    }

    /// The newest estimate that is worth something for the excitation.
    pub(crate) const fn latest(&self) -> Option<&Theta> {
        self.latest.as_ref()
    }

    /// The estimate that waits for its validation.
    pub(crate) fn candidate(&self) -> Option<Theta> {
        let waits = matches!(self.phase, Phase::Holding(..) | Phase::Validating);
        waits.then(|| self.fit.found())
    }

    fn window(&self, record: &MotionRecord) -> View {
        let end = record.end();
        View {
            begin: end.saturating_sub(WINDOW),
            end,
            ..self.view
        }
    }

    fn points(&self, theta: &Theta) -> usize {
        let [low, high] = HOLD_OUT_RANGE;
        let time = (HOLD_OUT / sqrt(theta.a1)).max(low).min(high);
        (time / self.view.time) as usize
    }

    /// One sample; a model, when one is accepted. `slack` widens the bounds.
    pub(crate) fn update(&mut self, record: &MotionRecord, slack: f32) -> Option<Theta> {
        self.is_busy = !matches!(self.phase, Phase::Waiting(_) | Phase::Holding(..));
        match self.phase {
            Phase::Waiting(points) => {
                if record.end() >= points {
                    self.attempt(record, 0);
                }
            }
            Phase::Trying(k) => {
                if self.regression.advance(record, self.pace[0]) && self.regression.solve_next() {
                    self.started = self.regression.best();
                    match self.started {
                        Some(theta) => {
                            let view = self.window(record);
                            let release = view.end - (view.end - view.begin) * 2 / 5;
                            self.simulate(record, view, theta, release);
                            self.phase = Phase::Ranking(k);
                        }
                        None => self.ranked(record, k, f32::NAN),
                    }
                }
            }
            Phase::Ranking(k) => self.rank(record, k),
            Phase::Refining => {
                if self.fit.advance(record, self.pace[0]) && self.fit.next_pass() {
                    let (theta, from) = (self.fit.found(), self.fit.end());
                    if self.fit.is_done(REFINE_PASSES) {
                        self.phase = Phase::Weighing(from, from + self.points(&theta));
                    } else if self.fit.went_on() {
                        self.refine(record, theta);
                    }
                }
            }
            Phase::Weighing(from, until) => {
                if self.fit.weigh() {
                    self.phase = Phase::Holding(from, until);
                }
            }
            Phase::Holding(from, until) => {
                if record.end() >= until {
                    let view = self.window(record);
                    self.simulate(record, view, self.fit.found(), from);
                    self.phase = Phase::Validating;
                }
            }
            Phase::Validating => return self.validate(record, slack),
        }
        None
    }

    fn attempt(&mut self, record: &MotionRecord, k: usize) {
        let (view, rate) = (self.window(record), self.starts[k]);
        self.regression.begin(record, view, rate, self.dead_zone);
        self.phase = Phase::Trying(k);
    }

    /// Begins a simulation that runs by itself from `release` to the end of the view.
    fn simulate(&mut self, record: &MotionRecord, mut view: View, theta: Theta, release: usize) {
        let corrected = CORRECTED / (CORRECTION * sqrt(theta.a1) * view.time);
        let begin = release.saturating_sub(corrected as usize);
        view.begin = view.begin.max(begin);
        self.simulation = Some(Simulation::new(record, view, theta, CORRECTION, release));
    }

    /// Error over movement, squared, at the end of the simulation.
    fn misfit(&mut self, record: &MotionRecord) -> Option<[f32; 2]> {
        let [error, moved] = self.simulation.as_mut()?.advance(record, self.pace[1])?;
        let noise = 9.0 * self.variance;
        Some([
            error / (moved + MOVEMENT_MIN * MOVEMENT_MIN),
            if error < noise { 1.0 } else { 0.0 },
        ])
    }

    fn rank(&mut self, record: &MotionRecord, k: usize) {
        if let Some([misfit, _]) = self.misfit(record) {
            self.ranked(record, k, misfit);
        }
    }

    /// Takes the misfit of a start; the best one is refined when all are there.
    fn ranked(&mut self, record: &MotionRecord, k: usize, misfit: f32) {
        if let Some(theta) = self.started
            && misfit.is_finite()
            && self.best.is_none_or(|(_, other)| misfit < other)
        {
            self.best = Some((theta, misfit));
        }
        let follows = self.best.is_some_and(|(_, misfit)| misfit < START_MISFIT);
        if k + 1 < self.starts.len() && !follows {
            self.attempt(record, k + 1);
        } else if let Some((theta, misfit)) = self.best {
            if misfit < 0.3 {
                self.latest = Some(theta);
            }
            self.refine(record, theta);
        } else {
            self.refusals.count(Reason::PoorFit);
            self.attempt(record, 0);
        }
    }

    fn refine(&mut self, record: &MotionRecord, theta: Theta) {
        let view = self.window(record);
        self.fit.begin(view, theta, CORRECTION);
        self.phase = Phase::Refining;
    }

    fn validate(&mut self, record: &MotionRecord, slack: f32) -> Option<Theta> {
        let seen @ [misfit, _] = self.misfit(record)?;
        let theta = self.fit.found();
        let verdict = verdict(&theta, self.previous.as_ref(), self.fit.std(), seen, slack);
        self.previous = Some(theta);
        match verdict {
            Ok(()) => return Some(theta),
            Err(reason) => self.refusals.count(reason),
        }
        if misfit < 0.3 {
            self.latest = Some(theta);
            self.failures = 0;
        } else {
            self.failures += 1;
        }
        if self.failures >= 2 {
            self.failures = 0;
            self.best = None;
            self.attempt(record, 0);
        } else if self.fit.go_on(record.end()) {
            self.phase = Phase::Refining;
        } else {
            self.refine(record, theta);
        }
        None
    }
}

const _: () = assert!(WINDOW < POINTS);

#[cfg(test)]
mod tests;
