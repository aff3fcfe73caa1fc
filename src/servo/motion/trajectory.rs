//! Jerk-limited trajectory: a standstill, moves, a run-out, a sine.

use crate::servo::error::Error;
use crate::servo::motion::profile::{Move, PLANNING, Search};
use crate::servo::motion::run_out::RunOut;
use crate::servo::motion::sine::Sine;
use crate::servo::motion::{Motion, MotionLimits, Setpoint, Travel};

/// How often the acceleration of a brake is doubled, at most, to come to rest within the travel.
const BRAKE_DOUBLINGS: u8 = 6;

/// Largest frequency of a sine, in periods per sample.
const FREQUENCY_STEP_MAX: f32 = 0.1;

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
    travel: Travel,
    sample_time: f32,
    setpoint: Setpoint,
    plan: Plan,
    /// A move that is being planned, and the target that came meanwhile.
    search: Option<Search>,
    next: Option<f32>,
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
            setpoint: Setpoint::at(travel.min),
            plan: Plan::Rest,
            search: None,
            next: None,
            sine: None,
        }
    }

    /// Stands still at `position` from now on; a jump of the reference if it was elsewhere.
    pub(crate) fn hold(&mut self, position: f32) {
        self.setpoint = Setpoint::at(self.travel.nearest(position));
        self.begin(Plan::Rest);
    }

    /// Replaces the plan, also a move that is being planned.
    fn begin(&mut self, plan: Plan) {
        self.plan = plan;
        self.search = None;
        self.next = None;
        self.sine = None;
    }

    /// Takes a motion over and lets it run out with a double pole at `-rate` (rad/s).
    ///
    /// Where that would leave the limits or the travel, the axis brakes: at the limits, and harder only where the travel
    /// ends sooner.
    pub(crate) fn run_out(&mut self, from: Motion, rate: f32) {
        self.setpoint = Setpoint::of(&from, 0.0);
        let run_out = RunOut { rate };
        if self.travel.contains(run_out.end(&from)) && run_out.keeps(&from, &self.limits) {
            self.begin(Plan::RunOut(run_out));
            return;
        }
        let mut limits = self.limits;
        let mut stop = Move::stop(from, &limits);
        for _ in 0..BRAKE_DOUBLINGS {
            if self.travel.contains(stop.target()) {
                break;
            }
            limits.acceleration *= 2.0;
            limits.jerk *= 4.0;
            stop = Move::stop(from, &limits);
        }
        self.begin(Plan::Move(stop));
    }

    /// Moves to rest at `target`, limited to the travel, as fast as the limits allow, beginning 17 samples from now.
    ///
    /// NaN and infinity are refused.
    ///
    /// Targets may come in any sample: while a move is being planned the last of them is the next one.
    /// Cost: 16 times [`Trajectory::update`] in motion, to know where the move begins.
    pub(crate) fn move_to(&mut self, target: f32) -> Result<(), Error> {
        Error::unless_within("target", target, f32::MIN, f32::MAX)?;
        let target = self.travel.nearest(target);
        self.sine = None;
        if self.search.is_some() {
            self.next = Some(target);
        } else {
            self.search(target);
        }
        Ok(())
    }

    fn search(&mut self, target: f32) {
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
            self.search(next);
        }
    }

    /// Oscillates with `frequency` in Hz about the present position, in motion about the place where the reference comes to
    /// rest; the amplitude grows over one period.
    ///
    /// Refused, with the largest amplitude, unless the limits of motion and the travel have room for it.
    /// Not for the 1 ms path: one sine and cosine.
    pub(crate) fn oscillate(&mut self, amplitude: f32, frequency: f32) -> Result<(), Error> {
        let fastest = FREQUENCY_STEP_MAX / self.sample_time;
        Error::unless_positive("frequency", frequency)?;
        Error::unless_within("frequency", frequency, 0.0, fastest)?;
        let stop = Move::stop(self.setpoint.motion(), &self.limits);
        let centre = if self.setpoint.is_rest() {
            self.setpoint.position
        } else {
            stop.target()
        };
        let (below, above) = (centre - self.travel.min, self.travel.max - centre);
        let room = below.min(above).max(0.0);
        let max = room.min(Sine::max_amplitude(frequency, &self.limits));
        Error::unless_within("amplitude", amplitude, -max, max)?;
        let sine = Sine::new(centre, amplitude, frequency, self.sample_time);
        if self.setpoint.is_rest() {
            self.begin(Plan::Sine(sine));
        } else {
            self.begin(Plan::Move(stop));
            self.sine = Some(sine);
        }
        Ok(())
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

    /// The last resort: a measured motion at an end of the travel may lead beyond it, a sine by a rounding.
    fn stop_at_end(&mut self) {
        let position = self.travel.nearest(self.setpoint.position);
        if matches!(self.plan, Plan::Sine(_)) {
            self.setpoint.position = position;
        } else {
            self.setpoint = Setpoint::at(position);
            self.plan = Plan::Rest;
        }
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
            self.plan = self.sine.take().map_or(Plan::Rest, Plan::Sine);
        }
        if !self.travel.contains(next.position) {
            self.stop_at_end();
        }
        self.setpoint
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ConfigError;
    use crate::math::sqrt;

    const LIMITS: MotionLimits = MotionLimits {
        velocity: 800.0,
        acceleration: 9000.0,
        jerk: 2.5e5,
    };

    fn at_rest() -> Trajectory {
        let travel = Travel {
            min: -1000.0,
            max: 1000.0,
        };
        let mut trajectory = Trajectory::new(LIMITS, travel, 1e-3);
        trajectory.hold(0.0);
        trajectory
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
            assert_eq!(reference.move_to(target), Ok(()));
            let _ = run(&mut reference, pause);
        }
        assert!(run(&mut reference, 2000) < 2000);
        assert_eq!(reference.setpoint(), Setpoint::at(199.99));
    }

    #[test]
    fn a_move_begins_after_its_planning_and_takes_the_time_of_the_limits() {
        let mut reference = at_rest();
        assert_eq!(reference.move_to(60.0), Ok(()));
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
            assert_eq!(reference.move_to(0.1 * k as f32), Ok(()));
            let _ = reference.update();
        }
        assert!(reference.setpoint().position > 25.0);
        assert!(run(&mut reference, 2000) < 2000);
        assert_eq!(reference.setpoint(), Setpoint::at(0.1 * 399.0));
    }

    const TRAVEL: Travel = Travel {
        min: 0.0,
        max: 400.0,
    };

    fn standing_at(position: f32, limits: MotionLimits) -> Trajectory {
        let mut reference = Trajectory::new(limits, TRAVEL, 1e-3);
        reference.hold(position);
        reference
    }

    #[test]
    fn a_slow_move_is_on_time_after_hours() {
        // 6 min, 1 h and 11 h of constant velocity.
        for velocity in [1.0_f32, 0.1, 0.01] {
            let mut reference = standing_at(
                0.0,
                MotionLimits {
                    velocity,
                    acceleration: 1e5,
                    jerk: 1e8,
                },
            );
            assert_eq!(reference.move_to(400.0), Ok(()));
            let time = 400.0 / f64::from(velocity);
            let half = (500.0 * time) as u32;
            let mut samples = 0_u32;
            while !reference.is_finished() && samples < 3 * half {
                let now = reference.update();
                samples += 1;
                if samples == half + u32::from(PLANNING) {
                    assert!((now.position - 200.0).abs() < 2e-3, "{}", now.position);
                }
            }
            let late = 1e-3 * f64::from(samples) - time;
            assert!(late.abs() < 0.02 + 1e-6 * time, "{velocity}: {late} s late");
        }
    }

    #[test]
    fn a_sine_without_room_is_refused_with_what_there_is_room_for() {
        let mut reference = standing_at(370.0, LIMITS);
        for (amplitude, frequency) in [
            (60.0, 1.0),
            (1e6, 1.0),
            (20.0, 400.0),
            (20.0, 1e30),
            (20.0, 0.0),
            (20.0, -1.0),
            (f32::NAN, 1.0),
            (20.0, f32::NAN),
            (f32::INFINITY, 1.0),
            (20.0, 5.0),
        ] {
            let refused = reference.oscillate(amplitude, frequency);
            assert!(refused.is_err(), "{amplitude} at {frequency} Hz");
            assert_eq!(reference.update(), Setpoint::at(370.0));
        }
        let refused = reference.oscillate(60.0, 1.0);
        let Err(Error::Setting(ConfigError::OutOfRange { limits, .. })) = refused else {
            panic!("no room for 60");
        };
        let max = limits[1];
        assert_eq!(max, 30.0);
        assert_eq!(reference.oscillate(max, 1.0), Ok(()));
    }

    /// Runs; nothing jumps, leaves its limits or the travel.
    fn watch(reference: &mut Trajectory, samples: usize) {
        let mut before = reference.setpoint();
        for k in 0..samples {
            let now = reference.update();
            assert!(TRAVEL.contains(now.position), "{k}: {now:?}");
            assert!(
                now.velocity.abs() <= 1.001 * LIMITS.velocity,
                "{k}: {now:?}"
            );
            assert!(
                now.acceleration.abs() <= 1.001 * LIMITS.acceleration,
                "{k}: {now:?}"
            );
            assert!(now.jerk.abs() <= 1.001 * LIMITS.jerk, "{k}: {now:?}");
            let v = now.velocity - before.velocity;
            assert!(
                v.abs() <= 1.01e-3 * LIMITS.acceleration,
                "{k}: {before:?} {now:?}"
            );
            before = now;
        }
    }

    #[test]
    fn a_sine_continues_the_motion_within_the_limits() {
        for interrupted in 17..330 {
            let mut reference = standing_at(40.0, LIMITS);
            assert_eq!(reference.move_to(300.0), Ok(()));
            watch(&mut reference, interrupted);
            assert_eq!(reference.oscillate(15.0, 2.0), Ok(()));
            watch(&mut reference, 700);
            // In motion again, and a move out of the sine.
            assert_eq!(reference.oscillate(10.0, 1.0), Ok(()));
            watch(&mut reference, interrupted);
            assert_eq!(reference.move_to(390.0), Ok(()));
            watch(&mut reference, 900);
            assert_eq!(reference.setpoint(), Setpoint::at(390.0));
        }
    }

    #[test]
    fn a_motion_that_is_taken_over_comes_to_rest_within_the_travel() {
        for position in [1.0_f32, 20.0, 100.0, 200.0, 390.0, 399.0] {
            for velocity in [-1500.0_f32, -800.0, -100.0, 0.0, 30.0, 800.0, 1500.0] {
                for acceleration in [-9e3_f32, 0.0, 5e3] {
                    let mut reference = standing_at(position, LIMITS);
                    let from = Motion {
                        position,
                        velocity,
                        acceleration,
                    };
                    reference.run_out(from, 25.0);
                    for _ in 0..2000 {
                        let now = reference.update();
                        assert!(TRAVEL.contains(now.position), "{from:?}: {now:?}");
                    }
                    assert!(reference.setpoint().is_rest(), "{from:?}");
                }
            }
        }
    }
}
