//! An axis of the population under a loop, with a fault between them.

use rand::RngExt;
use trendid::hardware::{Axis, Scale, Valve};
use trendid::servo::{self, Model, MotionLimits, Report, ServoLoop, Travel};

use crate::plants::pneumatic::Fault as Defect;
use crate::servo::faults::fault::Fault;
use crate::servo::population::adaptive::{PATIENCE, stated};
use crate::servo::population::bench::Bench;
use crate::servo::population::draw::{AxisDraw, Mechanics};
use crate::servo::population::range::{Purpose, stream};
use crate::servo::rig::SimulatedSensor;

/// A valve that can refuse its commands.
#[derive(Clone, Copy, Debug, Default)]
pub struct FailingValve {
    /// Whether it refuses.
    pub fails: bool,
}

impl Valve for FailingValve {
    type Error = ();

    fn drive(&mut self, command: f32) -> Result<f32, ()> {
        if self.fails { Err(()) } else { Ok(command) }
    }
}

/// Time in s after which an axis is controlled, or the loop does not take it.
const AWAITED: f64 = 0.5;
/// Period of the spikes in samples.
const SPIKES_EVERY: u32 = 100;

/// An axis with its loop.
#[derive(Clone, Debug)]
pub struct Machine {
    /// The axis.
    pub bench: Bench,
    /// The loop.
    pub servo: ServoLoop<SimulatedSensor, FailingValve>,
    fault: Option<Fault>,
    /// Samples since the fault, the code that it had then, and the opening command.
    since: u32,
    code: i32,
    command: f64,
    seed: u64,
}

/// A model as a commissioning finds it: gain within 10 %, natural frequency within 5 %, dead
/// zone 0.01, offset 0.005.
fn model(axis: &AxisDraw) -> Model {
    let mut random = stream(axis.seed, Purpose::Knowledge);
    let mut about = |part: f64| 1.0 + part * (2.0 * random.random::<f64>() - 1.0);
    let [gain, omega0, xi] = axis.truth(0.5 * axis.stroke_mm());
    let [dead_zone, offset] = axis.valve_null();
    let w = omega0 * about(0.05);
    let coulomb = match &axis.mechanics {
        Mechanics::Pneumatic(p) => 1e3 * p.friction.coulomb / p.mass,
        Mechanics::ThirdOrder(p) => p.friction.coulomb,
    };
    Model {
        dead_zone: (dead_zone + about(0.01) - 1.0).max(0.0) as f32,
        offset: (offset + about(0.005) - 1.0) as f32,
        friction: (coulomb * about(0.2)) as f32,
        ..Model::linear(
            (w * w) as f32,
            (2.0 * xi * w) as f32,
            (w * w * gain * about(0.1)) as f32,
        )
    }
}

impl Machine {
    /// An axis at rest under a loop that waits; `None` where the loop refuses its settings or its
    /// model.
    pub fn new(axis: &AxisDraw, adaptive: bool, installed: bool) -> Option<Self> {
        let limits = axis.limits();
        let [_, omega0, _] = axis.truth(0.5 * axis.stroke_mm());
        let travel = Travel {
            min: 0.0,
            max: axis.stroke_mm() as f32,
        };
        let mut config = servo::Config::new(axis.sample_time as f32, omega0 as f32, travel);
        config.noise = Some(axis.sigma_mm() as f32);
        config.delay = axis.delay().min(40.0 * axis.sample_time) as f32;
        config.motion = Some(MotionLimits {
            velocity: limits.velocity as f32,
            acceleration: limits.acceleration as f32,
            jerk: limits.jerk as f32,
        });
        config.adaptive = adaptive;
        if let Mechanics::ThirdOrder(_) = axis.mechanics {
            // As stiff at the ends as in the middle.
            config.controller.dead_volume = Some(f32::INFINITY);
        }
        config.controller.imbalance = axis.imbalance() as f32;
        let mut machine = Self::with(axis, &config)?;
        machine.bench.reversed = false;
        if installed {
            machine.install(axis)?;
        }
        Some(machine)
    }

    /// An axis, wired either way, that a loop has commissioned whose user states sample time,
    /// travel and limits of motion, and tries again until [`PATIENCE`] is over; `None` where no
    /// model was found.
    pub fn commissioned(axis: &AxisDraw) -> Option<Self> {
        let mut machine = Self::with(axis, &stated(axis, 1.0))?;
        while machine.bench.time() < PATIENCE {
            machine.servo.commission();
            while machine.step().state.is_commissioning() {}
            if machine.servo.supervisor().state().is_controlling() {
                return Some(machine);
            }
        }
        None
    }

    /// An axis at rest under a loop with these settings.
    fn with(axis: &AxisDraw, config: &servo::Config) -> Option<Self> {
        let sensor = Axis {
            scale: Scale::new(axis.resolution_mm as f32)?,
            reference: 0,
        };
        let (code, valve) = (SimulatedSensor::default(), FailingValve::default());
        Some(Self {
            bench: Bench::new(axis, Purpose::Disturbance),
            servo: ServoLoop::try_new(config, sensor, code, valve).ok()?,
            fault: None,
            since: 0,
            code: 0,
            command: 0.0,
            seed: axis.seed,
        })
    }

