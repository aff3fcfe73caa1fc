//! A least-squares fit of the model to the record, a few points per sample.

use crate::math::matrix::{backward, factor_columns, forward};
use crate::math::sqrt;
use crate::servo::commissioning::fit::certainty::Certainty;
use crate::servo::commissioning::predictor::{PARAMETERS, Point, Theta};
use crate::servo::commissioning::range::{bounded, scales, usual};
use crate::servo::commissioning::record::MotionRecord;
use crate::servo::commissioning::sensitivity::Sensitivity;
use crate::servo::commissioning::sums::{HALF, NO_SUMS, Sums};
use crate::servo::commissioning::view::{STEP_MAX, View};

/// Gain over the cost that is worth another pass; of points that are added to the sums of a pass,
/// what makes the points before worth a second look. Less is taken by the step that the sums ask
/// for, which costs no pass.
const GAIN: f32 = 0.1;
const GAIN_ADDED: f32 = 0.2;
/// Places of loss and stiffening among the parameters.
const LOSS: usize = 7;
const STIFFENING: usize = 8;
/// Points after a start in which the direction of the motion is uncertain.
const STARTING: u32 = 3;

/// A part of the end of a pass that is done.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Ending {
    Judged,
    /// The normal of the sums is half of the Cholesky factor of the normal equations, or all of it;
    /// with the gradient of the next step.
    Halved([f32; PARAMETERS]),
    Factored([f32; PARAMETERS]),
}

/// A gradient that leads nowhere.
const LEVEL: [f32; PARAMETERS] = [0.0; PARAMETERS];

/// Levenberg-Marquardt on the errors of a prediction that is corrected with a fixed rate.
///
/// The prediction sees about 1/rate ahead: less is blind to friction and delay, more loses the axis
/// where it sticks. Each pass over the points gives the cost and the next step.
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
    /// The prediction of this pass.
    at: Sensitivity,
    /// Parameters of a pass that has not begun.
    opening: Option<Theta>,
    next: usize,
    /// First point that counts.
    settled: usize,
    moving: u32,
    sums: Sums,
    passes: u32,
    converged: bool,
    /// How far the end of a pass has come.
    ending: Option<Ending>,
    /// Whether prediction and sums are those of the best parameters up to the end of the view.
    follows: bool,
    /// Whether this pass goes on from one before.
    goes_on: bool,
    /// The best parameters with the step that the last sums ask for.
    moved: Theta,
    /// Whether the stiffening, and with it the loss, is not searched.
    knows_stiffening: bool,
    /// How certain what was found is.
    certainty: Certainty,
}

impl Fit {
    #[inline(always)]
    pub(crate) fn new(knows_stiffening: bool) -> Self {
        let theta = Theta::from_array([1.0; PARAMETERS]);
        Self {
            view: View::EMPTY,
            rate: 1.0,
            gains: [0.0; 3],
            best: theta,
            best_sums: NO_SUMS,
            damping: 0.0,
            at: Sensitivity::new(),
            opening: None,
            next: 0,
            settled: 0,
            moving: 0,
            sums: NO_SUMS,
            passes: 0,
            converged: false,
            ending: None,
            follows: false,
            goes_on: false,
            moved: theta,
            knows_stiffening,
            certainty: Certainty::UNKNOWN,
        }
    }

    /// Begins at `theta`, with a correction of `ratio` times its natural frequency.
    pub(crate) fn begin(&mut self, view: View, theta: Theta, ratio: f32) {
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
        self.ending = None;
        self.goes_on = false;
        self.opening = Some(theta);
    }

    /// Goes on to `end` with the best parameters, to whose sums the points since are added; whether
    /// it can.
    ///
    /// The sums are those of the prediction linearised at the best parameters. As long as the step
    /// that they ask for is small, it is that of all points, and none need be read twice.
    pub(crate) fn go_on(&mut self, end: usize) -> bool {
        if !self.follows {
            return false;
        }
        self.view.end = end;
        self.sums = self.best_sums;
        self.best_sums.cost = f32::INFINITY;
        self.passes = 0;
        self.converged = false;
        self.opening = None;
        self.goes_on = true;
        true
    }

    /// Begins a pass. Cost: some 400 instructions.
    fn open(&mut self, record: &MotionRecord, theta: Theta) {
        self.gains = theta.gains(self.rate, self.view.time);
        let first = Point::of(record, self.view.begin, &self.view);
        self.at.begin(theta, &first);
        self.next = self.view.begin;
        self.settled = self.view.begin + (2.0 / (self.rate * self.view.time)) as usize;
        self.moving = 0;
        self.sums = NO_SUMS;
        self.follows = false;
    }

