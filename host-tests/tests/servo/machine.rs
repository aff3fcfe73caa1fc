//! A loop on an axis of the population, sample by sample.

use trendid::hardware::{Axis, Scale};
use trendid::servo::store::Record;
use trendid::servo::{Report, ServoLoop};
use trendid_host_tests::servo::population::adaptive::stated;
use trendid_host_tests::servo::population::bench::Bench;
use trendid_host_tests::servo::population::draw::AxisDraw;
use trendid_host_tests::servo::population::range::Purpose;
use trendid_host_tests::servo::rig::{SimulatedSensor, SimulatedValve};

/// The unit of the positions in mm.
pub(crate) const UNIT_MM: f64 = 100.0;

/// A loop on an axis, from power-up.
#[derive(Clone)]
pub(crate) struct Machine {
    pub(crate) bench: Bench,
    pub(crate) servo: ServoLoop<SimulatedSensor, SimulatedValve>,
}

impl Machine {
    pub(crate) fn new(axis: &AxisDraw) -> Self {
        let scale = Scale::new((axis.resolution_mm / UNIT_MM) as f32).expect("scale");
        let sensor = Axis {
            scale,
            reference: 0,
        };
        let config = stated(axis, UNIT_MM);
        let servo = ServoLoop::try_new(&config, sensor, SimulatedSensor::default(), SimulatedValve);
        Self {
            bench: Bench::new(axis, Purpose::Disturbance),
            servo: servo.expect("settings"),
        }
    }

    pub(crate) fn step(&mut self) -> Report {
        self.sample(true)
    }

    /// A sample whose reading succeeds or fails.
    pub(crate) fn sample(&mut self, reads: bool) -> Report {
        let code = self.bench.code();
        self.servo.sensor_mut().code = reads.then_some(code);
        let report = self.servo.update();
        self.bench.hold(f64::from(report.command));
        report
    }

    /// What a commissioning from power-up finds.
    pub(crate) fn record(&mut self) -> Option<Record> {
        self.servo.commission();
        while self.bench.time() < 6.0 {
            if self.step().state.is_controlling() {
                return self.servo.record();
            }
        }
        None
    }
}
