//! The decisions of the supervisor carried out, and access to the parts of the loop.

use crate::hardware::{PositionSensor, Valve};
use crate::identifier::Outcome;
use crate::servo::commissioning::{Found, Progress};
use crate::servo::control::controller::Controller;
use crate::servo::control::margins::Margins;
use crate::servo::control::place::PlacedFlow;
use crate::servo::design::constants::{CHANGED_STD, REOPENED_STD};
use crate::servo::identification::{LoopIdentifier, candidate, look, reopen};
use crate::servo::model::Model;
use crate::servo::motion::{Motion, Setpoint};
use crate::servo::servo_loop::ServoLoop;
use crate::servo::servo_loop::takeover::Fallback;
use crate::servo::supervision::event::{Event, LoopSample, Spare};
use crate::servo::supervision::state::{Reason, State};
use crate::servo::supervision::supervisor::Supervisor;
use crate::servo::tune::PIECES_PER_SAMPLE;

impl<S: PositionSensor, V: Valve> ServoLoop<S, V> {
    /// Everything between the identifier and the controller; whether a model reached the
    /// controller.
    pub(crate) fn supervise(
        &mut self,
        setpoint: &Setpoint,
        y: f32,
        same_code: bool,
        flow: f32,
        outcome: Outcome,
        spare: Spare,
    ) -> bool {
        let state = self.supervisor.state();
        let motion = self.motion();
        let seen = LoopSample {
            motion,
            y,
            flow: PlacedFlow {
                flow,
                stiffness: self.controller.stiffness(),
            },
            same_code,
            sticks: state.is_controlling() && self.controller.sticks(),
            error: setpoint.position - motion.position,
            speed: setpoint.velocity,
            innovation: outcome.innovation(),
            spare,
        };
        let mut event = self.supervisor.update(&seen);
        if event != Event::None {
            // What was looked at is no longer.
            self.takeover.looked = None;
        } else if spare == Spare::Thought {
            event = self.think();
        }
        let learns = self.learns();
        self.identifier.adapt(learns);
        if learns {
            let learning = &mut self.learning;
            learning.stiffness.add(seen.flow.stiffness, motion.velocity);
        }
        self.follow(event, state)
    }

    /// A piece of what can wait for a sample that has the time: the estimate becomes a candidate,
    /// or the search for poles goes on.
    fn think(&mut self) -> Event {
        if let Some(looked) = self.takeover.looked.take() {
            if !self.supervisor.wants_candidate() {
                return Event::None;
            }
            if core::mem::take(&mut self.fallback.reconsiders)
                && let Some(model) = self.fallback.known_good
            {
                self.supervisor.evidence.reconsider(model);
            }
            let candidate = candidate(
                &looked,
                self.controller.model(),
                self.learning.stiffness.mean(),
            );
            return self.supervisor.submit(&candidate);
        }
        if self.config.adaptive && self.supervisor.looks() {
            self.takeover.looked = Some(look(&self.identifier));
        } else {
            self.refine_poles();
        }
        Event::None
    }

    /// The identifier goes on from a model, known to `share`, where the axis is.
    pub(crate) fn identify_from(&mut self, model: &Model, share: f32) {
        let stiffness = self.controller.stiffness();
        self.learning.stiffness.begin(stiffness);
        reopen(&mut self.identifier, model, share, stiffness);
    }

    /// Whether the identifier learns from this sample.
    fn learns(&self) -> bool {
        let state = self.supervisor.state();
        self.config.adaptive
            && state == State::Adapting
            && self.learning.monitor.is_exciting()
            && self.slides()
    }

    /// Whether the axis has slid for a while: a start shows more of friction than of the model.
    fn slides(&self) -> bool {
        !self.controller.sticks() && self.controller.since() > self.learning.settled
    }

    /// Carries out what the supervisor decided; whether a model reached the controller.
    fn follow(&mut self, event: Event, before: State) -> bool {
        match event {
            Event::None | Event::Stopped => false,
            Event::Accepted(model) => {
                if before.is_commissioning() {
                    // Long since, however soon behind a first reading it was asked for.
                    self.moves.unsettled = 0;
                    self.controller.engage();
                    self.engage(model, self.controller.motion());
                } else {
                    self.retune(model);
                    // What oscillated was the loop on the model before.
                    self.derate(1.0);
                    self.identifier.set_nominal_as_shown();
                }
                true
            }
            Event::Restored(model) => {
                self.stop_building();
                if before.is_commissioning() {
                    self.moves.unsettled = 0;
                    self.take_over(model, self.commissioning.motion());
                } else {
                    self.retune(model);
                }
                self.identify_from(&model, REOPENED_STD);
                true
            }
            Event::Changed => {
                if self.config.adaptive
                    && let Some(model) = self.supervisor.verified_model()
                {
                    self.identify_from(&model, CHANGED_STD);
                }
                false
            }
        }
    }

