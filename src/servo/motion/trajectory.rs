//! Jerk-limited trajectory: a standstill, moves, a run-out, a sine.

mod planning;

use crate::math::within;
use crate::servo::error::Error;
use crate::servo::motion::brake::brake;
use crate::servo::motion::ends::EndApproach;
use crate::servo::motion::profile::Move;
use crate::servo::motion::returning::way_back;
use crate::servo::motion::run_out::RunOut;
use crate::servo::motion::search::ProfileSearch;
use crate::servo::motion::sine::Sine;
use crate::servo::motion::{Motion, MotionLimits, Setpoint, Travel};

/// Largest frequency of a sine, in periods per sample.
const FREQUENCY_STEP_MAX: f32 = 0.1;

/// Present activity of the generator.
#[derive(Debug, Clone, PartialEq)]
enum Activity {
    Rest,
    Move(Move),
    RunOut(RunOut),
    Sine(Sine),
}

/// Generator of the reference: standstill, jerk-limited moves, a run-out, a sine.
///
/// A move has up to seven pieces of constant jerk: to the cruising velocity, cruise,
/// to rest, from any state. Planning takes square roots and a bisection, some 4000
/// instructions; they are spread over the 16 samples after [`Trajectory::move_to`], in
/// which the reference goes on as before.
///
/// Known as: S-curve profile, double S velocity profile (Biagiotti and Melchiorri, Trajectory
/// Planning for Automatic Machines and Robots, 2008).
#[derive(Debug, Clone, PartialEq)]
#[doc(alias = "Reference")]
pub(crate) struct Trajectory {
    limits: MotionLimits,
    travel: Travel,
    sample_time: f32,
    ends: EndApproach,
    setpoint: Setpoint,
    plan: Activity,
    /// Whether it leads back from beyond an end of the travel.
    returns: bool,
    /// A move that is being planned, the target that came meanwhile, and one that waits for rest.
    search: Option<ProfileSearch>,
    next: Option<f32>,
    behind_rest: Option<f32>,
    /// Samples to come that plan nothing.
    pauses: u8,
    /// A sine that begins when the present plan has come to rest.
    sine: Option<Sine>,
}

impl Trajectory {
    /// A generator at rest at the lower end of `travel`; the limits are positive and finite.
    pub(crate) const fn new(limits: MotionLimits, travel: Travel, sample_time: f32) -> Self {
        Self {
            limits,
            travel,
            sample_time,
            ends: EndApproach::NONE,
            setpoint: Setpoint::at(travel.min),
            plan: Activity::Rest,
            returns: false,
            search: None,
            next: None,
            behind_rest: None,
            pauses: 0,
            sine: None,
        }
    }

    /// Other limits for what is planned from now on, positive and finite.
    pub(crate) const fn limit(&mut self, limits: MotionLimits) {
        self.limits = limits;
    }

    /// Stands still at `position` from now on; a jump of the reference if it was elsewhere.
    pub(crate) fn hold(&mut self, position: f32) {
        self.setpoint = Setpoint::at(self.travel.nearest(position));
        self.begin(Activity::Rest);
    }

    /// Replaces the plan, also a move that is being planned.
    fn begin(&mut self, plan: Activity) {
        self.plan = plan;
        self.returns = false;
        self.search = None;
        self.next = None;
        self.behind_rest = None;
        self.sine = None;
    }

    /// Begins where an axis at rest stands; beyond an end of the travel it leads back to that, at
    /// the `rate` (rad/s) of the axis.
    pub(crate) fn stand(&mut self, position: f32, rate: f32) {
        if self.travel.contains(position) {
            return self.hold(position);
        }
        let end = self.travel.nearest(position);
        self.setpoint = Setpoint::at(position);
        self.begin(Activity::Move(way_back(position, end, rate, &self.limits)));
        self.returns = true;
    }

    /// Comes to rest as soon as the limits allow, outside of `within` at its nearest place, and
    /// forgets what was asked for.
    pub(crate) fn stop(&mut self, within: &Travel) {
        let stop = self.brake(self.setpoint.motion());
        if self.returns || !within.contains(stop.target()) {
            let inside = within.nearest(stop.target());
            // A position is a finite number.
            let _ = self.move_to(inside);
        } else if self.setpoint.is_rest() {
            self.begin(Activity::Rest);
        } else {
            self.begin(Activity::Move(stop));
        }
    }

    /// Takes a motion over and lets it run out with a double pole at `-rate` (rad/s).
    ///
    /// Where that would leave the limits or the travel, the axis brakes: at the limits, and harder
    /// only where the travel ends sooner.
    pub(crate) fn run_out(&mut self, from: Motion, rate: f32) {
        if !self.travel.contains(from.position) {
            return self.stand(from.position, rate);
        }
        let from = self.without_swing(from);
        self.setpoint = Setpoint::of(&from, 0.0);
        let run_out = RunOut { rate };
        if run_out.stays_within(&from, &self.travel) && run_out.keeps(&from, &self.limits) {
            self.begin(Activity::RunOut(run_out));
        } else {
            self.begin(Activity::Move(self.brake(from)));
        }
    }

