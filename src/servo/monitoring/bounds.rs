//! Times and distances of the monitors, from the model in force.

use crate::math::sqrt;
use crate::servo::design::MonitoringDesign;
use crate::servo::design::constants::{
    BRAKE_RATIO, CLOSING_TIME_RATIO, EXPECTATION_TIME_RATIO, FLOW_SLACK, FOLLOWING_TIME_RATIO,
    FORCE_TIME_RATIO, HELD_DEFLECTIONS, LAG_TIME_RATIO, NO_MOTION_TIME_RATIO, OPPOSITE_TIME_RATIO,
    PUSH_TIME_RATIO, SATURATED_CROSSINGS, STOP_TIME_RATIO, SWING_TIME_RATIO,
};
use crate::servo::model::Model;

/// What the monitors compare with; lengths in units of y, times in samples.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Bounds {
    /// Velocity gain C.
    pub(crate) gain: f32,
    /// Natural frequency in rad/s.
    pub(crate) frequency: f32,
    pub(crate) sample_time: f32,
    /// Share of a new sample in the expected and the measured displacement.
    pub(crate) share: f32,
    /// Displacement that dead zone, offset and friction may add to the expectation or take from it.
    pub(crate) slack: f32,
    /// Drift per s that the flow makes of the motion of an axis that friction holds.
    pub(crate) drift: f32,
    /// Samples without motion, and against the command.
    pub(crate) no_motion: u32,
    pub(crate) opposite: u32,
    /// Harmless speed at an end.
    pub(crate) end_speed: f32,
    /// Samples at the full command.
    pub(crate) saturated: u32,
    pub(crate) short: ShortBounds,
    pub(crate) stuck: StuckBounds,
    pub(crate) response: ResponseBounds,
    pub(crate) following: FollowingBounds,
    pub(crate) end: EndBounds,
    pub(crate) stop: StopBounds,
}

/// Of an axis that falls short.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ShortBounds {
    /// Displacements by which a sound axis falls short, in motion and held by friction, and times
    /// in s by which the speed of a motion that it may swing after and that of a swing that is seen
    /// add to them.
    pub(crate) level: f32,
    pub(crate) held: f32,
    pub(crate) ring: f32,
    pub(crate) swing: f32,
    /// Share of a new sample in the means of the last 1/(4 w).
    pub(crate) share: f32,
    /// Samples by which commands may take effect sooner or later than in the model.
    pub(crate) late_rate: f32,
}

/// Of a code that stays.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StuckBounds {
    /// Motion that may be expected of an axis that friction holds, noise and resolution included,
    /// and the time in s by which a stop may be shorter than expected.
    pub(crate) held: f32,
    pub(crate) stopping: f32,
}

/// Of both sides of the equation of the drive.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ResponseBounds {
    /// Share of a sample in a filter of 1/w, what a damping xi lacks of 1, twice, and the share in
    /// the sums of both.
    pub(crate) share: f32,
    pub(crate) lack: f32,
    pub(crate) evidence: f32,
}

/// Of a following error.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FollowingBounds {
    /// The error that friction leaves, and the time in s in which a loop that works makes good any
    /// other.
    pub(crate) error: f32,
    pub(crate) lag: f32,
    /// Hundredths of samples of an error that stays.
    pub(crate) hundredths: u32,
}

/// Of the ends of the travel.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct EndBounds {
    /// Stopping distance per speed and per square of it.
    pub(crate) reaction: f32,
    pub(crate) half_inverse_brake: f32,
    /// Samples in which a brake must show.
    pub(crate) braking: u32,
}

/// Of a stop.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StopBounds {
    /// Samples of a controlled stop.
    pub(crate) braking: u32,
    /// Samples in which an axis behind a closed valve has lost its speed.
    pub(crate) closing: u32,
    /// Share of a sample in the mean velocity of an axis that creeps.
    pub(crate) creep: f32,
}

