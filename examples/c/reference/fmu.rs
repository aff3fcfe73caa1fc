//! The numbers of `fmu/test_fmu.py`.

use trendid::Servo;
use trendid::servo::{self, ServoLoop};
use trendid_example_support::drive::{Drive, SimulatedValve};
use trendid_example_support::hash::Hash;
use trendid_example_support::record::SAMPLE_TIME;

use crate::axis::{Failing, ORIGIN, TRAVEL, axis};
use crate::outcome::{parts, take_all};
use crate::record::{Error, table};

pub(crate) fn fmu() -> Result<(), Error> {
    let mut servo = Servo::<0>::new(SAMPLE_TIME, 20.0, 0.4, 50.0)?;
    let mut hash = Hash::new();
    for (u, y) in table()? {
        let outcome = servo.update(u, y);
        let found = servo.estimate();
        take_all(&mut hash, found.theta());
        take_all(&mut hash, found.std());
        hash.take(servo.prediction());
        let (kind, _, innovation) = parts(outcome);
        hash.take(innovation);
        hash.take_bits(kind);
    }
    println!("identifier {hash}");

    let config = servo::Config::new(0.001, 20.0, TRAVEL);
    let sensor = Failing {
        drive: Drive::new(ORIGIN),
        every: None,
        count: 0,
    };
    let mut servo = ServoLoop::try_new(&config, axis()?, sensor, SimulatedValve)?;
    servo.commission();
    let mut hash = Hash::new();
    for k in 0..6000 {
        if k == 5000 {
            servo.move_to(300.0)?;
        }
        let report = servo.update();
        hash.take(report.command);
        hash.take(report.position);
        hash.take(report.setpoint.position);
        hash.take(report.innovation.unwrap_or(0.0));
        hash.take_bits(u32::from(report.state.code()));
        hash.take_bits(report.state.reason().map_or(0, |reason| reason as u32 + 1));
    }
    println!("loop-fmu {hash}");
    println!("refusals ok");
    Ok(())
}
