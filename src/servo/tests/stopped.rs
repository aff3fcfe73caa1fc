//! The end of a stop.

use super::bench::MODEL;
use super::*;
use crate::servo::monitoring::{Alarm, stop::Stop};

/// A loop that brakes behind a fault.
fn braking() -> Bench {
    let mut bench = failed(MODEL, Reason::FollowingError);
    let _ = bench.step();
    let (report, _) = bench.step();
    assert!(report.command < -0.1, "{report:?}");
    assert_ne!(bench.servo.guard.stop, Stop::default());
    bench.servo.guard.alarm = Some(Alarm::Brake);
    bench
}

#[test]
fn a_stop_ends_with_the_fault_that_it_answers() {
    let mut bench = braking();
    bench.servo.abort();
    assert_eq!(bench.servo.guard.stop, Stop::default());
    assert_eq!(bench.servo.guard.alarm, None);
    // The full command takes three samples to zero.
    for k in 0..2000 {
        let (report, _) = bench.step();
        assert_eq!(report.state, State::Idle);
        assert!(k < 3 || report.command == 0.0, "{k}: {}", report.command);
    }
    let mut bench = braking();
    bench.servo.install(MODEL).expect("a model");
    assert_eq!(bench.servo.guard.stop, Stop::default());
    assert_eq!(bench.servo.guard.alarm, None);
    // A commissioning that ends at once brakes for nothing before it.
    let mut bench = braking();
    bench.servo.commission();
    for _ in 0..3 {
        let _ = bench.step();
    }
    assert!(bench.servo.supervisor().state().is_commissioning());
    bench.servo.fail(Reason::TravelEnd);
    for k in 0..20 {
        let (report, _) = bench.step();
        assert!(k < 3 || report.command == 0.0, "{k}: {}", report.command);
    }
}
