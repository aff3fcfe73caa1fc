//! How much flow an axis may be given on its way to an end of its travel.

use crate::servo::control::controller::Controller;
use crate::servo::motion::Setpoint;

/// Speed of a flow over the one that takes the room to an end within 1/w: what swings runs ahead of
/// its flow.
const APPROACH: f32 = 0.7;

/// A drive on its way to an end, all of it towards that end.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Approach {
    /// Distance to the end, velocity, acceleration, and drive beyond friction.
    distance: f32,
    velocity: f32,
    acceleration: f32,
    drive: f32,
    /// 1/w at this place.
    time: f32,
}

impl Approach {
    /// Largest speed of a flow that leaves room, negative when there is none.
    ///
    /// ```text
    /// room = distance - the larger of v/w + 2 a/w^2 and p/w^2,   C flow <= 0.7 w room
    /// ```
    ///
    /// Behind a closed valve a drive without damping goes `a/w^2 + sqrt((v/w)^2 + (a/w^2)^2)`
    /// further, which is less than the first, where v and a that lead away count as 0; one that is
    /// damped comes to rest after `p/w^2`. Of an axis that is held, a and p are what its drive is
    /// beyond friction: so it hops by the first when it is let go. With that flow all the time, a
    /// drive with a damping of 0.05 or more meets its end with less than a tenth of its speed, or
    /// not at all.
    ///
    /// Known as: control barrier function (Ames et al. 2019).
    #[inline]
    fn speed(&self) -> f32 {
        let onward = |x: f32| if x > 0.0 { x } else { 0.0 };
        let swing = onward(self.velocity) + 2.0 * self.time * onward(self.acceleration);
        let rest = self.time * self.drive;
        let further = if rest > swing { rest } else { swing };
        APPROACH * (self.distance / self.time - further)
    }
}

impl Controller {
    /// A flow within what leaves room at both ends of the travel, or within what the reference
    /// itself takes, which comes to rest by itself. Cost: about 45 instructions.
    #[inline]
    pub(super) fn with_room(&self, flow: f32, r: &Setpoint) -> f32 {
        let (model, step) = (self.estimator.model(), self.estimator.step());
        let state = self.estimator.ahead();
        let travel = self.design.estimator.travel;
        let (way, distance) = if flow > 0.0 {
            (1.0, travel.max - state.position)
        } else {
            (-1.0, state.position - travel.min)
        };
        let velocity = way * state.velocity;
        let drive = way * state.drive - model.friction;
        let approach = Approach {
            distance,
            velocity,
            acceleration: drive - step.a2 * velocity,
            drive,
            time: 1.0 / (self.frequency * self.estimator.frequency_ratio()),
        };
        let own = way * (r.jerk + step.a2 * r.acceleration + step.a1 * r.velocity) / step.b0;
        let most = approach.speed() * model.a1 / model.b0;
        let most = if most > own { most } else { own };
        if way * flow > most { way * most } else { flow }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::model::Model;
    use crate::servo::motion::Motion;

    /// The largest speed with which a drive passes an end at 100 that is told to go there at full
    /// flow, over its largest one; and its last place.
    fn blow(w: f32, damping: f32, gain: f32) -> (f32, f32) {
        let model = Model::linear(w * w, 2.0 * damping * w, w * w * gain);
        let mut motion = Motion::default();
        let (mut passed, mut fastest) = (0.0_f32, 0.0_f32);
        for _ in 0..(60_000.0 / w + 3e5 / gain) as usize {
            let approach = Approach {
                distance: 100.0 - motion.position,
                velocity: motion.velocity,
                acceleration: motion.acceleration,
                drive: motion.acceleration + model.a2 * motion.velocity,
                time: 1.0 / w,
            };
            let flow = (approach.speed() / gain).clamp(0.0, 1.0);
            model.advance(&mut motion, flow, 0.001);
            fastest = fastest.max(motion.velocity);
            if motion.position > 100.0 {
                passed = passed.max(motion.velocity);
            }
        }
        (passed / fastest, motion.position)
    }

    #[test]
    fn a_drive_that_is_told_to_go_to_its_end_arrives_slowly_or_not_at_all() {
        for w in [8.0_f32, 30.0, 90.0] {
            for damping in [0.05, 0.2, 0.5, 1.0, 1.3] {
                for gain in [100.0, 1000.0, 3000.0] {
                    let (passed, at) = blow(w, damping, gain);
                    assert!(passed < 0.1, "{w} {damping} {gain}: passes at {passed}");
                    assert!(at > 98.0, "{w} {damping} {gain}: stays at {at}");
                }
            }
        }
    }

    #[test]
    fn the_hop_of_an_axis_that_is_let_go_is_room_that_it_needs() {
        let held = Approach {
            distance: 5.0,
            velocity: 0.0,
            acceleration: 6400.0,
            drive: 6400.0,
            time: 1.0 / 40.0,
        };
        // Without a flow it hops by 2 a/w^2 = 8.
        assert!(held.speed() < 0.0);
        let farther = Approach {
            distance: 9.0,
            ..held
        };
        assert!(farther.speed() > 0.0);
    }
}
