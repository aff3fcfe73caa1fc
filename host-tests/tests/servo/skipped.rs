//! Slots that are missing, as after an overrun, and a loop that is told of them.

use trendid::hardware::{Axis, Scale};
use trendid::servo::{Config, Reason, ServoLoop, State};
use trendid_host_tests::plants::pneumatic::{AxisParameters, PneumaticAxis};
use trendid_host_tests::servo::plant::RESOLUTION_MM;
use trendid_host_tests::servo::rig::{SimulatedSensor, SimulatedValve, TRAVEL};

type Loop = ServoLoop<SimulatedSensor, SimulatedValve>;

/// A loop on an axis, and the command that stands at its valve.
struct Bench {
    servo: Loop,
    plant: PneumaticAxis,
    command: f32,
}

impl Bench {
    /// An idle loop before its first sample.
    fn new(seed: u64) -> Self {
        let axis = Axis {
            scale: Scale::new(RESOLUTION_MM as f32).expect("scale"),
            reference: 0,
        };
        let config = Config::minimal(1e-3, TRAVEL);
        let servo = ServoLoop::try_new(&config, axis, SimulatedSensor::default(), SimulatedValve);
        Self {
            servo: servo.expect("settings"),
            plant: PneumaticAxis::new(&AxisParameters::SERVO, seed),
            command: 0.0,
        }
    }

    /// A loop in control of its axis.
    fn in_control(seed: u64) -> Self {
        let mut bench = Self::new(seed);
        bench.servo.commission();
        for _ in 0..6000 {
            if bench.step().is_controlling() {
                return bench;
            }
        }
        panic!("seed {seed}: no model");
    }

    /// One slot; the command is in force until the next one.
    fn step(&mut self) -> State {
        self.servo.sensor_mut().code = Some(self.plant.measure_counts());
        let report = self.servo.update();
        self.command = report.command;
        self.plant.step(f64::from(report.command));
        report.state
    }

    /// A slot that is missing: the axis moves on under the old command.
    fn miss(&mut self, told: bool) {
        let _ = self.plant.measure_counts();
        self.plant.step(f64::from(self.command));
        if told {
            self.servo.skip(1);
        }
    }
}

/// Mean square of setpoint minus position in mm^2 over four moves, every `every`-th slot missing.
fn error(seed: u64, every: u32, told: bool) -> f64 {
    let mut bench = Bench::in_control(seed);
    let (mut sum, mut count) = (0.0, 0);
    for k in 0..6000 {
        if k % 1500 == 0 {
            let target = if k % 3000 == 0 { 120.0 } else { 280.0 };
            bench.servo.move_to(target).expect("a target");
        }
        if k % every == every - 1 {
            bench.miss(told);
            continue;
        }
        bench.servo.sensor_mut().code = Some(bench.plant.measure_counts());
        let before = bench.plant.position_mm();
        let report = bench.servo.update();
        bench.command = report.command;
        bench.plant.step(f64::from(report.command));
        assert!(
            report.state.is_controlling(),
            "seed {seed}, every {every}, told {told}: {:?}",
            report.state
        );
        let error = f64::from(report.setpoint.position) - before;
        sum += error * error;
        count += 1;
    }
    sum / f64::from(count)
}

/// Root mean square error in mm over the seeds.
fn rms(every: u32, told: bool) -> f64 {
    // How far an axis hops behind its friction spreads the errors of single runs.
    let sum: f64 = (200_301..200_317)
        .map(|seed| error(seed, every, told))
        .sum();
    (sum / 16.0).sqrt()
}

/// What missing slots add to the error of the loop is less than half when it is told of them.
#[test]
fn a_loop_that_is_told_of_missing_slots_follows_better() {
    let whole = rms(u32::MAX, true);
    for every in [50, 10] {
        let [told, untold] = [true, false].map(|told| rms(every, told));
        println!(
            "one slot in {every} missing: rms error {told:.3} mm, {untold:.3} mm when not told, {whole:.3} mm with every slot"
        );
        assert!(
            told - whole < 0.5 * (untold - whole),
            "one in {every}: {told} and {untold} mm, {whole} mm with every slot"
        );
    }
}

#[test]
fn as_many_missing_slots_as_readings_may_fail_stop_the_axis() {
    let mut bench = Bench::in_control(200_310);
    bench.servo.skip(2);
    assert!(bench.step().is_controlling(), "two are bridged");
    bench.servo.skip(3);
    assert_eq!(
        bench.servo.supervisor().state(),
        State::Failed(Reason::SensorFault)
    );
    let mut bench = Bench::in_control(200_310);
    bench.servo.skip(u32::MAX);
    assert_eq!(
        bench.servo.supervisor().state(),
        State::Failed(Reason::SensorFault)
    );
}

#[test]
fn nothing_is_missing_before_the_first_sample_nor_while_the_axis_stands() {
    let mut bench = Bench::new(200_320);
    bench.servo.skip(100);
    assert_eq!(bench.servo.supervisor().state(), State::Idle);
    assert_eq!(bench.step(), State::Idle);
    bench.servo.skip(100);
    assert_eq!(bench.servo.supervisor().state(), State::Idle);
    assert_eq!(bench.step(), State::Idle);
    assert!(bench.command == 0.0);
}
