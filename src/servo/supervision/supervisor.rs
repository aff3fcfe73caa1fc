//! The supervisor: which model may reach the controller, and when.

use crate::error::positive;
use crate::servo::error::ServoError;
use crate::servo::model::ServoModel;
use crate::servo::motion::Motion;
use crate::servo::supervision::config::SupervisorConfig;
use crate::servo::supervision::state::{Reason, State};
use crate::servo::supervision::validation::{Trial, TrialConfig, Verdict};

/// What the supervisor sees of one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// The motion as far as it is known.
    pub motion: Motion,
    /// Measured position.
    pub y: f32,
    /// The command that was set, in force from now on.
    pub u: f32,
    /// Whether the position code is the same as in the sample before.
    pub same_code: bool,
    /// Whether the axis sticks: then a model has nothing to show.
    pub sticks: bool,
    /// Reference minus observed position; 0 without control.
    pub error: f32,
    /// Innovation of the identifier, if there was one.
    pub innovation: Option<f32>,
}

/// A model with the variances of its parameters, as the identifier gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// The model.
    pub model: ServoModel,
    /// Relative variance of the velocity gain b0/a1.
    pub gain_variance: f32,
    /// Relative variance of the natural frequency.
    pub frequency_variance: f32,
    /// Relative variance of the damping.
    pub damping_variance: f32,
    /// Variance of b0.
    pub b0_variance: f32,
}

/// What the loop has to do after a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Event {
    /// Nothing.
    None,
    /// A model passed: the controller takes it.
    Accepted(ServoModel),
    /// The estimate went astray: the identifier begins again from this model, which stays in force.
    Restored(ServoModel),
    /// The drive changed: the memory of the identifier is opened.
    Changed,
    /// The axis is to be stopped.
    Stopped,
}

/// Samples between two looks at the estimate.
const LOOK: u32 = 16;

/// Samples without a candidate after an estimate went astray, and of the state that says so, lest the drive waits.
const PAUSE: u32 = 64;

/// Trials without success that end a commissioning.
const POOR_FITS: u32 = 2;

/// Samples in which a position code that never changes is a stuck sensor.
const STUCK: u32 = 150;

/// Decides, from the samples and the candidates of the identifier, what the controller may use.
///
/// A candidate must be finite, of the right sign, in range, stable, certain, and must explain
/// a window of later samples in free simulation, better than the model in use. The last
/// good model is kept as it is, bit for bit, whatever comes after it.
///
/// # Examples
/// ```
/// use trendid::{State, Supervisor, SupervisorConfig};
/// let mut supervisor = Supervisor::try_new(&SupervisorConfig::new(20.0, 400.0), 0.001)?;
/// assert_eq!(supervisor.state(), State::Idle);
/// supervisor.begin(200.0);
/// assert_eq!(supervisor.state(), State::Exciting);
/// supervisor.abort();
/// assert_eq!(supervisor.state(), State::Idle);
/// # Ok::<(), trendid::ServoError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Supervisor {
    config: SupervisorConfig,
    sample_time: f32,
    state: State,
    good: Option<ServoModel>,
    ticks: u32,
    trial: Option<Trial>,
    verdict: Verdict,
    refusal: Option<Reason>,
    accepted: u32,
    refused: u32,
    same: u32,
    low: f32,
    high: f32,
    /// Whether the axis moved downwards and upwards since the commissioning began.
    directions: [bool; 2],
    /// Trials without success in this commissioning.
    poor: u32,
    still_for: u32,
    fast: f32,
    slow: f32,
    alarm_pause: u32,
    /// Largest tracking error of late.
    miss: f32,
    limit_ticks: u32,
    excite_ticks: u32,
}

impl Supervisor {
    /// A supervisor without a model.
    ///
    /// # Errors
    /// [`ServoError::Bound`], [`ServoError::Time`], [`ServoError::SampleTime`].
    pub fn try_new(config: &SupervisorConfig, sample_time: f32) -> Result<Self, ServoError> {
        config.check()?;
        if !positive(sample_time) {
            return Err(ServoError::SampleTime(sample_time));
        }
        Ok(Self {
            config: *config,
            sample_time,
            state: State::Idle,
            good: None,
            ticks: 0,
            trial: None,
            verdict: Verdict::default(),
            refusal: None,
            accepted: 0,
            refused: 0,
            same: 0,
            low: 0.0,
            high: 0.0,
            directions: [false; 2],
            poor: 0,
            still_for: 0,
            fast: 0.0,
            slow: 0.0,
            alarm_pause: 0,
            miss: 0.0,
            limit_ticks: (config.time_limit / sample_time) as u32,
            excite_ticks: (config.excite / sample_time) as u32,
        })
    }

    /// The state.
    pub const fn state(&self) -> State {
        self.state
    }

    /// The last good model, if there is one.
    pub const fn good(&self) -> Option<ServoModel> {
        self.good
    }

    /// Why the last candidate was refused.
    pub const fn refusal(&self) -> Option<Reason> {
        self.refusal
    }

    /// How many models were accepted and refused so far.
    pub const fn counts(&self) -> (u32, u32) {
        (self.accepted, self.refused)
    }

