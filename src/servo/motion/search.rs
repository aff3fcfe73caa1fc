//! Planning of a jerk-limited move, spread over samples.

use crate::math::sqrt;
use crate::servo::motion::profile::Move;
use crate::servo::motion::segment::{Segment, braking, change, end, from_zero};
use crate::servo::motion::{Motion, MotionLimits, Travel};

/// Samples that planning a move takes, a power of two; the move begins with the one after them.
pub(crate) const PLANNING: u8 = 16;

/// The search for the cruising velocity of a move of up to seven pieces from `start` to rest at
/// `target`.
///
/// The velocity is the largest from which the axis still stops in time: 12 bits of it, one per
/// sample; cruising makes up for the rest.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ProfileSearch {
    start: Motion,
    target: f32,
    /// The limits on the way to rest.
    brake: MotionLimits,
    direction: f32,
    /// A velocity from which the axis stops in time, and one from which it does not.
    low: f32,
    high: f32,
    left: u8,
    planned: Option<Move>,
    fits: bool,
}

impl ProfileSearch {
    /// A search that will be finished after [`PLANNING`] steps, the last three for the move itself.
    pub(crate) const fn new(start: Motion, target: f32, brake: MotionLimits) -> Self {
        Self {
            start,
            target,
            brake,
            direction: 1.0,
            low: 0.0,
            high: 0.0,
            left: PLANNING,
            planned: None,
            fits: false,
        }
    }

    /// Where the move will end.
    pub(crate) const fn target(&self) -> f32 {
        self.target
    }

    /// One sample of the search; in the last one the move that was found, and whether it stays
    /// within the travel. Cost: some 300 instructions.
    pub(crate) fn step(&mut self, limits: &MotionLimits, travel: &Travel) -> Option<(Move, bool)> {
        const FIRST: u8 = PLANNING - 1;
        self.left = self.left.saturating_sub(1);
        match self.left {
            0 => {
                let found = self.planned.take();
                return found.map(|found| {
                    let fits = self.fits && found.begins_within(travel, 2, 3);
                    (found, fits)
                });
            }
            1 => {
                let planned = self.planned.as_ref();
                self.fits = planned.is_some_and(|p| p.begins_within(travel, 0, 2));
            }
            2 => self.planned = Some(Move::new(self.segments(limits), self.start, self.target)),
            FIRST => self.bracket(limits),
            _ => self.halve(limits),
        }
        None
    }

    /// The direction of the move, and velocities between which the largest is.
    fn bracket(&mut self, limits: &MotionLimits) {
        let start = &self.start;
        let stop = change(start.velocity, start.acceleration, 0.0, limits);
        let need = self.target - start.position;
        if need < end(&from_zero(start), &stop).position {
            self.direction = -1.0;
        }
        // Without a limit of the jerk, from rest, v^2 = a d; what it has already comes on top.
        let settled =
            start.velocity.abs() + 0.5 * start.acceleration * start.acceleration / limits.jerk;
        let reach = sqrt(limits.acceleration * need.abs()) + 2.0 * settled;
        // Twice the largest velocity: the first halving then tests the largest itself.
        self.high = if 2.0 * limits.velocity < reach {
            2.0 * limits.velocity
        } else {
            reach
        };
    }

    /// The half in which the largest velocity is.
    fn halve(&mut self, limits: &MotionLimits) {
        let need = self.direction * (self.target - self.start.position);
        let middle = 0.5 * (self.low + self.high);
        let middle = if middle < limits.velocity {
            middle
        } else {
            limits.velocity
        };
        if self.direction * self.reach(middle, limits).1 > need {
            self.high = middle;
        } else {
            self.low = middle;
            if middle >= limits.velocity {
                // The requested limit suffices.
                self.high = middle;
            }
        }
    }

    /// To the cruising velocity, and how far that and from it to rest leads.
    fn reach(&self, velocity: f32, limits: &MotionLimits) -> ([Segment; 3], f32) {
        let Motion {
            velocity: v,
            acceleration: a,
            ..
        } = self.start;
        let cruise = self.direction * velocity;
        let first = change(v, a, cruise, limits);
        let braking = self.direction * braking(velocity, &self.brake);
        (
            first,
            end(&from_zero(&self.start), &first).position + braking,
        )
    }

    /// The seven pieces of the move.
    fn segments(&self, limits: &MotionLimits) -> [Segment; 7] {
        let (first, reach) = self.reach(self.low, limits);
        let last = change(self.direction * self.low, 0.0, 0.0, &self.brake);
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

#[cfg(test)]
mod tests;
