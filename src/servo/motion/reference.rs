//! Jerk-limited reference: a standstill, moves, a run-out, a sine.

use crate::error::positive;
use crate::servo::error::ServoError;
use crate::servo::model::Motion;
use crate::servo::motion::profile::{PLANNING, Search, Segment};

/// What the drive is to do at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Setpoint {
    /// r.
    pub position: f32,
    /// r'.
    pub velocity: f32,
    /// r''.
    pub acceleration: f32,
    /// r''', in force until the next sample.
    pub jerk: f32,
}

impl Setpoint {
    /// A standstill at `position`.
    pub const fn at(position: f32) -> Self {
        Self {
            position,
            velocity: 0.0,
            acceleration: 0.0,
            jerk: 0.0,
        }
    }

    /// Whether nothing is to move.
    #[inline]
    pub fn is_rest(&self) -> bool {
        self.velocity == 0.0 && self.acceleration == 0.0 && self.jerk == 0.0
    }
}

/// Largest derivatives of a move, in units of y and s.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MotionLimits {
    /// Largest velocity.
    pub velocity: f32,
    /// Largest acceleration.
    pub acceleration: f32,
    /// Largest jerk.
    pub jerk: f32,
}

/// What the generator does now.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Plan {
    Rest,
    Move {
        segments: [Segment; 7],
        index: u8,
        start: Motion,
        time: f32,
        target: f32,
    },
    Coast {
        rate: f32,
    },
    Sine {
        centre: f32,
        amplitude: f32,
        /// Angular frequency in rad/s.
        omega: f32,
        /// cos and sin of the angle of one sample.
        turn: [f32; 2],
        /// cos and sin of the phase.
        phase: [f32; 2],
        /// Share of the full amplitude, and how much it grows per sample.
        share: f32,
        growth: f32,
    },
}

/// Generator of the reference: standstill, jerk-limited moves, a run-out, a sine.
///
/// A move has up to seven pieces of constant jerk: to the cruising velocity, cruise,
/// to rest, from any state. Planning takes square roots and a bisection, some 10 000
/// instructions; they are spread over the 16 samples after [`Reference::move_to`], in
/// which the reference goes on as before.
///
/// # Examples
/// ```
/// use trendid::{MotionLimits, Reference};
/// let limits = MotionLimits { velocity: 800.0, acceleration: 5000.0, jerk: 1.0e5 };
/// let mut reference = Reference::try_new(limits, 0.001, 10.0)?;
/// reference.move_to(70.0);
/// let mut samples = 0;
/// while !reference.is_finished() {
///     let _ = reference.update();
///     samples += 1;
/// }
/// assert_eq!(reference.setpoint().position, 70.0);
/// assert!(samples < 350);
/// # Ok::<(), trendid::ServoError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reference {
    limits: MotionLimits,
    sample_time: f32,
    setpoint: Setpoint,
    plan: Plan,
    /// A move that is being planned, and the target that came meanwhile.
    search: Option<Search>,
    next: Option<f32>,
}

impl Reference {
    /// A generator at rest at `position`.
    ///
    /// # Errors
    /// [`ServoError::SampleTime`], [`ServoError::MotionLimit`].
    pub fn try_new(
        limits: MotionLimits,
        sample_time: f32,
        position: f32,
    ) -> Result<Self, ServoError> {
        if !positive(sample_time) {
            return Err(ServoError::SampleTime(sample_time));
        }
        for limit in [limits.velocity, limits.acceleration, limits.jerk] {
            if !positive(limit) {
                return Err(ServoError::MotionLimit(limit));
            }
        }
        Ok(Self {
            limits,
            sample_time,
            setpoint: Setpoint::at(position),
            plan: Plan::Rest,
            search: None,
            next: None,
        })
    }

    /// Stands still at `position` from now on; a jump of the reference if it was elsewhere.
    pub fn hold(&mut self, position: f32) {
        self.setpoint = Setpoint::at(position);
        self.begin(Plan::Rest);
    }

