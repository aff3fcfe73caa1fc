//! A loop that begins anew in its place is one that was made new.

use trendid::hardware::{Axis, Scale};
use trendid::servo::{Config, ServoLoop, Travel};
use trendid_host_tests::plants::pneumatic::{AxisParameters, PneumaticAxis};
use trendid_host_tests::servo::plant::RESOLUTION_MM;
use trendid_host_tests::servo::rig::{SimulatedSensor, SimulatedValve, TRAVEL};

type Loop = ServoLoop<SimulatedSensor, SimulatedValve>;

/// One sample on an axis, told as text: every number to its last bit.
fn step(servo: &mut Loop, plant: &mut PneumaticAxis) -> String {
    servo.sensor_mut().code = Some(plant.measure_counts());
    let report = servo.update();
    plant.step(f64::from(report.command));
    format!("{report:?}")
}

fn axis(reference: i32) -> Axis {
    let scale = Scale::new(RESOLUTION_MM as f32).expect("scale");
    Axis { scale, reference }
}

#[test]
fn a_loop_begins_anew_whatever_it_did() {
    let first = Config::minimal(1e-3, TRAVEL);
    let mut second = Config::new(1e-3, 25.0, TRAVEL);
    second.noise = Some(0.02);
    second.adaptive = false;
    // Never used, commissioning, building the loop for what was found, in control, in motion.
    for samples in [0, 1, 150, 700, 1400, 2600, 4200] {
        let mut plant = PneumaticAxis::new(&AxisParameters::SERVO, 3);
        let sensor = SimulatedSensor::default();
        let mut used = Loop::try_new(&first, axis(0), sensor, SimulatedValve).expect("settings");
        used.commission();
        for k in 0..samples {
            if k == 4000 {
                used.move_to(150.0).expect("a target");
            }
            let _ = step(&mut used, &mut plant);
        }

        let before = format!("{used:?}");
        let mut refused = second.clone();
        refused.travel = Travel { min: 1.0, max: 1.0 };
        assert!(used.reconfigure(&refused, axis(40)).is_err());
        assert_eq!(format!("{used:?}"), before, "a refusal changes nothing");

        used.reconfigure(&second, axis(40)).expect("settings");
        let sensor = *used.sensor_mut();
        let mut fresh = Loop::try_new(&second, axis(40), sensor, SimulatedValve).expect("settings");
        assert_eq!(format!("{used:?}"), format!("{fresh:?}"), "{samples}");
        let mut twin = plant.clone();
        used.commission();
        fresh.commission();
        for k in 0..800 {
            let expected = step(&mut fresh, &mut twin);
            assert_eq!(step(&mut used, &mut plant), expected, "{samples}, {k}");
        }
    }
}
