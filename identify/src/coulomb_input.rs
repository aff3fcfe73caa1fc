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

/// Velocity from positions sampled every `dt` seconds, through the core's own second-order filter
/// forwards and backwards: the mean of both has no lag, so that a reversal is not late.
///
/// # Errors
/// A sampling interval that is not a positive number.
pub fn velocity(y: &[f64], dt: f64) -> Result<Vec<f64>, Error> {
    let forwards = one_way(y.iter(), dt)?;
    let backwards = one_way(y.iter().rev(), dt)?;
    let both = forwards.iter().zip(backwards.iter().rev());
    Ok(both.map(|(there, back)| 0.5 * (there - back)).collect())
}

fn one_way<'a>(y: impl Iterator<Item = &'a f64>, dt: f64) -> Result<Vec<f64>, Error> {
    let pole = (VELOCITY_POLE / dt) as f32;
    let trends = FilteredTrends::<2>::try_new(Scheme::Tustin, dt as f32, [pole; 2])?;
    let mut memory = Chain::output_at_rest(trends.design(), Form::Position, 0.0);
    // Movements from the first position, so that the filter starts at rest.
    let mut y = y.peekable();
    let first = y.peek().map_or(0.0, |y| **y);
    let step = |y: &f64| {
        let trends = trends.output(&mut memory, (y - first) as f32, Form::Position);
        // gamma y / (gamma + p)^2 has the gain 1/p^2 of a slow velocity.
        f64::from(pole * pole * trends.lower[1])
    };
    Ok(y.map(step).collect())
}

/// Means of sgn(v) from each sample to the next, v straight between them; 0 where the drive rests.
pub fn signs(v: &[f64]) -> Vec<f64> {
    let fastest = v.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let sign = |v: f64| f64::from(coulomb(v as f32, (REST * fastest) as f32));
    let mean = |k: usize| {
        let (now, next) = (v[k], v.get(k + 1).copied().unwrap_or(v[k]));
        match (sign(now), sign(next)) {
            (s, t) if s * t < 0.0 => s * (now.abs() - next.abs()) / (now.abs() + next.abs()),
            (s, t) => 0.5 * (s + t),
        }
    };
    (0..v.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reversal_is_not_late() {
        // The top of a parabola is at sample 500.
        let y: Vec<f64> = (0..1000)
            .map(|k| -1e-6 * f64::from(k - 500).powi(2))
            .collect();
        let v = velocity(&y, 1e-3).unwrap();
        let first = v[50..].iter().position(|v| *v < 0.0).map(|k| k + 50);
        assert!(first.is_some_and(|k| k.abs_diff(500) <= 1), "{first:?}");
    }

    #[test]
    fn a_ramp_has_its_slope_and_a_rest_no_sign() {
        let y: Vec<f64> = (0..1000).map(|k| 5.0 + 0.2 * 1e-3 * f64::from(k)).collect();
        let v = velocity(&y, 1e-3).unwrap();
        assert!((v[500] - 0.2).abs() < 1e-3, "{}", v[500]);
        // From 2 to -0.5 four fifths of the way are forwards.
        let signs = signs(&[2.0, -0.5, -0.5, 0.001, 0.0]);
        for (found, wanted) in signs.iter().zip([0.6, -1.0, -0.5, 0.0, 0.0]) {
            assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
        }
    }
}