    /// Does something else from now on, also instead of a move that is being planned.
    fn begin(&mut self, plan: Plan) {
        self.plan = plan;
        self.search = None;
        self.next = None;
    }

    /// Takes a motion over and lets it run out: `r''' = -2 rate r'' - rate^2 r'`, no plan and no roots.
    pub fn coast(&mut self, from: Motion, rate: f32) {
        self.setpoint = Setpoint {
            position: from.position,
            velocity: from.velocity,
            acceleration: from.acceleration,
            jerk: 0.0,
        };
        self.begin(Plan::Coast { rate });
    }

    /// Moves to rest at `target` as fast as the limits allow, beginning 17 samples from now; ignored unless finite.
    ///
    /// Targets may come in any sample: while a move is being planned the last of them is the next one.
    /// Cost: 16 times [`Reference::update`] in motion, to know where the move begins.
    pub fn move_to(&mut self, target: f32) {
        if !target.is_finite() {
            return;
        }
        if self.search.is_some() {
            self.next = Some(target);
            return;
        }
        let mut ahead = *self;
        if !matches!(ahead.plan, Plan::Rest) {
            for _ in 0..PLANNING {
                let _ = ahead.advance();
            }
        }
        let start = Motion {
            position: ahead.setpoint.position,
            velocity: ahead.setpoint.velocity,
            acceleration: ahead.setpoint.acceleration,
        };
        self.search = Some(Search::new(start, target, &self.limits));
    }

    /// One sample of planning; a move that is planned begins.
    fn plan(&mut self) {
        let Some(search) = &mut self.search else {
            return;
        };
        if search.step(&self.limits) {
            return;
        }
        let (start, target) = (search.start(), search.target());
        let segments = search.segments(&self.limits);
        let next = self.next;
        self.begin(Plan::Move {
            segments,
            index: 0,
            start,
            time: 0.0,
            target,
        });
        if let Some(next) = next {
            self.move_to(next);
        }
    }

    /// Oscillates about the present position with `frequency` in Hz; the amplitude grows over one period.
    ///
    /// Ignored unless both are finite. Not for the 1 ms path: one sine and cosine.
    pub fn oscillate(&mut self, amplitude: f32, frequency: f32) {
        if !(amplitude.is_finite() && positive(frequency)) {
            return;
        }
        let omega = 2.0 * core::f32::consts::PI * frequency;
        let angle = omega * self.sample_time;
        self.begin(Plan::Sine {
            centre: self.setpoint.position,
            amplitude,
            omega,
            turn: [
                crate::math::sin(angle + core::f32::consts::FRAC_PI_2),
                crate::math::sin(angle),
            ],
            phase: [1.0, 0.0],
            share: 0.0,
            growth: frequency * self.sample_time,
        });
    }

    /// Whether the reference stands still.
    pub fn is_finished(&self) -> bool {
        matches!(self.plan, Plan::Rest) && self.search.is_none()
    }

    /// The newest setpoint.
    pub const fn setpoint(&self) -> Setpoint {
        self.setpoint
    }

    /// The next setpoint, one sample on. Cost: about 60 instructions, and 400 more while a move is being planned.
    pub fn update(&mut self) -> Setpoint {
        let setpoint = self.advance();
        self.plan();
        setpoint
    }

