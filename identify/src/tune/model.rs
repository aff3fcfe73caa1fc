//! The plant that gains are for, and those within what is known of it.

use nalgebra::DMatrix;

use crate::estimate::Estimate;
use crate::identification::Identification;
use crate::problem::Problem;

/// Standard deviations by which the model is varied.
const VARIED: f64 = 2.0;

/// Gains within this factor may be those of one actuator in its two directions.
const ALIKE: f64 = 3.0;

/// `B(s)/A(s) e^(-s delay)` of one input.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// a_0 .. a_{m-1} of the monic denominator, order 1 to 4.
    pub a: Vec<f64>,
    /// b_0 .., fewer than the order and one.
    pub b: Vec<f64>,
    /// \[s\], with what the controller adds to it.
    pub delay: f64,
}

impl Model {
    /// The model of the first input of an estimate.
    pub fn of(estimate: &Estimate, delay: f64) -> Self {
        Self {
            a: estimate.a.clone(),
            b: estimate.b[0].clone(),
            delay,
        }
    }

    /// The models of the other delayed inputs that may be the same actuator, as where each
    /// direction has a column: those whose gain has the sign of the first one's, and at least a
    /// third and at most three times its size. With each the index of its input.
    pub fn others(problem: &Problem, estimate: &Estimate, delay: f64) -> Vec<(usize, Self)> {
        let inputs = problem.signals.inputs.iter().enumerate().skip(1);
        let alike = |c: &usize| {
            let ratio = estimate.b[*c][0] / estimate.b[0][0];
            (1.0 / ALIKE..=ALIKE).contains(&ratio)
        };
        let delayed = inputs.filter(|(_, input)| input.delayed).map(|(c, _)| c);
        let model = |c: usize| Self {
            a: estimate.a.clone(),
            b: estimate.b[c].clone(),
            delay,
        };
        delayed.filter(alike).map(|c| (c, model(c))).collect()
    }

    /// Two standard deviations to both sides along each principal axis of the covariance, that of
    /// the delay included where it was searched; an infinite one where its deviation is not finite.
    pub fn around(problem: &Problem, found: &Identification) -> Vec<Self> {
        let estimate = &found.estimate;
        let (n, dt) = (estimate.theta.len(), problem.signals.dt);
        let searched = found.delay_alike.and(found.delay_found.as_ref());
        let sigma = |j: usize| match searched {
            Some(delay) if j == n => delay.sigma,
            _ => estimate.sigma[j],
        };
        let known = |j: &usize| sigma(*j).is_finite() && sigma(*j) > 0.0;
        let all = n + usize::from(searched.is_some());
        if all > n && !sigma(n).is_finite() {
            let delay = f64::INFINITY;
            return vec![Self::of(estimate, delay)];
        }
        let places: Vec<usize> = (0..all).filter(known).collect();
        // In units of the standard deviations: an axis depends on the units otherwise.
        let correlation = DMatrix::from_fn(places.len(), places.len(), |i, j| {
            let (i, j) = (places[i].min(places[j]), places[i].max(places[j]));
            let covariance = match searched {
                Some(delay) if j == n && i == n => delay.sigma * delay.sigma,
                Some(delay) if j == n => delay.with[i],
                _ => estimate.covariance[i][j],
            };
            covariance / (sigma(i) * sigma(j))
        });
        if places.is_empty() || !correlation.iter().all(|v| v.is_finite()) {
            return Vec::new();
        }
        let axes = correlation.symmetric_eigen();
        let mut models = Vec::new();
        for (axis, variance) in axes.eigenvectors.column_iter().zip(&axes.eigenvalues) {
            for side in [-VARIED, VARIED] {
                let mut theta = estimate.theta.clone();
                theta.push(found.delay);
                for (place, part) in places.iter().zip(axis.iter()) {
                    theta[*place] += side * variance.max(0.0).sqrt() * part * sigma(*place);
                }
                let delay = theta.pop().unwrap_or_default().max(0.0) * dt;
                let model = problem.polynomials(&theta);
                models.push(Self {
                    a: model.a,
                    b: model.b[0].clone(),
                    delay,
                });
            }
        }
        models
    }

    /// With a gain divided by so much.
    pub(super) fn divided(&self, gain: f64) -> Self {
        Self {
            b: self.b.iter().map(|b| b / gain).collect(),
            ..self.clone()
        }
    }

    /// Coefficients of r, r', r'' .. in the command that lets the undelayed plant follow:
    /// `A(s)/B(s)` by powers of s.
    pub(super) fn feedforward(&self) -> Vec<f64> {
        let m = self.a.len();
        let a = |i: usize| self.a.get(i).copied().unwrap_or(1.0);
        let mut series: Vec<f64> = Vec::new();
        for i in 0..=m {
            let before = (1..=i).map(|j| self.b.get(j).copied().unwrap_or(0.0) * series[i - j]);
            let before: f64 = before.sum();
            series.push((a(i) - before) / self.b[0]);
        }
        series
    }
}
