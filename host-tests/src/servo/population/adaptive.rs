//! The loop of the core on the bench: commissioning from power-up, then a positioner.
//!
//! Its user states sample time, travel, sensor, and limits of motion that the drive can carry out;
//! nothing else is known: no bandwidth, no delay, no noise, no wiring. After a refusal he
//! commissions again from where the axis stands, until [`PATIENCE`] is over.

use trendid::hardware::{Axis, Scale};
use trendid::servo::{
    self, FaultCounters, Model, MotionLimits, Reason, Report, ServoLoop, State, Travel,
};

use crate::servo::population::bench::Bench;
use crate::servo::population::draw::AxisDraw;
use crate::servo::population::sequence::{Positioner, Sample};
use crate::servo::rig::{SimulatedSensor, SimulatedValve};

/// Time from power-up after which a user gives up \[s\].
pub const PATIENCE: f64 = 6.0;

/// Pause between a refusal and the next commissioning \[s\].
const PAUSE: f64 = 0.2;

/// Unit in which positions are stated \[mm\]: accelerations of any axis are then within what the
/// loop takes.
const UNIT_MM: f64 = 100.0;

/// The loop with the unit of its positions.
#[derive(Debug)]
pub struct LoopPositioner {
    servo: ServoLoop<SimulatedSensor, SimulatedValve>,
    unit_mm: f64,
    target_mm: f64,
    stopped: Option<Reason>,
    /// What the monitors counted until the latest sample.
    faults: Option<FaultCounters>,
    /// The samples, where they are kept.
    samples: Option<Vec<Seen>>,
}

/// One sample of the loop, in mm.
#[derive(Clone, Debug)]
pub struct Seen {
    /// What the loop reported.
    pub report: Report,
    /// Measured position.
    pub position_mm: f64,
    /// Wanted position.
    pub reference_mm: f64,
    /// Velocity gain, natural frequency and damping of the model in use.
    pub used: Option<[f64; 3]>,
}

/// What came of a commissioning.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Commissioned {
    /// Refusals with whether the valve was connected the wrong way round at the time.
    pub refusals: Vec<(Reason, bool)>,
    /// Time from power-up to control \[s\].
    pub verified_s: Option<f64>,
    /// Velocity gain \[mm/s\] and natural frequency \[rad/s\] of the accepted model, over those of
    /// the axis in the middle.
    pub ratios: Option<[f64; 2]>,
    /// Errors of the dead zone and of the offset of the valve, and of its delay \[s\].
    pub valve_errors: Option<[f64; 3]>,
    /// Whether a model was accepted with the other sign than that of the wiring.
    pub wrong_sign: bool,
}

/// What the user of an axis states, in units of `unit_mm`.
pub fn stated(axis: &AxisDraw, unit_mm: f64) -> servo::Config {
    let travel = Travel {
        min: 0.0,
        max: (axis.stroke_mm() / unit_mm) as f32,
    };
    let mut config = servo::Config::minimal(axis.sample_time as f32, travel);
    let limits = axis.limits();
    config.motion = Some(MotionLimits {
        velocity: (limits.velocity / unit_mm) as f32,
        acceleration: (limits.acceleration / unit_mm) as f32,
        jerk: (limits.jerk / unit_mm) as f32,
    });
    config
}

impl LoopPositioner {
    /// The loop with the settings that the user of an axis knows.
    ///
    /// # Errors
    /// What the loop says to its settings.
    pub fn new(axis: &AxisDraw, adaptive: bool) -> Result<Self, servo::Error> {
        Self::knowing(axis, adaptive, None)
    }

    /// The same, of a user who states how stiff the axis is near its ends: the dead volume of a
    /// chamber over that of the stroke.
    ///
    /// # Errors
    /// What the loop says to its settings.
    pub fn knowing(
        axis: &AxisDraw,
        adaptive: bool,
        dead_volume: Option<f32>,
    ) -> Result<Self, servo::Error> {
        let unit_mm = UNIT_MM;
        let Some(scale) = Scale::new((axis.resolution_mm / unit_mm) as f32) else {
            panic!("resolution {} mm", axis.resolution_mm);
        };
        let sensor = Axis {
            scale,
            reference: 0,
        };
        let mut config = stated(axis, unit_mm);
        config.adaptive = adaptive;
        config.controller.dead_volume = dead_volume;
        let (sensor_of, valve) = (SimulatedSensor::default(), SimulatedValve);
        Ok(Self {
            servo: ServoLoop::try_new(&config, sensor, sensor_of, valve)?,
            unit_mm,
            target_mm: 0.0,
            stopped: None,
            faults: None,
            samples: None,
        })
    }

