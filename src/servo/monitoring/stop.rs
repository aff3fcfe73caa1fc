//! How a fault stops the axis.

use crate::math::sign;
use crate::servo::monitoring::bounds::Bounds;
use crate::servo::supervision::state::Reason;

/// What the valve does after a fault.
///
/// While the position is known the controller brakes on its observer to velocity zero, for a
/// bounded time. Otherwise, and afterwards, the valve is in the middle of its dead zone: a drive
/// whose velocity follows its valve comes to rest by itself, within `2 xi v / w + a / w^2`.
///
/// With a wrong sign nobody knows on which side of zero the middle is: with the offset o of the
/// model it is at -o when the sensor counts the other way, and at o when the valve opens the other
/// way. The valve goes to zero; where the offset exceeds the dead zone, the axis then creeps, the
/// measured way along o when it is the valve and against it when it is the sensor. In both cases
/// the middle is |o| the way of the creep. A swing that is taken for a creep corrects itself: with
/// the valve at |o| the wrong way the axis creeps the other way.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Stop {
    /// Samples of braking that are left.
    braking: u32,
    /// Samples that are left of those in which the brake must show, and the largest speed in them.
    showing: u32,
    peak: f32,
    /// Samples until the axis has stopped; the mean velocity, the share of a sample in it, and the
    /// least that counts.
    stopping: u32,
    velocity: f32,
    /// The way of the latest creep, 0 until there is one.
    creep: f32,
    share: f32,
    least: f32,
}

/// Share of the largest speed to which a brake brings it in the time in which it shows.
const BRAKED: f32 = 0.9;

impl Stop {
    /// Begins for a reason.
    pub(crate) fn begin(&mut self, reason: Reason, bounds: &Bounds) {
        let known = matches!(
            reason,
            Reason::TravelEnd | Reason::FollowingError | Reason::Saturated
        );
        *self = Self::default();
        if known {
            self.braking = bounds.stop.braking;
            self.showing = bounds.end.braking;
            self.least = bounds.end_speed;
        } else if reason == Reason::WrongSign {
            self.stopping = bounds.stop.closing;
            self.share = bounds.stop.creep;
            self.least = bounds.end_speed;
        }
    }

    /// Counts a sample; whether the controller brakes in it.
    pub(crate) const fn brakes(&mut self) -> bool {
        let brakes = self.braking > 0;
        self.braking = self.braking.saturating_sub(1);
        brakes
    }

    /// Looks at a velocity of the stopped axis.
    pub(crate) fn look(&mut self, velocity: f32) {
        if self.braking > 0 {
            self.watch(velocity.abs());
            return;
        }
        self.velocity += self.share * (velocity - self.velocity);
        self.stopping = self.stopping.saturating_sub(1);
        if self.stopping == 0 && self.velocity.abs() > self.least {
            self.creep = sign(self.velocity);
        }
    }

    /// Ends a brake that does not brake.
    ///
    /// Within the delay and 1/w a brake takes a tenth of the speed away, as
    /// [`End`](super::travel::End) has it. An axis that is faster then, or later, is not that of
    /// the model: a closed valve stops it better.
    fn watch(&mut self, speed: f32) {
        if self.showing > 0 {
            self.showing -= 1;
            self.peak = if speed > self.peak { speed } else { self.peak };
        } else if speed > self.least && !(speed < BRAKED * self.peak) {
            self.braking = 0;
        }
    }

    /// The way in which the axis creeps behind a valve at zero: 1, -1, or 0 when it does not.
    pub(crate) const fn creeps(&self) -> f32 {
        self.creep
    }

    /// Ends a controlled stop: the position is no longer known, or the axis stands.
    pub(crate) const fn end(&mut self) {
        self.braking = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::model::Model;
    use crate::servo::monitoring::bounds::example;
    use crate::servo::motion::Motion;

    /// With an offset beyond the dead zone, whichever of valve and sensor is the wrong way round,
    /// the axis comes to rest.
    #[test]
    fn the_middle_of_the_valve_is_found_behind_a_wrong_sign() {
        for (valve, sensor) in [(-1.0, 1.0), (1.0, -1.0)] {
            for offset in [-0.08_f32, 0.08] {
                let model = Model {
                    dead_zone: 0.02,
                    offset,
                    ..Model::linear(400.0, 16.0, 4e5)
                };
                let bounds = example::bounds(&model);
                let mut stop = Stop::default();
                stop.begin(Reason::WrongSign, &bounds);
                // Still swinging.
                let mut motion = Motion {
                    velocity: 100.0,
                    ..Motion::default()
                };
                for _ in 0..1500 {
                    let command = offset.abs() * stop.creeps();
                    model.advance(&mut motion, model.valve_flow(valve * command), 0.001);
                    stop.look(sensor * motion.velocity);
                }
                assert!(
                    motion.velocity.abs() < 1.0,
                    "{valve} {sensor} {offset}: {} mm/s",
                    motion.velocity
                );
            }
        }
    }

    #[test]
    fn a_creep_is_a_mean_velocity_once_the_axis_has_stopped() {
        let bounds = example::bounds(&Model::linear(400.0, 16.0, 4e5));
        for way in [1.0, -1.0] {
            let mut stop = Stop::default();
            stop.begin(Reason::WrongSign, &bounds);
            for k in 1..=bounds.stop.closing {
                assert_eq!(stop.creeps(), 0.0, "{k}");
                stop.look(100.0 * way);
                let left = libm::powf(1.0 - bounds.stop.creep, k as f32);
                let exact = 100.0 * way * (1.0 - left);
                assert!((stop.velocity - exact).abs() < 1e-2, "{k}");
            }
            assert_eq!(stop.creeps(), way);
        }
    }

    /// Samples for which it brakes an axis whose speed is `speed(k)` in sample k.
    fn braked(bounds: &Bounds, speed: impl Fn(f32) -> f32) -> u32 {
        let mut stop = Stop::default();
        stop.begin(Reason::FollowingError, bounds);
        (0..10_000)
            .find(|k| {
                stop.look(speed(*k as f32));
                !stop.brakes()
            })
            .unwrap_or(u32::MAX)
    }

    #[test]
    fn a_brake_ends_when_it_does_not_show() {
        let bounds = example::bounds(&Model::linear(400.0, 16.0, 4e5));
        let shows = bounds.end.braking as f32;
        for way in [1.0, -1.0_f32] {
            // It falls, by a third in that time, to a speed that an end may take.
            let falls = |k: f32| way * 300.0 * libm::powf(0.66, k / shows);
            assert_eq!(braked(&bounds, falls), bounds.stop.braking);
            let swings = |k: f32| falls(k) * libm::cosf(0.02 * k);
            assert_eq!(braked(&bounds, swings), bounds.stop.braking);
            let creeps = |_: f32| way * 0.9 * bounds.end_speed;
            assert_eq!(braked(&bounds, creeps), bounds.stop.braking);
            // It stays, or grows, at once or later.
            for speed in [300.0_f32, 50.0] {
                assert_eq!(braked(&bounds, |_| way * speed), bounds.end.braking);
                let grows = |k: f32| way * (speed + k);
                assert_eq!(braked(&bounds, grows), bounds.end.braking);
            }
            let comes_back = |k: f32| way * (300.0 - 1.5 * k).abs();
            let back = braked(&bounds, comes_back);
            assert!((379..383).contains(&back), "{back}");
        }
    }
}
