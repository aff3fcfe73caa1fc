//! How an estimate comes to its end through a record.

use crate::plants::servo::{REFERENCE, Servo};
use crate::signals::experiment::Record;

/// What one method made of one record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Signed errors of C, omega0, xi at the end \[%\]; infinite where the estimate has no such
    /// reading.
    pub error_pct: [f64; 3],
    /// Mean over the last half of `|theta(k) - theta(end)| / |theta(end)|`, averaged over a1, a2,
    /// b0.
    pub conv: Option<f64>,
    /// First time after which all three errors stay within 5 % \[ms\], infinite when the end is
    /// outside.
    pub settled_ms: Option<f64>,
    /// Whether instruments were too weak and least squares stands in their place.
    pub weak: bool,
}

impl Run {
    /// Whether an error is above 100 %, or there is no reading.
    pub fn diverged(&self) -> bool {
        !self.error_pct.iter().all(|e| e.abs() <= 100.0)
    }
}

/// Follows an estimate through a record.
pub(crate) struct Transient {
    duration_s: f64,
    inside_since: Option<f64>,
    late: Vec<[f64; 3]>,
    error_pct: [f64; 3],
}

/// Band of the settling time \[%\].
const SETTLED_PCT: f64 = 5.0;

impl Transient {
    pub(crate) fn new(record: &Record) -> Self {
        Self {
            duration_s: record.len() as f64 * record.dt,
            inside_since: None,
            late: Vec::new(),
            error_pct: [f64::INFINITY; 3],
        }
    }

    pub(crate) fn push(&mut self, t: f64, [a1, a2, b0]: [f64; 3]) {
        self.error_pct = Servo::from_coefficients(a1, a2, b0)
            .map_or([f64::INFINITY; 3], |s| s.error_pct(&REFERENCE));
        let inside = self.error_pct.iter().all(|e| e.abs() <= SETTLED_PCT);
        self.inside_since = match (inside, self.inside_since) {
            (true, since) => since.or(Some(t)),
            (false, _) => None,
        };
        if 2.0 * t >= self.duration_s {
            self.late.push([a1, a2, b0]);
        }
    }

    pub(crate) fn finish(self) -> Run {
        let conv = self.late.last().map(|end| {
            let distance: f64 = self
                .late
                .iter()
                .map(|theta| {
                    (0..3)
                        .map(|i| ((theta[i] - end[i]) / end[i]).abs() / 3.0)
                        .sum::<f64>()
                })
                .sum();
            distance / self.late.len() as f64
        });
        Run {
            error_pct: self.error_pct,
            conv,
            settled_ms: Some(self.inside_since.map_or(f64::INFINITY, |t| 1e3 * t)),
            weak: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signals::experiment::Experiment;
    use crate::signals::noise::Condition;

    #[test]
    fn settling_begins_after_the_last_excursion() {
        let record = Experiment::reference(Condition::CLEAN, 0.01).record(1);
        let mut transient = Transient::new(&record);
        for (k, a2) in [10.0, 20.0, 25.0, 20.5, 20.0].into_iter().enumerate() {
            transient.push(2e-3 * k as f64, [400.0, a2, 1e6]);
        }
        let run = transient.finish();
        assert_eq!(run.settled_ms, Some(6.0));
        assert!(!run.diverged());
        // Samples at 6 and 8 ms are the last half: a2 is 2.5 % from its end at one of them.
        assert!((run.conv.unwrap() - 0.025 / 2.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn an_estimate_without_reading_is_a_diverged_run() {
        let record = Experiment::reference(Condition::CLEAN, 0.01).record(1);
        let mut transient = Transient::new(&record);
        transient.push(0.0, [-1.0, 20.0, 1e6]);
        let run = transient.finish();
        assert!(run.diverged());
        assert_eq!(run.settled_ms, Some(f64::INFINITY));
    }
}
