//! Commissioning in stages: from sample time, travel and sensor to a verified model.
//!
//! | stage | what happens | what it shows | refusals |
//! |---|---|---|---|
//! | 0 [`rest`] | valve centred | noise, drift | |
//! | 1 [`probe`] | growing triangles until the axis moves | command at the first movement, sign | `SensorStuck`, `Blocked` |
//! | 1b [`relay`] | relay about the start: brake and test of the sign | sign, time scale | `ValveStuck`, `WrongSign` |
//! | 2 [`sweep`] | random levels within a band of the travel | the record | `TravelEnd` |
//! | 2b [`defiance`] | the valve closed, where the axis moves against its commands | why it does | `WrongSign`, `ValveStuck` |
//! | 3, 4 [`search`] | fits from several starts, free simulation of later samples, two estimates that agree | the model | `PoorFit`, `Uncertain` |

mod defiance;
mod ends;
mod face;
mod fit;
#[cfg(test)]
mod oracle;
mod predictor;
mod probe;
mod range;
mod reach;
mod record;
mod regression;
mod relay;
mod rest;
mod result;
mod search;
mod sensitivity;
mod simulation;
mod stages;
mod standstill;
mod sums;
mod sweep;
mod verdict;
mod view;

pub(crate) use face::{CommissioningDesign, Found, Progress};

use crate::servo::commissioning::defiance::ValveClosing;
use crate::servo::commissioning::ends::at_end;
use crate::servo::commissioning::predictor::Theta;
use crate::servo::commissioning::probe::Probe;
use crate::servo::commissioning::record::MotionRecord;
use crate::servo::commissioning::relay::Relay;
use crate::servo::commissioning::rest::{Rest, Still};
use crate::servo::commissioning::search::Search;
use crate::servo::commissioning::standstill::Standstill;
use crate::servo::commissioning::sweep::{MIDDLE, Sweep};
use crate::servo::control::place::stiffening;
use crate::servo::motion::Travel;
use crate::servo::motion::alpha_beta_gamma::AlphaBetaGamma;
use crate::servo::supervision::state::Reason;

/// Poles of the filter that gives the velocity: at least in rad/s, over the frequency of the axis,
/// and at most per sample.
const TRACKING_RATE: f32 = 120.0;
const TRACKING_RATIO: f32 = 4.0;
const TRACKING_STEP: f32 = 0.3;

/// Poles in rad/s of the filter that gives the velocity of an axis of this frequency, 0 where it is
/// not known.
///
/// The velocity lags by `atan(3 w/p) - 3 atan(w/p)`, 5 degrees at a quarter of the poles and 50
/// at 0.8 of them: with so much lag, reversals at the ends of a band drive the oscillation of a
/// lightly damped axis.
const fn tracking_rate(frequency: f32, sample_time: f32) -> f32 {
    let rate = TRACKING_RATE.max(TRACKING_RATIO * frequency);
    rate.min(TRACKING_STEP / sample_time)
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    Resting(Rest),
    Probing(Probe),
    Relaying(Relay),
    Sweeping(Sweep),
}

/// What the axis has once seemed to do, and what remains to be shown.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Suspicion {
    /// To obey the other sign than the known one.
    mirrored: bool,
    /// To move against its commands: the valve is closed to see why.
    closing: Option<ValveClosing>,
    /// The same until it met an end of the travel.
    defied: bool,
}

/// An axis beyond the safe travel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Outside {
    /// Time in s without coming back.
    time: f32,
    /// Where that began, and the outermost place since then.
    began: f32,
    outermost: f32,
}

/// The commissioning. Memory: 4 kB of record, some 3 kB of sums.
///
/// Cost per ms: some 4 points of a fit. The samples in which a fit ends or a model is taken cost
/// more: see the table of instruction counts.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Commissioning {
    design: CommissioningDesign,
    stage: Stage,
    still: Still,
    /// Command that surely moved the axis, for the first time; 0 before, and where that one tells
    /// nothing.
    moving_command: f32,
    sign: f32,
    known_sign: Option<f32>,
    suspicion: Suspicion,
    time: f32,
    attempt: u32,
    outside: Outside,
    tracking: AlphaBetaGamma,
    record: MotionRecord,
    search: Search,
    /// What the search begins with when the record has its spacing: the spacing in samples,
    /// frequency and dead zone.
    first_guess: Option<[f32; 3]>,
    /// `a1` of the model that the sweep has been told of.
    informed: f32,
    /// The model that was accepted, and whether that was in an earlier sample.
    accepted: Option<Theta>,
    has_rested: bool,
    /// Samples since the code changed.
    same: u32,
    /// The drive since the axis moved last.
    standstill: Standstill,
}

