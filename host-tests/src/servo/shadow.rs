//! A second loop beside the one of a scenario: on a processor, behind a line.

use trendid::hardware::{PositionSensor, Valve};
use trendid::{Report, ServoLoop};

use crate::servo::scenario::Rig;

/// What the user of a loop asks of it between two samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Request {
    /// Commission the axis.
    Commission,
    /// Stop commissioning or control.
    Abort,
    /// Move to a position \[mm\].
    MoveTo(f32),
    /// Oscillate about the present reference.
    Oscillate {
        /// Amplitude \[mm\].
        amplitude: f32,
        /// Frequency \[Hz\].
        frequency: f32,
    },
}

impl Request {
    /// Asks it of a loop.
    pub fn put_to<S: PositionSensor, V: Valve>(self, servo: &mut ServoLoop<S, V>) {
        match self {
            Self::Commission => servo.commission(),
            Self::Abort => servo.abort(),
            Self::MoveTo(target) => servo.move_to(target),
            Self::Oscillate {
                amplitude,
                frequency,
            } => servo.oscillate(amplitude, frequency),
        }
    }
}

/// A loop that gets what the loop of the rig gets, sample by sample, and drives the plant in its place.
pub trait Companion {
    /// What the sensor of both loops says for `code`; `None` is a reading that failed.
    fn reading(&mut self, code: i32) -> Option<i32> {
        Some(code)
    }

    /// Hears what is asked of the loop before its next sample.
    fn request(&mut self, request: Request);

    /// Takes the reading after the loop of `rig` took it and gave `report`; the command for the plant, or `None` to end.
    fn update(&mut self, reading: Option<i32>, report: &Report, rig: &Rig) -> Option<f32>;
}
