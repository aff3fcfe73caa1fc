//! All monitors behind one call per sample.

use crate::servo::design::constants::BREAKAWAY_RATIO;
use crate::servo::design::{MonitoringDesign, ObserverDesign};
use crate::servo::model::Model;
use crate::servo::monitoring::bounds::Bounds;
use crate::servo::monitoring::counters::FaultCounters;
use crate::servo::monitoring::following::{Efforts, Following};
use crate::servo::monitoring::gaps::Gaps;
use crate::servo::monitoring::obedience::{Conduct, Obedience};
use crate::servo::monitoring::oscillation::Oscillation;
use crate::servo::monitoring::reading::{Credibility, Plausibility};
use crate::servo::monitoring::saturation::Saturation;
use crate::servo::monitoring::stuck_code::StuckCode;
use crate::servo::monitoring::travel::{End, TravelMonitor};
use crate::servo::monitoring::twin::Twin;
use crate::servo::monitoring::unrest::Unrest;
use crate::servo::motion::{Motion, Setpoint};
use crate::servo::supervision::state::Reason;

/// One sample in control, as the monitors see it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seen<'a> {
    pub(crate) setpoint: &'a Setpoint,
    /// Measured position.
    pub(crate) y: f32,
    /// Velocity from the measured positions alone.
    pub(crate) velocity: f32,
    /// The command in force from now on.
    pub(crate) command: f32,
    pub(crate) same_code: bool,
    /// What the loop does about the error.
    pub(crate) efforts: Efforts,
    /// Whether friction holds the axis in a hunt that the window of its rest still answers.
    pub(crate) hunts: bool,
}

/// What the loop must do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Alarm {
    /// The axis must stop.
    Stop(Reason),
    /// The axis moves against its commands: the valve closes, until it is known why.
    Close,
    /// The axis oscillates: it becomes slower first.
    Oscillates,
    /// The stopping distance is used up: the full command against the motion.
    Brake,
}

/// All monitors; see the [module](super).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Monitors {
    design: MonitoringDesign,
    bounds: Bounds,
    twin: Twin,
    readings: Plausibility,
    gaps: Gaps,
    stuck: StuckCode,
    obedience: Obedience,
    following: Following,
    saturation: Saturation,
    travel: TravelMonitor,
    oscillation: Oscillation,
    unrest: Unrest,
    counters: FaultCounters,
}

impl Monitors {
    /// Monitors of an axis whose `model` is a placeholder until [`Monitors::begin`]; `observer`
    /// measures nothing.
    #[inline(always)]
    pub(crate) fn new(design: &MonitoringDesign, observer: &ObserverDesign, model: Model) -> Self {
        Self {
            design: *design,
            bounds: Bounds::new(design, &model),
            twin: Twin::new(design, observer, model),
            readings: Plausibility::new(design),
            gaps: Gaps::new(design),
            stuck: StuckCode::new(design),
            obedience: Obedience::default(),
            following: Following::default(),
            saturation: Saturation::default(),
            travel: TravelMonitor::new(design.travel),
            oscillation: Oscillation::new(design),
            unrest: Unrest::new(design),
            counters: FaultCounters::NONE,
        }
    }

    /// Goes on with other numbers; the counters stay.
    pub(crate) fn redesign(
        &mut self,
        design: &MonitoringDesign,
        observer: &ObserverDesign,
        model: Model,
    ) {
        let counters = self.counters;
        *self = Self::new(design, observer, model);
        self.counters = counters;
    }

    /// Begins with a verified model, at a motion and with the command in force.
    pub(crate) fn begin(&mut self, model: Model, motion: Motion, command: f32) {
        self.tune(model);
        self.twin.place(motion, command);
        self.stuck.restart();
        self.obedience = Obedience::default();
        self.following = Following::default();
        self.saturation = Saturation::default();
        self.oscillation = Oscillation::new(&self.design);
        self.unrest = Unrest::new(&self.design);
        self.gaps.restart();
    }

    /// What is `seen` of a motion and is no part of the one with which the expectation has begun:
    /// an axis that swings unknown has the amplitude of `v` and `v' / w` together at most.
    pub(crate) fn begins_beside(&mut self, seen: &Motion, known: &Motion) {
        let velocity = (seen.velocity - known.velocity).abs();
        let acceleration = (seen.acceleration - known.acceleration).abs();
        self.obedience = Obedience::beside(velocity + acceleration / self.bounds.frequency);
    }

    /// The expectation begins again at a motion.
    pub(crate) fn place(&mut self, motion: Motion, command: f32) {
        self.twin.place(motion, command);
    }

