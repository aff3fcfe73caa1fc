//! The whole position loop as a row of the counts: it gets what a loop on the simulated drive got.

use trendid::hardware::{Axis, PositionSensor, Scale, Valve};
use trendid::servo::{self, ServoLoop, Travel};

use trendid_example_support::drive::{Drive, SimulatedValve};

/// The whole position loop, from the code of the encoder to the command of the valve.
pub(crate) type Servo<V> = ServoLoop<Code, V>;

/// An encoder that gives the code it was set to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Code {
    pub code: i32,
}

impl PositionSensor for Code {
    type Error = core::convert::Infallible;

    fn counts(&mut self) -> Result<i32, Self::Error> {
        Ok(self.code)
    }
}

/// A valve that moves nothing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Still;

impl Valve for Still {
    type Error = core::convert::Infallible;

    fn drive(&mut self, command: f32) -> Result<f32, Self::Error> {
        Ok(command)
    }
}

/// Code of the encoder at the begin of the travel.
pub(crate) const ORIGIN: i32 = 8_000_000;

/// A loop on the simulated drive of 20 rad/s and 400 mm, about to commission itself.
pub(crate) fn servo<V: Valve>(valve: V) -> Result<Servo<V>, servo::Error> {
    let axis = Axis {
        scale: const { Scale::new(0.005).unwrap() },
        reference: ORIGIN,
    };
    let travel = Travel {
        min: 0.0,
        max: 400.0,
    };
    let config = servo::Config::new(1e-3, 20.0, travel);
    let mut servo = ServoLoop::try_new(&config, axis, Code { code: ORIGIN }, valve)?;
    servo.commission();
    Ok(servo)
}

/// The target of a sample: every second a move that is asked for at rest, another one 0.15 s into
/// its motion, and from 0.2 to 0.25 s a new one in every sample.
fn target(k: usize) -> Option<f32> {
    let there = if (k / 1000).is_multiple_of(2) {
        250.0
    } else {
        150.0
    };
    match k % 1000 {
        999 => Some(there),
        149 if k > 1000 => Some(200.0),
        burst @ 200..250 if k > 1000 => Some(200.0 + burst as f32 - 200.0),
        _ => None,
    }
}

/// Codes of the drive under a loop of its own, and its moves.
pub(crate) fn motion(
    leader: &mut Servo<SimulatedValve>,
    samples: usize,
) -> impl Iterator<Item = ((i32, Option<f32>), f32)> {
    let mut drive = Drive::new(ORIGIN);
    (0..samples).map(move |k| {
        let code = drive.counts().unwrap_or(ORIGIN);
        leader.sensor_mut().code = code;
        if let Some(target) = target(k) {
            let _ = leader.move_to(target);
        }
        let _ = leader.update();
        ((code, target(k)), 0.0)
    })
}
