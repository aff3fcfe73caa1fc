//! A least-squares fit of the model to the record, a few points per sample.

use crate::math::matrix::{Matrix, backward, cholesky, forward};
use crate::math::sqrt;
use crate::servo::commissioning::predictor::{
    PARAMETERS, Point, Prediction, REACH, Theta, bounded, scales,
};
use crate::servo::commissioning::record::Record;
use crate::servo::commissioning::view::{STEP_MAX, View};

/// Difference of a parameter, in its scale, from which sensitivities are taken.
const DIFFERENCE: f32 = 0.02;
/// Cost over the one before from which a pass has gained next to nothing.
const CONVERGED: f32 = 0.97;
/// Points after a start in which the direction of the motion is uncertain.
const STARTING: u32 = 3;

/// Levenberg-Marquardt on the errors of a prediction that is corrected with a fixed rate.
///
/// The prediction sees about 1/rate ahead: less is blind to friction and delay, more loses the axis where it sticks.
/// Sensitivities are differences. Each pass over the points gives the cost and the next step.
///
/// Known as: prediction-error method (Ljung 1999), Levenberg-Marquardt (Marquardt 1963).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fit {
    view: View,
    rate: f32,
    gains: [f32; 3],
    /// Best parameters with their cost and normal equations.
    best: Theta,
    best_sums: Sums,
    damping: f32,
    /// Parameters of this pass and those beside them.
    tried: [Theta; PARAMETERS + 1],
    scale: [f32; PARAMETERS],
    at: [Prediction; PARAMETERS + 1],
    next: usize,
    /// First point that counts.
    settled: usize,
    moving: u32,
    sums: Sums,
    passes: u32,
    converged: bool,
}

/// Sums over a pass.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Sums {
    normal: Matrix<PARAMETERS>,
    gradient: [f32; PARAMETERS],
    cost: f32,
    /// Sum of products of neighbouring errors, and the last error.
    lagged: f32,
    last: f32,
    count: f32,
}

const NO_SUMS: Sums = Sums {
    normal: [[0.0; PARAMETERS]; PARAMETERS],
    gradient: [0.0; PARAMETERS],
    cost: 0.0,
    lagged: 0.0,
    last: 0.0,
    count: 0.0,
};

/// Standard deviations, in scales, with which the parameters are known beforehand: weak, so that nothing runs away.
const PRIOR: [f32; PARAMETERS] = [5.0, 3.0, 5.0, 2.0, 2.0, 3.0, 5.0, 0.2];
/// Largest correlation of neighbouring errors that counts.
const CORRELATION_MAX: f32 = 0.8;

impl Fit {
    pub(crate) fn new() -> Self {
        let theta = Theta::from_array([1.0; PARAMETERS]);
        Self {
            view: View::EMPTY,
            rate: 1.0,
            gains: [0.0; 3],
            best: theta,
            best_sums: NO_SUMS,
            damping: 0.0,
            tried: [theta; PARAMETERS + 1],
            scale: [1.0; PARAMETERS],
            at: [Prediction::default(); PARAMETERS + 1],
            next: 0,
            settled: 0,
            moving: 0,
            sums: NO_SUMS,
            passes: 0,
            converged: false,
        }
    }

    /// Begins at `theta`, with a correction of `ratio` times its natural frequency.
    pub(crate) fn begin(&mut self, record: &Record, view: View, theta: Theta, ratio: f32) {
        let rate = ratio * sqrt(theta.a1);
        self.view = view;
        self.rate = if rate * view.time < STEP_MAX {
            rate
        } else {
            STEP_MAX / view.time
        };
        self.best = theta;
        self.best_sums.cost = f32::INFINITY;
        self.damping = 1e-2;
        self.passes = 0;
        self.converged = false;
        self.open(record, theta);
    }

    /// Begins a pass. Cost: some 1500 instructions.
    fn open(&mut self, record: &Record, theta: Theta) {
        self.scale = scales(&theta);
        self.gains = theta.gains(self.rate, self.view.time);
        let base = theta.to_array();
        for (j, tried) in self.tried.iter_mut().enumerate() {
            let mut other = base;
            if j > 0 {
                other[j - 1] += DIFFERENCE * self.scale[j - 1];
            }
            *tried = Theta::from_array(other);
        }
        let first = self.point(record, self.view.begin);
        for (at, theta) in self.at.iter_mut().zip(&self.tried) {
            *at = Prediction {
                x: first.y,
                v: first.velocity,
                p: theta.a2 * first.velocity + theta.friction * first.direction,
            };
        }
        self.next = self.view.begin;
        self.settled = self.view.begin + (2.0 / (self.rate * self.view.time)) as usize;
        self.moving = 0;
        self.sums = NO_SUMS;
    }

