//! A prediction of the fit with its sensitivities, a point at a time.

use crate::math::sign;
use crate::servo::commissioning::predictor::{PARAMETERS, Point, Prediction, Theta};
use crate::servo::control::load::balanced;
use crate::servo::control::place::{off_middle, stiffness};

/// Position, velocity and drive after an interval under a constant unit of acceleration, and of
/// rate of the drive: Taylor series to the fourth derivative.
#[derive(Debug, Clone, Copy)]
struct Transition {
    /// Of the unit of acceleration, of the unit of rate.
    acceleration: [f32; 3],
    rate: [f32; 3],
    /// Of a unit of velocity and of drive, beside themselves.
    velocity: [f32; 3],
    drive: [f32; 3],
}

impl Transition {
    /// Over `time`, with a loss of flow `k`. Cost: about 70 instructions.
    #[inline]
    fn new(theta: &Theta, k: f32, time: f32) -> Self {
        let step = |v: f32, p: f32| (p - theta.a2 * v, -theta.a1 * v - k * p);
        let (h2, h3, h4) = (0.5 * time, time * (1.0 / 3.0), 0.25 * time);
        let series = |v1: f32, p1: f32| {
            let (v2, p2) = step(v1, p1);
            let (v3, p3) = step(v2, p2);
            let (v4, p4) = step(v3, p3);
            [
                time * h2 * (v1 + h3 * (v2 + h4 * v3)),
                time * (v1 + h2 * (v2 + h3 * (v3 + h4 * v4))),
                time * (p1 + h2 * (p2 + h3 * (p3 + h4 * p4))),
            ]
        };
        let acceleration = series(1.0, 0.0);
        let rate = series(0.0, 1.0);
        let both = |a: f32, r: f32| {
            let [x, v, p] = acceleration;
            let [x_r, v_r, p_r] = rate;
            [a * x + r * x_r, a * v + r * v_r, a * p + r * p_r]
        };
        let [x, v, p] = both(-theta.a2, -theta.a1);
        Self {
            acceleration,
            rate,
            velocity: [time + x, v, p],
            drive: both(1.0, -k),
        }
    }

    /// One interval on, under an acceleration and a rate of the drive.
    #[inline(always)]
    fn advance(&self, at: &mut Prediction, [acceleration, rate]: [f32; 2]) {
        let Prediction { x, v, p } = *at;
        let ([vx, vv, vp], [px, pv, pp]) = (self.velocity, self.drive);
        let acted = |k: usize| self.acceleration[k] * acceleration + self.rate[k] * rate;
        *at = Prediction {
            x: x + vx * v + px * p + acted(0),
            v: v + vv * v + pv * p + acted(1),
            p: p + vp * v + pp * p + acted(2),
        };
    }

    /// One interval on from a state that is corrected by its position with these gains, without
    /// anything that acts on it.
    #[inline]
    fn corrected(&self, [x, v, p]: [f32; 3]) -> Step {
        let ([vx, vv, vp], [px, pv, pp]) = (self.velocity, self.drive);
        let (vv, pp) = (1.0 + vv, 1.0 + pp);
        Step {
            position: [
                1.0 - x - vx * v - px * p,
                -vv * v - pv * p,
                -vp * v - pp * p,
            ],
            velocity: [vx, vv, vp],
            drive: [px, pv, pp],
        }
    }
}

/// What position, velocity and drive of a unit become.
#[derive(Debug, Clone, Copy)]
struct Step {
    position: [f32; 3],
    velocity: [f32; 3],
    drive: [f32; 3],
}

impl Step {
    /// One interval on, under an action of this size.
    #[inline(always)]
    fn advance(&self, at: &mut Prediction, action: &[f32; 3], size: f32) {
        let Prediction { x, v, p } = *at;
        let on = |k: usize| {
            self.position[k] * x + self.velocity[k] * v + self.drive[k] * p + action[k] * size
        };
        *at = Prediction {
            x: on(0),
            v: on(1),
            p: on(2),
        };
    }
}

/// What acts on the sensitivities in an interval.
#[derive(Debug, Clone, Copy)]
struct Acts {
    /// The parameters at the place.
    theta: Theta,
    /// Size of the flow, and what arrives of it.
    size: f32,
    arrives: f32,
    /// Direction of the flow.
    side: f32,
    /// What dead zone, offset and delay do to the flow.
    bent: [f32; 3],
    /// Mean velocity and drive.
    v: f32,
    p: f32,
    /// Stiffness over that of the middle, and its slope by the stiffening.
    stiffer: [f32; 2],
}

/// A prediction and how it changes with each parameter.
///
/// The sensitivities obey the equation of the prediction, linearised: they share its transition
/// over an interval, and differ by what acts on them. What follows the state acts with its mean
/// over the interval.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sensitivity {
    theta: Theta,
    at: Prediction,
    slopes: [Prediction; PARAMETERS],
}

impl Sensitivity {
    #[inline(always)]
    pub(crate) fn new() -> Self {
        Self {
            theta: Theta::from_array([1.0; PARAMETERS]),
            at: Prediction::default(),
            slopes: [Prediction::default(); PARAMETERS],
        }
    }

