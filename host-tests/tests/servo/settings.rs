//! No setting of the position loop is dead: each changes what the loop does, or is refused with its
//! name.

use std::collections::BTreeSet;

use trendid::ConfigError;
use trendid::hardware::{Axis, Scale};
use trendid::servo::{Config, Error, Model, MotionLimits, ServoLoop};
use trendid_host_tests::plants::pneumatic::{AxisParameters, PneumaticAxis};
use trendid_host_tests::servo::plant::RESOLUTION_MM;
use trendid_host_tests::servo::rig::{ROUGH_BANDWIDTH, SimulatedSensor, SimulatedValve, TRAVEL};
use trendid_host_tests::settings::names;

fn defaults() -> Config {
    Config::new(1e-3, ROUGH_BANDWIDTH, TRAVEL)
}

/// A model of the axis from an earlier day.
fn stored() -> Model {
    Model {
        dead_zone: 0.03,
        friction: 3400.0,
        ..Model::linear(900.0, 13.5, 1.48e6)
    }
}

/// Commands and states of 13.5 s: a sine on a stored model with five times the mass and back; then
/// commissioning, moves, rest, a sine, with five times the mass at 8.5 s and back at 10.5 s.
fn trace(config: &Config) -> Result<Vec<(u32, u8)>, Error> {
    let axis = Axis {
        scale: Scale::new(RESOLUTION_MM as f32).expect("scale"),
        reference: 0,
    };
    let mut servo = ServoLoop::try_new(config, axis, SimulatedSensor::default(), SimulatedValve)?;
    let mut plant = PneumaticAxis::new(&AxisParameters::SERVO, 7);
    let mass = plant.parameters().mass;
    let mut trace = Vec::new();
    for k in 0..13_500 {
        match k {
            // A model or a motion that a setting refuses is a change as well.
            50 => drop(servo.install(stored())),
            60 => drop(servo.oscillate(60.0, 1.0)),
            900 => plant.set_mass(5.0 * mass),
            2400 => plant.set_mass(mass),
            3900 => servo.abort(),
            4200 => servo.commission(),
            6500 => drop(servo.move_to(250.0)),
            7300 => drop(servo.oscillate(60.0, 1.0)),
            8500 => plant.set_mass(5.0 * mass),
            10_500 => plant.set_mass(mass),
            12_000 => drop(servo.move_to(180.0)),
            _ => {}
        }
        servo.sensor_mut().code = Some(plant.measure_counts());
        let report = servo.update();
        plant.step(f64::from(report.command));
        trace.push((report.command.to_bits(), report.state.code()));
    }
    Ok(trace)
}

type Change = fn(&mut Config);