    /// Takes `points` more; whether there were none left. Cost: some 720 instructions per point.
    pub(crate) fn advance(&mut self, record: &MotionRecord, points: usize) -> bool {
        if let Some(theta) = self.opening.take() {
            self.open(record, theta);
            return false;
        }
        let inverse = 1.0 / self.view.time;
        for taken in 0..points {
            let i = self.next;
            // A pass that is worse already need not be finished.
            let worse = self.sums.cost > self.best_sums.cost;
            if i + self.view.beyond() >= self.view.end || worse {
                return taken == 0;
            }
            let point = self.at.seen(Point::of(record, i, &self.view));
            self.moving = if point.rests {
                0
            } else {
                self.moving.saturating_add(1)
            };
            let counts = i >= self.settled && self.moving > STARTING;
            if counts {
                let (error, mut slope) = self.at.error(&point);
                if self.knows_stiffening {
                    (slope[LOSS], slope[STIFFENING]) = (0.0, 0.0);
                }
                self.sums.add(&slope, error);
            }
            let theta = self.at.theta();
            let commands = theta.commands_at(record, self.view.sign, i, inverse);
            self.at.advance(&point, self.gains, commands, inverse);
            self.next += 1;
        }
        false
    }

    /// Ends a pass, in four samples: takes its parameters if they are better, factors the normal
    /// equations in two, finds the parameters of the next one. Whether that is done. Cost: some
    /// 2000 instructions each.
    pub(crate) fn next_pass(&mut self) -> bool {
        match self.ending.take() {
            None => self.evaluate(),
            Some(Ending::Judged) => self.factor(),
            Some(Ending::Halved(gradient)) => {
                let solved = factor_columns(&mut self.sums.normal, HALF, PARAMETERS);
                self.ending = Some(Ending::Factored(if solved { gradient } else { LEVEL }));
            }
            Some(Ending::Factored(gradient)) => {
                let (theta, gained) = self.step(gradient);
                let worth = if self.goes_on { GAIN_ADDED } else { GAIN };
                self.converged |= gained < worth * self.best_sums.cost;
                self.moved = theta;
                self.opening = Some(theta);
                return true;
            }
        }
        false
    }

    /// Takes the parameters of the pass if they are better.
    fn evaluate(&mut self) {
        self.passes += 1;
        // Written so that NaN is worse.
        self.follows = self.sums.cost < self.best_sums.cost;
        if self.follows {
            self.converged = self.sums.cost > (1.0 - GAIN) * self.best_sums.cost;
            self.best = *self.at.theta();
            self.best_sums = self.sums;
            self.damping *= 0.2;
        } else {
            self.damping *= 10.0;
        }
        self.ending = Some(Ending::Judged);
    }

    /// Factors half of the normal equations of the best parameters with what is known beforehand,
    /// in the place of the sums of this pass.
    fn factor(&mut self) {
        let scale = scales(&self.best);
        let best = self.best.to_array();
        let usual = usual(&self.best, self.knows_stiffening).to_array();
        let mut gradient = self.best_sums.gradient;
        let prior = self.best_sums.prior(&scale);
        let normal = &mut self.sums.normal;
        *normal = self.best_sums.normal;
        for j in 0..PARAMETERS {
            normal[j][j] += prior[j] + self.damping * (normal[j][j] + prior[j]);
            gradient[j] -= prior[j] * (best[j] - usual[j]);
        }
        let solved = factor_columns(normal, 0, HALF);
        self.ending = Some(Ending::Halved(if solved { gradient } else { LEVEL }));
    }

    /// The best parameters, moved to where the factored normal equations lead under a gradient, and
    /// what they promise to take from the cost.
    fn step(&self, gradient: [f32; PARAMETERS]) -> (Theta, f32) {
        if gradient == LEVEL {
            return (self.best, 0.0);
        }
        let scale = scales(&self.best);
        let factor = &self.sums.normal;
        let step = backward(factor, forward(factor, gradient));
        let gained: f32 = step.iter().zip(&gradient).map(|(s, g)| s * g).sum();
        let mut theta = self.best.to_array();
        for (j, value) in theta.iter_mut().enumerate() {
            let limit = if j < 3 { 0.5 } else { 1.0 } * scale[j];
            let step = if step[j] > limit {
                limit
            } else if step[j] < -limit {
                -limit
            } else {
                step[j]
            };
            *value += step;
        }
        (bounded(theta), gained)
    }

    /// The parameters that were found: the best ones with the step that their sums ask for.
    pub(crate) const fn found(&self) -> Theta {
        self.moved
    }

    /// Whether the pass went on from one before.
    pub(crate) const fn went_on(&self) -> bool {
        self.goes_on
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

mod certainty;
#[cfg(test)]
mod tests;
mod weighing;
