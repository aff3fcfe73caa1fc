//! What came out of a run, and the limits that it has to keep.

use crate::endurance::reading::Reading;
use crate::endurance::scenario::Case;

/// Largest allowed errors of C, omega0 and xi in percent, where the data obey the model and their
/// noise is that of the setup: far out f32 has a larger one, which the standard deviations tell.
pub const LIMITS_PCT: [f64; 3] = [0.15, 0.1, 0.3];

/// The same ten seconds after data that did not.
pub const RECOVERED_PCT: f64 = 0.1;

/// Largest allowed error in standard deviations.
pub const LIMIT_SIGMA: f64 = 4.0;

/// Least share of the samples in which the estimate is held while a command that acts does not move
/// the axis: all but what the gate needs to see it.
pub const HELD_LEAST: f64 = 0.9;

/// What came out of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Whether every estimate, standard deviation and factor D was finite, and every D positive.
    pub finite: bool,
    /// Largest errors of C, omega0, xi in percent: all the time, or after the motion that follows
    /// the scenario.
    pub errors_pct: [f64; 3],
    /// The same of the samples whose last digit in f32 is no larger than the noise.
    pub resolved_pct: [f64; 3],
    /// Largest error over its standard deviation.
    pub over_sigma: f64,
    /// Largest P_ii over its bound; over the prior without a memory.
    pub over_bound: f64,
    /// Share of the samples of the scenario in which the estimate was held.
    pub held: f64,
    /// Largest error in percent of plain, directional and stabilised forgetting; `None` where they
    /// were not run.
    pub others_pct: Option<[f64; 3]>,
}

impl Found {
    /// Nothing looked at yet.
    pub(super) const NOTHING: Self = Self {
        finite: true,
        errors_pct: [0.0; 3],
        resolved_pct: [0.0; 3],
        over_sigma: 0.0,
        over_bound: 0.0,
        held: 0.0,
        others_pct: None,
    };

    /// Takes an estimate, `None` where there is none, and whether f32 resolves the noise of the
    /// newest position.
    pub(super) fn compare(&mut self, reading: Option<Reading>, truth: &[f64; 3], resolved: bool) {
        let Some(reading) = reading else {
            (self.errors_pct, self.resolved_pct) = ([f64::INFINITY; 3], [f64::INFINITY; 3]);
            return;
        };
        for (i, [value, std]) in reading.into_iter().enumerate() {
            let error = (value - truth[i]).abs();
            if truth[i] > 0.0 {
                let share = 100.0 * error / truth[i];
                self.errors_pct[i] = larger(self.errors_pct[i], share);
                if resolved {
                    self.resolved_pct[i] = larger(self.resolved_pct[i], share);
                }
            }
            self.over_sigma = larger(self.over_sigma, error / std);
        }
    }

    /// Which limit the run breaks, if any.
    pub fn violation(&self, case: &Case) -> Option<String> {
        let limits = match (case.has_limits(), case.scenario.obeys_model()) {
            (true, true) => LIMITS_PCT,
            (true, false) if case.scenario.recovers() => [RECOVERED_PCT; 3],
            (true, false) => [f64::INFINITY; 3],
            (false, _) => [f64::INFINITY; 3],
        };
        let over = self
            .resolved_pct
            .iter()
            .zip(limits)
            .any(|(e, l)| !(*e <= l));
        if !self.finite {
            Some("not finite".into())
        } else if over {
            Some(format!("errors above {limits:?} %"))
        } else if case.scenario.obeys_model() && !(self.over_sigma <= LIMIT_SIGMA) {
            Some(format!("error above {LIMIT_SIGMA} sigma"))
        } else if !(self.over_bound <= 1.01) {
            Some("covariance above its bound".into())
        } else if case.must_hold() && self.held < HELD_LEAST {
            Some(format!("held in {:.1} % only", 100.0 * self.held))
        } else {
            None
        }
    }
}

/// The larger one; NaN is larger than anything.
fn larger(worst: f64, value: f64) -> f64 {
    if value > worst || value.is_nan() {
        value
    } else {
        worst
    }
}
