//! The simulated drive of the loops, and where its sensor stands.

use trendid::hardware::{Axis, PositionSensor, Scale};
use trendid::servo::Travel;
use trendid_example_support::drive::Drive;

use crate::record::Error;

/// A drive whose readings fail now and then; it moves on all the same.
pub(crate) struct Failing {
    pub(crate) drive: Drive,
    /// Every so many-th reading fails.
    pub(crate) every: Option<u32>,
    pub(crate) count: u32,
}

impl PositionSensor for Failing {
    type Error = ();

    fn counts(&mut self) -> Result<i32, ()> {
        let Ok(code) = self.drive.counts();
        let count = self.count;
        self.count += 1;
        match self.every {
            Some(every) if count % every == every - 1 => Err(()),
            _ => Ok(code),
        }
    }
}

/// Code of the sensor at the begin of the travel.
pub(crate) const ORIGIN: i32 = 8_000_000;

pub(crate) const TRAVEL: Travel = Travel {
    min: 0.0,
    max: 400.0,
};

pub(crate) fn axis() -> Result<Axis, Error> {
    let scale = Scale::new(0.005).ok_or("scale")?;
    Ok(Axis {
        scale,
        reference: ORIGIN,
    })
}
