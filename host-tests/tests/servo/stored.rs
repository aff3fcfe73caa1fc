//! What a loop found, kept over the loss of power, and control that begins with it.

use trendid::hardware::{Axis, Scale};
use trendid::servo::store::Record;
use trendid::servo::{Config, Error, Reason, ServoLoop, State};
use trendid_host_tests::plants::pneumatic::{AxisParameters, PneumaticAxis};
use trendid_host_tests::servo::plant::RESOLUTION_MM;
use trendid_host_tests::servo::rig::{DEAD_VOLUME, SimulatedSensor, SimulatedValve, TRAVEL};

type Loop = ServoLoop<SimulatedSensor, SimulatedValve>;

/// A loop that is told sample time, travel, sensor and that the axis is a cylinder.
fn fresh() -> Loop {
    let scale = Scale::new(RESOLUTION_MM as f32).expect("scale");
    let axis = Axis {
        scale,
        reference: 0,
    };
    let mut config = Config::minimal(1e-3, TRAVEL);
    config.controller.dead_volume = Some(DEAD_VOLUME);
    ServoLoop::try_new(&config, axis, SimulatedSensor::default(), SimulatedValve).expect("settings")
}

/// One sample of a loop on an axis, whose valve is wired by `wires`: 1 or -1.
fn step(servo: &mut Loop, plant: &mut PneumaticAxis, wires: f64) -> State {
    servo.sensor_mut().code = Some(plant.measure_counts());
    let report = servo.update();
    plant.step(wires * f64::from(report.command));
    report.state
}

/// What a commissioning finds, and the axis after a loss of power: the valve has closed.
fn found(wires: f64) -> (Record, PneumaticAxis) {
    let (mut servo, mut plant) = (fresh(), PneumaticAxis::new(&AxisParameters::SERVO, 3));
    servo.commission();
    for _ in 0..6000 {
        if step(&mut servo, &mut plant, wires).is_controlling() {
            break;
        }
    }
    let record = servo.record().expect("a model");
    assert_eq!(f64::from(record.sign), wires);
    for _ in 0..1000 {
        plant.step(0.0);
    }
    (record, plant)
}

#[test]
fn control_begins_with_a_stored_model_on_either_wiring() {
    for wires in [1.0, -1.0] {
        let (record, mut plant) = found(wires);
        let mut servo = fresh();
        assert_eq!(servo.record(), None);
        servo.resume(&record).expect("the model of this axis");
        let before = plant.position_mm();
        for k in 0..4000 {
            if k == 500 {
                let moved = (plant.position_mm() - before).abs();
                assert!(moved < 0.5, "it stays where it stood: {moved} mm");
                servo.move_to(150.0).expect("a target");
            }
            assert!(step(&mut servo, &mut plant, wires).is_controlling());
        }
        let error = (plant.position_mm() - 150.0).abs();
        assert!(error < 0.1, "{error} mm");
        let kept = servo.record().expect("a model");
        assert_eq!(
            (kept.sign, kept.delay, kept.noise),
            (record.sign, record.delay, record.noise)
        );
        assert_eq!(
            kept.std, record.std,
            "a model that nobody has improved is known as before"
        );
    }
}

/// The load changes so much that the loop follows by more than half a per cent of the travel, and
/// learns another model: what it knows of it is stored with it, and comes back.
#[test]
fn a_model_that_was_improved_is_stored_with_its_deviations() {
    let (first, mut plant) = found(1.0);
    assert_eq!(first.std, [f32::INFINITY; 6], "of the commissioning");
    let mut servo = fresh();
    servo.resume(&first).expect("the model of this axis");
    plant.set_mass(3.5 * plant.parameters().mass);
    // The motion of the axis has to be known first.
    let begins = (0..100).any(|_| {
        let _ = step(&mut servo, &mut plant, 1.0);
        servo.oscillate(60.0, 1.0).is_ok()
    });
    assert!(begins, "a sine in the travel");
    let learned = (0..20_000).find_map(|_| {
        let _ = step(&mut servo, &mut plant, 1.0);
        servo.record().filter(|record| record.model != first.model)
    });
    let learned = learned.expect("a better model");
    let model = learned.model.parameters();
    for (known, value) in learned.std.iter().zip(model).take(3) {
        assert!(*known > 0.0 && *known < 0.5 * value, "{learned:?}");
    }
    assert_eq!(learned.std[3..], [f32::INFINITY; 3]);
    let mut servo = fresh();
    servo.resume(&learned).expect("the model of this axis");
    let again = servo.record().expect("a model");
    for (is, was) in again.std.iter().zip(learned.std).take(3) {
        assert!((is / was - 1.0).abs() < 1e-6, "{again:?} {learned:?}");
    }
}

#[test]
fn a_record_that_cannot_control_is_refused_and_changes_nothing() {
    let (good, _) = found(1.0);
    let with = |change: fn(&mut Record)| {
        let mut record = good.clone();
        change(&mut record);
        record
    };
    for (record, reason) in [
        (with(|r| r.sign = 0.0), Reason::WrongSign),
        (with(|r| r.sign = f32::NAN), Reason::WrongSign),
        (with(|r| r.delay = -1e-3), Reason::NotFinite),
        (with(|r| r.noise = f32::INFINITY), Reason::NotFinite),
        (with(|r| r.model.b0 = f32::NAN), Reason::NotFinite),
        (with(|r| r.model.b0 = -r.model.b0), Reason::WrongSign),
        (with(|r| r.model.a1 = -1.0), Reason::Unstable),
        (with(|r| r.model.a2 = 0.0), Reason::Unstable),
        (with(|r| r.model.dead_zone = 0.9), Reason::OutOfRange),
        (with(|r| r.model.friction = -1.0), Reason::OutOfRange),
    ] {
        let mut servo = fresh();
        let refused = servo.resume(&record);
        assert_eq!(refused, Err(Error::Model(reason)), "{record:?}");
        assert_eq!(servo.record(), None);
        assert_eq!(servo.supervisor().state(), State::Idle);
    }
}
