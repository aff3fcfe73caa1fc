//! The supervisor: which model may reach the controller, and when.

use crate::servo::design::SupervisionDesign;
use crate::servo::model::Model;
use crate::servo::supervision::change::VarianceRatio;
use crate::servo::supervision::comparison::Comparison;
use crate::servo::supervision::event::{Event, LoopSample};
use crate::servo::supervision::evidence::Evidence;
use crate::servo::supervision::screening::{Candidate, UNKNOWN};
use crate::servo::supervision::state::{Reason, State};
use crate::servo::supervision::validation::{FitReport, ValidationWindow};

/// Decides from samples and candidates of the identifier which model the controller may use.
///
/// An estimate must be finite, of the right sign, in range, stable and certain. It, and changes of
/// one number of the model in use, must explain windows of later samples in free simulation,
/// clearly better than that model. The last verified model is kept bit for bit until another one
/// replaces it.
#[derive(Debug, Clone, PartialEq)]
pub struct Supervisor {
    pub(crate) design: SupervisionDesign,
    state: State,
    pub(super) verified_model: Option<Model>,
    /// Variances of its a1, a2 and b0.
    pub(crate) variances: [f32; 3],
    /// Samples in the present state.
    pub(crate) ticks: u32,
    /// Samples since the last look at the estimate.
    since_look: u32,
    pub(crate) change: VarianceRatio,
    pub(crate) comparison: Comparison,
    /// The latest window.
    pub(super) window: ValidationWindow,
    pub(crate) evidence: Evidence,
    pub(super) report: FitReport,
    pub(super) refusal: Option<Reason>,
    /// The latest fault since a verified model took over.
    fault: Option<Reason>,
    pub(super) accepted: u32,
    refused: u32,
    /// Samples without motion.
    pub(crate) still_for: u32,
    /// Largest recent tracking error.
    pub(crate) peak_error: f32,
    /// Largest recent velocity of the reference.
    pub(crate) peak_speed: f32,
}

impl Supervisor {
    /// A supervisor without a model.
    pub(crate) fn new(design: &SupervisionDesign) -> Self {
        Self {
            design: design.clone(),
            state: State::Idle,
            verified_model: None,
            variances: UNKNOWN,
            ticks: 0,
            since_look: 0,
            change: VarianceRatio::new(&design.change),
            comparison: Comparison::Rests,
            window: ValidationWindow::none(&design.validation),
            evidence: Evidence::NONE,
            report: FitReport::default(),
            refusal: None,
            fault: None,
            accepted: 0,
            refused: 0,
            still_for: 0,
            peak_error: 0.0,
            peak_speed: 0.0,
        }
    }

    /// The state.
    pub const fn state(&self) -> State {
        self.state
    }

    /// The last verified model, if there is one.
    #[doc(alias = "good")]
    pub const fn verified_model(&self) -> Option<Model> {
        self.verified_model
    }

    /// Why the last candidate was refused.
    pub const fn refusal(&self) -> Option<Reason> {
        self.refusal
    }

    /// The latest fault since a verified model took over; an abort leaves it.
    pub(crate) const fn fault(&self) -> Option<Reason> {
        self.fault
    }

    /// How many models were accepted and refused so far.
    pub const fn counts(&self) -> (u32, u32) {
        (self.accepted, self.refused)
    }

    /// Result of the last validation, to be looked at after [`Reason::PoorFit`].
    #[doc(alias = "verdict")]
    pub const fn fit_report(&self) -> FitReport {
        self.report
    }

    /// Takes a verified model that may control; the controller may start without commissioning.
    pub(crate) fn install(&mut self, model: Model) -> Result<(), Reason> {
        self.design.screening.admits(&model)?;
        self.verified_model = Some(model);
        self.variances = UNKNOWN;
        self.evidence = Evidence::NONE;
        self.enter(State::Frozen);
        Ok(())
    }

    /// Begins the commissioning.
    pub(crate) fn begin(&mut self) {
        self.evidence = Evidence::NONE;
        self.enter(State::Exciting);
        self.refusal = None;
    }

    /// Ends the commissioning or the control at once; the verified model is kept.
    pub(crate) fn abort(&mut self) {
        self.refusal = Some(Reason::Aborted);
        self.enter(State::Idle);
    }

    /// A fault of the machine: the valve closes and the verified model is kept.
    pub(crate) fn fail(&mut self, reason: Reason) {
        self.refusal = Some(reason);
        self.enter(State::Failed(reason));
    }

    /// Goes back to a model that was verified before another one; whether there is another one.
    pub(crate) fn goes_back(&mut self, model: Model) -> bool {
        let other = self.verified_model != Some(model);
        if other {
            self.verified_model = Some(model);
            self.variances = UNKNOWN;
            self.evidence = Evidence::NONE;
            self.refusal = Some(Reason::FollowingError);
            self.enter(State::Rejected(Reason::FollowingError));
        }
        other
    }

