//! A drive that is its own model, and the loop on it.

use crate::hardware::{Axis, PositionSensor, Scale, Valve};
use crate::servo::motion::Motion;
use crate::servo::store::Record;
use crate::servo::{Config, Model, Report, ServoLoop, Travel};

/// Units per count.
pub(in crate::servo) const SCALE: f32 = 1e-4;

/// The code of the axis; [`MUTE`] for a reading that fails.
#[derive(Clone, Debug)]
pub(in crate::servo) struct Code(pub(in crate::servo) i32);

impl PositionSensor for Code {
    type Error = ();

    fn counts(&mut self) -> Result<i32, ()> {
        if self.0 == MUTE { Err(()) } else { Ok(self.0) }
    }
}

/// The code of no reading.
pub(in crate::servo) const MUTE: i32 = i32::MIN;

/// A valve that takes every command.
#[derive(Clone, Debug)]
pub(in crate::servo) struct Spool(pub(in crate::servo) f32);

impl Valve for Spool {
    type Error = ();

    fn drive(&mut self, command: f32) -> Result<f32, ()> {
        self.0 = command;
        Ok(command)
    }
}

/// Position 0 at code 0.
pub(in crate::servo) fn axis() -> Axis {
    Axis {
        scale: Scale::new(SCALE).expect("a scale"),
        reference: 0,
    }
}

pub(in crate::servo) type Loop = ServoLoop<Code, Spool>;

pub(in crate::servo) const MODEL: Model = Model::linear(625.0, 20.0, 1e6);
pub(in crate::servo) const DELAY: usize = 3;

/// What a commissioning of this drive finds.
pub(in crate::servo) const RECORD: Record = Record {
    model: MODEL,
    std: [f32::INFINITY; 6],
    delay: 1e-3 * DELAY as f32,
    sign: 1.0,
    noise: 2e-4,
    dead_volume: f32::INFINITY,
    imbalance: 0.0,
};

/// A drive that is the model, behind a delay, and the loop on it.
pub(in crate::servo) struct Bench {
    pub(in crate::servo) servo: Loop,
    pub(in crate::servo) model: Model,
    pub(in crate::servo) motion: Motion,
    /// Sign of the valve.
    pub(in crate::servo) sign: f32,
    /// Whether the sensor says nothing.
    pub(in crate::servo) is_mute: bool,
    /// Whether the sensor repeats its code.
    pub(in crate::servo) hangs: bool,
    commands: [f32; DELAY + 1],
    state: u32,
}

impl Bench {
    /// Settings for this drive.
    pub(in crate::servo) fn config() -> Config {
        let travel = Travel {
            min: 0.0,
            max: 400.0,
        };
        let mut config = Config::new(1e-3, 25.0, travel);
        config.delay = 1e-3 * DELAY as f32;
        config.adaptive = false;
        config.noise = Some(2e-4);
        config.controller.dead_volume = Some(f32::INFINITY);
        config
    }

    /// Settings that leave to the commissioning what it finds.
    pub(in crate::servo) fn untold() -> Config {
        let mut config = Self::config();
        (config.bandwidth, config.delay, config.noise) = (None, 0.0, None);
        config
    }

    /// Stands at 200 of 400 on a verified model.
    pub(in crate::servo) fn new(model: Model) -> Self {
        let mut bench = Self::without_a_model(model, &Self::config());
        let servo = &mut bench.servo;
        servo.install(model).expect("a model that may control");
        bench
    }

    /// The same of a loop that adapts, 1.5 s later.
    pub(in crate::servo) fn adaptive(model: Model) -> Self {
        let mut config = Self::config();
        config.adaptive = true;
        let mut bench = Self::without_a_model(model, &config);
        let servo = &mut bench.servo;
        servo.install(model).expect("a model that may control");
        let _ = bench.worst(1500);
        bench
    }

    /// Stands at 200 of 400, and nothing is known of the drive.
    pub(in crate::servo) fn without_a_model(model: Model, config: &Config) -> Self {
        let code = (200.0 / SCALE) as i32;
        let servo = Loop::try_new(config, axis(), Code(code), Spool(0.0));
        let mut servo = servo.expect("settings");
        let _ = servo.update();
        Self {
            servo,
            model,
            motion: Motion::at(200.0),
            sign: 1.0,
            is_mute: false,
            hangs: false,
            commands: [0.0; DELAY + 1],
            state: 1,
        }
    }

    /// One sample; the report and the true position.
    pub(in crate::servo) fn step(&mut self) -> (Report, f32) {
        self.state = self
            .state
            .wrapping_mul(1_664_525)
            .wrapping_add(1_013_904_223);
        let noise = (self.state >> 30) as i32 - 1;
        let code = libm::roundf(self.motion.position / SCALE) as i32 + noise;
        if !self.hangs {
            self.servo.sensor_mut().0 = if self.is_mute { MUTE } else { code };
        }
        let report = self.servo.update();
        (report, self.advance())
    }

    /// One sample in which the loop was not called; the true position.
    pub(in crate::servo) fn miss(&mut self) -> f32 {
        self.servo.skip(1);
        self.advance()
    }

    /// The drive for a sample under the newest command; where it was.
    fn advance(&mut self) -> f32 {
        self.commands.rotate_right(1);
        self.commands[0] = self.servo.valve_mut().0;
        let flow = self.model.valve_flow(self.sign * self.commands[DELAY]);
        let before = self.motion.position;
        self.model.advance(&mut self.motion, flow, 1e-3);
        before
    }

    /// The largest error of the position in so many samples.
    pub(in crate::servo) fn worst(&mut self, samples: u32) -> f32 {
        (0..samples).fold(0.0_f32, |worst, _| {
            let (report, y) = self.step();
            assert!(report.state.is_controlling(), "{:?}", report.state);
            worst.max((report.setpoint.position - y).abs())
        })
    }
}
