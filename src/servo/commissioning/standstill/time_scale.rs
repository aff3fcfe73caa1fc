//! What is known of the time scale of the axis, from the relay and then from a model, and how far a
//! swing takes it.

use crate::math::{larger, smaller, sqrt};
use crate::servo::commissioning::predictor::Theta;
use crate::servo::commissioning::probe::LATENESS;
use crate::servo::commissioning::rest::DETECTION_DEVIATIONS;
use crate::servo::commissioning::standstill::Standstill;
use crate::servo::commissioning::standstill::known::{Known, LAG_RADIANS};
use crate::servo::motion::Motion;

/// Half periods of the axis after which a drive without friction has moved by most of what its flow
/// leads to.
const LAG_HALVES: f32 = LAG_RADIANS / core::f32::consts::PI;

/// Half periods of the axis within which a swing is furthest against the drive.
const SWING_HALVES: f32 = 2.0;
/// The same in s before there is a model: a relay switches too soon on a lightly damped axis, so
/// that its half periods are short.
const SWING_FIRST: f32 = 0.3;
/// Half period of the axis over that of a relay, which switches too soon.
const SHORT_HALVES: f32 = 1.2;

impl Standstill {
    /// Half a period of the axis in s, as the relay has it, and the deviation of the acceleration
    /// over that of the position.
    pub(crate) const fn inform(&mut self, half: f32, noise: f32) {
        self.period = SWING_HALVES * half + LATENESS;
        self.relayed.late = LAG_HALVES * half + LATENESS;
        let per_frequency = SHORT_HALVES * core::f32::consts::FRAC_1_PI * half;
        let noise = noise * self.detection / DETECTION_DEVIATIONS;
        self.reach.inform(per_frequency, noise, self.detection);
        self.relayed.swing = if self.period > SWING_FIRST {
            self.period
        } else {
            SWING_FIRST
        };
    }

    /// Takes the motion after [`Self::update`], with the same command: whether the axis has gone
    /// further against it than a swing takes it.
    pub(crate) fn is_out_of_reach(&mut self, motion: &Motion, command: f32, step: f32) -> bool {
        self.reach.update(motion, command, step)
    }

    /// Whether the command has surely driven it since its direction began.
    pub(crate) fn is_driven(&self) -> bool {
        self.defiance.is_driven()
    }

    /// What is known of friction and time: from the model, or the first movement and the relay.
    pub(super) fn known(&mut self, model: Option<&Theta>) -> Known {
        match model {
            Some(m) if m.a1 != self.known.a1 => {
                self.known = Known::of(m, self.detection);
                self.reach.rescale(1.0 / sqrt(m.a1));
                // Neither the model nor the relay is certain of a period: the longer one.
                self.known.swing = larger(self.known.swing, self.period);
                let [up, down] = self.opening(1.0);
                self.opens = [
                    smaller(up, m.dead_zone - m.offset),
                    smaller(down, m.dead_zone + m.offset),
                ];
                self.known
            }
            Some(_) => self.known,
            None => self.relayed,
        }
    }
}
