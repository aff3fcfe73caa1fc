//! Jerk-limited reference: moves planned once, evaluated with + - x only.

use crate::error::positive;
use crate::math::sqrt;
use crate::servo_error::ServoError;
use crate::servo_model::Motion;

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

/// A piece of constant jerk.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Segment {
    jerk: f32,
    duration: f32,
}

impl Segment {
    /// Where the piece leads after `time` seconds.
    #[inline]
    fn at(&self, start: &Motion, time: f32) -> Motion {
        let half = 0.5 * time;
        let third = time * (1.0 / 3.0);
        let (v, a, j) = (start.velocity, start.acceleration, self.jerk);
        Motion {
            position: start.position + time * (v + half * (a + third * j)),
            velocity: v + time * (a + half * j),
            acceleration: a + time * j,
        }
    }
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
/// to rest. [`Reference::move_to`] plans it with square roots and a bisection, once
/// per move and from any state; [`Reference::update`] evaluates it with + - x only.
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
        })
    }

    /// Stands still at `position` from now on; a jump of the reference if it was elsewhere.
    pub fn hold(&mut self, position: f32) {
        self.setpoint = Setpoint::at(position);
        self.plan = Plan::Rest;
    }

    /// Takes a motion over and lets it run out: `r''' = -2 rate r'' - rate^2 r'`, no plan and no roots.
    pub fn coast(&mut self, from: Motion, rate: f32) {
        self.setpoint = Setpoint {
            position: from.position,
            velocity: from.velocity,
            acceleration: from.acceleration,
            jerk: 0.0,
        };
        self.plan = Plan::Coast { rate };
    }

    /// Plans a move from the present state to rest at `target`; ignored unless finite.
    ///
    /// Not for the 1 ms path: about 60 square roots in software.
    pub fn move_to(&mut self, target: f32) {
        if !target.is_finite() {
            return;
        }
        let start = Motion {
            position: self.setpoint.position,
            velocity: self.setpoint.velocity,
            acceleration: self.setpoint.acceleration,
        };
        self.plan = Plan::Move {
            segments: plan(&start, target, &self.limits),
            index: 0,
            start,
            time: 0.0,
            target,
        };
        self.setpoint.jerk = 0.0;
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
        self.plan = Plan::Sine {
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
        };
    }

    /// Whether the reference stands still.
    pub fn is_finished(&self) -> bool {
        matches!(self.plan, Plan::Rest)
    }

    /// The newest setpoint.
    pub const fn setpoint(&self) -> Setpoint {
        self.setpoint
    }

    /// The next setpoint, one sample on. Cost: about 60 instructions.
    pub fn update(&mut self) -> Setpoint {
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

/// From velocity `v0` and acceleration `a0` to velocity `v1` and acceleration 0, as fast as the limits allow.
fn change(v0: f32, a0: f32, v1: f32, limits: &MotionLimits) -> [Segment; 3] {
    let j = limits.jerk;
    let settled = v0 + 0.5 * a0 * a0.abs() / j;
    let sign = if v1 >= settled { 1.0 } else { -1.0 };
    let gain = sign * (v1 - v0);
    let along = sign * a0;
    let mut peak = sqrt(j * gain + 0.5 * a0 * a0);
    let mut flat = 0.0;
    let cap = if along > limits.acceleration {
        along
    } else {
        limits.acceleration
    };
    if peak > cap {
        peak = cap;
        flat = (gain - (peak * peak - 0.5 * a0 * a0) / j) / peak;
    }
    let seconds = |t: f32| if t > 0.0 { t } else { 0.0 };
    [
        Segment {
            jerk: sign * j,
            duration: seconds((peak - along) / j),
        },
        Segment {
            jerk: 0.0,
            duration: seconds(flat),
        },
        Segment {
            jerk: -sign * j,
            duration: seconds(peak / j),
        },
    ]
}

/// Where the pieces lead from `start`.
fn end(start: &Motion, segments: &[Segment]) -> Motion {
    let mut motion = *start;
    for segment in segments {
        motion = segment.at(&motion, segment.duration);
    }
    motion
}

/// Seven pieces from `start` to rest at `target`.
fn plan(start: &Motion, target: f32, limits: &MotionLimits) -> [Segment; 7] {
    // Distances relative to the start keep their digits.
    let origin = Motion {
        position: 0.0,
        ..*start
    };
    let need = target - start.position;
    let stop = end(
        &origin,
        &change(start.velocity, start.acceleration, 0.0, limits),
    );
    let direction = if need >= stop.position { 1.0 } else { -1.0 };
    let pieces = |velocity: f32| {
        let first = change(
            start.velocity,
            start.acceleration,
            direction * velocity,
            limits,
        );
        let last = change(direction * velocity, 0.0, 0.0, limits);
        let between = end(&origin, &first);
        (first, last, end(&between, &last).position)
    };
    let (mut low, mut high) = (0.0, limits.velocity);
    let full = pieces(high);
    if direction * full.2 <= direction * need {
        low = high;
    } else {
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            if direction * pieces(middle).2 <= direction * need {
                low = middle;
            } else {
                high = middle;
            }
        }
    }
    let (first, last, reach) = pieces(low);
    let left = direction * (need - reach);
    let cruise = if left > 0.0 && low > 1e-6 * limits.velocity {
        left / low
    } else {
        0.0
    };
    [
        first[0],
        first[1],
        first[2],
        Segment {
            jerk: 0.0,
            duration: cruise,
        },
        last[0],
        last[1],
        last[2],
    ]
}