    /// The next setpoint of the present plan.
    fn advance(&mut self) -> Setpoint {
        let step = self.sample_time;
        match &mut self.plan {
            Plan::Rest => {
                self.setpoint = Setpoint::at(self.setpoint.position);
            }
            Plan::Move {
                segments,
                index,
                start,
                time,
                target,
            } => {
                *time += step;
                while let Some(segment) = segments.get(usize::from(*index))
                    && *time >= segment.duration
                {
                    *start = segment.at(start, segment.duration);
                    *time -= segment.duration;
                    *index += 1;
                }
                if let Some(segment) = segments.get(usize::from(*index)) {
                    let now = segment.at(start, *time);
                    self.setpoint = Setpoint {
                        position: now.position,
                        velocity: now.velocity,
                        acceleration: now.acceleration,
                        jerk: segment.jerk,
                    };
                } else {
                    // What rounding left is below the resolution of any sensor.
                    self.setpoint = Setpoint::at(*target);
                    self.plan = Plan::Rest;
                }
            }
            Plan::Coast { rate } => {
                let s = &mut self.setpoint;
                s.jerk = -*rate * (2.0 * s.acceleration + *rate * s.velocity);
                s.position += step * (s.velocity + 0.5 * step * s.acceleration);
                s.velocity += step * (s.acceleration + 0.5 * step * s.jerk);
                s.acceleration += step * s.jerk;
                if s.velocity.abs() < 1e-4 * self.limits.velocity
                    && s.acceleration.abs() < 1e-4 * self.limits.acceleration
                {
                    self.setpoint = Setpoint::at(s.position);
                    self.plan = Plan::Rest;
                }
            }
            Plan::Sine {
                centre,
                amplitude,
                omega,
                turn,
                phase,
                share,
                growth,
            } => {
                let [c, s] = *phase;
                let mut rotated = [c * turn[0] - s * turn[1], s * turn[0] + c * turn[1]];
                // One step of Newton keeps the phasor on the unit circle.
                let correction = 1.5 - 0.5 * (rotated[0] * rotated[0] + rotated[1] * rotated[1]);
                rotated[0] *= correction;
                rotated[1] *= correction;
                *phase = rotated;
                let [c, s] = rotated;
                // Smooth step of degree 7 and its derivatives: the amplitude begins without a kick.
                let mut blend = [1.0, 0.0, 0.0, 0.0];
                if *share < 1.0 {
                    *share += *growth;
                    let x = if *share < 1.0 { *share } else { 1.0 };
                    let (x2, x3) = (x * x, x * x * x);
                    let rate = *growth / step;
                    blend = [
                        x3 * x * (35.0 - 84.0 * x + 70.0 * x2 - 20.0 * x3),
                        rate * 140.0 * x3 * (1.0 - 3.0 * x + 3.0 * x2 - x3),
                        rate * rate * 420.0 * x2 * (1.0 - 4.0 * x + 5.0 * x2 - 2.0 * x3),
                        rate * rate * rate * 840.0 * x * (1.0 - 6.0 * x + 10.0 * x2 - 5.0 * x3),
                    ];
                }
                let w = *omega;
                let wave = [s, w * c, -w * w * s, -w * w * w * c];
                self.setpoint = Setpoint {
                    position: *centre + *amplitude * blend[0] * wave[0],
                    velocity: *amplitude * (blend[0] * wave[1] + blend[1] * wave[0]),
                    acceleration: *amplitude
                        * (blend[0] * wave[2] + 2.0 * blend[1] * wave[1] + blend[2] * wave[0]),
                    jerk: *amplitude
                        * (blend[0] * wave[3]
                            + 3.0 * (blend[1] * wave[2] + blend[2] * wave[1])
                            + blend[3] * wave[0]),
                };
            }
        }
        self.setpoint
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

    fn at_rest() -> Result<Reference, ServoError> {
        Reference::try_new(LIMITS, 1e-3, 0.0)
    }

    /// Runs until it stands; checks that nothing jumps and nothing exceeds its limit.
    fn run(reference: &mut Reference, samples: usize) -> usize {
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
    fn moves_from_rest_and_in_motion_end_at_their_targets() -> Result<(), ServoError> {
        let mut reference = at_rest()?;
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
        Ok(())
    }

    #[test]
    fn a_move_begins_after_its_planning_and_takes_the_time_of_the_limits() -> Result<(), ServoError>
    {
        let mut reference = at_rest()?;
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
        Ok(())
    }

    #[test]
    fn targets_in_every_sample_are_followed() -> Result<(), ServoError> {
        let mut reference = at_rest()?;
        for k in 0..400 {
            reference.move_to(0.1 * k as f32);
            let _ = reference.update();
        }
        assert!(reference.setpoint().position > 25.0);
        assert!(run(&mut reference, 2000) < 2000);
        assert_eq!(reference.setpoint(), Setpoint::at(0.1 * 399.0));
        Ok(())
    }
}