    /// Whether the axis moved in one direction only since the commissioning began.
    pub const fn is_one_way(&self) -> bool {
        self.directions[0] != self.directions[1]
    }

    /// The verdict of the last trial.
    pub const fn verdict(&self) -> Verdict {
        self.verdict
    }

    /// Takes a model that is known to be good; the controller may start without commissioning.
    pub fn install(&mut self, model: ServoModel) {
        self.good = Some(model);
        self.enter(State::Frozen);
    }

    /// Begins the commissioning at `position`.
    pub fn begin(&mut self, position: f32) {
        self.enter(State::Exciting);
        self.refusal = None;
        self.same = 0;
        self.directions = [false; 2];
        self.poor = 0;
        self.low = position;
        self.high = position;
    }

    /// Ends the commissioning or the control at once; the last good gains are kept.
    pub fn abort(&mut self) {
        self.refusal = Some(Reason::Aborted);
        self.enter(State::Idle);
    }

    /// A defect of the machine: the valve goes to zero and the last good gains are kept.
    pub fn fail(&mut self, reason: Reason) {
        self.refusal = Some(reason);
        self.enter(State::Failed(reason));
    }

    fn enter(&mut self, state: State) {
        self.state = state;
        self.ticks = 0;
        self.trial = None;
        self.still_for = 0;
    }

    /// Whether this sample is one on which the supervisor wants to see the estimate.
    #[inline]
    pub fn wants_candidate(&self) -> bool {
        self.trial.is_none()
            && self.ticks % LOOK == LOOK - 1
            && match self.state {
                State::Identifying => true,
                State::Adapting => {
                    self.still_for == 0 && self.ticks > PAUSE && self.miss > self.config.tolerable
                }
                _ => false,
            }
    }

    /// Looks at a candidate: refuses it, or puts it to trial from this sample on.
    pub fn consider(&mut self, candidate: &Candidate, seen: &Observation) -> Event {
        match self.judge(candidate) {
            Err(reason) => self.refuse(reason),
            Ok(()) => {
                let config = TrialConfig {
                    observer_rate: 6.0 * self.config.bandwidth,
                    observe: (1.4 / self.config.bandwidth / self.sample_time) as u32,
                    window: (self.config.window / self.sample_time) as u32,
                    sample_time: self.sample_time,
                };
                let incumbent = if self.state.is_commissioning() {
                    None
                } else {
                    self.good
                };
                self.trial = Some(Trial::new(
                    &config,
                    candidate.model,
                    incumbent,
                    seen.motion,
                    seen.u,
                ));
                Event::None
            }
        }
    }

    /// The tests that need no samples.
    fn judge(&self, candidate: &Candidate) -> Result<(), Reason> {
        let model = &candidate.model;
        let config = &self.config;
        if !model.is_finite() {
            return Err(Reason::NotFinite);
        }
        if self.state.is_commissioning() && !(self.directions[0] && self.directions[1]) {
            // A drift fits a model with a large offset; a drive that obeys goes both ways.
            return Err(Reason::ValveStuck);
        }
        let sure = model.b0 * model.b0 > 9.0 * candidate.b0_variance;
        if model.b0 <= 0.0 && sure {
            return Err(Reason::WrongSign);
        }
        let certainty = if self.state.is_commissioning() {
            config.certainty
        } else {
            config.certainty_adapting
        };
        let limit = certainty * certainty;
        let certain = candidate.gain_variance < limit
            && candidate.frequency_variance < limit
            && candidate.damping_variance < 16.0 * limit;
        if !certain || model.b0 <= 0.0 {
            return Err(Reason::Uncertain);
        }
        if !(model.a1 > 0.0 && model.a2 > 0.0) {
            return Err(Reason::Unstable);
        }
        let square = config.bandwidth * config.bandwidth;
        let spread = config.spread * config.spread;
        // w0, C and xi by their squares: no roots here.
        let frequency = model.a1 < spread * square && model.a1 * spread > square;
        let gain = model.b0 < config.largest_gain * model.a1;
        let damping = model.a2 * model.a2 < 36.0 * model.a1;
        let valve = model.dead_zone < 0.3 && model.offset.abs() < 0.3;
        if !(frequency && gain && damping && valve) {
            return Err(Reason::OutOfRange);
        }
        Ok(())
    }

    fn refuse(&mut self, reason: Reason) -> Event {
        self.refusal = Some(reason);
        self.refused = self.refused.saturating_add(1);
        match (self.state, self.good) {
            (State::Adapting, Some(good)) if reason.is_astray() => {
                self.enter(State::Rejected(reason));
                Event::Restored(good)
            }
            _ => Event::None,
        }
    }

