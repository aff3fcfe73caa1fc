//! What an alarm of the monitors does.

use super::bench::MODEL;
use super::*;
use crate::servo::monitoring::Alarm;
use crate::servo::motion::Motion;

#[test]
fn what_the_monitors_see_reaches_the_valve() {
    // Faster towards the end than it can brake, at a command along that.
    let mut bench = Bench::new(MODEL);
    let _ = bench.worst(1500);
    let motion = Motion {
        velocity: 2000.0,
        ..Motion::at(380.0)
    };
    bench.servo.moves.tracking.begin(motion);
    let there = Setpoint::at(380.0);
    assert!(!bench.servo.is_stopped(&there, 380.0, 1.0, false));
    assert_eq!(bench.servo.guard.alarm, Some(Alarm::Brake));
    // A valve whose sign turns.
    let mut bench = Bench::new(MODEL);
    let _ = bench.worst(1500);
    bench.servo.move_to(300.0).expect("a target");
    bench.sign = -1.0;
    let closes = (0..1000).any(|_| {
        assert!(bench.step().0.state.is_controlling());
        bench.servo.guard.alarm == Some(Alarm::Close)
    });
    assert!(closes);
}

#[test]
fn an_axis_that_swings_at_rest_is_held_by_less_bandwidth_and_the_monitors_say_so() {
    let mut bench = Bench::new(MODEL);
    let _ = bench.worst(1500);
    let (poles, y) = (
        bench.servo.controller.bandwidth(),
        bench.servo.sensed.position,
    );
    let at_rest = Setpoint::at(y);
    let swings = (0..20_000).any(|k| {
        let way = if k / 50 % 2 == 0 { 0.02 } else { -0.02 };
        assert!(!bench.servo.is_stopped(&at_rest, y + way, 0.0, false));
        bench.servo.fallback.derating < 1.0
    });
    assert!(swings);
    let (report, _) = bench.step();
    assert_eq!(
        (report.faults.oscillations, report.faults.derating),
        (1, 0.7)
    );
    let slower = bench.servo.controller.bandwidth();
    assert!((slower / poles - 0.7).abs() < 1e-4, "{slower} of {poles}");
}

#[test]
fn the_monitors_expect_what_the_controller_goes_on_with() {
    let mut bench = Bench::new(MODEL);
    let _ = bench.worst(1500);
    bench.servo.move_to(300.0).expect("a target");
    let _ = bench.worst(100);
    let other = Model {
        a2: 1.5 * MODEL.a2,
        ..MODEL
    };
    let mut monitors = bench.servo.guard.monitors.clone();
    monitors.retune(other, bench.servo.controller.motion());
    assert_ne!(monitors, bench.servo.guard.monitors);
    bench.servo.retune(other);
    assert_eq!(monitors, bench.servo.guard.monitors);
}
