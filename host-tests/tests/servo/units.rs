//! The unit of the position does not matter to the loop.

use trendid::hardware::{Axis, Scale};
use trendid::servo::ServoLoop;
use trendid_host_tests::servo::population::adaptive::stated;
use trendid_host_tests::servo::population::bench::Bench;
use trendid_host_tests::servo::population::draw::AxisDraw;
use trendid_host_tests::servo::population::family::Family;
use trendid_host_tests::servo::population::range::Purpose;
use trendid_host_tests::servo::rig::{SimulatedSensor, SimulatedValve};

type Loop = ServoLoop<SimulatedSensor, SimulatedValve>;

/// A loop on an axis, whose user measures in units of so many mm.
fn servo(axis: &AxisDraw, unit_mm: f64) -> Loop {
    let sensor = Axis {
        scale: Scale::new((axis.resolution_mm / unit_mm) as f32).expect("a scale"),
        reference: 0,
    };
    ServoLoop::try_new(
        &stated(axis, unit_mm),
        sensor,
        SimulatedSensor::default(),
        SimulatedValve,
    )
    .expect("settings")
}

/// a1, a2, b0 and friction of the model in use, for positions in mm.
fn in_mm(servo: &Loop, unit_mm: f64) -> [f32; 4] {
    let model = servo.controller().model();
    let unit = unit_mm as f32;
    [model.a1, model.a2, unit * model.b0, unit * model.friction]
}

/// The units are powers of two, so that every command is the same to the last bit: through the
/// commissioning, moves, a sine, a change of the load and models that replace each other.
#[test]
fn every_command_is_that_of_the_same_axis_in_other_units() {
    let mut controlled = 0;
    for family in [Family::Pneumatic, Family::Linear, Family::Hydraulic] {
        for seed in 294_001..294_009 {
            let axis = AxisDraw::new(family, false, seed);
            let mut bench = Bench::new(&axis, Purpose::Disturbance);
            let units = [128.0, 64.0, 1024.0];
            let mut loops = units.map(|unit| servo(&axis, unit));
            for servo in &mut loops {
                servo.commission();
            }
            let (mut k, mut controls) = (0_u32, false);
            while bench.time() < 12.0 {
                k += 1;
                if k == (9.0 / axis.sample_time) as u32 {
                    bench.multiply_mass(2.0);
                }
                let code = bench.code();
                let reports = [0, 1, 2].map(|i| {
                    let length = axis.stroke_mm() / units[i];
                    let servo: &mut Loop = &mut loops[i];
                    if k % 1500 == 0 {
                        let place = if k % 3000 == 0 { 0.4 } else { 0.6 };
                        let _ = servo.move_to((place * length) as f32);
                    }
                    if k % 6000 == 5000 {
                        let _ = servo.oscillate((0.01 * length) as f32, 1.0);
                    }
                    servo.sensor_mut().code = Some(code);
                    servo.update()
                });
                let [first, ..] = &reports;
                for report in &reports {
                    assert_eq!(report.state, first.state, "{family:?} {seed} {k}");
                    assert_eq!(
                        report.command.to_bits(),
                        first.command.to_bits(),
                        "{family:?} {seed} {k}"
                    );
                }
                controls |= first.state.is_controlling();
                bench.hold(f64::from(first.command));
                let models = [0, 1, 2].map(|i| in_mm(&loops[i], units[i]));
                assert_eq!(models[1], models[0], "{family:?} {seed} {k}");
                assert_eq!(models[2], models[0], "{family:?} {seed} {k}");
            }
            controlled += u32::from(controls);
        }
    }
    assert!(controlled >= 20, "{controlled} of 24 axes");
}