    /// Begins at a point.
    pub(crate) fn begin(&mut self, theta: Theta, first: &Point) {
        self.theta = theta;
        self.at = Prediction {
            x: first.y,
            v: first.velocity,
            p: theta.a2 * first.velocity + theta.friction * first.direction,
        };
        self.slopes = [Prediction::default(); PARAMETERS];
        let [_, a2, _, _, _, friction, ..] = &mut self.slopes;
        a2.p = first.velocity;
        friction.p = first.direction;
    }

    /// A point as the prediction sees it.
    #[inline]
    pub(crate) fn seen(&self, point: Point) -> Point {
        point.under(self.at.p, self.theta.friction)
    }

    /// The parameters.
    pub(crate) const fn theta(&self) -> &Theta {
        &self.theta
    }

    /// Error of the predicted position, and how the prediction changes with each parameter.
    #[inline]
    pub(crate) fn error(&self, point: &Point) -> (f32, [f32; PARAMETERS]) {
        let mut slope = [0.0; PARAMETERS];
        for (slope, at) in slope.iter_mut().zip(&self.slopes) {
            *slope = at.x;
        }
        (point.y - self.at.x, slope)
    }

    /// Corrects the prediction and moves it one interval on, under these commands: the newer one,
    /// the older one and its share. At rest the position is known. Cost: about 400 instructions.
    #[inline]
    pub(crate) fn advance(
        &mut self,
        point: &Point,
        gains: [f32; 3],
        [newer, older, part]: [f32; 3],
        inverse: f32,
    ) {
        let k = stiffness(self.theta.stiffening, point.y);
        let theta = self.theta.stiffer(k);
        let mean = |newer: f32, older: f32| newer + part * (older - newer);
        let (newer, older) = (theta.flow(newer), theta.flow(older));
        let (n, o) = (sign(newer), sign(older));
        let flow = mean(newer, older);
        let bent = [-mean(n, o), mean(n * n, o * o), (older - newer) * inverse];
        let side = sign(flow);
        let size = side * flow;
        let arrives = balanced(flow, theta.imbalance);
        let (loss, rate) = (theta.kappa * size, theta.b0 * arrives);
        let mut acts = Acts {
            theta,
            size,
            arrives,
            side,
            bent,
            v: 0.0,
            p: self.at.p,
            stiffer: [k, k * k * off_middle(point.y)],
        };
        if point.rests {
            self.at.x = point.y;
            self.at.p += point.time * (rate - loss * self.at.p);
            self.at.v = 0.0;
            self.follow_at_rest(&acts, loss, point.time);
        } else {
            self.at.correct(gains, point.y - self.at.x);
            let before = self.at;
            let transition = Transition::new(&theta, loss, point.time);
            let friction = -theta.friction * point.direction;
            transition.advance(&mut self.at, [friction, rate]);
            acts.v = 0.5 * (before.v + self.at.v);
            acts.p = 0.5 * (before.p + self.at.p);
            self.follow(&acts, &transition, gains, point.direction);
        }
    }

    /// Rates of the drive by which the parameters act on it: all but damping and friction.
    #[inline]
    fn rates(&self, acts: &Acts) -> [f32; 8] {
        let Acts {
            theta,
            size,
            arrives,
            side,
            bent: [dead_zone, offset, delay],
            v,
            p,
            stiffer: [k, slope],
        } = acts;
        let gain = theta.b0 - side * (theta.b0 * theta.imbalance + theta.kappa * p);
        let lost = size * p;
        [
            -v * k,
            arrives * k,
            gain * dead_zone,
            gain * offset,
            gain * delay,
            -lost * k,
            (self.theta.b0 * arrives - self.theta.a1 * v - self.theta.kappa * lost) * slope,
            -theta.b0 * size,
        ]
    }

    #[inline]
    fn follow(&mut self, acts: &Acts, on: &Transition, gains: [f32; 3], direction: f32) {
        let rates = self.rates(acts);
        let (damping, friction) = (-acts.v, -direction);
        let step = on.corrected(gains);
        for (slope, rate) in driven(&mut self.slopes).into_iter().zip(rates) {
            step.advance(slope, &on.rate, rate);
        }
        let [_, a2, _, _, _, own_friction, ..] = &mut self.slopes;
        step.advance(a2, &on.acceleration, damping);
        step.advance(own_friction, &on.acceleration, friction);
    }

    #[inline]
    fn follow_at_rest(&mut self, acts: &Acts, loss: f32, time: f32) {
        let rates = self.rates(acts);
        for slope in &mut self.slopes {
            *slope = Prediction {
                p: slope.p - time * loss * slope.p,
                ..Prediction::default()
            };
        }
        for (slope, rate) in driven(&mut self.slopes).into_iter().zip(rates) {
            slope.p += time * rate;
        }
    }
}

/// The sensitivities on whose drive their parameters act, in the order of [`Sensitivity::rates`].
#[inline]
const fn driven(slopes: &mut [Prediction; PARAMETERS]) -> [&mut Prediction; 8] {
    let [a1, _, b0, dead_zone, offset, _, others @ ..] = slopes;
    let [delay, kappa, stiffening, imbalance] = others;
    [
        a1, b0, dead_zone, offset, delay, kappa, stiffening, imbalance,
    ]
}

#[cfg(test)]
mod tests;
