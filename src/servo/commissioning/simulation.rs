//! A model that runs by itself beside the record.

use crate::math::sqrt;
use crate::servo::commissioning::predictor::{Point, Prediction, Theta};
use crate::servo::commissioning::record::MotionRecord;
use crate::servo::commissioning::view::{STEP_MAX, View};
use crate::servo::control::place::stiffness;

/// A model in free simulation beside the record.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Simulation {
    view: View,
    theta: Theta,
    gains: [f32; 3],
    at: Prediction,
    next: usize,
    /// Point from which the model runs by itself.
    release: usize,
    origin: f32,
    sums: [f32; 3],
    count: f32,
}

impl Simulation {
    /// Begins with a correction that ends at `release`.
    pub(crate) fn new(
        record: &MotionRecord,
        view: View,
        theta: Theta,
        ratio: f32,
        release: usize,
    ) -> Self {
        let first = Point::of(record, view.begin, &view);
        let rate = ratio * sqrt(theta.a1);
        let rate = if rate * view.time < STEP_MAX {
            rate
        } else {
            STEP_MAX / view.time
        };
        Self {
            view,
            theta,
            gains: theta.gains(rate, view.time),
            at: Prediction {
                x: first.y,
                v: first.velocity,
                p: theta.a2 * first.velocity + theta.friction * first.direction,
            },
            next: view.begin,
            release,
            origin: record.y(release),
            sums: [0.0; 3],
            count: 0.0,
        }
    }

    /// Takes `points` more; where there were none left, the mean squared error and the variance of
    /// the position.
    ///
    /// Cost: some 240 instructions per point.
    pub(crate) fn advance(&mut self, record: &MotionRecord, points: usize) -> Option<[f32; 2]> {
        let inverse = 1.0 / self.view.time;
        for taken in 0..points {
            let i = self.next;
            if i + self.view.beyond() >= self.view.end {
                if taken > 0 {
                    return None;
                }
                let [sse, sum, squares] = self.sums;
                let mean = sum / self.count;
                return Some([sse / self.count, squares / self.count - mean * mean]);
            }
            let point = Point::of(record, i, &self.view).under(self.at.p, self.theta.friction);
            let error = point.y - self.at.x;
            if i < self.release {
                if point.rests {
                    self.at.x = point.y;
                } else {
                    self.at.correct(self.gains, error);
                }
            } else {
                let moved = point.y - self.origin;
                self.sums[0] += error * error;
                self.sums[1] += moved;
                self.sums[2] += moved * moved;
                self.count += 1.0;
            }
            let flow = self.theta.flow_at(record, self.view.sign, i, inverse);
            self.theta
                .stiffer(stiffness(self.theta.stiffening, point.y))
                .advance(&mut self.at, flow, &point);
            self.next += 1;
        }
        None
    }
}

#[cfg(test)]
mod tests;
