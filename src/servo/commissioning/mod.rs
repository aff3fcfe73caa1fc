//! Commissioning in stages: from sample time, travel and sensor to a verified model.
//!
//! | stage | what happens | what it shows | refusals |
//! |---|---|---|---|
//! | 0 [`rest`] | valve centred | noise, drift | |
//! | 1 [`probe`] | growing triangles until the axis moves | command at the first movement, sign | `SensorStuck`, `Blocked` |
//! | 1b [`relay`] | relay about the start: brake and test of the sign | sign, time scale | `ValveStuck`, `WrongSign` |
//! | 2 [`sweep`] | random levels within a band of the travel | the record | `TravelEnd` |
//! | 3, 4 [`search`] | fits from several starts, free simulation of later samples, two estimates that agree | the model | `PoorFit`, `Uncertain` |

mod face;
mod fit;
mod predictor;
mod probe;
mod record;
mod regression;
mod relay;
mod rest;
mod search;
mod simulation;
mod sweep;
mod view;

pub(crate) use face::{CommissioningDesign, Found, Progress};

use crate::servo::commissioning::predictor::Theta;
use crate::servo::commissioning::probe::{Probe, Probed};
use crate::servo::commissioning::record::Record;
use crate::servo::commissioning::relay::{Relay, Relayed};
use crate::servo::commissioning::rest::{Rest, Still};
use crate::servo::commissioning::search::Search;
use crate::servo::commissioning::sweep::Sweep;
use crate::servo::commissioning::view::View;
use crate::servo::model::Model;
use crate::servo::motion::Motion;
use crate::servo::motion::alpha_beta_gamma::AlphaBetaGamma;
use crate::servo::supervision::state::Reason;

/// Poles in rad/s of the filter that gives the velocity.
const TRACKING_RATE: f32 = 120.0;
/// Points of the record per half period of the relay, and the largest spacing in s.
const POINTS_PER_HALF: f32 = 16.0;
const SPACING_MAX: f32 = 1e-2;
/// Least dead zone over the command at the first movement, for the levels.
const DEAD_ZONE_MIN: f32 = 0.4;
/// Time in s within which an axis beyond the safe travel comes back, and the least speed in travels per s.
const RETURN_TIME: f32 = 0.25;
const RETURN_SPEED: f32 = 0.02;
/// Time in s from and to which the bounds of a model widen, and by how much.
const WIDENING: [f32; 3] = [1.8, 2.8, 1.6];

#[derive(Debug, Clone, Copy, PartialEq)]
enum Stage {
    Resting(Rest),
    Probing(Probe),
    Relaying(Relay),
    Sweeping(Sweep),
}

/// The commissioning. Memory: 4 kB of record, some 3 kB of sums.
///
/// Cost per ms: some 3 points of a fit. The samples in which a fit ends or a model is taken cost more: see the table of
/// instruction counts.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Commissioning {
    design: CommissioningDesign,
    stage: Stage,
    still: Still,
    sign: f32,
    known_sign: Option<f32>,
    time: f32,
    attempt: u32,
    /// Attempts in a row that changed no code.
    silent: u8,
    /// Time in s beyond the safe travel without coming back, and where it began.
    outside: f32,
    tracking: AlphaBetaGamma,
    record: Record,
    search: Search,
    /// What the search begins with when the record has its spacing: the spacing, frequency and dead zone.
    first_guess: Option<[f32; 3]>,
    /// The model that was accepted, and whether that was in an earlier sample.
    accepted: Option<Theta>,
    has_rested: bool,
    /// Samples since the code changed.
    same: u32,
}

impl Commissioning {
    pub(crate) fn new(design: CommissioningDesign) -> Self {
        let rate = TRACKING_RATE.min(0.3 / design.sample_time);
        Self {
            stage: Stage::Resting(Rest::default()),
            still: Still::default(),
            sign: 1.0,
            known_sign: None,
            time: 0.0,
            attempt: 0,
            silent: 0,
            outside: 0.0,
            tracking: AlphaBetaGamma::new(rate, design.sample_time),
            record: Record::new(),
            search: Search::new(design.sample_time, design.delay),
            first_guess: None,
            accepted: None,
            has_rested: false,
            same: 0,
            design,
        }
    }