    fn point(&self, record: &Record, i: usize) -> Point {
        Point::of(record, i, self.view.time, self.view.rest_velocity)
    }

    /// Takes `points` more; whether the pass is over. Cost: some 1000 instructions per point.
    pub(crate) fn advance(&mut self, record: &Record, points: usize) -> bool {
        let inverse = 1.0 / self.view.time;
        for _ in 0..points {
            let i = self.next;
            // A pass that is worse already need not be finished.
            let worse = self.sums.cost > self.best_sums.cost;
            if i + REACH >= self.view.end || worse {
                return true;
            }
            let point = self.point(record, i);
            self.moving = if point.direction == 0.0 {
                0
            } else {
                self.moving.saturating_add(1)
            };
            let counts = i >= self.settled && self.moving > STARTING;
            self.correct(&point, counts);
            let time = point.time;
            // Decided once for all predictions.
            if point.direction == 0.0 {
                self.predict(record, i, inverse, |theta, at, flow| {
                    theta.rest(at, flow, time);
                });
            } else {
                self.predict(record, i, inverse, |theta, at, flow| {
                    theta.slide(at, flow, point.direction, time);
                });
            }
            self.next += 1;
        }
        false
    }

    /// Moves all predictions on by a point.
    #[inline]
    fn predict(
        &mut self,
        record: &Record,
        i: usize,
        inverse: f32,
        advance: impl Fn(&Theta, &mut Prediction, f32),
    ) {
        let [own, a1, a2, b0, dead_zone, offset, friction, delay, kappa] = &self.tried;
        let [
            at,
            at_a1,
            at_a2,
            at_b0,
            at_dead_zone,
            at_offset,
            at_friction,
            at_delay,
            at_kappa,
        ] = &mut self.at;
        // All but one have the same delay: its commands are looked up once; and all but three have the same flow.
        let commands = own.commands_at(record, self.view.sign, i, inverse);
        let flow = own.mean_flow(commands);
        for (theta, at) in [
            (own, at),
            (a1, at_a1),
            (a2, at_a2),
            (b0, at_b0),
            (friction, at_friction),
            (kappa, at_kappa),
        ] {
            advance(theta, at, flow);
        }
        for (theta, at) in [(dead_zone, at_dead_zone), (offset, at_offset)] {
            advance(theta, at, theta.mean_flow(commands));
        }
        let flow = delay.flow_at(record, self.view.sign, i, inverse);
        advance(delay, at_delay, flow);
    }

    fn correct(&mut self, point: &Point, counts: bool) {
        if counts {
            let [base, others @ ..] = &self.at;
            let error = point.y - base.x;
            let mut slope = [0.0; PARAMETERS];
            for (slope, other) in slope.iter_mut().zip(others) {
                *slope = (other.x - base.x) * (1.0 / DIFFERENCE);
            }
            self.sums.add(&slope, error);
        }
        for at in &mut self.at {
            let error = point.y - at.x;
            if point.direction == 0.0 {
                at.x = point.y;
                continue;
            }
            at.x += self.gains[0] * error;
            at.v += self.gains[1] * error;
            at.p += self.gains[2] * error;
        }
    }

    /// Ends a pass: takes its parameters if they are better, and begins the next one. Cost: some 3000 instructions.
    pub(crate) fn next_pass(&mut self, record: &Record) {
        self.passes += 1;
        // Written so that NaN is worse.
        if self.sums.cost < self.best_sums.cost {
            self.converged = self.sums.cost > CONVERGED * self.best_sums.cost;
            self.best = self.tried[0];
            self.best_sums = self.sums;
            self.damping *= 0.2;
        } else {
            self.damping *= 10.0;
        }
        let theta = self.step();
        self.open(record, theta);
    }

