//! A simulated drive behind the traits of the real one: for the emulator and the host, where there
//! is no machine.

use core::sync::atomic::{AtomicU32, Ordering};

use trendid::hardware::{PositionSensor, Valve};

use crate::random::Random;

/// Counts per mm.
const COUNTS: f32 = 200.0;

/// The reference drive.
const A1: f32 = 400.0;
const B0: f32 = 1e6;

/// Half-width of the dead zone of the valve.
const DEAD_ZONE: f32 = 0.03;

/// Command in force, as bits of an f32: written by the valve, read by the sensor one sample later.
static COMMAND: AtomicU32 = AtomicU32::new(0);

/// The position transducer of the reference drive x''' + 20 x'' + 400 x' = 10^6 u, in mm, with
/// noise of two counts.
///
/// Reading it moves the drive on by one millisecond.
#[derive(Debug)]
pub struct Drive {
    origin: i32,
    position: f32,
    velocity: f32,
    acceleration: f32,
    noise: Random,
    /// a1 and b0.
    stiffness: f32,
    gain: f32,
}

impl Drive {
    /// A drive at rest at 200 mm whose transducer has the code `origin` at the begin of the travel.
    #[must_use]
    pub fn new(origin: i32) -> Self {
        COMMAND.store(0, Ordering::Relaxed);
        Self {
            origin,
            position: 200.0,
            velocity: 0.0,
            acceleration: 0.0,
            noise: Random::new(1),
            stiffness: A1,
            gain: B0,
        }
    }

    /// Moves `factor` times the mass from now on: the air is a spring between valve and mass.
    pub fn set_mass(&mut self, factor: f32) {
        self.stiffness = A1 / factor;
        self.gain = B0 / factor;
    }
}

impl PositionSensor for Drive {
    type Error = core::convert::Infallible;

    fn counts(&mut self) -> Result<i32, Self::Error> {
        const STEPS: usize = 8;
        const TIME: f32 = 0.001 / STEPS as f32;
        let command = f32::from_bits(COMMAND.load(Ordering::Relaxed));
        let flow = if command > DEAD_ZONE {
            command - DEAD_ZONE
        } else if command < -DEAD_ZONE {
            command + DEAD_ZONE
        } else {
            0.0
        };
        for _ in 0..STEPS {
            let jerk = self.gain * flow - 20.0 * self.acceleration - self.stiffness * self.velocity;
            self.acceleration += TIME * jerk;
            self.velocity += TIME * self.acceleration;
            self.position += TIME * self.velocity;
        }
        let noise = (self.noise.bits() >> 24) as i32 % 5 - 2;
        Ok(self.origin + (self.position * COUNTS) as i32 + noise)
    }
}

/// The valve of the simulated drive.
#[derive(Debug)]
pub struct SimulatedValve;

impl Valve for SimulatedValve {
    type Error = core::convert::Infallible;

    fn drive(&mut self, command: f32) -> Result<f32, Self::Error> {
        COMMAND.store(command.to_bits(), Ordering::Relaxed);
        Ok(command)
    }
}
