//! What a dead zone that is not quite known moves: the nuisance parameter of a window.

use crate::math::within;
use crate::servo::control::observer::Transition;
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

/// Errors of a model in free simulation.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Errors {
    /// Sum of their squares.
    pub(crate) squares: f32,
    /// Sum of their products with the response to the unknown flow.
    along: f32,
}

impl Errors {
    /// One error, with the response at that sample.
    #[inline]
    pub(crate) fn add(&mut self, error: f32, response: f32) {
        self.squares += error * error;
        self.along += error * response;
    }
}

/// The flow that a model in use does not know, beside a window of free simulation.
///
/// Of its dead zone a verified model may not know a part. What is not known is a flow that is
/// constant while the command keeps its direction, and turns with it; in a slow motion it moves the
/// axis as a wrong gain or load would. So what such a flow explains speaks against no model:
///
/// ```text
/// s        response of the model in use to the sign of the flow, from where it runs freely
/// e        errors of a model in free simulation
/// left     min over |c| <= the larger of half of the dead zone and 0.04 of  Sum (e - c s)^2
/// c        Sum e s / Sum s^2 within the bound, since the sum is a parabola in c
/// ```
///
/// An axis that is the model in use with a dead zone wrong by no more than the bound has errors of
/// c s, and of what the observation before got wrong: a window, and any number of them, leaves
/// nothing of the first; of the second, at a wrong c an observer of rate w is wrong in velocity by
/// `3 (w0/w)^2` of what that flow moves. A wrong gain leaves errors in proportion to the flow: in a
/// large motion those beyond the bound remain, in a slow one the window cannot tell.
///
/// Known as: nuisance parameter, profiled out of a sum of squares (profile likelihood, Cox and
/// Hinkley 1974), here within bounds.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct UnknownFlow {
    /// The model in use over a sample, and its 1/C.
    step: Transition,
    inverse_gain: f32,
    /// What the flow is at most.
    bound: f32,
    /// What it has moved.
    motion: Motion,
    /// Sum of the squares of the response.
    squares: f32,
}

impl UnknownFlow {
    /// Of a model in use, in samples of this time.
    pub(crate) fn new(used: &Model, time: f32) -> Self {
        Self {
            step: Transition::new(used, time),
            inverse_gain: used.a1 / used.b0,
            bound: unknown_flow(used),
            motion: Motion::default(),
            squares: 0.0,
        }
    }

    /// The response after another sample of free simulation, under the flow that was in force.
    /// Cost: about 35 instructions.
    #[inline]
    pub(crate) fn update(&mut self, at: PlacedFlow) -> f32 {
        let direction = if at.flow > 0.0 {
            1.0
        } else if at.flow < 0.0 {
            -1.0
        } else {
            0.0
        };
        let flow = PlacedFlow {
            flow: direction,
            ..at
        };
        let moved = flow.moved().at(self.motion.velocity, self.inverse_gain);
        self.step.advance(&mut self.motion, moved);
        let response = self.motion.position;
        self.squares += response * response;
        response
    }

    /// What is left of errors; below zero by rounding alone. Not finite where these are not.
    pub(crate) fn left(&self, errors: &Errors) -> f32 {
        let Errors { squares, along } = *errors;
        if !(self.squares > 0.0) {
            return squares;
        }
        let flow = within(along / self.squares, self.bound);
        squares - flow * (2.0 * along - flow * self.squares)
    }
}

#[cfg(test)]
mod tests;
