//! A motion that is taken over runs out.

use crate::servo::motion::{Motion, MotionLimits, Setpoint, Travel};

/// Share of the limits of motion below which a motion that runs out has ended.
const ENDED: f32 = 1e-4;

/// Lets a motion run out: `r''' = -2 rate r'' - rate^2 r'`, no plan and no roots.
#[derive(Debug, Clone, PartialEq)]
#[doc(alias = "coast")]
pub(crate) struct RunOut {
    /// Double pole in rad/s.
    pub(crate) rate: f32,
}

impl RunOut {
    /// Whether no point of the motion is outside of the travel.
    ///
    /// It ends at `x + (2 rate v + a) / rate^2`. Its velocity is `(v + w t) e^(-rate t)` with
    /// `w = a + rate v`: it reverses once, at `t = -v / w`, where that is positive, and has gone by
    /// at most `v t` until then.
    pub(crate) fn stays_within(&self, from: &Motion, travel: &Travel) -> bool {
        let (v, a) = (from.velocity, from.acceleration);
        let end = from.position + (2.0 * self.rate * v + a) / (self.rate * self.rate);
        let slower = a + self.rate * v;
        let turn = if v * slower < 0.0 {
            from.position - v * v / slower
        } else {
            from.position
        };
        travel.contains(end) && travel.contains(turn)
    }

    /// Whether acceleration and jerk of this motion stay within the limits: both are largest at its
    /// begin, but for an acceleration of at most `rate v / e` on the way.
    pub(crate) fn keeps(&self, from: &Motion, limits: &MotionLimits) -> bool {
        let (speed, acceleration) = (self.rate * from.velocity.abs(), from.acceleration.abs());
        acceleration <= limits.acceleration
            && 0.37 * speed <= limits.acceleration
            && self.rate * (2.0 * acceleration + speed) <= limits.jerk
    }

    /// One sample of `step` seconds on from `s`; whether the motion has ended. Cost: about 25
    /// instructions.
    #[inline]
    pub(crate) fn next(&self, s: &Setpoint, step: f32, limits: &MotionLimits) -> (Setpoint, bool) {
        let mut s = *s;
        s.jerk = -self.rate * (2.0 * s.acceleration + self.rate * s.velocity);
        s.position += step * (s.velocity + 0.5 * step * s.acceleration);
        s.velocity += step * (s.acceleration + 0.5 * step * s.jerk);
        s.acceleration += step * s.jerk;
        let ended = s.velocity.abs() < ENDED * limits.velocity
            && s.acceleration.abs() < ENDED * limits.acceleration;
        (if ended { Setpoint::at(s.position) } else { s }, ended)
    }

    /// The motion `2^doublings` samples of `step` seconds on; one that has ended before goes on, by
    /// less than its end cut off. Cost: about 30 instructions per doubling.
    ///
    /// What [`next`](Self::next) does is linear: velocity and acceleration are multiplied by a
    /// matrix M, the position grows by c times them. Over twice the samples they are M M and
    /// c + c M.
    pub(crate) fn after(&self, from: &Motion, step: f32, doublings: u32) -> Motion {
        let (h, r) = (step, self.rate);
        let [mut vv, mut va] = [1.0 - 0.5 * h * h * r * r, h - h * h * r];
        let [mut av, mut aa] = [-h * r * r, 1.0 - 2.0 * h * r];
        let [mut of_v, mut of_a] = [h, 0.5 * h * h];
        for _ in 0..doublings {
            [of_v, of_a] = [of_v + of_v * vv + of_a * av, of_a + of_v * va + of_a * aa];
            let (trace, mixed) = (vv + aa, va * av);
            [vv, aa] = [vv * vv + mixed, aa * aa + mixed];
            [va, av] = [va * trace, av * trace];
        }
        let (v, a) = (from.velocity, from.acceleration);
        Motion {
            position: from.position + of_v * v + of_a * a,
            velocity: vv * v + va * a,
            acceleration: av * v + aa * a,
        }
    }
}

#[cfg(test)]
mod tests;