/// Every setting with a value that the loop must notice.
const CHANGES: &[(&str, Change)] = &[
    ("sample_time", |c| c.sample_time = 0.9e-3),
    ("bandwidth", |c| c.bandwidth = Some(27.0)),
    ("reversed", |c| c.reversed = Some(true)),
    ("travel.min", |c| c.travel.min = -50.0),
    ("travel.max", |c| c.travel.max = 420.0),
    ("noise", |c| c.noise = Some(0.5)),
    ("range", |c| c.range = 0.3),
    ("rate", |c| c.rate = 50.0),
    ("delay", |c| c.delay = 4e-3),
    ("memory", |c| c.memory = 0.3),
    ("min_excitation", |c| c.min_excitation = 0.5),
    ("adaptive", |c| c.adaptive = false),
    ("motion", |c| {
        c.motion = Some(MotionLimits {
            velocity: 300.0,
            acceleration: 3000.0,
            jerk: 5e4,
        });
    }),
    ("controller.bandwidth", |c| {
        c.controller.bandwidth = Some(15.0)
    }),
    ("controller.blend", |c| c.controller.blend = 0.02),
    ("controller.rest_window", |c| {
        c.controller.rest_window = Some(1.0)
    }),
    ("controller.dead_volume", |c| {
        c.controller.dead_volume = Some(0.2);
    }),
    ("controller.imbalance", |c| c.controller.imbalance = 0.1),
    ("controller.transition", |c| c.controller.transition = 0.5),
    ("excitation.amplitude", |c| c.excitation.amplitude = 0.2),
    ("supervision.frequency_factor", |c| {
        c.supervision.frequency_factor = 1.01;
    }),
    ("supervision.max_gain", |c| {
        c.supervision.max_gain = Some(100.0)
    }),
    ("supervision.max_relative_std_adapting", |c| {
        c.supervision.max_relative_std_adapting = 1e-4;
    }),
    ("supervision.min_r_squared_adapting", |c| {
        c.supervision.min_r_squared_adapting = 0.3;
    }),
    ("supervision.replace_ratio", |c| {
        c.supervision.replace_ratio = 1e-6
    }),
    ("supervision.min_improvement", |c| {
        c.supervision.min_improvement = 100.0;
    }),
    ("supervision.excite_time", |c| {
        c.supervision.excite_time = 0.4
    }),
    ("supervision.validation_time", |c| {
        c.supervision.validation_time = Some(0.2);
    }),
    ("supervision.time_limit", |c| c.supervision.time_limit = 0.3),
    ("supervision.min_speed", |c| {
        c.supervision.min_speed = Some(1e4)
    }),
    ("supervision.min_travel", |c| {
        c.supervision.min_travel = Some(300.0)
    }),
    ("supervision.alarm_ratio", |c| {
        c.supervision.alarm_ratio = 1.01
    }),
    ("supervision.error_deadband", |c| {
        c.supervision.error_deadband = Some(300.0);
    }),
];

#[test]
fn every_setting_is_listed() {
    let listed: BTreeSet<String> = CHANGES.iter().map(|(name, _)| name.to_string()).collect();
    assert_eq!(names(&defaults()), listed);
}

#[test]
fn every_setting_changes_what_the_loop_does() {
    let usual = trace(&defaults()).expect("settings");
    let dead: Vec<&str> = CHANGES
        .iter()
        .filter(|(name, change)| {
            let mut config = defaults();
            change(&mut config);
            usual == trace(&config).unwrap_or_else(|error| panic!("{name}: {error}"))
        })
        .map(|(name, _)| *name)
        .collect();
    assert!(dead.is_empty(), "without effect: {dead:?}");
}

/// Puts a value into one setting.
type Put = fn(&mut Config, f32);

#[test]
fn a_value_that_cannot_work_is_refused_with_the_name_of_its_setting() {
    for value in [f32::NAN, f32::INFINITY, -1.0] {
        let cases: [(&str, Put); 12] = [
            ("sample_time", |c, x| c.sample_time = x),
            ("bandwidth", |c, x| c.bandwidth = Some(x)),
            ("rate", |c, x| c.rate = x),
            ("delay", |c, x| c.delay = x),
            ("min_excitation", |c, x| c.min_excitation = x),
            ("controller.bandwidth", |c, x| {
                c.controller.bandwidth = Some(x);
            }),
            ("controller.dead_volume", |c, x| {
                c.controller.dead_volume = Some(if x > 0.0 { f32::NAN } else { x });
            }),
            ("controller.rest_window", |c, x| {
                c.controller.rest_window = Some(if x > 0.0 { f32::NAN } else { x });
            }),
            ("controller.imbalance", |c, x| c.controller.imbalance = x),
            ("excitation.amplitude", |c, x| c.excitation.amplitude = x),
            ("supervision.time_limit", |c, x| {
                c.supervision.time_limit = x
            }),
            ("supervision.alarm_ratio", |c, x| {
                c.supervision.alarm_ratio = x;
            }),
        ];
        for (name, change) in cases {
            let mut config = defaults();
            change(&mut config, value);
            match config.resolve() {
                Err(Error::Setting(
                    ConfigError::NotPositive { setting, .. }
                    | ConfigError::OutOfRange { setting, .. },
                )) => assert_eq!(setting, name.into()),
                other => panic!("{name} = {value}: {other:?}"),
            }
        }
    }
}
