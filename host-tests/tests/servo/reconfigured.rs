//! A loop that begins anew in its place is one that was made new, but for what its valve was told.

use trendid::hardware::{Axis, Scale};
use trendid::servo::{Config, ServoLoop, Travel};
use trendid_host_tests::plants::pneumatic::{AxisParameters, PneumaticAxis};
use trendid_host_tests::random::Random;
use trendid_host_tests::servo::plant::RESOLUTION_MM;
use trendid_host_tests::servo::rig::{SimulatedSensor, SimulatedValve, TRAVEL};

use rand::{RngExt, SeedableRng};

type Loop = ServoLoop<SimulatedSensor, SimulatedValve>;

/// One sample on an axis, told as text: every number to its last bit.
fn step(servo: &mut Loop, plant: &mut PneumaticAxis) -> String {
    servo.sensor_mut().code = Some(plant.measure_counts());
    let report = servo.update();
    plant.step(f64::from(report.command));
    format!("{report:?}")
}

/// A loop as text, without what the valve was told: limiter and latest commands.
fn untold(servo: &Loop) -> String {
    let text = format!("{servo:?}");
    let (before, after) = text.split_once(" limiter: ").expect("a limiter");
    let (_, after) = after.split_once(" sensed: ").expect("what was sensed");
    format!("{before}{after}")
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
        assert_eq!(untold(&used), untold(&fresh), "{samples}");
        let mut twin = plant.clone();
        used.commission();
        fresh.commission();
        for k in 0..800 {
            let expected = step(&mut fresh, &mut twin);
            assert_eq!(step(&mut used, &mut plant), expected, "{samples}, {k}");
        }
    }
}

/// A loop that begins anew in any sample, again and again: what the valve is told changes by no
/// more than the rate of the settings in force.
#[test]
fn the_command_keeps_its_rate_over_other_settings() {
    let mut wide = 0;
    for seed in 200_001..200_031 {
        let mut random = Random::seed_from_u64(seed);
        let mut plant = PneumaticAxis::new(&AxisParameters::SERVO, seed);
        let sensor = SimulatedSensor::default();
        let mut config = Config::minimal(1e-3, TRAVEL);
        let mut servo = Loop::try_new(&config, axis(0), sensor, SimulatedValve).expect("settings");
        let mut last = 0.0_f32;
        for _ in 0..6 {
            servo.commission();
            for _ in 0..random.random_range(0..2500) {
                servo.sensor_mut().code = Some(plant.measure_counts());
                let report = servo.update();
                plant.step(f64::from(report.command));
                let change = (report.command - last).abs();
                let most = config.rate * config.sample_time;
                assert!(change <= most * 1.0001, "{seed}: {change}, {most}");
                let range = last.abs().max(config.range);
                assert!(report.command.abs() <= range, "{seed}: {report:?}");
                last = report.command;
                if report.state.is_controlling() && random.random_bool(0.01) {
                    let _ = servo.move_to(random.random_range(0.0..400.0));
                }
            }
            config.rate = random.random_range(2.0..100.0);
            config.range = random.random_range(0.1..1.0);
            wide += u32::from(last.abs() > config.rate * config.sample_time);
            servo.reconfigure(&config, axis(0)).expect("settings");
        }
    }
    assert!(wide > 20, "{wide} times in motion");
}