    /// Keeps its samples from now on.
    pub fn remember(&mut self) {
        self.samples = Some(Vec::new());
    }

    /// The samples that were kept.
    pub fn remembered(self) -> Vec<Seen> {
        self.samples.unwrap_or_default()
    }

    /// One sample of the loop.
    fn sample(&mut self, code: i32) -> Report {
        self.servo.sensor_mut().code = Some(code);
        let report = self.servo.update();
        self.faults = Some(report.faults);
        if let Some(samples) = &mut self.samples {
            let used = self.servo.supervisor().verified_model().map(|m| {
                let (a1, a2, b0) = (f64::from(m.a1), f64::from(m.a2), f64::from(m.b0));
                [self.unit_mm * b0 / a1, a1.sqrt(), 0.5 * a2 / a1.sqrt()]
            });
            samples.push(Seen {
                report: report.clone(),
                position_mm: self.unit_mm * f64::from(report.position),
                reference_mm: self.unit_mm * f64::from(report.setpoint.position),
                used,
            });
        }
        report
    }

    /// The loop.
    pub fn servo(&self) -> &ServoLoop<SimulatedSensor, SimulatedValve> {
        &self.servo
    }

    /// Why the loop stopped the axis in control.
    pub fn stopped(&self) -> Option<Reason> {
        self.stopped
    }

    /// What the monitors counted; `None` before the first sample.
    pub fn faults(&self) -> Option<FaultCounters> {
        self.faults
    }

    /// Commissions from power-up until the loop controls or the user gives up.
    pub fn commission(&mut self, bench: &mut Bench) -> Commissioned {
        let mut done = Commissioned::default();
        self.servo.commission();
        let mut next = f64::INFINITY;
        while bench.time() < PATIENCE {
            let report = self.sample(bench.code());
            match report.state {
                State::Failed(reason) if next.is_infinite() => {
                    done.refusals.push((reason, bench.reversed));
                    next = bench.time() + PAUSE;
                }
                State::Failed(_) if bench.time() >= next => {
                    self.servo.commission();
                    next = f64::INFINITY;
                }
                state if state.is_controlling() => {
                    done.verified_s = Some(bench.time());
                    done.wrong_sign = (self.servo.sign() < 0.0) != bench.reversed;
                    let model = self.servo.supervisor().verified_model();
                    done.ratios = model.map(|m| self.ratios(&m, bench.axis()));
                    done.valve_errors = model.map(|m| self.valve_errors(&m, bench.axis()));
                    bench.hold(f64::from(report.command));
                    return done;
                }
                _ => {}
            }
            bench.hold(f64::from(report.command));
        }
        self.servo.abort();
        done
    }

    fn valve_errors(&self, model: &Model, axis: &AxisDraw) -> [f64; 3] {
        let [dead_zone, offset] = axis.valve_null();
        [
            f64::from(model.dead_zone) - dead_zone,
            f64::from(model.offset) - offset,
            f64::from(self.servo.delay()) - axis.delay(),
        ]
    }

    /// Velocity gain and natural frequency of a model over those of the axis, both in the middle of
    /// the travel.
    fn ratios(&self, model: &Model, axis: &AxisDraw) -> [f64; 2] {
        let [gain, omega0, _] = axis.truth(0.5 * axis.stroke_mm());
        let a1 = f64::from(model.a1);
        let found = self.unit_mm * f64::from(model.b0) / a1;
        [found / gain, a1.sqrt() / omega0]
    }
}

impl Positioner for LoopPositioner {
    fn move_to(&mut self, target_mm: f64) {
        self.target_mm = target_mm;
        // A refusal leaves the reference where it is; the sequence then finds that it does not
        // arrive.
        let _ = self.servo.move_to((target_mm / self.unit_mm) as f32);
    }

    fn oscillate(&mut self, amplitude_mm: f64, frequency_hz: f64) -> bool {
        let amplitude = (amplitude_mm / self.unit_mm) as f32;
        self.servo.oscillate(amplitude, frequency_hz as f32).is_ok()
    }

    fn update(&mut self, code: i32) -> Sample {
        let report = self.sample(code);
        if let State::Failed(reason) = report.state {
            self.stopped.get_or_insert(reason);
        }
        let reference_mm = self.unit_mm * f64::from(report.setpoint.position);
        Sample {
            reference_mm,
            resting: report.setpoint.is_rest() && (reference_mm - self.target_mm).abs() < 1e-2,
            command: f64::from(report.command),
            alive: report.state.is_controlling(),
            moves_at_rest: report.faults.moves_at_rest,
        }
    }
}
