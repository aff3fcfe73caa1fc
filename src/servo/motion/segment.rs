//! Pieces of constant jerk.

use crate::math::sqrt;
use crate::servo::motion::{Motion, MotionLimits};

/// A piece of constant jerk.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Segment {
    pub(crate) jerk: f32,
    pub(crate) duration: f32,
}

impl Segment {
    /// Where the piece leads after `time` seconds.
    #[inline]
    pub(crate) fn at(&self, start: &Motion, time: f32) -> Motion {
        let half = 0.5 * time;
        let third = time * (1.0 / 3.0);
        let (v, a, j) = (start.velocity, start.acceleration, self.jerk);
        Motion {
            position: start.position + time * (v + half * (a + third * j)),
            velocity: v + time * (a + half * j),
            acceleration: a + time * j,
        }
    }

    /// The places within the piece at which the motion reverses, its begin where there is none.
    pub(crate) fn reversals(&self, start: &Motion) -> [f32; 2] {
        let (v, a, j) = (start.velocity, start.acceleration, self.jerk);
        let root = a * a - 2.0 * j * v;
        // Both solutions of v + a t + j t^2 / 2 = 0 without cancellation; without any, the begin.
        let q = if root < 0.0 {
            0.0
        } else {
            -a - sqrt(root).copysign(a)
        };
        [[q, j], [2.0 * v, q]].map(|[over, under]| {
            let time = if under == 0.0 { 0.0 } else { over / under };
            let within = time > 0.0 && time < self.duration;
            self.at(start, if within { time } else { 0.0 }).position
        })
    }
}

/// The same motion, seen from where it begins: distances keep their digits.
pub(crate) fn from_zero(start: &Motion) -> Motion {
    Motion {
        position: 0.0,
        ..*start
    }
}

/// From velocity `v0` and acceleration `a0` to velocity `v1` and acceleration 0, as fast as the
/// limits allow.
pub(crate) fn change(v0: f32, a0: f32, v1: f32, limits: &MotionLimits) -> [Segment; 3] {
    let j = limits.jerk;
    let settled = v0 + 0.5 * a0 * a0.abs() / j;
    let sign = if v1 >= settled { 1.0 } else { -1.0 };
    let gain = sign * (v1 - v0);
    let along = sign * a0;
    let mut peak = sqrt(j * gain + 0.5 * a0 * a0);
    let mut flat = 0.0;
    let cap = if along > limits.acceleration {
        along
    } else {
        limits.acceleration
    };
    if peak > cap {
        peak = cap;
        flat = (gain - (peak * peak - 0.5 * a0 * a0) / j) / peak;
    }
    let seconds = |t: f32| if t > 0.0 { t } else { 0.0 };
    [
        Segment {
            jerk: sign * j,
            duration: seconds((peak - along) / j),
        },
        Segment {
            jerk: 0.0,
            duration: seconds(flat),
        },
        Segment {
            jerk: -sign * j,
            duration: seconds(peak / j),
        },
    ]
}

/// How far an axis goes from a constant velocity above 0 to rest: half of it in the mean, for up to
/// the largest acceleration and back to none, and what is left of the velocity at the largest.
pub(crate) fn braking(velocity: f32, limits: &MotionLimits) -> f32 {
    let MotionLimits {
        acceleration: a,
        jerk: j,
        ..
    } = *limits;
    let time = if velocity * j < a * a {
        2.0 * sqrt(velocity / j)
    } else {
        velocity / a + a / j
    };
    0.5 * velocity * time
}

/// Where the pieces lead from `start`.
pub(crate) fn end(start: &Motion, segments: &[Segment]) -> Motion {
    let mut motion = *start;
    for segment in segments {
        motion = segment.at(&motion, segment.duration);
    }
    motion
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn braking_takes_half_the_time_for_as_long_as_the_jerk_needs() {
        let limits = MotionLimits {
            velocity: 10.0,
            acceleration: 2.0,
            jerk: 1.0,
        };
        // Below a^2 / j without a flat piece; from there on with v / a + a / j.
        for (velocity, time) in [(1.0_f32, 2.0), (2.25, 3.0), (4.0, 4.0), (6.0, 5.0)] {
            let found = braking(velocity, &limits);
            assert!(
                (found - 0.5 * velocity * time).abs() < 1e-5,
                "{velocity}: {found}"
            );
        }
    }
}
