//! Why an axis moves against its commands: the valve closes, which is the safe answer and the test
//! at once.

use crate::math::sign;
use crate::servo::monitoring::bounds::Bounds;
use crate::servo::monitoring::response::Response;
use crate::servo::supervision::state::Reason;

/// The motion of an axis whose valve closes.
///
/// With the wrong sign of valve or sensor the axis obeys its valve, only the other way: behind a
/// closed valve it is a spring, whose speed is gone after a quarter of its period, or a little
/// later when its force still grows, and comes back with the other sign. A spool that is stuck, or
/// a load that falls without air, goes on as before. The speed decides, half a period, 3/w, and the
/// delay after the command to close the valve: more than half of the largest one since then is no
/// stop.
///
/// What is slower by then may be the swing of a drive about the speed that an open spool gives it.
/// In the other half of the period a spring comes back and a drive with much damping stands; over
/// both the mean of a swing is that speed. Where both, the mean of the second half and that of the
/// whole, are above a fifth of the largest speed, the axis went on.
///
/// What stops within that time may have met an end of the travel, or friction. Then the
/// [`Response`] decides, by what it has shown when the valve was still open, and, with half of that
/// weight, until now.
///
/// The valve is closed all that time, which is the best that any answer can do; only the reason
/// waits. Cost: about 10 instructions, 40 in the last sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Closing {
    /// Samples that are left, and in each half; direction at the begin, and largest speed since
    /// then.
    left: u32,
    half: u32,
    way: f32,
    peak: f32,
    /// Sums of the velocity along that direction, of the whole and of its first half.
    moved: f32,
    first: f32,
    /// [`Response::mirrored`] at the begin.
    mirrored: f32,
    /// Whether the axis has met an end of the travel since then.
    met: bool,
}

/// Share of the largest speed above which the axis goes on.
const GOES_ON: f32 = 0.5;
/// The same of the mean speeds of the second half and of the whole.
const WENT_ON: f32 = 0.2;
/// Weight of what is shown behind the closed valve.
const CLOSED: f32 = 0.5;
/// Weight of a sample in the sums of the response: these twelve times 1/(2 w) weigh three times
/// what they knew before.
const CLOSED_WEIGHT: f32 = 0.25;

impl Closing {
    /// Whether the valve is being closed.
    pub(crate) const fn is_active(&self) -> bool {
        self.left > 0
    }

    /// The valve closes while the axis moves so fast.
    pub(crate) fn begin(&mut self, velocity: f32, response: &Response, bounds: &Bounds) {
        self.half = bounds.stop.closing;
        self.left = self.half.saturating_mul(2);
        self.way = sign(velocity);
        self.peak = velocity.abs();
        self.moved = 0.0;
        self.mirrored = response.mirrored();
        self.met = false;
    }

    /// Weight of a sample in the sums of the response, 1 before the valve closes; what the axis
    /// shows after it has met an end of the travel is not its drive.
    #[inline]
    pub(crate) fn weight(&mut self, at_end: bool) -> f32 {
        if !self.is_active() {
            return 1.0;
        }
        self.met |= at_end;
        if self.met { 0.0 } else { CLOSED_WEIGHT }
    }

