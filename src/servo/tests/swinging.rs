//! Control that begins in a swing of a drive that is hardly damped.

use super::bench::{Bench, RECORD};
use crate::servo::Model;
use crate::servo::motion::Motion;
use crate::servo::store::Record;

/// Standard deviation of the position, which the settings state.
const NOISE: f32 = 0.05;

/// In a swing behind the closed valve, of this speed in this phase, as long as the filter of the
/// positions needs to know it; then control begins.
fn swinging(model: Model, speed: f32, phase: f32) -> Bench {
    let mut config = Bench::config();
    config.noise = Some(NOISE);
    let mut bench = Bench::without_a_model(model, &config);
    bench.motion = Motion {
        velocity: speed * libm::cosf(phase),
        acceleration: -25.0 * speed * libm::sinf(phase),
        ..bench.motion
    };
    for _ in 0..100 {
        let _ = bench.step();
    }
    let record = Record {
        model,
        noise: NOISE,
        ..RECORD
    };
    bench.servo.resume(&record).expect("a record");
    bench
}

#[test]
fn an_axis_that_swings_unknown_when_control_begins_is_no_fault() {
    // Damping of 0.05 and 0.1.
    for (a2, b0) in [(2.5, 1e5), (2.5, 4e4), (5.0, 4e4)] {
        let model = Model::linear(625.0, a2, b0);
        for k in 0..24 {
            // The filter shows a motion from 1.76 times its rate and the grain on.
            let speed = if k < 12 { 45.0 } else { 60.0 };
            let mut bench = swinging(model, speed, 0.53 * k as f32);
            let _ = bench.worst(1500);
            let left = bench.motion.velocity.abs();
            assert!(left < 5.0, "{k}: {left}");
        }
    }
}

#[test]
fn the_reference_does_not_run_away_from_an_axis_that_swings() {
    for k in 0..24 {
        let mut bench = swinging(Model::linear(625.0, 5.0, 1e5), 150.0, 0.26 * k as f32);
        // A swing of 150 is one of 6 to each side.
        let error = bench.worst(1500);
        assert!(error < 12.0, "{k}: {error}");
    }
}
