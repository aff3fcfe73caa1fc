//! The loop on a sensor that fails now and then.

use crate::servo::run::{Options, run_with_shadow};
use crate::servo::scenario::Scenario;
use crate::servo::shadow::FailingSensor;

/// Runs the nominal scenario of a seed with every twentieth reading lost.
///
/// # Panics
/// When the model is not verified within 3 s, or the sine of 0.5 Hz is off by 1.05 mm or more.
pub fn assert_failing_readings_are_bridged(seed: u64) {
    let mut sensor = FailingSensor::new(20);
    let options = Options::adaptive(seed);
    let f = run_with_shadow(Scenario::Nominal, &options, &mut sensor, &mut |_, _| {});
    assert!(sensor.failed > 500);
    assert!(f.verified_at_s.is_some_and(|t| t < 3.0), "seed {seed}");
    let sine = f.tracking_0p5hz_mm.unwrap_or(f64::INFINITY);
    assert!(sine < 1.05, "seed {seed}: 0.5 Hz {sine} mm");
}