impl Commissioning {
    #[inline(always)]
    pub(crate) fn new(design: CommissioningDesign) -> Self {
        let rate = tracking_rate(0.0, design.sample_time);
        Self {
            stage: Stage::Resting(Rest::default()),
            still: Still::default(),
            moving_command: 0.0,
            sign: 1.0,
            known_sign: None,
            suspicion: Suspicion::default(),
            time: 0.0,
            attempt: 0,
            outside: Outside::default(),
            tracking: AlphaBetaGamma::new(rate, design.sample_time),
            record: MotionRecord::new(),
            search: Search::new(
                design.sample_time,
                design.delay,
                design.dead_volume.map(stiffening),
            ),
            first_guess: None,
            informed: 0.0,
            accepted: None,
            has_rested: false,
            same: 0,
            standstill: Standstill::default(),
            design,
        }
    }

    /// Begins at `position`, with the sign of the valve if it is known; every attempt draws other
    /// levels.
    pub(crate) fn begin(&mut self, position: f32, sign: Option<f32>) {
        self.known_sign = sign;
        self.suspicion = Suspicion::default();
        self.stage = Stage::Resting(Rest::default());
        self.still = Still::default();
        self.moving_command = 0.0;
        self.sign = 1.0;
        self.outside.time = 0.0;
        self.first_guess = None;
        self.accepted = None;
        self.same = 0;
        self.time = 0.0;
        self.attempt = self.attempt.wrapping_add(1);
        self.tracking.place(self.share(position));
        self.record.restart(1);
        self.search.stop();
    }

    /// Where the middle of an excitation may be: from there it has room to both ends.
    pub(crate) fn middles(&self) -> Travel {
        let travel = &self.design.travel;
        let [low, high] = MIDDLE;
        Travel {
            min: travel.min + low * travel.length(),
            max: travel.min + high * travel.length(),
        }
    }

    fn share(&self, position: f32) -> f32 {
        let travel = self.design.travel;
        (position - travel.min) / travel.length()
    }

    /// The reason when the time is over.
    fn undecided(&self) -> Reason {
        match self.search.refusal() {
            _ if self.suspicion.defied => Reason::ValveStuck,
            refusal => refusal.unwrap_or(Reason::Uncertain),
        }
    }

    /// Takes a position.
    pub(crate) fn update(&mut self, position: f32, same_code: bool) -> Progress {
        let y = self.share(position);
        let step = self.design.sample_time;
        self.tracking.update(y);
        self.time += step;
        if self.time > self.design.time_limit && self.accepted.is_none() {
            return Progress::Failed(self.undecided());
        }
        self.same = if same_code {
            self.same.saturating_add(1)
        } else {
            0
        };
        if self.still.is_stuck(self.same, step) {
            return Progress::Failed(Reason::SensorStuck);
        }
        let v = self.tracking.motion().velocity;
        match self.stage {
            Stage::Resting(mut rest) => {
                if let Some(still) = rest.update(y, step, self.design.resolution) {
                    self.still = still;
                    self.stage = Stage::Probing(Probe::default());
                } else {
                    self.stage = Stage::Resting(rest);
                }
                Progress::Command(0.0)
            }
            Stage::Probing(probe) => self.probe(probe, y, same_code),
            Stage::Relaying(relay) => {
                let progress = self.relay(relay, y, v);
                let standing = self.watch_standstill(y, same_code, &progress);
                let mut away = false;
                if let Stage::Relaying(relay) = &mut self.stage {
                    relay.take(standing, y);
                    away = relay.is_away(y);
                }
                match self.unless_unresponsive(standing, progress) {
                    Progress::Failed(Reason::Blocked) if away && at_end(y) => {
                        Progress::Failed(Reason::ValveStuck)
                    }
                    progress => progress,
                }
            }
            Stage::Sweeping(sweep) => {
                if let Some(closing) = self.suspicion.closing {
                    return self.close(closing, y, v);
                }
                let progress = self.sweep(sweep, y, v);
                let standing = self.watch_standstill(y, same_code, &progress);
                if self.standstill.turned() {
                    return Progress::Failed(Reason::WrongSign);
                }
                if let Stage::Sweeping(sweep) = &mut self.stage {
                    sweep.take(standing);
                }
                let progress = self.unless_unresponsive(standing, progress);
                self.unless_defiant(progress)
            }
        }
    }

    /// Takes the command that was set, with the position of the same sample.
    pub(crate) fn applied(&mut self, position: f32, command: f32) {
        let y = self.share(position);
        self.record.push(y, command);
    }
}

#[cfg(test)]
mod tests;
