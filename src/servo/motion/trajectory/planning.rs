//! The planning of moves, beside the reference that goes on.

use crate::servo::motion::ends::EndApproach;
use crate::servo::motion::search::{PLANNING, ProfileSearch};
use crate::servo::motion::trajectory::{Activity, Trajectory};
use crate::servo::motion::{Motion, MotionLimits};

/// Samples between two plannings: targets in every sample leave time for what waits for it.
pub(super) const PAUSES: u8 = 2;

impl Trajectory {
    /// What is asked for from now on is for a drive that reaches no more than `reach`, and comes to
    /// its ends so.
    pub(crate) fn serve(&mut self, reach: &MotionLimits, ends: EndApproach) {
        let lesser = |a: f32, b: f32| if b < a { b } else { a };
        let stated = &self.stated;
        self.limits = MotionLimits {
            velocity: lesser(stated.velocity, reach.velocity),
            acceleration: lesser(stated.acceleration, reach.acceleration),
            jerk: lesser(stated.jerk, reach.jerk),
        };
        self.ends = ends;
    }

    pub(super) fn search(&mut self, target: f32) {
        let start = self.ahead();
        let brake = self
            .ends
            .brake(start.position, target, &self.limits, &self.travel);
        self.search = Some(ProfileSearch::new(start, target, brake));
    }

    /// The motion of the present plan after the samples that planning takes.
    pub(super) fn ahead(&self) -> Motion {
        const DOUBLINGS: u32 = PLANNING.trailing_zeros();
        let (now, step) = (self.setpoint.motion(), self.sample_time);
        let motion = match &self.plan {
            Activity::Rest => now,
            Activity::Move(planned) => planned.ahead(PLANNING, step).motion(),
            Activity::RunOut(run_out) => run_out.after(&now, step, DOUBLINGS),
            Activity::Sine(sine) => {
                let long = step * f32::from(PLANNING);
                sine.clone().coarse(DOUBLINGS).next(long).motion()
            }
        };
        if self.returns {
            // It does not begin beyond the end: what is asked for waits for rest.
            return motion;
        }
        Motion {
            position: self.travel.nearest(motion.position),
            ..motion
        }
    }

    /// Whether a move is planned in the sample to come, or a target that waits is taken up.
    pub(crate) const fn is_planning(&self) -> bool {
        let rested = self.behind_rest.is_some() && matches!(self.plan, Activity::Rest);
        self.search.is_some() || self.pauses == 0 && (self.next.is_some() || rested)
    }

    /// One sample of planning; a move that is planned begins.
    pub(super) fn plan(&mut self) {
        let Some(search) = &mut self.search else {
            if matches!(self.plan, Activity::Rest)
                && let Some(target) = self.behind_rest.take()
            {
                self.next = Some(target);
            }
            if self.pauses > 0 {
                self.pauses -= 1;
            } else if let Some(target) = self.next.take() {
                self.search(target);
            }
            return;
        };
        let Some((planned, fits)) = search.step(&self.limits, &self.travel) else {
            return;
        };
        let next = self.next;
        if fits {
            self.begin(Activity::Move(planned));
            (self.next, self.pauses) = (next, if next.is_some() { PAUSES } else { 0 });
            return;
        }
        // A motion that was taken over may need a harder brake than the limits: it comes to rest
        // first.
        let target = next.unwrap_or(planned.target());
        if matches!(self.plan, Activity::Sine(_)) {
            self.begin(Activity::Move(self.brake(self.setpoint.motion())));
        }
        self.search = None;
        self.next = None;
        self.behind_rest = Some(target);
    }
}
