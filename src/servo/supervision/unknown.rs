//! What a dead zone and a friction that are not quite known move: the nuisance parameters of a
//! window.

use crate::math::{sign, within};
use crate::servo::control::observer::Observer;
use crate::servo::control::place::PlacedFlow;
use crate::servo::design::constants::{UNKNOWN_FLOW, UNKNOWN_PART};
use crate::servo::model::Model;
use crate::servo::motion::Motion;

/// The flow by which the dead zone of a verified model may be wrong.
pub(crate) fn unknown_flow(model: &Model) -> f32 {
    let part = UNKNOWN_PART * model.dead_zone;
    if part > UNKNOWN_FLOW {
        part
    } else {
        UNKNOWN_FLOW
    }
}

/// What a unit of the flow, and of the friction, has moved at a sample.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Responses {
    flow: f32,
    friction: f32,
}

/// Errors of a model in free simulation.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Errors {
    /// Sum of their squares.
    pub(crate) squares: f32,
    /// Sums of their products with the responses.
    along: Responses,
}

impl Errors {
    /// One error, with the responses at that sample.
    #[inline]
    pub(crate) fn add(&mut self, error: f32, responses: Responses) {
        self.squares += error * error;
        self.along.flow += error * responses.flow;
        self.along.friction += error * responses.friction;
    }
}

/// What a model in use does not know of the valve and of friction, beside a window of free
/// simulation.
///
/// Of its dead zone a verified model may not know a part. What is not known is a flow that is
/// constant while the command keeps its direction, and turns with it; in a slow motion it moves the
/// axis as a wrong gain or load would. Of its friction neither: that of a reversal is above that of
/// a motion (Stribeck 1902). Near the natural frequency the amplitude is what the drive has beyond
/// friction, over a small damping: friction that is a third higher halves it, as half of the gain
/// would. So what such a flow and such a friction explain speaks against no model:
///
/// ```text
/// s, r   responses of the model in use to the sign of the flow, and to that of the velocity as a
///        deceleration, from the begin of the window on: observed, then free
/// e      errors of a model in free simulation
/// left   min  Sum (e - c s - d r)^2
///        |c| <= the larger of half of the dead zone and 0.03,  |d| <= half of the friction
/// ```
///
/// An axis that is the model in use, with dead zone and friction wrong by no more than the bounds,
/// has errors of c s + d r: a window, and any number of them, leaves nothing. The observation
/// before is wrong with it, in velocity by `3 (w0/w)^2` of what such a flow moves where its rate w
/// is above w0, and by all of it where it is not: s and r are wrong alike. A wrong gain leaves
/// errors in proportion to the flow: in a large motion those beyond the bounds remain; in a slow
/// one, and in one that friction rules, the window cannot tell.
///
/// The sum is a parabola in c and d, with its lowest point at (c0, d0). Where only one of both is
/// out of its bound, that one is at its bound: on the line on which the other is best the sum grows
/// with the distance from c0, d0. Where both are, the least lies on the side of one or the other.
/// So of two points one is the least within the bounds: c0 in its bound with the best d for it, and
/// d0 with the best c.
///
/// Known as: nuisance parameters, profiled out of a sum of squares (profile likelihood, Cox and
/// Hinkley 1974), here within bounds.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Unknown {
    /// 1/C of the model in use.
    inverse_gain: f32,
    /// What flow and friction are at most.
    bounds: Responses,
    /// What they have moved.
    by_flow: Motion,
    by_friction: Motion,
    /// Direction of the axis, against which friction acts; 0 before the first.
    direction: f32,
    /// Sums of the squares of the responses, and of their product.
    squares: Responses,
    product: f32,
}

impl Unknown {
    /// Of a model in use.
    pub(crate) fn new(used: &Model) -> Self {
        Self {
            inverse_gain: used.a1 / used.b0,
            bounds: Responses {
                flow: unknown_flow(used),
                friction: UNKNOWN_PART * used.friction,
            },
            by_flow: Motion::default(),
            by_friction: Motion::default(),
            direction: 0.0,
            squares: Responses::default(),
            product: 0.0,
        }
    }

    /// A sample in which the model in use is observed, with the flow that was in force and the
    /// velocity of the axis. Cost: about 75 instructions.
    #[inline]
    pub(crate) fn observe(&mut self, used: &Observer, at: PlacedFlow, velocity: f32) {
        let [flow, friction] = self.moved(at);
        used.deviate_observed(&mut self.by_flow, flow);
        used.deviate_observed(&mut self.by_friction, friction);
        self.reverse(velocity);
    }

    /// A sample in which it runs freely: the responses after it. Cost: about 75 instructions.
    #[inline]
    pub(crate) fn update(&mut self, used: &Observer, at: PlacedFlow, velocity: f32) -> Responses {
        let [flow, friction] = self.moved(at);
        used.deviate(&mut self.by_flow, flow);
        used.deviate(&mut self.by_friction, friction);
        self.reverse(velocity);
        let responses = Responses {
            flow: self.by_flow.position,
            friction: self.by_friction.position,
        };
        self.squares.flow += responses.flow * responses.flow;
        self.squares.friction += responses.friction * responses.friction;
        self.product += responses.flow * responses.friction;
        responses
    }

    /// What moves both responses: a unit of the flow along its direction, and nothing; less what
    /// their velocities take of it where the axis is stiffer than in the middle, see
    /// [`MovedFlow`](crate::servo::control::place::MovedFlow).
    #[inline]
    fn moved(&self, at: PlacedFlow) -> [f32; 2] {
        let slope = (at.stiffness - 1.0) * self.inverse_gain;
        let along = if at.flow > 0.0 {
            at.stiffness
        } else if at.flow < 0.0 {
            -at.stiffness
        } else {
            0.0
        };
        [
            along - slope * self.by_flow.velocity,
            -slope * self.by_friction.velocity,
        ]
    }

    /// Friction turns with the axis: a jump of the acceleration.
    #[inline]
    fn reverse(&mut self, velocity: f32) {
        if velocity * self.direction > 0.0 {
            return;
        }
        let direction = sign(velocity);
        if direction == 0.0 {
            return;
        }
        if self.direction != 0.0 {
            self.by_friction.acceleration -= direction - self.direction;
        }
        self.direction = direction;
    }

    /// What is left of errors; below zero by rounding alone. Not finite where these are not.
    pub(crate) fn left(&self, errors: &Errors) -> f32 {
        let Errors { squares, along } = *errors;
        let (ss, rr, sr) = (self.squares.flow, self.squares.friction, self.product);
        let left = |c: f32, d: f32| {
            let explained = c * (2.0 * along.flow - c * ss) + d * (2.0 * along.friction - d * rr);
            squares - explained + 2.0 * c * d * sr
        };
        let flow_for = |d: f32| bounded(along.flow - d * sr, ss, self.bounds.flow);
        let friction_for = |c: f32| bounded(along.friction - c * sr, rr, self.bounds.friction);
        let determinant = ss * rr - sr * sr;
        let c = bounded(
            along.flow * rr - along.friction * sr,
            determinant,
            self.bounds.flow,
        );
        let d = bounded(
            along.friction * ss - along.flow * sr,
            determinant,
            self.bounds.friction,
        );
        let (one, other) = (left(c, friction_for(c)), left(flow_for(d), d));
        // NaN stays.
        if one < other { one } else { other }
    }
}

/// A quotient within a bound; 0 where there is nothing to divide by.
#[inline]
fn bounded(dividend: f32, divisor: f32, bound: f32) -> f32 {
    if divisor > 0.0 {
        within(dividend / divisor, bound)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests;