    pub(crate) fn enter(&mut self, state: State) {
        self.state = state;
        if let State::Failed(reason) = state {
            self.fault = Some(reason);
        } else if state.is_controlling() {
            self.fault = None;
        }
        self.ticks = 0;
        self.since_look = 0;
        self.comparison = Comparison::Rests;
        self.still_for = 0;
    }

    /// Whether it is time to look at the estimate; if so, not again for a while. A look that waits
    /// for a sample that has the time stays due.
    #[inline]
    pub(crate) fn looks(&mut self) -> bool {
        let due = self.since_look >= self.design.look && self.wants_candidate();
        if due {
            self.since_look = 0;
        }
        due
    }

    /// Whether a candidate would be heard, and a window begin.
    #[inline]
    pub(crate) fn wants_candidate(&self) -> bool {
        self.comparison.rests()
            && self.state == State::Adapting
            && self.still_for == 0
            && self.ticks > self.design.rejection
            && self.is_astray()
    }

    /// Takes an estimate, refuses it or not; a window begins with the next sample.
    pub(crate) fn submit(&mut self, candidate: &Candidate) -> Event {
        match self.screen(candidate) {
            Ok(()) => self.evidence.propose(candidate),
            Err(reason) if reason.rejects_estimate() => return self.refuse(reason),
            Err(reason) => {
                let _ = self.refuse(reason);
            }
        }
        self.comparison = Comparison::Begins;
        Event::None
    }

    fn screen(&self, candidate: &Candidate) -> Result<(), Reason> {
        if !candidate.model.is_finite() {
            return Err(Reason::NotFinite);
        }
        self.design.screening.screen(candidate)
    }

    pub(crate) fn refuse(&mut self, reason: Reason) -> Event {
        self.refusal = Some(reason);
        self.refused = self.refused.saturating_add(1);
        match (self.state, self.verified_model) {
            (State::Adapting, Some(model)) if reason.rejects_estimate() => {
                self.enter(State::Rejected(reason));
                Event::Restored(model)
            }
            _ => Event::None,
        }
    }

    /// Takes one sample. Cost: see the table of instruction counts.
    pub(crate) fn update(&mut self, seen: &LoopSample) -> Event {
        self.ticks = self.ticks.saturating_add(1);
        self.since_look = self.since_look.saturating_add(1);
        let (velocity, min_speed) = (seen.motion.velocity, self.design.min_speed);
        let moving = velocity > min_speed || velocity < -min_speed;
        self.still_for = if moving {
            0
        } else {
            self.still_for.saturating_add(1)
        };
        match self.state {
            State::Idle | State::Failed(_) => {}
            State::Exciting | State::Identifying => {}
            State::Adapting => return self.adapt(seen),
            State::Verified if self.ticks > self.design.look => self.enter(State::Adapting),
            State::Frozen if moving => self.enter(State::Adapting),
            State::Rejected(reason) if self.ticks > self.rejection(reason) => {
                self.enter(State::Frozen);
            }
            State::Verified | State::Frozen | State::Rejected(_) => {}
        }
        Event::None
    }

    /// Samples of [`State::Rejected`].
    const fn rejection(&self, reason: Reason) -> u32 {
        if reason.rejects_estimate() {
            self.design.rejection
        } else {
            self.design.excite
        }
    }

    /// One sample of a commissioning that goes on.
    pub(crate) fn commission(&mut self, identifying: bool) {
        self.ticks = self.ticks.saturating_add(1);
        if identifying && self.state == State::Exciting {
            self.state = State::Identifying;
        }
    }

    /// The end of a commissioning with a model.
    pub(crate) fn commissioned(&mut self, model: Model) -> Event {
        if let Err(reason) = self.design.screening.admits(&model) {
            return self.give_up(reason);
        }
        self.accepted = self.accepted.saturating_add(1);
        self.verified_model = Some(model);
        self.variances = UNKNOWN;
        self.refusal = None;
        self.enter(State::Verified);
        self.change.restart();
        Event::Accepted(model)
    }

    /// Goes on with other numbers.
    pub(crate) fn redesign(&mut self, design: SupervisionDesign) {
        self.change = VarianceRatio::new(&design.change);
        self.design = design;
    }

    /// The end of a commissioning without a model; an older verified model comes back into force.
    pub(crate) fn give_up(&mut self, reason: Reason) -> Event {
        self.refusal = Some(reason);
        match self.verified_model {
            Some(model) if !reason.is_fault() => {
                self.enter(State::Rejected(reason));
                Event::Restored(model)
            }
            _ => {
                self.enter(State::Failed(reason));
                Event::Stopped
            }
        }
    }
}

#[cfg(test)]
pub(crate) mod tests;
