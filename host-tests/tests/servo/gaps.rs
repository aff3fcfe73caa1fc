//! Readings that fail in patterns, in every state and on every family of axes.

use trendid::servo::{Reason, State};
use trendid_host_tests::servo::population::draw::AxisDraw;
use trendid_host_tests::servo::population::family::Family;

use crate::machine::{Machine, UNIT_MM};

/// Readings that fail of so many.
const PATTERNS: [[u32; 2]; 5] = [[1, 2], [2, 3], [1, 3], [2, 5], [1, 10]];

/// The largest distance in mm of what is taken for the position from the axis, while the loop is in
/// the state that it begins in and readings fail; the state behind so many samples.
fn run(machine: &mut Machine, [fail, of]: [u32; 2], samples: u32) -> (f64, State) {
    let (mut worst, mut last) = (0.0_f64, machine.servo.supervisor().state());
    let moves = last.is_controlling() || last.is_commissioning();
    for k in 0..samples {
        let before = machine.bench.position_mm();
        let report = machine.sample(k % of >= fail);
        assert!(report.position.is_finite() && report.setpoint.position.is_finite());
        last = report.state;
        if moves && matches!(last, State::Failed(_)) {
            break;
        }
        worst = worst.max((UNIT_MM * f64::from(report.position) - before).abs());
    }
    (worst, last)
}

#[test]
fn a_position_that_is_expected_stays_with_the_axis_however_readings_fail() {
    for family in Family::ALL {
        for seed in [300_001, 300_003] {
            let axis = AxisDraw::new(family, true, seed);
            let mut controls = Machine::new(&axis);
            let mut excites = controls.clone();
            excites.servo.commission();
            while excites.bench.time() < 0.5 {
                let _ = excites.step();
            }
            let found = controls.record();
            assert!(found.is_some(), "{family:?} {seed}: no model");
            let length = (axis.stroke_mm() / UNIT_MM) as f32;
            let there = controls.servo.move_to(0.5 * length);
            there.expect("a target");
            for _ in 0..3000 {
                let _ = controls.step();
            }
            let sine = controls.servo.oscillate(0.02 * length, 0.5);
            sine.expect("a sine");
            let mut idle = controls.clone();
            idle.servo.abort();
            let mut failed = controls.clone();
            let _ = run(&mut failed, [10, 10], 10);
            for _ in 0..1000 {
                let _ = (idle.step(), failed.step());
            }
            for pattern in PATTERNS {
                for start in [&excites, &controls, &idle, &failed] {
                    let mut machine = start.clone();
                    let before = machine.servo.supervisor().state();
                    let (worst, after) = run(&mut machine, pattern, 2000);
                    let told =
                        format!("{family:?} {seed} {pattern:?} {before}: {worst} mm, {after}");
                    assert!(worst < 2.0, "{told}");
                    // What fails as often as not is no sensor to move an axis by.
                    let moves = before.is_controlling() || before.is_commissioning();
                    if moves && 2 * pattern[0] >= pattern[1] {
                        assert_eq!(after, State::Failed(Reason::SensorFault), "{told}");
                    } else if before.is_controlling() {
                        assert!(after.is_controlling(), "{told}");
                    }
                }
            }
        }
    }
}
