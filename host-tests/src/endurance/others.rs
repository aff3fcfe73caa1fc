//! Other ways to forget, for comparison.

use crate::endurance::scenario::{DT, MOTION};
use crate::oracles::forgetting::{Forgetting, Kind, ServoRows};
use crate::plants::servo::Servo;

/// Three other ways to forget on the same samples.
pub(super) struct Others {
    rows: ServoRows,
    estimators: [Forgetting<5>; 3],
    left: u64,
    worst: [f64; 3],
}

impl Others {
    /// Beside an identifier with this memory (s), for so many samples.
    pub(super) fn new(memory: f64, bandwidth: f64, samples: u64) -> Self {
        let kinds = [
            Kind::Plain,
            Kind::Directional,
            Kind::Stabilised { variance: 1e3 },
        ];
        Self {
            rows: ServoRows::new(bandwidth, 0.4, 1000.0 / bandwidth, DT),
            estimators: kinds.map(|kind| Forgetting::new(kind, [1e8; 5], memory / DT)),
            left: samples + MOTION,
            worst: [0.0; 3],
        }
    }

    /// Takes a sample.
    pub(super) fn update(&mut self, u: f64, y: f64) {
        if self.left == 0 {
            return;
        }
        self.left -= 1;
        let (phi, psi) = self.rows.update(u, y);
        for estimator in &mut self.estimators {
            estimator.update(&phi, psi);
        }
    }

    /// Makes their estimates nominal.
    pub(super) fn set_nominal(&mut self) {
        for estimator in &mut self.estimators {
            estimator.set_nominal();
        }
    }

    /// Their largest errors in percent.
    pub(super) fn worst(&self) -> [f64; 3] {
        self.worst
    }

    /// Compares their estimates with the truth.
    pub(super) fn look(&mut self, truth: &[f64; 3]) {
        if self.left == 0 {
            return;
        }
        let truth = Servo {
            c: truth[0],
            omega0: truth[1],
            xi: truth[2],
        };
        for (worst, estimator) in self.worst.iter_mut().zip(&self.estimators) {
            let theta: [f64; 5] =
                std::array::from_fn(|j| self.rows.units[j] * estimator.theta()[j]);
            let found = Servo::from_coefficients(theta[0], theta[1], theta[2]);
            let error = found.map_or(f64::INFINITY, |found| {
                found
                    .error_pct(&truth)
                    .into_iter()
                    .fold(0.0, |w: f64, e| w.max(e.abs()))
            });
            // f64::max would drop a NaN.
            *worst = if error > *worst || error.is_nan() {
                error
            } else {
                *worst
            };
        }
    }
}
