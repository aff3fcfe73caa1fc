//! The loop for what the commissioning found, built a part per sample.
//!
//! | sample | part |
//! |---|---|
//! | 1 | settings and design |
//! | 2 to 5 | trends, plan, noise of the trends and state of the identifier |
//! | 6 | controller |
//! | 7 | supervisor, reference, motion |
//! | 8 | monitors; the controller knows motion and commands, and its observer settles from here on |
//!
//! Meanwhile the commissioning goes on: it moves the axis within its own bounds and uses none of
//! these parts. What can be refused comes before anything is replaced. Another model begins anew:
//! only the newest is worth controlling on.

use crate::servo::building::{Building, Part, carried_out, tuned};
use crate::servo::commissioning::Found;
use crate::servo::control::controller::Controller;
use crate::servo::identification::{expect_noise, replan, trends};
use crate::servo::motion::alpha_beta_gamma::AlphaBetaGamma;
use crate::servo::motion::trajectory::Trajectory;
use crate::servo::servo_loop::ServoLoop;
use crate::servo::servo_loop::drive::Drive;
use crate::servo::servo_loop::learning::Learning;
use crate::servo::supervision::state::Reason;

impl<S, V> ServoLoop<S, V> {
    /// Builds the next part for what was found; whether that was the last one.
    ///
    /// # Errors
    /// [`Reason::OutOfRange`] for numbers that cannot work; the loop is as before.
    pub(crate) fn build(&mut self, found: &Found) -> Result<bool, Reason> {
        let Some(building) = &mut self.takeover.building else {
            return self.begin_building(found);
        };
        if building.model != found.model {
            return self.begin_building(found);
        }
        let design = &building.design;
        let refused = |_| Reason::OutOfRange;
        let part = building.next;
        building.next = part.following();
        match part {
            Part::Trends => {
                let trends = trends(&design.identification, design.sample_time);
                building.trends = Some(trends.map_err(refused)?);
            }
            Part::Identifier => {
                if let Some(trends) = building.trends.take() {
                    let identifier = &mut self.identifier;
                    replan(identifier, &design.identification, trends).map_err(refused)?;
                }
            }
            Part::Noise => {
                expect_noise(&mut self.identifier, &design.identification).map_err(refused)?;
            }
            Part::Estimate => {
                self.identifier.reset();
            }
            Part::Controller => {
                self.control_on(found);
            }
            Part::Supervision => {
                self.supervise_on();
            }
            Part::Monitors => {
                self.guard.monitors.redesign(
                    &design.monitoring.with_resolution(self.axis.resolution()),
                    &design.supervision.validation.observer,
                    found.model,
                );
                self.takeover.building = None;
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The controller, with the poles that were searched.
    fn control_on(&mut self, found: &Found) {
        let Some(Building { design, .. }) = &self.takeover.building else {
            return;
        };
        let design = design.controller.with_resolution(self.axis.resolution());
        self.controller = match &self.takeover.tuning {
            Some(tuned) if tuned.model == found.model => {
                let (poles, margins) = tuned.tuning.poles();
                Controller::with_poles(&design, found.model, poles, margins)
            }
            // The poles are searched where the model is installed.
            _ => Controller::provisional(&design, found.model),
        };
        self.drive = Drive::of(found);
    }

    /// Supervisor, reference, and the motion by the measured positions alone: another rate, and on
    /// from what was measured so far, in every state. Begun elsewhere, the filter takes the first
    /// reading for a jump, and what it gets over within a time constant brakes an axis at rest.
    fn supervise_on(&mut self) {
        let Some(Building { design, model, .. }) = &self.takeover.building else {
            return;
        };
        let motion = self.moves.tracking.motion();
        self.moves.run_out_rate = design.run_out_rate;
        let limits = carried_out(&self.config, design.motion, model);
        self.moves.trajectory = Trajectory::new(limits, design.travel, design.sample_time);
        self.moves.trajectory.hold(motion.position);
        let delay = design.controller.estimator.delay;
        self.moves.follow(delay, design.sample_time);
        self.learning = Learning::new(design);
        let supervision = design.supervision.clone();
        self.supervisor
            .redesign(supervision.with_resolution(self.axis.resolution()));
        self.moves.tracking = AlphaBetaGamma::new(design.tracking_rate, design.sample_time);
        self.moves.tracking.begin(motion);
        if self.moves.unsettled > 0 {
            self.moves.unsettle(design.sample_time);
        }
    }

    /// Gives up what is being built. An identifier whose plan is the new one and whose state is the
    /// old one begins anew.
    pub(crate) fn stop_building(&mut self) {
        if let Some(building) = self.takeover.building.take()
            && matches!(building.next, Part::Noise | Part::Estimate)
        {
            if building.next == Part::Noise {
                // It refuses nothing.
                let _ = expect_noise(&mut self.identifier, &building.design.identification);
            }
            self.identifier.reset();
        }
    }

    /// The settings and the design for what was found.
    fn begin_building(&mut self, found: &Found) -> Result<bool, Reason> {
        let design = tuned(&self.config, found).resolve();
        self.takeover.building = Some(Building {
            model: found.model,
            design: design.map_err(|_| Reason::OutOfRange)?,
            trends: None,
            next: Part::Trends,
        });
        Ok(false)
    }
}
