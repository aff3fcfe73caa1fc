//! A jerk-limited move.

use crate::servo::motion::segment::{Segment, change, end, from_zero};
use crate::servo::motion::{Motion, MotionLimits, Setpoint, Travel};

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

/// A place of a move: the piece, where it began, and the time since.
struct Reached {
    index: u8,
    start: Motion,
    time: f32,
}

impl Move {
    /// A move of these pieces that ends at rest at `target`.
    pub(crate) fn new(segments: [Segment; 7], start: Motion, target: f32) -> Self {
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
    pub(crate) fn stays_within(&self, travel: &Travel) -> bool {
        self.begins_within(travel, 0, 3)
    }

    /// Whether no point of the pieces `from` to `to`, of the first three, is outside of the travel,
    /// nor the target.
    ///
    /// Only on the way to the cruising velocity, the first three pieces, does the motion reverse at
    /// a place of its own; after it the motion keeps its direction to the target. Cost: some 150
    /// instructions per piece.
    pub(crate) fn begins_within(&self, travel: &Travel, from: usize, to: usize) -> bool {
        let mut start = self.start;
        for (k, segment) in self.segments.iter().enumerate().take(to) {
            let reversals = || segment.reversals(&start);
            if k >= from && !reversals().iter().all(|y| travel.contains(*y)) {
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
        let now = self.at(self.offset + self.samples as f32 * step);
        if now.index != self.index {
            (self.index, self.start) = (now.index, now.start);
            (self.offset, self.samples) = (now.time, 0);
        }
        self.setpoint(&now)
    }

    /// The setpoint `samples` of `step` seconds on.
    pub(crate) fn ahead(&self, samples: u8, step: f32) -> Setpoint {
        let samples = self.samples.saturating_add(samples.into());
        self.setpoint(&self.at(self.offset + samples as f32 * step))
            .0
    }

    /// Where a time from the begin of the present piece on leads.
    #[inline]
    fn at(&self, time: f32) -> Reached {
        let mut now = Reached {
            index: self.index,
            start: self.start,
            time,
        };
        while let Some(segment) = self.segments.get(usize::from(now.index))
            && now.time >= segment.duration
        {
            now.start = segment.at(&now.start, segment.duration);
            now.time -= segment.duration;
            now.index += 1;
        }
        now
    }

    /// The setpoint there, and whether the move has ended.
    #[inline]
    fn setpoint(&self, now: &Reached) -> (Setpoint, bool) {
        match self.segments.get(usize::from(now.index)) {
            Some(segment) => {
                let motion = segment.at(&now.start, now.time);
                (Setpoint::of(&motion, segment.jerk), false)
            }
            // What rounding left is below the resolution of any sensor.
            None => (Setpoint::at(self.target), true),
        }
    }
}
