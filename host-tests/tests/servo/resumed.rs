//! Control that begins with a record on axes of the population that stand anywhere on their travel.

use trendid_host_tests::servo::population::draw::{AxisDraw, Mechanics};
use trendid_host_tests::servo::population::family::Family;

use crate::machine::Machine;

fn placed(axis: &AxisDraw, place: f64) -> AxisDraw {
    let mut axis = *axis;
    match &mut axis.mechanics {
        Mechanics::Pneumatic(p) => p.start_mm = place * 1e3 * p.stroke,
        Mechanics::ThirdOrder(p) => p.start = place * p.stroke,
    }
    axis
}

/// An axis at rest is where its filter of the measured positions has been for a while: nothing has
/// to be got over when control begins.
#[test]
fn an_axis_at_rest_stays_at_rest_when_control_begins() {
    for family in Family::ALL {
        for seed in [300_003, 300_008] {
            let axis = AxisDraw::new(family, true, seed);
            let record = Machine::new(&axis).record();
            let record = record.unwrap_or_else(|| panic!("{family:?} {seed}: no model"));
            for place in [0.1, 0.5, 0.9] {
                let mut machine = Machine::new(&placed(&axis, place));
                while machine.bench.time() < 0.1 {
                    let _ = machine.step();
                }
                let before = machine.bench.position_mm();
                machine
                    .servo
                    .resume(&record)
                    .expect("the model of this axis");
                while machine.bench.time() < 1.1 {
                    let report = machine.step();
                    let told = format!("{family:?} {seed} at {place}: {report:?}");
                    assert!(report.state.is_controlling(), "{told}");
                    let moved = (machine.bench.position_mm() - before).abs();
                    assert!(moved < 1.0, "{told}: {moved} mm");
                }
                assert!(machine.bench.blow_mm_s < 50.0, "{family:?} {seed} {place}");
            }
        }
    }
}
