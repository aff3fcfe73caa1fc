//! The loop of the core on a simulated drive, sample by sample.

use trendid::hardware::{Axis, PositionSensor, Scale, Valve};
use trendid::servo::{self, Report, ServoLoop, Travel};

use crate::servo::plant::{Plant, RESOLUTION_MM};

/// Sensor of the loop: the code that the simulation put there.
#[derive(Clone, Copy, Debug, Default)]
pub struct SimulatedSensor {
    /// The code of the next reading; `None` is a reading that fails.
    pub code: Option<i32>,
}

impl PositionSensor for SimulatedSensor {
    type Error = ();

    fn counts(&mut self) -> Result<i32, ()> {
        self.code.ok_or(())
    }
}

/// Valve of the loop: applies every command as it is.
#[derive(Clone, Copy, Debug, Default)]
pub struct SimulatedValve;

impl Valve for SimulatedValve {
    type Error = ();

    fn drive(&mut self, command: f32) -> Result<f32, ()> {
        Ok(command)
    }
}

/// What the user of a loop requests between two samples.
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
    /// Passes the request to a loop; one that a fault has stopped moves no more, and says so.
    ///
    /// # Panics
    /// When the loop refuses it: no scenario requests what the axis has no room for.
    pub fn apply_to<S: PositionSensor, V: Valve>(self, servo: &mut ServoLoop<S, V>) {
        let done = match self {
            Self::Commission => {
                servo.commission();
                Ok(())
            }
            Self::Abort => {
                servo.abort();
                Ok(())
            }
            Self::MoveTo(target) => servo.move_to(target),
            Self::Oscillate {
                amplitude,
                frequency,
            } => servo.oscillate(amplitude, frequency),
        };
        match done {
            Ok(()) | Err(servo::Error::NotControlling) => {}
            Err(error) => panic!("{self:?}: {error}"),
        }
    }
}

/// One instant of a scenario.
#[derive(Clone, Debug)]
pub struct Instant {
    /// Time \[s\].
    pub t: f64,
    /// True position \[mm\].
    pub position_mm: f64,
    /// What the loop reported.
    pub report: Report,
}

/// The loop on its plant.
pub struct Rig {
    /// The drive.
    pub plant: Plant,
    /// The loop.
    pub servo: ServoLoop<SimulatedSensor, SimulatedValve>,
    samples: u64,
}

/// Travel of both plants \[mm\].
pub const TRAVEL: Travel = Travel {
    min: 0.0,
    max: 400.0,
};

/// Bandwidth that the user expects of the axis \[rad/s\]; the pneumatic axis has about 31, the
/// linear one 20.
pub const ROUGH_BANDWIDTH: f32 = 25.0;

/// Dead volume of a chamber over that of the stroke that the user states: a cylinder.
pub const DEAD_VOLUME: f32 = 0.06;

impl Rig {
    /// A rig with these settings of the loop.
    ///
    /// # Panics
    /// When the settings cannot work; the message names the setting.
    pub fn new(plant: Plant, config: &servo::Config) -> Self {
        let Some(scale) = Scale::new(RESOLUTION_MM as f32) else {
            panic!("resolution");
        };
        let axis = Axis {
            scale,
            reference: 0,
        };
        match ServoLoop::try_new(config, axis, SimulatedSensor::default(), SimulatedValve) {
            Ok(servo) => Self {
                plant,
                servo,
                samples: 0,
            },
            Err(error) => panic!("{error}"),
        }
    }

    /// One sample of the loop; [`Rig::drive`] must follow.
    pub(crate) fn sample(&mut self, reading: Option<i32>) -> Instant {
        self.servo.sensor_mut().code = reading;
        Instant {
            t: 1e-3 * self.samples as f64,
            position_mm: self.plant.position_mm(),
            report: self.servo.update(),
        }
    }

    /// Moves the plant on to the next sample.
    pub(crate) fn drive(&mut self, command: f32) {
        self.plant.step(f64::from(command));
        self.samples += 1;
    }

    pub(crate) fn request(&mut self, request: Request) {
        request.apply_to(&mut self.servo);
    }
}
