//! The loop on a sensor that fails now and then.

use crate::servo::run::{Options, run_with_shadow};
use crate::servo::scenario::Scenario;
use crate::servo::shadow::FailingSensor;

/// Largest median, 90 % and 99 % of that error over many seeds \[mm\]: those of a sensor that never
/// fails.
pub const SINE_MAX_MM: [f64; 3] = [0.75, 1.02, 1.2];

/// Runs the nominal scenario of a seed with every twentieth reading lost; the largest error in the
/// sine of 0.5 Hz \[mm\].
///
/// # Panics
/// When the model is not verified within 3 s.
pub fn error_with_failing_readings(seed: u64) -> f64 {
    let mut sensor = FailingSensor::new(20);
    let options = Options::adaptive(seed);
    let f = run_with_shadow(Scenario::Nominal, &options, &mut sensor, &mut |_, _| {});
    assert!(sensor.failed > 500);
    assert!(f.verified_at_s.is_some_and(|t| t < 3.0), "seed {seed}");
    f.tracking_0p5hz_mm.unwrap_or(f64::INFINITY)
}