    /// Begins at `position`, with the sign of the valve if it is known; every attempt draws other levels.
    pub(crate) fn begin(&mut self, position: f32, sign: Option<f32>) {
        self.known_sign = sign;
        self.stage = Stage::Resting(Rest::default());
        self.sign = 1.0;
        self.outside = 0.0;
        self.first_guess = None;
        self.accepted = None;
        self.same = 0;
        self.time = 0.0;
        self.attempt = self.attempt.wrapping_add(1);
        self.tracking.place(self.share(position));
        self.record.restart(1);
        self.search.stop();
    }

    fn share(&self, position: f32) -> f32 {
        let travel = self.design.travel;
        (position - travel.min) / travel.length()
    }

    /// Takes a position.
    pub(crate) fn update(&mut self, position: f32, same_code: bool) -> Progress {
        let y = self.share(position);
        let step = self.design.sample_time;
        self.tracking.update(y);
        self.time += step;
        if self.time > self.design.time_limit && self.accepted.is_none() {
            return Progress::Failed(self.search.refusal().unwrap_or(Reason::Uncertain));
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
                    self.stage = Stage::Probing(Probe::new(self.silent));
                } else {
                    self.stage = Stage::Resting(rest);
                }
                Progress::Command(0.0)
            }
            Stage::Probing(probe) => self.probe(probe, y, same_code),
            Stage::Relaying(relay) => self.relay(relay, y, v),
            Stage::Sweeping(mut sweep) => {
                sweep.see(same_code);
                self.sweep(sweep, y, v)
            }
        }
    }

    /// Takes the command that was set, with the position of the same sample.
    pub(crate) fn applied(&mut self, position: f32, command: f32) {
        let y = self.share(position);
        self.record.push(y, command);
    }

    fn probe(&mut self, mut probe: Probe, y: f32, same_code: bool) -> Progress {
        let scale = 1.0_f32.min(2.0 * self.design.amplitude);
        match probe.update(y, same_code, &self.still, self.design.sample_time, scale) {
            Probed::Command(u) => {
                self.stage = Stage::Probing(probe);
                Progress::Command(u)
            }
            Probed::Moved { sign, command } => {
                self.silent = 0;
                let place = self.still.place;
                let side = if y > place { 1.0 } else { -1.0 };
                let detection = self.still.detection;
                let mut relay = Relay::new(place, detection, command, sign, side);
                let v = self.tracking.motion().velocity;
                let first = relay.update(y, v, self.design.sample_time, self.design.amplitude);
                self.stage = Stage::Relaying(relay);
                self.still.since = command;
                match first {
                    Relayed::Command { command, .. } => Progress::Command(command),
                    _ => Progress::Command(0.0),
                }
            }
            Probed::SameCode => {
                self.silent = self.silent.saturating_add(1);
                Progress::Failed(Reason::SensorStuck)
            }
            Probed::Still => Progress::Failed(Reason::Blocked),
        }
    }

    fn relay(&mut self, mut relay: Relay, y: f32, v: f32) -> Progress {
        match relay.update(y, v, self.design.sample_time, self.design.amplitude) {
            Relayed::Command { command, sign } => {
                self.sign = sign;
                self.stage = Stage::Relaying(relay);
                Progress::Command(command)
            }
            Relayed::Obeys { half, sign } => {
                self.sign = sign;
                if self.known_sign.is_some_and(|known| known != sign) {
                    return Progress::Failed(Reason::WrongSign);
                }
                self.begin_search(half, y)
            }
            Relayed::Disobeys => Progress::Failed(Reason::ValveStuck),
        }
    }

    fn begin_search(&mut self, half: f32, y: f32) -> Progress {
        let step = self.design.sample_time;
        let frequency = self
            .design
            .frequency
            .unwrap_or(core::f32::consts::PI / half);
        let half = core::f32::consts::PI / frequency;
        let spacing = SPACING_MAX.min(half / POINTS_PER_HALF);
        let dead_zone = (0.5 * self.still.since).min(0.1);
        self.first_guess = Some([spacing / step, frequency, dead_zone]);
        let hold = half.min(0.25);
        let sweep = Sweep::new(
            y,
            hold,
            [dead_zone, self.still.since],
            self.design.amplitude,
            self.attempt,
        );
        self.stage = Stage::Sweeping(sweep);
        self.settle_record();
        Progress::Command(0.0)
    }

    /// Gives the record its spacing and begins the search.
    fn settle_record(&mut self) {
        let Some([stride, frequency, dead_zone]) = self.first_guess else {
            return;
        };
        while !self.record.fix(stride as usize) {}
        self.first_guess = None;
        let time = self.record.stride() as f32 * self.design.sample_time;
        let span = 2.0 * predictor::REACH as f32 * time;
        let noise = 6.0 * self.still.sigma / span;
        let view = View {
            begin: 0,
            end: 0,
            time,
            rest_velocity: noise.max(2e-3),
            sign: self.sign,
        };
        let points = self.record.end() + (self.design.excite_time / time) as usize;
        self.search
            .begin(points, view, self.still.sigma, [frequency, dead_zone]);
    }

    fn sweep(&mut self, mut sweep: Sweep, y: f32, v: f32) -> Progress {
        // Beyond the safe travel the command leads inwards, and the axis has to follow.
        let returns = (y < 0.5) == (v > 0.0) && v.abs() > RETURN_SPEED;
        self.outside = if sweep.is_safe(y) || returns {
            0.0
        } else {
            self.outside + self.design.sample_time
        };
        if self.outside > RETURN_TIME {
            return Progress::Failed(Reason::TravelEnd);
        }
        let [from, to, most] = WIDENING;
        let share = ((self.time - from) / (to - from)).clamp(0.0, 1.0);
        let slack = 1.0 + share * (most - 1.0);
        self.has_rested = self.accepted.is_some();
        if self.accepted.is_none() {
            self.accepted = self.search.update(&self.record, slack);
        }
        if let Some(theta) = self.search.latest() {
            let half = 2.6 / crate::math::sqrt(theta.a1);
            let least = DEAD_ZONE_MIN * self.still.since.min(0.25);
            sweep.inform(half.min(0.35), theta.dead_zone.max(least), theta.offset);
        }
        let command = sweep.update(y, v, self.design.sample_time);
        if sweep.is_blind() {
            return Progress::Failed(Reason::SensorStuck);
        }
        self.stage = Stage::Sweeping(sweep);
        match self.accepted {
            // The axis moves on until the loop is ready for it.
            Some(theta) => Progress::Found(self.found(&theta), self.sign * command),
            None => Progress::Command(self.sign * command),
        }
    }

    /// The estimate that waits for its validation.
    pub(crate) fn candidate(&self) -> Option<Found> {
        self.search.candidate().map(|theta| self.found(&theta))
    }

    fn found(&self, theta: &Theta) -> Found {
        let length = self.design.travel.length();
        Found {
            model: Model {
                a1: theta.a1,
                a2: theta.a2,
                b0: theta.b0 * length,
                dead_zone: theta.dead_zone,
                offset: theta.offset,
                friction: theta.friction * length,
            },
            delay: theta.delay,
            sign: self.sign,
            noise: length * self.still.sigma,
        }
    }

    /// Whether a fit or a simulation takes the time of this sample.
    pub(crate) const fn is_busy(&self) -> bool {
        !self.has_rested && self.search.is_busy()
    }

    /// Whether the axis obeys and is being identified.
    pub(crate) const fn is_sweeping(&self) -> bool {
        matches!(self.stage, Stage::Sweeping(_))
    }

    /// The motion in units of y, from the measured positions alone.
    pub(crate) fn motion(&self) -> Motion {
        let Motion {
            position,
            velocity,
            acceleration,
        } = self.tracking.motion();
        let travel = self.design.travel;
        let length = travel.length();
        Motion {
            position: travel.min + length * position,
            velocity: length * velocity,
            acceleration: length * acceleration,
        }
    }
}
