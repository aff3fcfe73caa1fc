//! The auxiliary denominator of the instruments.

use crate::polynomials::{Pole, from_roots};
use crate::problem::Problem;

/// The slowest and the fastest auxiliary pole: 1/(0.2 T) and 0.3/h.
const SLOWEST_SHARE: f64 = 0.2;
const FASTEST_SHARE: f64 = 0.3;

/// Whether two polynomials are alike within a share of every coefficient.
pub(super) fn near(p: &[f64], q: &[f64], share: f64) -> bool {
    p.len() == q.len()
        && p.iter()
            .zip(q)
            .all(|(p, q)| (p - q).abs() <= share * p.abs())
}

impl Problem<'_> {
    /// The auxiliary denominator with these poles: stable, and within what the record shows.
    pub(super) fn within_reach(&self, poles: &[Pole]) -> Vec<f64> {
        let dt = self.signals.dt;
        let slowest = 1.0 / (SLOWEST_SHARE * self.samples() as f64 * dt);
        let fastest = (FASTEST_SHARE / dt).max(slowest);
        let limited: Vec<Pole> = poles
            .iter()
            .map(|(re, im)| {
                (
                    -re.abs().clamp(slowest, fastest),
                    im.clamp(-1.0 / dt, 1.0 / dt),
                )
            })
            .collect();
        from_roots(&limited)
    }
}
