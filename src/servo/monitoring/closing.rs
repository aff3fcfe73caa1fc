//! Why an axis moves against its commands: the valve closes, which is the safe answer and the test at once.

use crate::servo::monitoring::bounds::Bounds;
use crate::servo::supervision::state::Reason;

/// The motion of an axis whose valve closes.
///
/// With the wrong sign of valve or sensor the axis obeys its valve, only the other way: behind a closed valve it is a spring, whose
/// speed is gone after a quarter of its period, or a little later when its force still grows, and comes back with the other sign. A spool that is stuck, or a load that
/// falls without air, goes on as before. What stops without having been mirrored has only run out: the valve was closed already, or moves nothing.
/// The speed decides, half a period, 3/w, and the delay after the valve was told to close.
///
/// Cost: about 8 instructions.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Closing {
    /// Samples that are left, and the speed at the begin.
    left: u32,
    speed: f32,
    /// Whether the motion was the expected one with the other sign.
    mirrored: bool,
}

/// Share of the speed at the begin above which the axis goes on.
const GOES_ON: f32 = 0.4;

impl Closing {
    /// Whether the valve is being closed.
    pub(crate) const fn is_active(&self) -> bool {
        self.left > 0
    }

    /// The valve closes while the axis moves so fast; `mirrored`: as expected, with the other sign.
    pub(crate) const fn begin(&mut self, velocity: f32, mirrored: bool, bounds: &Bounds) {
        self.mirrored = mirrored;
        self.left = bounds.closing;
        self.speed = velocity;
    }

    /// One sample; the reason in the last one.
    #[inline]
    pub(crate) fn update(&mut self, velocity: f32) -> Option<Reason> {
        self.left = self.left.saturating_sub(1);
        if self.left > 0 {
            return None;
        }
        let along = if self.speed > 0.0 {
            velocity
        } else {
            -velocity
        };
        Some(if along > GOES_ON * self.speed.abs() {
            Reason::ValveStuck
        } else if self.mirrored {
            Reason::WrongSign
        } else {
            Reason::Blocked
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::model::Model;
    use crate::servo::monitoring::bounds::example;
    use crate::servo::motion::Motion;

    /// A drive at any motion whose valve closes after its delay stops; one whose valve does not goes on.
    #[test]
    fn a_closed_valve_stops_an_axis_and_an_open_one_does_not() {
        for w in [8.0_f32, 20.0, 80.0] {
            for damping in [0.1, 0.7, 2.0] {
                let model = Model::linear(w * w, damping * w, w * w * 1000.0);
                let bounds = example::bounds(&model);
                for push in [0.0, 0.5, 1.0] {
                    for flow in [0.0, 0.3] {
                        let mut motion = Motion {
                            velocity: 300.0,
                            acceleration: push * w * 300.0,
                            ..Motion::default()
                        };
                        let mut closing = Closing::default();
                        closing.begin(motion.velocity, true, &bounds);
                        let mut reason = None;
                        while closing.is_active() {
                            model.advance(&mut motion, flow, 0.001);
                            reason = closing.update(motion.velocity);
                        }
                        let right = if flow > 0.0 {
                            Reason::ValveStuck
                        } else {
                            Reason::WrongSign
                        };
                        assert_eq!(reason, Some(right), "w {w} damping {damping} push {push}");
                    }
                }
            }
        }
    }
}