    /// The motion with no more acceleration than the limits allow: what an axis has beyond them is
    /// a swing of its drive. A reference that had it, too, would need `a / jerk` to be rid of it,
    /// and by then a velocity of `a^2 / (2 jerk)` that the axis never had.
    fn without_swing(&self, from: Motion) -> Motion {
        Motion {
            acceleration: within(from.acceleration, self.limits.acceleration),
            ..from
        }
    }

    /// To rest at the limits, and harder only where the travel ends sooner.
    fn brake(&self, from: Motion) -> Move {
        brake(from, &self.limits, &self.travel)
    }

    /// Moves to rest at `target`, limited to the travel, as fast as the limits allow, beginning 17
    /// samples from now.
    ///
    /// NaN and infinity are refused.
    ///
    /// Targets may come in any sample: while a move is being planned the last of them is the next
    /// one. Where the present motion brakes harder than the limits, because the travel ends, the
    /// move begins when it has come to rest. Cost: about 200 instructions, in motion, to know where
    /// the move begins.
    pub(crate) fn move_to(&mut self, target: f32) -> Result<(), Error> {
        Error::unless_within("target", target, f32::MIN, f32::MAX)?;
        let target = self.travel.nearest(target);
        self.sine = None;
        self.behind_rest = None;
        if self.is_planning() || self.next.is_some() {
            self.next = Some(target);
        } else {
            self.search(target);
        }
        Ok(())
    }

    /// Oscillates with `frequency` in Hz about the present position, in motion about the place
    /// where the reference comes to rest; the amplitude grows over one period, over two or four
    /// where the limits of motion require it.
    ///
    /// Refused, with the largest amplitude, unless the limits of motion and the travel have room
    /// for it. Not for the 1 ms path: one sine and cosine.
    pub(crate) fn oscillate(&mut self, amplitude: f32, frequency: f32) -> Result<(), Error> {
        let fastest = FREQUENCY_STEP_MAX / self.sample_time;
        Error::unless_positive("frequency", frequency)?;
        Error::unless_within("frequency", frequency, 0.0, fastest)?;
        let stop = self.brake(self.setpoint.motion());
        let centre = if self.returns || self.setpoint.is_rest() {
            self.travel.nearest(self.setpoint.position)
        } else {
            stop.target()
        };
        let (below, above) = (centre - self.travel.min, self.travel.max - centre);
        let room = below.min(above).max(0.0);
        let max = room.min(Sine::max_amplitude(frequency, &self.limits));
        Error::unless_within("amplitude", amplitude, -max, max)?;
        let sine = Sine::new(centre, amplitude, frequency, &self.limits, self.sample_time);
        if self.returns {
            self.sine = Some(sine);
        } else if self.setpoint.is_rest() {
            self.begin(Activity::Sine(sine));
        } else {
            self.begin(Activity::Move(stop));
            self.sine = Some(sine);
        }
        Ok(())
    }

    /// Whether the reference stands still, and nothing is asked for.
    pub(crate) fn is_finished(&self) -> bool {
        matches!(self.plan, Activity::Rest)
            && self.search.is_none()
            && self.next.is_none()
            && self.behind_rest.is_none()
    }

    /// Where the present move comes to rest.
    #[inline]
    pub(crate) fn goal(&self) -> Option<f32> {
        match &self.plan {
            Activity::Move(planned) => Some(planned.target()),
            Activity::Rest | Activity::RunOut(_) | Activity::Sine(_) => None,
        }
    }

    /// The newest setpoint.
    pub(crate) const fn setpoint(&self) -> Setpoint {
        self.setpoint
    }

    /// The next setpoint, one sample on. Cost: about 60 instructions, and 400 more while a move is
    /// being planned.
    pub(crate) fn update(&mut self) -> Setpoint {
        let setpoint = self.advance();
        self.plan();
        setpoint
    }

    /// The last resort: a measured motion at an end of the travel may lead beyond it, a sine by a
    /// rounding.
    fn stop_at_end(&mut self) {
        let position = self.travel.nearest(self.setpoint.position);
        if matches!(self.plan, Activity::Sine(_)) {
            self.setpoint.position = position;
        } else {
            self.setpoint = Setpoint::at(position);
            self.plan = Activity::Rest;
            // What is being planned begins where nothing will be.
            if let Some(search) = self.search.take() {
                self.next = self.next.or(Some(search.target()));
            }
        }
    }

    /// The next setpoint of the present plan.
    fn advance(&mut self) -> Setpoint {
        let step = self.sample_time;
        let (next, ended) = match &mut self.plan {
            Activity::Rest => (Setpoint::at(self.setpoint.position), false),
            Activity::Move(planned) => planned.next(step),
            Activity::RunOut(run_out) => run_out.next(&self.setpoint, step, &self.limits),
            Activity::Sine(sine) => (sine.next(step), false),
        };
        self.setpoint = next;
        if ended {
            self.returns = false;
            self.plan = self.sine.take().map_or(Activity::Rest, Activity::Sine);
        }
        if !self.travel.contains(next.position) && !self.returns {
            self.stop_at_end();
        }
        self.setpoint
    }
}

#[cfg(test)]
mod tests;
