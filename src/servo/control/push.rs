//! The push that moves an axis which friction holds.

use crate::math::{sign, within};
use crate::servo::control::controller::Controller;
use crate::servo::control::estimator::DRIVE_MAX_RATIO;
use crate::servo::design::constants::BREAKAWAY_RATIO;
use crate::servo::motion::Setpoint;

/// Rate of the push over friction and bandwidth: the largest one behind a moving reference, that at
/// rest, and the growth of both per 1/wc for which the axis is held.
const PUSH_MOST: f32 = 3.0;
const PUSH_AT_REST: f32 = 0.25;
const PUSH_GROWTH: f32 = 0.3;
/// Largest growth behind a reference that moves: a quicker push makes a longer hop than those whose
/// length is known, and leads past a slow reference.
const GROWN: f32 = 1.5;
/// Drive over friction that waits for a reference which comes to the axis: it holds, and little is
/// missing.
const READY: f32 = 0.8;
/// Time over 1/wc in which a push moves the axis, and the part of it by which it may be sooner or
/// later.
const LATER: f32 = 1.5;
const LATER_ERROR: f32 = 0.25;
/// Largest drive over friction with which an axis that sticks can still be one that its friction
/// holds.
const HELD_MOST: f32 = 0.99 * DRIVE_MAX_RATIO;

impl Controller {
    /// Rate of the drive that moves a sticking axis.
    ///
    /// It is pushed to where the reference will be when the push has moved it, which is not beyond
    /// the goal of a move: a small one is over before. That time is known to a quarter: what is
    /// missing then has a sign only beyond a quarter of the way that the reference goes meanwhile.
    /// A push the wrong way would cost the whole hop.
    ///
    /// Behind a moving reference it grows so that the axis hops when as much is missing as a hop is
    /// long: see [`due`]. After a pause of the reference it may grow faster, by the time of it: a
    /// move that begins there outruns the hop, which says nothing about those to come. At rest it
    /// begins slowly and grows with the time for which the axis is held, so that a hop is as short
    /// as it can be, and comes. Time for which the valve rested does not count: nothing was missing
    /// then, and a small step behind a long rest would be met by a push of any rate.
    ///
    /// The drive of an axis that sticks is only integrated, up to a limit. Beyond it, a load is in
    /// the way or the drive is less than it seems: then the error counts, as for an axis that
    /// slides.
    #[inline]
    pub(super) fn break_away(&self, r: &Setpoint, at_rest: bool, heading_rate: f32) -> f32 {
        let model = self.estimator.model();
        let state = self.estimator.ahead();
        let error = r.position - state.position;
        // Where the reference will be when a push has moved the axis: a hop that overshoots it is
        // none.
        let wc = self.estimator.poles().bandwidth;
        let later = LATER / wc;
        let velocity = r.velocity + 0.5 * later * r.acceleration;
        let coming = error + self.until_goal(r, later * velocity);
        let direction = sign(coming);
        let goes = later * (r.velocity.abs() + 0.5 * later * r.acceleration.abs());
        let (unknown, window) = (LATER_ERROR * goes, self.rest.window());
        let band = if unknown > window { unknown } else { window };
        let worth = if at_rest {
            0.0
        } else {
            self.hop.worth(direction, r.position)
        };
        let least = if band > worth { band } else { worth };
        if within(coming, least) == coming {
            return 0.0;
        }
        if direction * error < -band {
            // The reference comes to the axis, which is held until then.
            let missing = READY * model.friction - direction * state.drive;
            let rate = self.quick() * missing;
            return if rate > 0.0 { direction * rate } else { 0.0 };
        }
        let growth = self.growth();
        let rested = if at_rest { self.rested } else { 0 };
        let grown = 1.0 + growth * self.anchor.since().saturating_sub(rested) as f32;
        let rate = if at_rest {
            PUSH_AT_REST * wc * grown
        } else {
            let left = self.hop.length(direction) - direction * error;
            let grown = if grown < GROWN { grown } else { GROWN };
            let pause = growth * self.pause as f32;
            let most = if pause > grown { pause } else { grown };
            due(left, direction * velocity, PUSH_MOST * wc * most)
        };
        let least = rate * model.friction;
        let quick = self.quick() * (model.friction - direction * state.drive);
        let push = if quick > least { quick } else { least };
        if direction * self.estimator.now().drive < HELD_MOST * model.friction {
            return direction * push;
        }
        let slide = direction * self.slide(r, at_rest, heading_rate);
        direction * if slide > push { slide } else { push }
    }

    /// The error for which it waits while friction holds the axis behind a reference that moves:
    /// the length of a hop. 0 while it waits for none.
    pub(crate) fn awaited(&self, r: &Setpoint) -> f32 {
        if self.sticks() && !r.is_rest() {
            let error = r.position - self.estimator.now().position;
            self.hop.length(sign(error))
        } else {
            0.0
        }
    }

    /// So much of a way of the reference as it goes until its goal, if it is on the way there.
    fn until_goal(&self, r: &Setpoint, way: f32) -> f32 {
        let Some(goal) = self.goal else {
            return way;
        };
        let left = goal - r.position;
        let leaves = r.velocity * left < 0.0;
        let ends = way * left < 0.0 || within(way, left.abs()) != way;
        if ends && !leaves { left } else { way }
    }

    /// Growth of the push in a sample.
    fn growth(&self) -> f32 {
        PUSH_GROWTH * self.estimator.poles().bandwidth * self.sample_time()
    }

    /// One sample of a reference that rests.
    #[inline]
    pub(super) const fn pauses(&mut self) {
        self.pause = if self.sticks() {
            self.anchor.since()
        } else {
            0
        };
    }

    /// Whether the motion that ends was pushed by the pause before it; it is none for the next one.
    pub(super) fn resumed(&mut self) -> bool {
        let pause = core::mem::take(&mut self.pause);
        self.growth() * pause as f32 > GROWN
    }
}

/// Rate over friction of a push whose hop is due when a reference that goes with `speed` has gone
/// the distance that is `left` until as much is missing as a hop is long.
///
/// ```text
/// rate = 2.5 speed / left,   at most `most`;   that one where a hop is due
/// ```
///
/// Until then it gathers the drive of the largest breakaway. Sooner, the hop leads past the
/// reference, later the axis is behind it for nothing. A reference that turns back takes the push
/// back.
#[inline]
fn due(left: f32, speed: f32, most: f32) -> f32 {
    if left > 0.0 && BREAKAWAY_RATIO * speed < most * left {
        BREAKAWAY_RATIO * speed / left
    } else {
        most
    }
}

#[cfg(test)]
mod tests;
