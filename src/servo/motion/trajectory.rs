//! Jerk-limited trajectory: a standstill, moves, a run-out, a sine.

use crate::error::positive;
use crate::servo::motion::profile::{Move, PLANNING, Search};
use crate::servo::motion::run_out::RunOut;
use crate::servo::motion::sine::Sine;
use crate::servo::motion::{Motion, MotionLimits, Setpoint};

/// What the generator does now.
#[derive(Debug, Clone, PartialEq)]
enum Plan {
    Rest,
    Move(Move),
    RunOut(RunOut),
    Sine(Sine),
}

/// Generator of the reference: standstill, jerk-limited moves, a run-out, a sine.
///
/// A move has up to seven pieces of constant jerk: to the cruising velocity, cruise,
/// to rest, from any state. Planning takes square roots and a bisection, some 10 000
/// instructions; they are spread over the 16 samples after [`Trajectory::move_to`], in
/// which the reference goes on as before.
///
/// Known as: S-curve profile, double S velocity profile (Biagiotti and Melchiorri, Trajectory Planning for Automatic
/// Machines and Robots, 2008).
#[derive(Debug, Clone, PartialEq)]
#[doc(alias = "Reference")]
pub(crate) struct Trajectory {
    limits: MotionLimits,
    sample_time: f32,
    setpoint: Setpoint,
    plan: Plan,
    /// A move that is being planned, and the target that came meanwhile.
    search: Option<Search>,
    next: Option<f32>,
}

impl Trajectory {
    /// A generator at rest at `position`; the limits are positive and finite.
    pub(crate) const fn new(limits: MotionLimits, sample_time: f32, position: f32) -> Self {
        Self {
            limits,
            sample_time,
            setpoint: Setpoint::at(position),
            plan: Plan::Rest,
            search: None,
            next: None,
        }
    }

    /// Stands still at `position` from now on; a jump of the reference if it was elsewhere.
    pub(crate) fn hold(&mut self, position: f32) {
        self.setpoint = Setpoint::at(position);
        self.begin(Plan::Rest);
    }

    /// Replaces the plan, also a move that is being planned.
    fn begin(&mut self, plan: Plan) {
        self.plan = plan;
        self.search = None;
        self.next = None;
    }

    /// Takes a motion over and lets it run out with a double pole at `-rate` (rad/s).
    pub(crate) fn run_out(&mut self, from: Motion, rate: f32) {
        self.setpoint = Setpoint::of(&from, 0.0);
        self.begin(Plan::RunOut(RunOut { rate }));
    }

    /// Moves to rest at `target` as fast as the limits allow, beginning 17 samples from now; ignored unless finite.
    ///
    /// Targets may come in any sample: while a move is being planned the last of them is the next one.
    /// Cost: 16 times [`Trajectory::update`] in motion, to know where the move begins.
    pub(crate) fn move_to(&mut self, target: f32) {
        if !target.is_finite() {
            return;
        }
        if self.search.is_some() {
            self.next = Some(target);
            return;
        }
        let mut ahead = self.clone();
        if !matches!(ahead.plan, Plan::Rest) {
            for _ in 0..PLANNING {
                let _ = ahead.advance();
            }
        }
        self.search = Some(Search::new(ahead.setpoint.motion(), target, &self.limits));
    }

    /// One sample of planning; a move that is planned begins.
    fn plan(&mut self) {
        let Some(search) = &mut self.search else {
            return;
        };
        if search.step(&self.limits) {
            return;
        }
        let planned = search.planned(&self.limits);
        let next = self.next;
        self.begin(Plan::Move(planned));
        if let Some(next) = next {
            self.move_to(next);
        }
    }

    /// Oscillates about the present position with `frequency` in Hz; the amplitude grows over one period.
    ///
    /// Ignored unless both are finite. Not for the 1 ms path: one sine and cosine.
    pub(crate) fn oscillate(&mut self, amplitude: f32, frequency: f32) {
        if !(amplitude.is_finite() && positive(frequency)) {
            return;
        }
        let centre = self.setpoint.position;
        let sine = Sine::new(centre, amplitude, frequency, self.sample_time);
        self.begin(Plan::Sine(sine));
    }

