//! Results of the commissioning, while it runs.

use crate::servo::commissioning::predictor::Theta;
use crate::servo::commissioning::{Commissioning, Found, Stage};
use crate::servo::control::place::dead_volume;
use crate::servo::model::Model;
use crate::servo::motion::Motion;

impl Commissioning {
    /// The estimate that waits for its validation.
    pub(crate) fn candidate(&self) -> Option<Found> {
        self.search.candidate().map(|theta| self.found(&theta))
    }

    pub(crate) fn found(&self, theta: &Theta) -> Found {
        let length = self.design.travel.length();
        Found {
            model: Model {
                a1: theta.a1,
                a2: theta.a2,
                b0: theta.b0 * length,
                dead_zone: theta.dead_zone,
                offset: theta.offset,
                friction: theta.friction * length,
            },
            delay: theta.delay,
            sign: self.sign,
            noise: length * self.still.sigma,
            // What was stated stays, also where no fit goes so far.
            dead_volume: (self.design.dead_volume).unwrap_or_else(|| dead_volume(theta.stiffening)),
            imbalance: theta.imbalance,
        }
    }

    /// Whether a fit or a simulation takes the time of this sample.
    pub(crate) const fn is_busy(&self) -> bool {
        !self.has_rested && self.search.is_busy()
    }

    /// Whether the axis obeys and is being identified.
    pub(crate) const fn is_sweeping(&self) -> bool {
        matches!(self.stage, Stage::Sweeping(_))
    }

    /// The motion in units of y, from the measured positions alone.
    pub(crate) fn motion(&self) -> Motion {
        let Motion {
            position,
            velocity,
            acceleration,
        } = self.tracking.motion();
        let travel = self.design.travel;
        let length = travel.length();
        Motion {
            position: travel.min + length * position,
            velocity: length * velocity,
            acceleration: length * acceleration,
        }
    }
}
