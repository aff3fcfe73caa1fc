//! The loop: commissioning, moves, its record, and another loop that goes on with it.

use trendid::hardware::Valve;
use trendid::servo::store::{Identity, Record};
use trendid::servo::{self, Report, ServoLoop};
use trendid_example_support::drive::{Drive, SimulatedValve};
use trendid_example_support::hash::Hash;

use crate::axis::{Failing, ORIGIN, TRAVEL, axis};
use crate::record::Error;

fn take_report(hash: &mut Hash, report: &Report) {
    hash.take_bits(u32::from(report.state.code()));
    hash.take_bits(report.state.reason().map_or(0, |reason| reason as u32 + 1));
    hash.take_bits(u32::from(report.retuned));
    hash.take(report.command);
    hash.take(report.position);
    hash.take(report.setpoint.position);
    hash.take(report.innovation.unwrap_or(0.0));
}

pub(crate) fn control() -> Result<(), Error> {
    let config = servo::Config::new(0.001, 20.0, TRAVEL);
    let sensor = Failing {
        drive: Drive::new(ORIGIN),
        every: Some(997),
        count: 0,
    };
    let mut first = ServoLoop::try_new(&config, axis()?, sensor, SimulatedValve)?;
    first.commission();
    let mut hash = Hash::new();
    for k in 0..12_000 {
        let report = first.update();
        match k {
            5000 => first.move_to(300.0)?,
            7000 => first.move_to(150.0)?,
            9000 => first.oscillate(20.0, 0.5)?,
            _ => {}
        }
        take_report(&mut hash, &report);
    }
    println!("loop {hash}");

    let identity = Identity::new(4711, &config);
    let bytes = first.record().ok_or("no model")?.to_bytes(&identity, 9);
    let mut stored = Hash::new();
    for byte in bytes {
        stored.take_bits(u32::from(byte));
    }
    println!("record {stored}");

    let (record, _) = Record::from_bytes(&bytes, &identity)?;
    let drive = std::mem::replace(&mut first.sensor_mut().drive, Drive::new(ORIGIN));
    // A new drive has set the command to zero, as the second loop of C begins.
    let sensor = Failing {
        drive,
        every: None,
        count: 0,
    };
    let mut second = ServoLoop::try_new(&config, axis()?, sensor, SimulatedValve)?;
    let _ = second.valve_mut().drive(0.0);
    second.resume(&record)?;
    let mut hash = Hash::new();
    for _ in 0..2000 {
        take_report(&mut hash, &second.update());
    }
    println!("resumed {hash}");
    Ok(())
}