    /// One sample; the reason in the last one.
    #[inline]
    pub(crate) fn update(&mut self, velocity: f32, response: &Response) -> Option<Reason> {
        self.left = self.left.saturating_sub(1);
        let along = self.way * velocity;
        if along > self.peak {
            self.peak = along;
        }
        self.moved += along;
        if self.left >= self.half {
            self.first = self.moved;
            let goes_on = self.left == self.half && along > GOES_ON * self.peak;
            return goes_on.then_some(Reason::ValveStuck);
        }
        if self.left > 0 {
            return None;
        }
        let least = WENT_ON * self.half as f32 * self.peak;
        let went_on = self.moved - self.first > least && self.moved > 2.0 * least;
        Some(if went_on && !self.met {
            Reason::ValveStuck
        } else if response.is_faint() {
            Reason::Blocked
        } else if self.mirrored + CLOSED * response.mirrored() > 0.0 {
            Reason::WrongSign
        } else {
            Reason::ValveStuck
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::model::Model;
    use crate::servo::monitoring::bounds::example;
    use crate::servo::motion::Motion;

    /// What is found of a drive in motion behind a valve that opens by `sign` times its command,
    /// or, with a `stuck` spool, stays as it was. The command grows the other way, as that of a
    /// loop whose axis runs away, for 2/w, and ends when the valve closes.
    fn found(w: f32, damping: f32, sign: f32, stuck: Option<f32>) -> Option<Reason> {
        let model = Model::linear(w * w, damping * w, w * w * 1000.0);
        let bounds = example::bounds(&model);
        let (mut motion, mut response) = (Motion::default(), Response::default());
        let mut closing = Closing::default();
        let (begin, last) = ((20_000.0 / w) as usize, (22_000.0 / w) as usize);
        for k in 0..10_000 {
            let before = stuck.unwrap_or(0.0);
            let u = if k < begin {
                before
            } else if k < last {
                before + (k - begin) as f32 / (last - begin) as f32
            } else {
                0.0
            };
            let flow = stuck.unwrap_or(sign * u);
            model.advance(&mut motion, flow, 0.001);
            let weight = closing.weight(false);
            response.update(u, motion.velocity, weight, &bounds);
            if k == last {
                closing.begin(motion.velocity, &response, &bounds);
            } else if k > last
                && let Some(reason) = closing.update(motion.velocity, &response)
            {
                return Some(reason);
            }
        }
        None
    }

    #[test]
    fn a_wrong_sign_a_stuck_spool_and_a_closed_valve_are_told_apart() {
        for w in [8.0_f32, 20.0, 80.0] {
            for damping in [0.1, 0.7, 2.0] {
                for gain in [0.5, 1.0, 1.3] {
                    assert_eq!(
                        found(w, damping, -gain, None),
                        Some(Reason::WrongSign),
                        "w {w} damping {damping} gain {gain}"
                    );
                }
                for stuck in [-0.8, -0.3, -0.2] {
                    assert_eq!(
                        found(w, damping, 1.0, Some(stuck)),
                        Some(Reason::ValveStuck),
                        "w {w} damping {damping} stuck at {stuck}"
                    );
                }
                assert_eq!(found(w, damping, 0.0, None), Some(Reason::Blocked));
            }
        }
    }

    /// The reason of velocities behind the closed valve, over w t, of a drive that has shown `gain`
    /// times the velocity of a command that grew.
    fn reason(velocity: impl Fn(f32) -> f32, gain: f32, at_end: bool) -> Option<Reason> {
        let bounds = example::bounds(&Model::linear(400.0, 20.0, 4e5));
        let mut response = Response::default();
        for k in 0..500 {
            let flow = k as f32 * 0.002;
            response.update(flow, gain * bounds.gain * flow, 1.0, &bounds);
        }
        let mut closing = Closing::default();
        closing.begin(velocity(0.0), &response, &bounds);
        (1..2000).find_map(|k| {
            let _ = closing.weight(at_end);
            closing.update(velocity(k as f32 * 0.001 * bounds.frequency), &response)
        })
    }

    #[test]
    fn a_swing_about_a_speed_is_that_of_an_open_spool_and_one_about_none_a_spring() {
        // Natural frequency over that of the model, the speed, what is shown, what is found.
        for (frequency, mean, gain, expected) in [
            (0.8, 60.0, -0.8, Reason::ValveStuck),
            (1.0, 30.0, -0.8, Reason::ValveStuck),
            (1.25, 30.0, -0.8, Reason::ValveStuck),
            (0.8, 0.0, -0.8, Reason::WrongSign),
            (1.0, 0.0, -0.8, Reason::WrongSign),
            (1.25, 0.0, -0.8, Reason::WrongSign),
            (1.0, 0.0, 0.0, Reason::Blocked),
        ] {
            for damping in [0.1_f32, 0.3, 0.6] {
                let wave = |t: f32| libm::expf(-damping * t) * libm::cosf(t);
                let velocity = |t: f32| mean + (100.0 - mean) * wave(frequency * t);
                let found = reason(velocity, gain, false);
                assert_eq!(found, Some(expected), "{damping} {frequency} {mean}");
            }
        }
        // The speed at half a period is over the largest one, which may come later; means of both
        // halves and of the second one decide behind it.
        let steps = |[first, early, half, late]: [f32; 4]| {
            move |t: f32| match t {
                ..0.2 => first,
                ..2.9 => early,
                ..3.4 => half,
                _ => late,
            }
        };
        for (speeds, expected) in [
            ([50.0, 100.0, 40.0, 0.0], Reason::WrongSign),
            ([100.0, 50.0, 60.0, 0.0], Reason::ValveStuck),
            ([100.0, 30.0, 30.0, 30.0], Reason::ValveStuck),
            ([100.0, 0.0, 0.0, 30.0], Reason::WrongSign),
            ([100.0, 60.0, 0.0, 0.0], Reason::WrongSign),
        ] {
            assert_eq!(
                reason(steps(speeds), -0.8, false),
                Some(expected),
                "{speeds:?}"
            );
        }
        // A rebound at an end of the travel is no speed that a valve gives.
        let rebound = |t: f32| if (0.5..4.0).contains(&t) { 0.0 } else { 100.0 };
        for (at_end, found) in [(false, Reason::ValveStuck), (true, Reason::WrongSign)] {
            assert_eq!(reason(rebound, -0.8, at_end), Some(found), "{at_end}");
        }
    }

    #[test]
    fn what_an_end_of_the_travel_makes_of_the_motion_does_not_count() {
        let bounds = example::bounds(&Model::linear(400.0, 20.0, 4e5));
        let mut closing = Closing::default();
        assert_eq!(closing.weight(true), 1.0, "before");
        closing.begin(100.0, &Response::default(), &bounds);
        assert_eq!(closing.weight(false), CLOSED_WEIGHT);
        assert_eq!(closing.weight(true), 0.0);
        assert_eq!(closing.weight(false), 0.0, "and after it");
    }
}
