//! A second loop in step with the one of a scenario: on a processor, behind a line.

use trendid::servo::Report;

use crate::servo::rig::{Request, Rig};

/// A loop that gets what the loop of the rig gets, sample by sample, and drives the plant in its
/// place.
pub trait Shadow {
    /// What the sensor of both loops says for `code`; `None` is a reading that failed.
    fn reading(&mut self, code: i32) -> Option<i32> {
        Some(code)
    }

    /// A request to the loop before its next sample.
    fn request(&mut self, request: Request);

    /// Takes the reading after the loop of `rig` took it and gave `report`; the command for the
    /// plant, or `None` to end.
    fn update(&mut self, reading: Option<i32>, report: &Report, rig: &Rig) -> Option<f32>;
}

/// The sensor fails at every so many readings; the loop of the rig drives the plant itself.
#[derive(Clone, Copy, Debug)]
pub struct FailingSensor {
    every: u32,
    readings: u32,
    /// Readings that failed.
    pub failed: u32,
}

impl FailingSensor {
    /// Fails at each `every`-th reading.
    pub const fn new(every: u32) -> Self {
        Self {
            every,
            readings: 0,
            failed: 0,
        }
    }
}

impl Shadow for FailingSensor {
    fn reading(&mut self, code: i32) -> Option<i32> {
        self.readings += 1;
        let fails = self.readings.is_multiple_of(self.every);
        self.failed += u32::from(fails);
        (!fails).then_some(code)
    }

    fn request(&mut self, _: Request) {}

    fn update(&mut self, _: Option<i32>, report: &Report, _: &Rig) -> Option<f32> {
        Some(report.command)
    }
}