    /// Goes on with another model.
    pub(crate) fn tune(&mut self, model: Model) {
        self.bounds = Bounds::new(&self.design, &model);
        self.twin.tune(model, self.bounds.frequency);
        self.readings
            .tune(self.bounds.gain * self.bounds.frequency + BREAKAWAY_RATIO * model.friction);
    }

    /// Goes on with another model in motion: its expectation begins at this motion, not where the
    /// model before has led.
    pub(crate) fn retune(&mut self, model: Model, motion: Motion) {
        self.tune(model);
        self.twin.go_on(motion);
        self.obedience = Obedience::default();
    }

    /// Waits for the axis to follow from now on.
    pub(crate) fn waits_again(&mut self) {
        self.following = Following::default();
    }

    /// Classifies a reading; `missed`: samples in a row without one. While the valve is closed to
    /// find out why the axis moves against its commands, every reading counts: of such a motion the
    /// model expects nothing.
    #[inline]
    pub(crate) fn classify(&mut self, y: f32, earlier: &Motion, missed: u32) -> Credibility {
        if self.obedience.is_closing() {
            return Credibility::Good;
        }
        let verdict = self.readings.classify(y, earlier, missed);
        if verdict != Credibility::Good {
            self.counters.implausible_readings =
                self.counters.implausible_readings.saturating_add(1);
        }
        verdict
    }

    /// Counts a reading that is there or not; whether too many are missing.
    #[inline]
    pub(crate) fn count_reading(&mut self, failed: bool, missing: bool) -> bool {
        if failed {
            self.counters.failed_readings = self.counters.failed_readings.saturating_add(1);
        }
        self.gaps.update(missing)
    }

    /// One sample in control. Cost: about 250 instructions.
    pub(crate) fn update(&mut self, seen: &Seen) -> Option<Alarm> {
        let bounds = &self.bounds;
        self.twin.update(seen.y, seen.command, bounds);
        let lags = self
            .following
            .update(seen.setpoint, seen.y, &seen.efforts, bounds);
        let full = self
            .saturation
            .update(seen.command, self.design.full, bounds);
        let ends = self
            .travel
            .update(seen.y, seen.velocity, seen.command, seen.setpoint, bounds);
        let at_end = self.travel.is_end(seen.y, self.design.grain);
        let mut found = self
            .obedience
            .update(&self.twin, seen.velocity, at_end, bounds);
        let swing = self.obedience.swing();
        let velocity = self.twin.velocity();
        let stuck = self.stuck.update(seen.same_code, velocity, swing, bounds);
        let oscillates = self.oscillation.update(seen.setpoint, seen.y, seen.hunts);
        if self.unrest.update(seen.setpoint, seen.y) {
            self.counters.moves_at_rest = self.counters.moves_at_rest.saturating_add(1);
        }
        if self.saturation.is_full() {
            self.counters.saturated_samples = self.counters.saturated_samples.saturating_add(1);
        }
        if found == Conduct::Nothing && ends == End::Lost {
            found = self.obedience.at_end(&self.twin, seen.velocity, bounds);
        }
        let reason = match found {
            _ if stuck && !self.obedience.is_closing() => Some(Reason::SensorStuck),
            // An axis that stands shows its noise; a code that never changes is the sensor.
            Conduct::Disobeys(Reason::Blocked) if self.stuck.run() > bounds.no_motion => {
                Some(Reason::SensorStuck)
            }
            Conduct::Disobeys(reason) => Some(reason),
            Conduct::Against => return Some(Alarm::Close),
            Conduct::Nothing if lags => Some(Reason::FollowingError),
            Conduct::Nothing if full => Some(Reason::Saturated),
            Conduct::Nothing => None,
        };
        match reason {
            Some(reason) => Some(Alarm::Stop(reason)),
            None if oscillates => {
                self.counters.oscillations = self.counters.oscillations.saturating_add(1);
                Some(Alarm::Oscillates)
            }
            None if ends == End::Brake => Some(Alarm::Brake),
            None => None,
        }
    }

    /// Notes a stop.
    pub(crate) const fn stopped(&mut self) {
        self.counters.stops = self.counters.stops.saturating_add(1);
    }

    /// Notes the factor on the bandwidth.
    pub(crate) const fn derated(&mut self, factor: f32) {
        self.counters.derating = factor;
    }

    /// What a stop needs to know of the drive.
    pub(crate) const fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    pub(crate) const fn counters(&self) -> FaultCounters {
        self.counters
    }
}