    /// Installs a model behind the first reading; until the motion of the axis is known, the loop
    /// refuses to move it.
    fn install(&mut self, axis: &AxisDraw) -> Option<()> {
        let _ = self.step();
        self.servo.install(model(axis)).ok()?;
        let here = self.step().position;
        let end = self.bench.time() + AWAITED;
        while self.servo.move_to(here).is_err() && self.bench.time() < end {
            let _ = self.step();
        }
        Some(())
    }

    /// Brings a fault with the next sample.
    pub fn break_down(&mut self, fault: Fault) {
        self.fault = Some(fault);
        self.since = 0;
        self.code = self.bench.code();
        self.bench.blow_mm_s = 0.0;
        match fault {
            Fault::BlockedAxis => {
                if let Some(axis) = self.bench.pneumatic_mut() {
                    axis.set_fault(Some(Defect::BlockedAxis));
                }
            }
            Fault::LostSupply => {
                if let Some(axis) = self.bench.pneumatic_mut() {
                    axis.set_supply(0.05);
                }
            }
            _ => {}
        }
    }

    /// What the loop reads of a code.
    fn reading(&mut self, code: i32) -> Option<i32> {
        let quarter =
            (0.25 * self.bench.axis().stroke_mm() / self.bench.axis().resolution_mm) as i32;
        // Toward the middle, so that the position stays on the travel.
        let middle = (0.5 * self.bench.axis().stroke_mm() / self.bench.axis().resolution_mm) as i32;
        let off = if code < middle { quarter } else { -quarter };
        match self.fault {
            Some(Fault::LostReadings) => None,
            Some(Fault::GappyReadings) => (self.since.is_multiple_of(3)).then_some(code),
            Some(Fault::StuckCode) => Some(self.code),
            Some(Fault::ShortlyStuck) => {
                let samples = (0.1 / self.bench.axis().sample_time) as u32;
                Some(if self.since < samples {
                    self.code
                } else {
                    code
                })
            }
            Some(Fault::StuckValue) => {
                let true_code =
                    (self.bench.position_mm() / self.bench.axis().resolution_mm).round();
                Some(self.code + code - true_code as i32)
            }
            Some(Fault::SensorSign) => Some(2 * self.code - code),
            Some(Fault::Jump) => Some(code + self.jump(off)),
            Some(Fault::Spikes) if self.since.is_multiple_of(SPIKES_EVERY) => Some(code + off),
            _ => Some(code),
        }
    }

    /// The offset of a jump stays what it was at first.
    fn jump(&mut self, off: i32) -> i32 {
        if self.since == 0 {
            self.code = off;
        }
        self.code
    }

    /// What the valve makes of a command.
    fn opening(&mut self, command: f64) -> f64 {
        let [dead_zone, offset] = self.bench.axis().valve_null();
        match self.fault {
            Some(Fault::ClosedValve | Fault::FailedValve) => -offset,
            Some(Fault::StuckValve) => {
                // A spool that sticks, sticks where it works and not in the middle.
                let works = (self.command + offset).abs() > dead_zone + 0.05;
                if !works {
                    self.command = command;
                }
                self.command
            }
            Some(Fault::ReversedValve) => -command,
            _ => {
                self.command = command;
                command
            }
        }
    }

    /// One sample.
    pub fn step(&mut self) -> Report {
        let code = self.bench.code();
        self.servo.sensor_mut().code = self.reading(code);
        self.servo.valve_mut().fails = self.fault == Some(Fault::FailedValve);
        let report = self.servo.update();
        let opening = self.opening(f64::from(report.command));
        self.bench.hold(opening);
        self.since = self.since.saturating_add(1);
        report
    }

    /// Passes a time.
    pub fn pass(&mut self, seconds: f64) {
        let end = self.bench.time() + seconds;
        while self.bench.time() < end {
            let _ = self.step();
        }
    }

    /// Hardest blow within 2 s when the valve closes now: what physics makes of the present motion.
    /// Infinite for a valve that is stuck: it does not close.
    pub fn closing(&self) -> f64 {
        if self.fault == Some(Fault::StuckValve) {
            return f64::INFINITY;
        }
        let mut bench = self.bench.clone();
        bench.blow_mm_s = 0.0;
        // What the spool is told, whatever comes between it and the loop.
        let [_, offset] = bench.axis().valve_null();
        let end = bench.time() + 2.0;
        while bench.time() < end {
            bench.hold(-offset);
        }
        bench.blow_mm_s
    }

    /// The seed of the axis.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Whether the noise does not reach from code to code.
    pub fn is_silent(&self) -> bool {
        let axis = self.bench.axis();
        axis.noise_mm < 0.6 * axis.resolution_mm
    }
}
