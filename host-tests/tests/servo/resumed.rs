//! Control that begins with a record on axes of the population that stand anywhere on their travel.

use trendid::hardware::{Axis, Scale};
use trendid::servo::store::Record;
use trendid::servo::{Error, Reason, State};
use trendid_host_tests::servo::population::adaptive::stated;
use trendid_host_tests::servo::population::draw::{AxisDraw, Mechanics};
use trendid_host_tests::servo::population::family::Family;

use crate::machine::{Machine, UNIT_MM};

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

/// A machine whose stated travel is the inner eight tenths of its stroke, and the ends in mm.
fn narrow(axis: &AxisDraw) -> (Machine, [f64; 2]) {
    let mut machine = Machine::new(axis);
    let mut config = stated(axis, UNIT_MM);
    let ends = [0.1, 0.9].map(|end| end * axis.stroke_mm());
    [config.travel.min, config.travel.max] = ends.map(|end| (end / UNIT_MM) as f32);
    let scale = Scale::new((axis.resolution_mm / UNIT_MM) as f32).expect("scale");
    let sensor = Axis {
        scale,
        reference: 0,
    };
    machine
        .servo
        .reconfigure(&config, sensor)
        .expect("settings");
    (machine, ends)
}

/// The same beyond the lower or upper end of that by a share of it, with the place of the end.
fn beyond(axis: &AxisDraw, upper: bool, share: f64) -> (Machine, f64) {
    let away = 0.8 * share;
    let place = if upper { 0.9 + away } else { 0.1 - away };
    let (machine, ends) = narrow(&placed(axis, place));
    (machine, ends[usize::from(upper)])
}

fn records(family: Family) -> impl Iterator<Item = (AxisDraw, Record)> {
    (300_001..300_009).filter_map(move |seed| {
        let axis = placed(&AxisDraw::new(family, true, seed), 0.5);
        Some((axis, narrow(&axis).0.record()?))
    })
}

#[test]
fn an_axis_that_stands_beyond_its_travel_is_not_moved() {
    for family in Family::ALL {
        for (axis, record) in records(family) {
            for (upper, share) in [(false, 0.02), (true, 0.05)] {
                let (mut machine, _) = beyond(&axis, upper, share);
                let before = machine.bench.position_mm();
                // Nobody has seen it yet.
                machine.servo.resume(&record).expect("a model");
                let state = machine.step().state;
                assert_eq!(state, State::Failed(Reason::Implausible), "{}", axis.seed);
                for ask in [true, false] {
                    let refused = if ask {
                        machine.servo.resume(&record)
                    } else {
                        machine.servo.install(record.model)
                    };
                    assert!(matches!(refused, Err(Error::Setting(_))), "{refused:?}");
                }
                let moved = (machine.bench.position_mm() - before).abs();
                assert!(moved < 0.1, "{family:?} {}: {moved} mm", axis.seed);
            }
        }
    }
}

#[test]
fn an_axis_a_little_beyond_its_travel_comes_back_as_planned() {
    // A drive that is as stiff everywhere and taken for a cylinder may swing at its ends.
    for family in [Family::Pneumatic, Family::Linear, Family::BallScrew] {
        for (axis, record) in records(family) {
            for upper in [false, true] {
                let (mut machine, end) = beyond(&axis, upper, 0.008);
                let told = format!("{family:?} {} {upper}", axis.seed);
                let away = (machine.bench.position_mm() - end).abs();
                machine.servo.resume(&record).expect("a model");
                let (mut last, mut jump) = (machine.bench.position_mm(), 0.0_f64);
                while machine.bench.time() < 2.0 {
                    let report = machine.step();
                    assert!(report.state.is_controlling(), "{told}: {report:?}");
                    let reference = UNIT_MM * f64::from(report.setpoint.position);
                    jump = jump.max((reference - last).abs());
                    last = reference;
                }
                let left = (machine.bench.position_mm() - end).abs();
                println!("{told}: {away:.2} mm away, {jump:.3} mm a sample, then {left:.2}");
                assert!((last - end).abs() < 1e-3, "{told}: {last}");
                // D w Delta / 2 and the noise of the first reading.
                assert!(jump < 0.15 * away + 0.05, "{told}");
                assert!(machine.bench.blow_mm_s == 0.0, "{told}");
                // What friction lets go hops, and rests where it comes to.
                assert!(left < 1.0 || family == Family::Pneumatic, "{told}");
            }
        }
    }
}
