//! The model of the fit: a drive of third order behind a delayed valve, corrected by the record as
//! it goes.

use crate::servo::commissioning::record::MotionRecord;
use crate::servo::commissioning::view::View;
use crate::servo::control::load::balanced;

/// Number of parameters.
pub(crate) const PARAMETERS: usize = 10;

/// The parameters in the order of the fit; positions are in travels.
///
/// ```text
/// v' = p - a2 v - F s   p' = k(x) (b0 (f - lambda |f|) - a1 v - kappa |f| p)   f = q(u(t - tau) + offset)
/// ```
///
/// s is the direction of the measured motion; kappa is the loss of flow under load of an open
/// valve. A drive with a rod, or under a constant load, is quicker one way than the other, by the
/// imbalance lambda: without it that would count as an offset of the valve. a1, b0 and kappa are
/// those of the middle of the travel: at a place all three are k(x) times as large, see
/// [`Place`](crate::servo::control::place::Place).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Theta {
    pub(crate) a1: f32,
    pub(crate) a2: f32,
    pub(crate) b0: f32,
    pub(crate) dead_zone: f32,
    pub(crate) offset: f32,
    pub(crate) friction: f32,
    pub(crate) delay: f32,
    pub(crate) kappa: f32,
    /// How fast the stiffness grows towards the ends: e of k(x).
    pub(crate) stiffening: f32,
    /// lambda: share of the flow that is missing upwards and that there is more of downwards.
    pub(crate) imbalance: f32,
}

/// Position, velocity, drive.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Prediction {
    pub(crate) x: f32,
    pub(crate) v: f32,
    pub(crate) p: f32,
}

impl Prediction {
    /// Corrects it by the error of its position.
    #[inline]
    pub(crate) fn correct(&mut self, [x, v, p]: [f32; 3], error: f32) {
        self.x += x * error;
        self.v += v * error;
        self.p += p * error;
    }
}

/// What a point of the record shows beside position and command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point {
    /// Spacing of the points in s.
    pub(crate) time: f32,
    /// Position.
    pub(crate) y: f32,
    /// Mean velocity about the interval that it begins.
    pub(crate) velocity: f32,
    /// Mean direction of the motion, -1 to 1; 0 where it is too slow to tell.
    pub(crate) direction: f32,
    /// Whether it is at rest.
    pub(crate) rests: bool,
}

/// Drive over friction that nothing holds: a breakaway of 2.5 times the Coulomb friction, of which
/// a fit that has just begun may have found an eighth.
const HELD_MOST: f32 = 20.0;

impl Point {
    /// Point `i` of a record, and the motion of the interval that it begins; [`View::beyond`] more
    /// points follow.
    ///
    /// Where the velocity turns within the interval, the direction is the mean of the signs: of a
    /// velocity that goes from v to w in a straight line, `(v + w) / (|v| + |w|)`.
    #[inline]
    pub(crate) fn of(record: &MotionRecord, i: usize, view: &View) -> Self {
        let reach = view.reach;
        let moved = |i: usize| record.y(i + reach) - record.y(i.saturating_sub(reach));
        let (before, after) = (moved(i), moved(i + 1));
        let sum = before + after;
        let rests = before.abs() <= view.rest && after.abs() <= view.rest;
        Self {
            time: view.time,
            y: record.y(i),
            velocity: view.per_movement * sum,
            direction: if rests {
                0.0
            } else {
                sum / (before.abs() + after.abs())
            },
            rests,
        }
    }

    /// The point under a drive: what friction cannot hold moves, however slowly.
    ///
    /// A drive without friction that counted as resting would lose what its slow motion shows.
    #[inline]
    pub(crate) fn under(self, drive: f32, friction: f32) -> Self {
        Self {
            rests: self.rests && drive.abs() <= HELD_MOST * friction,
            ..self
        }
    }
}

impl Theta {
    pub(crate) fn to_array(self) -> [f32; PARAMETERS] {
        let Self {
            a1,
            a2,
            b0,
            dead_zone,
            offset,
            friction,
            delay,
            kappa,
            stiffening,
            imbalance,
        } = self;
        [
            a1, a2, b0, dead_zone, offset, friction, delay, kappa, stiffening, imbalance,
        ]
    }