    /// The controller takes over the moving axis on a verified model, and lets it run out.
    pub(crate) fn take_over(&mut self, model: Model, motion: Motion) {
        self.begin_control(model, motion);
        self.engage(model, motion);
        let seen = self.moves.tracking.motion();
        self.guard.monitors.begins_beside(&seen, &motion);
    }

    /// The controller knows the motion and the commands that are on their way.
    fn begin_control(&mut self, model: Model, motion: Motion) {
        let commands = self.commands.along(self.drive.sign);
        self.controller.begin(model, motion, commands);
    }

    /// Control begins at a motion of the controller, and lets it run out.
    ///
    /// An axis that was measured beyond an end is led back from there; one that is only expected
    /// there, as its readings fail, may stand within the travel, where its reference stays.
    fn engage(&mut self, model: Model, motion: Motion) {
        let along = self.drive.sign * self.limiter.last();
        self.guard.release();
        self.guard.monitors.begin(model, motion, along);
        self.derate(1.0);
        self.fallback = Fallback::new(Some(model));
        self.takeover.looked = None;
        self.takeover.unsearched = None;
        self.moves.astray = 0.0;
        let travel = self.config.travel;
        let reference = if travel.contains(motion.position) {
            // What is on its way leads there before a command takes effect.
            let mut ahead = self.controller.motion_ahead();
            ahead.position = travel.nearest(ahead.position);
            ahead
        } else if self.moves.gap.is_open() {
            Motion::at(travel.nearest(motion.position))
        } else {
            motion
        };
        self.moves
            .trajectory
            .run_out(reference, self.moves.run_out_rate);
        self.moves
            .follow(self.controller.delay(), self.config.sample_time);
    }

    /// What the newest sample of the commissioning leads to; whether a model reached the
    /// controller.
    pub(crate) fn commission_on(&mut self, command: f32) -> bool {
        let before = self.supervisor.state();
        let event = match self.progress {
            Progress::Command(_) => {
                self.supervisor.commission(self.commissioning.is_sweeping());
                if let Some(found) = self.commissioning.candidate()
                    && !self.commissioning.is_busy()
                {
                    self.search_poles(&found, PIECES_PER_SAMPLE);
                }
                Event::None
            }
            Progress::Found(found, _) => {
                if self.takeover.watching > 0 {
                    self.takeover.watching -= 1;
                    self.controller
                        .watch(self.sensed.position, self.drive.sign * command);
                    match self.takeover.watching {
                        0 => self.supervisor.commissioned(found.model),
                        // Beside the begin of control a sample has no time for it.
                        1 => {
                            self.identify_from(&found.model, REOPENED_STD);
                            return false;
                        }
                        _ => return false,
                    }
                } else if self.commissioning.is_busy() {
                    return false;
                } else {
                    match self.prepare(&found) {
                        Ok(()) => return false,
                        Err(reason) => self.supervisor.give_up(reason),
                    }
                }
            }
            Progress::Failed(reason) => self.supervisor.give_up(reason),
        };
        self.follow(event, before)
    }

    /// A sample of the way from what was found to a controller that watches: poles, the parts of
    /// the loop, the motion.
    ///
    /// Ready after the poles (some 30 samples per case of
    /// [`Tuning`](super::control::tuning::Tuning), most of them while the model is validated), 8
    /// samples and the settling of the observer.
    fn prepare(&mut self, found: &Found) -> Result<(), Reason> {
        if self.takeover.building.is_none() && !self.has_poles(found) {
            self.search_poles(found, PIECES_PER_SAMPLE);
            return Ok(());
        }
        if self.build(found)? {
            self.begin_control(found.model, self.commissioning.motion());
            self.takeover.watching = self.controller.settling();
        }
        Ok(())
    }

    /// The supervisor, for its state, its reasons and the fit of models.
    pub const fn supervisor(&self) -> &Supervisor {
        &self.supervisor
    }

    /// Sign of the valve as the commissioning found it: -1 when the axis moves against a positive
    /// command.
    pub const fn sign(&self) -> f32 {
        self.drive.sign
    }

    /// Delay of the valve in s, as the commissioning found it.
    pub const fn delay(&self) -> f32 {
        self.drive.delay
    }

    /// The identifier, for its estimate.
    pub const fn identifier(&self) -> &LoopIdentifier {
        &self.identifier
    }

    /// The controller, for its model and what it observes.
    pub const fn controller(&self) -> &Controller {
        &self.controller
    }

    /// Margins of the loop in the middle of the travel, for the model that its poles were found
    /// for; `None` before there are poles, and when none have the wanted margins and the slowest
    /// are in use.
    pub const fn margins(&self) -> Option<Margins> {
        self.controller.margins()
    }

    /// The sensor, e.g. of a simulation.
    pub const fn sensor_mut(&mut self) -> &mut S {
        &mut self.sensor
    }

    /// The valve, e.g. of a simulation.
    pub const fn valve_mut(&mut self) -> &mut V {
        &mut self.valve
    }
}
