//! The whole position loop as a row of the counts: it gets what a loop on the simulated drive got.

use trendid::hardware::{Axis, PositionSensor, Scale, Valve};
use trendid::servo::{self, ServoLoop, Travel};

use trendid_example_support::drive::{Drive, SimulatedValve};
use trendid_example_support::random::Random;

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

/// Samples between two changes of the mass.
const LOADED: usize = 3000;

/// Codes of the drive under a loop of its own, and its moves.
///
/// When a move is asked for and where to is drawn at random: at rest, in motion, in every sample
/// for a while. A drive with `loads` moves three times its mass, and its own again: models are
/// compared, and the better one replaces the one in use.
pub(crate) fn motion(
    leader: &mut Servo<SimulatedValve>,
    samples: usize,
    loads: bool,
) -> impl Iterator<Item = ((i32, Option<f32>), f32)> {
    let mut drive = Drive::new(ORIGIN);
    let mut random = Random::new(1);
    let mut draw = move || random.unit();
    let (mut pause, mut burst) = (1000.0_f32, 0.0_f32);
    (0..samples).map(move |k| {
        if loads && k % LOADED == LOADED - 1 {
            drive.set_mass(if (k / LOADED).is_multiple_of(2) {
                3.0
            } else {
                1.0
            });
        }
        let code = drive.counts().unwrap_or(ORIGIN);
        leader.sensor_mut().code = code;
        let target = (pause < 1.0).then(|| 100.0 + 200.0 * draw());
        if let Some(target) = target {
            let _ = leader.move_to(target);
            burst -= 1.0;
            if burst < 0.0 {
                pause = 600.0 * draw() * draw();
                burst = 50.0 * (4.0 * draw() - 3.0);
            }
        } else {
            pause -= 1.0;
        }
        let _ = leader.update();
        ((code, target), 0.0)
    })
}
