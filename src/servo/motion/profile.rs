//! Planning of a jerk-limited move, spread over samples.

use crate::math::sqrt;
use crate::servo::motion::{Motion, MotionLimits, Setpoint, Travel};

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

impl Segment {
    /// The places within the piece at which the motion reverses, its begin where there is none.
    fn reversals(&self, start: &Motion) -> [f32; 2] {
        let (v, a, j) = (start.velocity, start.acceleration, self.jerk);
        let root = a * a - 2.0 * j * v;
        // Both solutions of v + a t + j t^2 / 2 = 0 without cancellation; without any, the begin.
        let q = if root < 0.0 {
            0.0
        } else {
            -a - sqrt(root).copysign(a)
        };
        [[q, j], [2.0 * v, q]].map(|[over, under]| {
            let time = if under == 0.0 { 0.0 } else { over / under };
            let within = time > 0.0 && time < self.duration;
            self.at(start, if within { time } else { 0.0 }).position
        })
    }
}

/// A planned move: seven pieces, and where it is now.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Move {
    segments: [Segment; 7],
    /// The present piece, and where it began.
    index: u8,
    start: Motion,
    /// Time into the piece at its first sample, and samples since: a sum of sample times would lose
    /// them after hours.
    offset: f32,
    samples: u32,
    target: f32,
}

impl Move {
    /// A move of these pieces that ends at rest at `target`.
    fn new(segments: [Segment; 7], start: Motion, target: f32) -> Self {
        Self {
            segments,
            index: 0,
            start,
            offset: 0.0,
            samples: 0,
            target,
        }
    }

    /// A move that comes to rest from `start` as fast as the limits allow.
    pub(crate) fn stop(start: Motion, limits: &MotionLimits) -> Self {
        let [a, b, c] = change(start.velocity, start.acceleration, 0.0, limits);
        let target = start.position + end(&from_zero(&start), &[a, b, c]).position;
        let none = Segment::default();
        Self::new([a, b, c, none, none, none, none], start, target)
    }

    /// Whether no point of the move is outside of the travel.
    ///
    /// Only on the way to the cruising velocity, the first three pieces, does the motion reverse at
    /// a place of its own; after it the motion keeps its direction to the target. Cost: some 100
    /// instructions.
    pub(crate) fn stays_within(&self, travel: &Travel) -> bool {
        let [a, b, c, ..] = &self.segments;
        let mut start = self.start;
        for segment in [a, b, c] {
            if !segment
                .reversals(&start)
                .iter()
                .all(|y| travel.contains(*y))
            {
                return false;
            }
            start = segment.at(&start, segment.duration);
        }
        travel.contains(self.target)
    }

    /// Where the move ends.
    pub(crate) const fn target(&self) -> f32 {
        self.target
    }

    /// The setpoint `step` seconds on, and whether the move has ended. Cost: about 45 instructions.
    #[inline]
    pub(crate) fn next(&mut self, step: f32) -> (Setpoint, bool) {
        self.samples = self.samples.saturating_add(1);
        let mut time = self.offset + self.samples as f32 * step;
        while let Some(segment) = self.segments.get(usize::from(self.index))
            && time >= segment.duration
        {
            self.start = segment.at(&self.start, segment.duration);
            time -= segment.duration;
            self.offset = time;
            self.samples = 0;
            self.index += 1;
        }
        match self.segments.get(usize::from(self.index)) {
            Some(segment) => {
                let now = segment.at(&self.start, time);
                (Setpoint::of(&now, segment.jerk), false)
            }
            // What rounding left is below the resolution of any sensor.
            None => (Setpoint::at(self.target), true),
        }
    }
}

/// Samples that planning a move takes; the move begins with the one after them.
pub(crate) const PLANNING: u8 = 16;

/// The search for the cruising velocity of a move of up to seven pieces from `start` to rest at
/// `target`.
///
/// The velocity is the largest from which the axis still stops in time: 15 bits of it, one per
/// sample; cruising makes up for the rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Search {
    start: Motion,
    target: f32,
    direction: f32,
    /// A velocity from which the axis stops in time, and one from which it does not.
    low: f32,
    high: f32,
    left: u8,
}

impl Search {
    /// A search that will be finished after [`PLANNING`] steps.
    pub(crate) fn new(start: Motion, target: f32, limits: &MotionLimits) -> Self {
        let stop = change(start.velocity, start.acceleration, 0.0, limits);
        let need = target - start.position;
        let direction = if need >= end(&from_zero(&start), &stop).position {
            1.0
        } else {
            -1.0
        };
        // Without a limit of the jerk, from rest, v^2 = a d; what it has already comes on top.
        let settled =
            start.velocity.abs() + 0.5 * start.acceleration * start.acceleration / limits.jerk;
        let reach = sqrt(limits.acceleration * need.abs()) + 2.0 * settled;
        Self {
            start,
            target,
            direction,
            low: 0.0,
            // Twice the largest velocity: the first step of the search then tests the largest
            // itself.
            high: if 2.0 * limits.velocity < reach {
                2.0 * limits.velocity
            } else {
                reach
            },
            left: PLANNING,
        }
    }

    /// One sample of the search; whether there is more to do. Cost: some 400 instructions.
    pub(crate) fn step(&mut self, limits: &MotionLimits) -> bool {
        self.left = self.left.saturating_sub(1);
        if self.left == 0 {
            // This sample has the seven pieces to compute.
            return false;
        }
        let need = self.direction * (self.target - self.start.position);
        let middle = 0.5 * (self.low + self.high);
        let middle = if middle < limits.velocity {
            middle
        } else {
            limits.velocity
        };
        if self.direction * self.pieces(middle, limits).2 > need {
            self.high = middle;
        } else {
            self.low = middle;
            if middle >= limits.velocity {
                // The requested limit suffices.
                self.high = middle;
            }
        }
        true
    }

    /// To the cruising velocity, from it to rest, and how far that leads.
    fn pieces(&self, velocity: f32, limits: &MotionLimits) -> ([Segment; 3], [Segment; 3], f32) {
        let Motion {
            velocity: v,
            acceleration: a,
            ..
        } = self.start;
        let cruise = self.direction * velocity;
        let first = change(v, a, cruise, limits);
        let last = change(cruise, 0.0, 0.0, limits);
        let between = end(&from_zero(&self.start), &first);
        (first, last, end(&between, &last).position)
    }

    /// The move that was found.
    pub(crate) fn planned(&self, limits: &MotionLimits) -> Move {
        Move::new(self.segments(limits), self.start, self.target)
    }

    /// The seven pieces of the move.
    fn segments(&self, limits: &MotionLimits) -> [Segment; 7] {
        let (first, last, reach) = self.pieces(self.low, limits);
        let left = self.direction * (self.target - self.start.position - reach);
        let duration = if left > 0.0 && self.low > 1e-6 * limits.velocity {
            left / self.low
        } else {
            0.0
        };
        let cruise = Segment {
            jerk: 0.0,
            duration,
        };
        [
            first[0], first[1], first[2], cruise, last[0], last[1], last[2],
        ]
    }
}

/// The same motion, seen from where it begins: distances keep their digits.
fn from_zero(start: &Motion) -> Motion {
    Motion {
        position: 0.0,
        ..*start
    }
}

/// From velocity `v0` and acceleration `a0` to velocity `v1` and acceleration 0, as fast as the
/// limits allow.
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