    pub(crate) fn from_array(theta: [f32; PARAMETERS]) -> Self {
        let [
            a1,
            a2,
            b0,
            dead_zone,
            offset,
            friction,
            delay,
            kappa,
            stiffening,
            imbalance,
        ] = theta;
        Self {
            a1,
            a2,
            b0,
            dead_zone,
            offset,
            friction,
            delay,
            kappa,
            stiffening,
            imbalance,
        }
    }

    /// The parameters where the stiffness is `k` times that of the middle.
    #[inline]
    pub(crate) fn stiffer(&self, k: f32) -> Self {
        Self {
            a1: k * self.a1,
            b0: k * self.b0,
            kappa: k * self.kappa,
            ..*self
        }
    }

    /// Flow of a command.
    #[inline]
    pub(crate) fn flow(&self, command: f32) -> f32 {
        let (d, opening) = (self.dead_zone, command + self.offset);
        if opening > d {
            opening - d
        } else if opening < -d {
            opening + d
        } else {
            0.0
        }
    }

    /// The commands of the interval that begins at point `i`, the newer and the older one, and the
    /// share of the older one: the delay in parts of the spacing.
    #[inline]
    pub(crate) fn commands_at(
        &self,
        record: &MotionRecord,
        sign: f32,
        i: usize,
        inverse_time: f32,
    ) -> [f32; 3] {
        let back = self.delay * inverse_time;
        let whole = back as usize;
        let part = back - whole as f32;
        [
            sign * record.u(i, whole),
            sign * record.u(i, whole + 1),
            part,
        ]
    }

    /// Mean flow of the commands of an interval.
    #[inline]
    pub(crate) fn mean_flow(&self, [newer, older, part]: [f32; 3]) -> f32 {
        let (newer, older) = (self.flow(newer), self.flow(older));
        newer + part * (older - newer)
    }

    /// Mean flow of the interval that begins at point `i`.
    #[inline]
    pub(crate) fn flow_at(
        &self,
        record: &MotionRecord,
        sign: f32,
        i: usize,
        inverse_time: f32,
    ) -> f32 {
        self.mean_flow(self.commands_at(record, sign, i, inverse_time))
    }

    /// Moves a prediction on by the spacing of the points. Cost: about 60 instructions.
    #[inline]
    pub(crate) fn advance(&self, at: &mut Prediction, flow: f32, point: &Point) {
        if point.rests {
            self.rest(at, flow, point.time);
        } else {
            self.slide(at, flow, point.direction, point.time);
        }
    }

    /// Rate of the drive under a flow, and what it loses of itself.
    #[inline]
    fn driven(&self, flow: f32) -> [f32; 2] {
        let size = if flow < 0.0 { -flow } else { flow };
        [self.b0 * balanced(flow, self.imbalance), self.kappa * size]
    }

    /// The same at rest, where only the drive changes.
    #[inline]
    pub(crate) fn rest(&self, at: &mut Prediction, flow: f32, time: f32) {
        let [rate, k] = self.driven(flow);
        at.p += time * (rate - k * at.p);
        at.v = 0.0;
    }

    /// The same in motion.
    #[inline]
    pub(crate) fn slide(&self, at: &mut Prediction, flow: f32, direction: f32, time: f32) {
        let [rate, k] = self.driven(flow);
        let step = |v: f32, p: f32| (p - self.a2 * v, -self.a1 * v - k * p);
        let (dv, dp) = step(at.v, at.p);
        let (v1, p1) = (dv - self.friction * direction, dp + rate);
        let (v2, p2) = step(v1, p1);
        let (v3, p3) = step(v2, p2);
        let (v4, p4) = step(v3, p3);
        let (h2, h3, h4) = (0.5 * time, time * (1.0 / 3.0), 0.25 * time);
        at.x += time * (at.v + h2 * (v1 + h3 * (v2 + h4 * v3)));
        at.v += time * (v1 + h2 * (v2 + h3 * (v3 + h4 * v4)));
        at.p += time * (p1 + h2 * (p2 + h3 * (p3 + h4 * p4)));
    }

    /// Gains, per point, of a correction with three poles at `-rate`.
    pub(crate) fn gains(&self, rate: f32, time: f32) -> [f32; 3] {
        let l1 = 3.0 * rate - self.a2;
        let l2 = 3.0 * rate * rate - self.a2 * l1 - self.a1;
        let l3 = rate * rate * rate - self.a2 * l2 - self.a1 * l1;
        [time * l1, time * l2, time * (l3 + self.a2 * l2)]
    }
}

#[cfg(test)]
mod tests;