    /// The best parameters, moved to where the normal equations lead.
    fn step(&self) -> Theta {
        let scale = scales(&self.best);
        let mut normal = self.best_sums.normal;
        let mut gradient = self.best_sums.gradient;
        let variance = self.variance();
        for j in 0..PARAMETERS {
            let prior = variance / (PRIOR[j] * PRIOR[j]);
            normal[j][j] += prior + self.damping * (normal[j][j] + prior);
            if j > 4 && j != 6 {
                // Friction and loss of flow are none unless they are seen.
                gradient[j] -= prior * self.best.to_array()[j] / scale[j];
            }
        }
        let Some(factor) = cholesky(&normal) else {
            return self.best;
        };
        let step = backward(&factor, forward(&factor, gradient));
        let mut theta = self.best.to_array();
        for (j, value) in theta.iter_mut().enumerate() {
            let limit = if j < 3 { 0.5 } else { 1.0 };
            let step = if step[j] > limit {
                limit
            } else if step[j] < -limit {
                -limit
            } else {
                step[j]
            };
            *value += step * scale[j];
        }
        bounded(theta)
    }

    /// Variance of an error that counts alone: neighbouring errors are alike.
    fn variance(&self) -> f32 {
        let sums = &self.best_sums;
        let correlation = sums.lagged / sums.cost;
        let correlation = if correlation > CORRELATION_MAX {
            CORRELATION_MAX
        } else if correlation > 0.0 {
            correlation
        } else {
            0.0
        };
        let factor = (1.0 + correlation) / (1.0 - correlation);
        factor * sums.cost / (sums.count + 1.0)
    }

    /// Standard deviations of a1, a2 and of the gain b0/a1, in the scales of a1, a2 and b0; infinite when they are not known.
    ///
    /// With the parameters in reverse order a1, a2 and b0 are the last ones: the last rows of the Cholesky factor are then that of
    /// the inverse of their own covariance. Cost: some 1200 instructions.
    pub(crate) fn std(&self) -> [f32; 3] {
        let variance = self.variance();
        let last = PARAMETERS - 1;
        let mut reversed = [[0.0; PARAMETERS]; PARAMETERS];
        for (i, row) in reversed.iter_mut().enumerate() {
            for (j, value) in row.iter_mut().enumerate().take(i + 1) {
                *value = self.best_sums.normal[last - j][last - i];
            }
            row[i] += variance / (PRIOR[last - i] * PRIOR[last - i]);
        }
        let Some(factor) = cholesky(&reversed) else {
            return [f32::INFINITY; 3];
        };
        let [.., [.., l55, _, _], [.., l65, l66, _], [.., l75, l76, l77]] = factor;
        let own = [[l55, 0.0, 0.0], [l65, l66, 0.0], [l75, l76, l77]];
        let covariance = |unit: [f32; 3]| backward(&own, forward(&own, unit));
        let [b0, _, b0_a1] = covariance([1.0, 0.0, 0.0]);
        let [_, a2, _] = covariance([0.0, 1.0, 0.0]);
        let [_, _, a1] = covariance([0.0, 0.0, 1.0]);
        let gain = b0 + a1 - 2.0 * b0_a1;
        [a1, a2, gain].map(|x| sqrt(variance * x))
    }

    pub(crate) const fn best(&self) -> Theta {
        self.best
    }

    /// Number after the last point of the fit.
    pub(crate) const fn end(&self) -> usize {
        self.view.end
    }

    /// Whether the last pass has gained next to nothing, or there were `most` of them.
    pub(crate) const fn is_done(&self, most: u32) -> bool {
        self.converged || self.passes >= most
    }
}

impl Sums {
    #[inline]
    fn add(&mut self, slope: &[f32; PARAMETERS], error: f32) {
        for (sum, si) in self.gradient.iter_mut().zip(slope) {
            *sum += si * error;
        }
        let [row0, row1, row2, row3, row4, row5, row6, row7] = &mut self.normal;
        add::<1>(row0, slope);
        add::<2>(row1, slope);
        add::<3>(row2, slope);
        add::<4>(row3, slope);
        add::<5>(row4, slope);
        add::<6>(row5, slope);
        add::<7>(row6, slope);
        add::<8>(row7, slope);
        self.cost += error * error;
        self.lagged += error * self.last;
        self.last = error;
        self.count += 1.0;
    }
}

/// Adds the products of the last of the first K slopes with all of them: a row of the lower triangle, without a loop.
#[inline(always)]
fn add<const K: usize>(row: &mut [f32; PARAMETERS], slope: &[f32; PARAMETERS]) {
    const { assert!(K > 0 && K <= PARAMETERS) }
    for j in 0..K {
        row[j] += slope[K - 1] * slope[j];
    }
}
