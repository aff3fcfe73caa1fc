//! The Coulomb input: the sign of a velocity that is measured or that the
//! filtered position gives.

use trendid::inputs::coulomb;
use trendid::trends::{Chain, FilteredTrends, Form, Memory, Scheme, TrendOperator};

use crate::error::Error;

/// Poles of the velocity filter per sample: its lag, about seven samples, is
/// small against the time between two reversals of a drive.
const VELOCITY_POLE: f64 = 0.3;

/// Share of the fastest motion below which the drive counts as resting, where
/// friction has no known sign.
const REST: f64 = 1e-3;

/// Velocity from positions sampled every `dt` seconds, through the core's own
/// second-order filter.
///
/// # Errors
/// A sampling interval that is not a positive number.
pub fn velocity(y: &[f64], dt: f64) -> Result<Vec<f64>, Error> {
    let pole = (VELOCITY_POLE / dt) as f32;
    let trends = FilteredTrends::<2>::try_new(Scheme::Tustin, dt as f32, [pole; 2])?;
    let mut memory = Chain::output_at_rest(trends.design(), Form::Position, 0.0);
    // Movements from the first position, so that the filter starts at rest.
    let first = y.first().copied().unwrap_or(0.0);
    let step = |y: &f64| {
        let trends = trends.output(&mut memory, (y - first) as f32, Form::Position);
        // gamma y / (gamma + p)^2 has the gain 1/p^2 of a slow velocity.
        f64::from(pole * pole * trends.lower[1])
    };
    Ok(y.iter().map(step).collect())
}

/// sgn(v), and 0 where the drive rests.
pub fn signs(v: &[f64]) -> Vec<f64> {
    let fastest = v.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    v.iter()
        .map(|&v| f64::from(coulomb(v as f32, (REST * fastest) as f32)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_has_its_slope_and_a_rest_no_sign() {
        let y: Vec<f64> = (0..1000).map(|k| 5.0 + 0.2 * 1e-3 * f64::from(k)).collect();
        let v = velocity(&y, 1e-3).unwrap();
        assert!((v[999] - 0.2).abs() < 1e-3, "{}", v[999]);
        assert_eq!(signs(&[2.0, -0.5, 0.001, 0.0]), [1.0, -1.0, 0.0, 0.0]);
    }
}