/// Rate of the recent means over that of the displacements, whose window is 4/w.
const RECENT_RATE: f32 = 16.0;
/// The same of the filters of both sides of the equation of the drive, and of their sums.
const RESPONSE_RATE: f32 = 4.0;
const EVIDENCE_RATE: f32 = 8.0;
/// The same of the mean velocity of an axis that creeps: of a swing little is left.
const CREEP_RATE: f32 = 1.0;

const fn least_of_one(share: f32) -> f32 {
    if share < 1.0 { share } else { 1.0 }
}

impl Bounds {
    /// Derives the bounds; a model that passed the screening has a1 and b0 above 0. Not for the 1
    /// ms path: one square root.
    pub(crate) fn new(design: &MonitoringDesign, model: &Model) -> Self {
        let w = sqrt(model.a1);
        let gain = model.b0 / model.a1;
        let samples = |seconds: f32| {
            let count = seconds / design.sample_time;
            // Saturates: beyond 2^32 samples a bound is none.
            if count > 1.0 { count as u32 } else { 1 }
        };
        let window = EXPECTATION_TIME_RATIO / w;
        let flow = FLOW_SLACK * gain;
        let deflection = model.friction / model.a1;
        let share = design.sample_time / window;
        let ring = (w - model.a2) / model.a1;
        let unknown = 2.0 * (design.grain + flow / w);
        Self {
            gain,
            frequency: w,
            sample_time: design.sample_time,
            share: least_of_one(share),
            slack: flow * window + 2.0 * deflection + design.grain,
            drift: flow,
            no_motion: samples(NO_MOTION_TIME_RATIO / w),
            opposite: samples(OPPOSITE_TIME_RATIO / w),
            end_speed: 0.5 * flow,
            saturated: samples(SATURATED_CROSSINGS * design.travel.length() / gain + 10.0 / w),
            short: ShortBounds {
                level: 2.0 * deflection + unknown,
                held: HELD_DEFLECTIONS * deflection + unknown,
                ring: if ring > 0.0 { ring } else { 0.0 },
                swing: SWING_TIME_RATIO / w,
                share: least_of_one(RECENT_RATE * share),
                late_rate: 0.5 * design.delay / design.sample_time + 1.0,
            },
            stuck: StuckBounds {
                held: HELD_DEFLECTIONS * deflection + design.grain,
                stopping: 1.0 / w,
            },
            response: ResponseBounds {
                share: least_of_one(RESPONSE_RATE * share),
                lack: 2.0 - model.a2 / w,
                evidence: least_of_one(EVIDENCE_RATE * share),
            },
            following: FollowingBounds {
                error: 2.0 * flow / w + 2.0 * deflection + design.error,
                lag: LAG_TIME_RATIO / w,
                hundredths: samples(100.0 * (FOLLOWING_TIME_RATIO + PUSH_TIME_RATIO) / w),
            },
            end: EndBounds {
                reaction: design.delay + FORCE_TIME_RATIO / w,
                half_inverse_brake: BRAKE_RATIO / (gain * w),
                braking: samples(design.delay + 1.0 / w),
            },
            stop: StopBounds {
                braking: samples(STOP_TIME_RATIO / w),
                closing: samples(design.delay + CLOSING_TIME_RATIO / w),
                creep: least_of_one(CREEP_RATE * share),
            },
        }
    }
}

#[cfg(test)]
pub(crate) mod example {
    use super::*;
    use crate::servo::Config;
    use crate::servo::motion::Travel;

    /// Bounds of a model on an axis of 400 units, at 1 ms.
    pub(crate) fn bounds(model: &Model) -> Bounds {
        let travel = Travel {
            min: 0.0,
            max: 400.0,
        };
        let Ok(design) = Config::new(0.001, 20.0, travel).resolve() else {
            panic!("a setting is refused");
        };
        Bounds::new(&design.monitoring, model)
    }
}