    /// Whether the reference stands still.
    #[cfg(test)]
    pub(crate) fn is_finished(&self) -> bool {
        matches!(self.plan, Plan::Rest) && self.search.is_none()
    }

    /// The newest setpoint.
    #[cfg(test)]
    pub(crate) const fn setpoint(&self) -> Setpoint {
        self.setpoint
    }

    /// The next setpoint, one sample on. Cost: about 60 instructions, and 400 more while a move is being planned.
    pub(crate) fn update(&mut self) -> Setpoint {
        let setpoint = self.advance();
        self.plan();
        setpoint
    }

    /// The next setpoint of the present plan.
    fn advance(&mut self) -> Setpoint {
        let step = self.sample_time;
        let (next, ended) = match &mut self.plan {
            Plan::Rest => (Setpoint::at(self.setpoint.position), false),
            Plan::Move(planned) => planned.next(step),
            Plan::RunOut(run_out) => run_out.next(&self.setpoint, step, &self.limits),
            Plan::Sine(sine) => (sine.next(step), false),
        };
        self.setpoint = next;
        if ended {
            self.plan = Plan::Rest;
        }
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sqrt;

    const LIMITS: MotionLimits = MotionLimits {
        velocity: 800.0,
        acceleration: 9000.0,
        jerk: 2.5e5,
    };

    fn at_rest() -> Trajectory {
        Trajectory::new(LIMITS, 1e-3, 0.0)
    }

    /// Runs until it stands; checks that nothing jumps and nothing exceeds its limit.
    fn run(reference: &mut Trajectory, samples: usize) -> usize {
        let mut before = reference.setpoint();
        for k in 0..samples {
            let now = reference.update();
            assert!(now.velocity.abs() <= 1.001 * LIMITS.velocity);
            assert!(now.acceleration.abs() <= 1.001 * LIMITS.acceleration);
            let step = 1e-3 * LIMITS.jerk + 1e-3 * LIMITS.acceleration;
            assert!((now.acceleration - before.acceleration).abs() <= 1.01 * step);
            assert!((now.position - before.position).abs() <= 1.001e-3 * LIMITS.velocity + 1e-4);
            before = now;
            if reference.is_finished() {
                return k;
            }
        }
        samples
    }

    #[test]
    fn moves_from_rest_and_in_motion_end_at_their_targets() {
        let mut reference = at_rest();
        for (target, pause) in [
            (60.0, 40),
            (-3.0, 90),
            (0.02, 10),
            (200.0, 200),
            (900.0, 900),
            (200.0, 700),
            (199.99, 5),
        ] {
            reference.move_to(target);
            let _ = run(&mut reference, pause);
        }
        assert!(run(&mut reference, 2000) < 2000);
        assert_eq!(reference.setpoint(), Setpoint::at(199.99));
    }

    #[test]
    fn a_move_begins_after_its_planning_and_takes_the_time_of_the_limits() {
        let mut reference = at_rest();
        reference.move_to(60.0);
        for _ in 0..PLANNING {
            assert_eq!(reference.update(), Setpoint::at(0.0));
        }
        // 60 units without cruise: v^2/a + v a/j = 60, and twice v/a + a/j to go up and down.
        let (a, j) = (LIMITS.acceleration, LIMITS.jerk);
        let v = 0.5 * (sqrt(a * a * a * a / (j * j) + 4.0 * a * 60.0) - a * a / j);
        let time = 2.0 * (v / a + a / j);
        let taken = 1e-3 * run(&mut reference, 2000) as f32;
        assert!((taken - time).abs() < 2e-3, "{taken} s instead of {time} s");
    }

    #[test]
    fn targets_in_every_sample_are_followed() {
        let mut reference = at_rest();
        for k in 0..400 {
            reference.move_to(0.1 * k as f32);
            let _ = reference.update();
        }
        assert!(reference.setpoint().position > 25.0);
        assert!(run(&mut reference, 2000) < 2000);
        assert_eq!(reference.setpoint(), Setpoint::at(0.1 * 399.0));
    }
}