    /// Takes one sample. Cost: see the table of instruction counts.
    pub fn update(&mut self, seen: &Observation) -> Event {
        self.ticks = self.ticks.saturating_add(1);
        let moving =
            seen.motion.velocity > self.config.slow || seen.motion.velocity < -self.config.slow;
        self.still_for = if moving {
            0
        } else {
            self.still_for.saturating_add(1)
        };
        match self.state {
            State::Idle | State::Failed(_) => Event::None,
            State::Exciting | State::Identifying => self.commission(seen),
            State::Verified => {
                if self.ticks > LOOK {
                    self.enter(State::Adapting);
                }
                Event::None
            }
            State::Adapting => self.adapt(seen),
            State::Frozen => {
                if moving {
                    self.enter(State::Adapting);
                }
                Event::None
            }
            State::Rejected(reason) => {
                let pause = if reason.is_astray() {
                    PAUSE
                } else {
                    self.excite_ticks
                };
                if self.ticks > pause {
                    self.enter(State::Frozen);
                }
                Event::None
            }
        }
    }

    fn commission(&mut self, seen: &Observation) -> Event {
        self.directions[0] |= seen.motion.velocity < -self.config.slow;
        self.directions[1] |= seen.motion.velocity > self.config.slow;
        self.same = if seen.same_code { self.same + 1 } else { 0 };
        self.low = if seen.y < self.low { seen.y } else { self.low };
        self.high = if seen.y > self.high {
            seen.y
        } else {
            self.high
        };
        if self.same >= STUCK {
            return self.give_up(Reason::SensorStuck);
        }
        if self.state == State::Exciting && self.ticks >= self.excite_ticks {
            if self.high - self.low < self.config.still {
                return self.give_up(Reason::Blocked);
            }
            self.state = State::Identifying;
        }
        if let Some(verdict) = self.run_trial(seen) {
            if verdict.explained() >= self.config.explained {
                return self.accept();
            }
            self.trial = None;
            let _ = self.refuse(Reason::PoorFit);
            // One of many wrong models would pass in the end.
            self.poor += 1;
            if self.poor >= POOR_FITS {
                return self.give_up(Reason::PoorFit);
            }
        }
        if self.ticks >= self.limit_ticks {
            return self.give_up(self.refusal.unwrap_or(Reason::Uncertain));
        }
        Event::None
    }

    /// The end of a commissioning without a model; older good gains come back into force.
    pub fn give_up(&mut self, reason: Reason) -> Event {
        self.refusal = Some(reason);
        // With the wrong sign the old gains would drive the axis to its end.
        let defect = matches!(
            reason,
            Reason::WrongSign
                | Reason::SensorStuck
                | Reason::ValveStuck
                | Reason::Blocked
                | Reason::TravelEnd
        );
        match self.good {
            Some(good) if !defect => {
                self.enter(State::Rejected(reason));
                Event::Restored(good)
            }
            _ => {
                self.enter(State::Failed(reason));
                Event::Stopped
            }
        }
    }

    fn run_trial(&mut self, seen: &Observation) -> Option<Verdict> {
        let verdict = self.trial.as_mut()?.update(seen.u, seen.y)?;
        self.verdict = verdict;
        Some(verdict)
    }

    fn accept(&mut self) -> Event {
        let Some(trial) = self.trial.take() else {
            return Event::None;
        };
        let model = *trial.candidate().model();
        self.accepted = self.accepted.saturating_add(1);
        self.good = Some(model);
        self.refusal = None;
        if self.state.is_commissioning() {
            self.enter(State::Verified);
            self.fast = 0.0;
            self.slow = 0.0;
        }
        Event::Accepted(model)
    }

    fn adapt(&mut self, seen: &Observation) -> Event {
        let error = seen.error.abs();
        self.miss -= self.sample_time * self.miss;
        self.miss = if error > self.miss { error } else { self.miss };
        if self.still_for > 200 {
            self.enter(State::Frozen);
            return Event::None;
        }
        if self.watch(seen) {
            self.trial = None;
            return Event::Changed;
        }
        if seen.sticks {
            self.trial = None;
            return Event::None;
        }
        let Some(verdict) = self.run_trial(seen) else {
            return Event::None;
        };
        let enough = 5.0 * self.config.still;
        let moved = verdict.total > enough * enough * verdict.samples as f32;
        let better = verdict.incumbent.is_none_or(|other| {
            verdict.candidate < self.config.better * other
                && other - verdict.candidate > self.config.worth * verdict.total
        });
        let reason = if !moved {
            None
        } else if verdict.explained() < self.config.explained_adapting {
            Some(Reason::PoorFit)
        } else if !better {
            Some(Reason::NotBetter)
        } else {
            return self.accept();
        };
        self.trial = None;
        if let Some(reason) = reason {
            return self.refuse(reason);
        }
        Event::None
    }

    /// Change detection: the innovation's variance over 30 ms against that over 2 s.
    fn watch(&mut self, seen: &Observation) -> bool {
        let Some(innovation) = seen.innovation else {
            return false;
        };
        let square = innovation * innovation;
        self.fast += (self.sample_time / 0.03) * (square - self.fast);
        self.alarm_pause = self.alarm_pause.saturating_sub(1);
        if self.slow == 0.0 {
            self.slow = square;
        }
        let alarm = self.alarm_pause == 0
            && self.ticks > LOOK
            && self.fast > self.config.change * self.slow;
        if alarm {
            self.alarm_pause = self.excite_ticks;
            self.slow = self.fast;
            return true;
        }
        self.slow += (self.sample_time / 2.0) * (square - self.slow);
        false
    }
}
