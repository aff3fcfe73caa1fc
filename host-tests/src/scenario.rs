//! Scenarios of the adaptive position loop: the core's `ServoLoop` on a simulated axis, with its figures per seed.

use trendid::hardware::{Axis as Counts, PositionSensor, Scale, Valve};
use trendid::{LoopConfig, Report, ServoLoop, Travel};

use crate::noise::{Additive, Condition};
use crate::nonlinear::Valve as Null;
use crate::plant::LinearPlant;
use crate::pneumatic::{Axis, AxisParameters};
use crate::reference::REFERENCE;

/// Sensor of the loop: the code that the simulation put there.
#[derive(Clone, Copy, Debug, Default)]
pub struct SimulatedSensor {
    /// The code of the next reading.
    pub code: i32,
}

impl PositionSensor for SimulatedSensor {
    type Error = ();

    fn counts(&mut self) -> Result<i32, ()> {
        Ok(self.code)
    }
}

/// Valve of the loop: sets what it is told.
#[derive(Clone, Copy, Debug, Default)]
pub struct SimulatedValve;

impl Valve for SimulatedValve {
    type Error = ();

    fn drive(&mut self, command: f32) -> Result<f32, ()> {
        Ok(command)
    }
}

/// The drive under the loop.
pub enum Plant {
    /// The pneumatic axis.
    Pneumatic(Box<Axis>),
    /// The reference servo behind a valve with dead zone, with the same sensor as the axis.
    Linear {
        /// The servo.
        plant: Box<LinearPlant>,
        /// Its valve.
        valve: Null,
        /// Noise of the sensor.
        noise: Box<Additive>,
    },
}

impl Plant {
    /// The pneumatic axis of the figures.
    pub fn pneumatic(parameters: &AxisParameters, seed: u64) -> Self {
        Self::Pneumatic(Box::new(Axis::new(parameters, seed)))
    }

    /// The linear reference servo at 200 mm with a dead zone of 3 % and noise of +-10 um.
    pub fn linear(seed: u64) -> Self {
        let mut plant = REFERENCE.plant(1e-3);
        plant.reset(200.0);
        Self::Linear {
            plant: Box::new(plant),
            valve: Null {
                dead_zone: 0.03,
                ..Null::IDEAL
            },
            noise: Box::new(Additive::new(&Condition::white(20.0), seed)),
        }
    }

    fn code(&mut self) -> i32 {
        match self {
            Self::Pneumatic(axis) => axis.measure_counts(),
            Self::Linear { plant, noise, .. } => {
                let noise = noise.next().unwrap_or(0.0);
                ((plant.output() + noise) / RESOLUTION_MM).round() as i32
            }
        }
    }

    fn step(&mut self, u: f64) {
        match self {
            Self::Pneumatic(axis) => axis.step(u),
            Self::Linear { plant, valve, .. } => {
                plant.step(&[valve.flow(u)]);
            }
        }
    }

    /// True position \[mm\].
    pub fn position_mm(&self) -> f64 {
        match self {
            Self::Pneumatic(axis) => axis.position_mm(),
            Self::Linear { plant, .. } => plant.output(),
        }
    }
}

/// Resolution of the sensor of both plants \[mm\].
pub const RESOLUTION_MM: f64 = 0.01;

/// One instant of a scenario.
#[derive(Clone, Copy, Debug)]
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
    begin: 0.0,
    end: 400.0,
};

impl Rig {
    /// A rig with these settings of the loop.
    ///
    /// # Panics
    /// When the settings cannot work; the message names the setting.
    pub fn new(plant: Plant, config: &LoopConfig) -> Self {
        let Some(scale) = Scale::new(RESOLUTION_MM as f32) else {
            panic!("resolution");
        };
        let counts = Counts {
            scale,
            reference: 0,
        };
        match ServoLoop::try_new(config, counts, SimulatedSensor::default(), SimulatedValve) {
            Ok(servo) => Self {
                plant,
                servo,
                samples: 0,
            },
            Err(error) => panic!("{error}"),
        }
    }

    /// One sample.
    pub fn step(&mut self) -> Instant {
        self.servo.sensor_mut().code = self.plant.code();
        let position_mm = self.plant.position_mm();
        let report = self.servo.update();
        self.plant.step(f64::from(report.command));
        self.samples += 1;
        Instant {
            t: 1e-3 * (self.samples - 1) as f64,
            position_mm,
            report,
        }
    }
}
