//! A position loop on a drive, and what must hold in every sample.

use trendid::hardware::{Axis, PositionSensor, Valve};
use trendid::servo::{Config, Report, ServoLoop, Travel};

use crate::bytes::Bytes;

/// The reading that comes next.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sensor(Option<i32>);

impl PositionSensor for Sensor {
    type Error = ();

    fn counts(&mut self) -> Result<i32, ()> {
        self.0.ok_or(())
    }
}

/// A valve that notes what it was asked for.
#[derive(Clone, Debug, Default)]
pub(crate) struct Probe {
    asked: Option<f32>,
    fails: bool,
}

impl Valve for Probe {
    type Error = ();

    fn drive(&mut self, command: f32) -> Result<f32, ()> {
        self.asked = Some(command);
        if self.fails { Err(()) } else { Ok(command) }
    }
}

pub(crate) type Loop = ServoLoop<Sensor, Probe>;

/// A drive that is quick to simulate: dead zone, velocity of second order with a damping of 0.5,
/// ends of the travel.
#[derive(Clone)]
pub(crate) struct Drive {
    position: f32,
    velocity: f32,
    /// What drives the velocity.
    thrust: f32,
    pub(crate) gain: f32,
    /// Natural frequency in rad per sample.
    pub(crate) share: f32,
    pub(crate) dead_zone: f32,
    ends: [f32; 2],
}

impl Drive {
    fn step(&mut self, command: f32, sample_time: f32) {
        let flow = if command.abs() > self.dead_zone {
            command - self.dead_zone * command.signum()
        } else {
            0.0
        };
        self.thrust += self.share * (self.gain * flow - self.velocity - self.thrust);
        self.velocity += self.share * self.thrust;
        self.position += sample_time * self.velocity;
        let inside = self.position.clamp(self.ends[0], self.ends[1]);
        if inside != self.position {
            (self.position, self.velocity, self.thrust) = (inside, 0.0, 0.0);
        }
    }
}

/// Where the last command stood, and what is allowed from there.
#[derive(Clone)]
pub(crate) struct Watch {
    range: f32,
    step: f32,
    pub(crate) travel: Travel,
    last: f32,
    /// Whether the last command reached the valve.
    known: bool,
    /// How far the setpoint or the measured position was outside of the travel.
    outside: f32,
}

impl Watch {
    fn look(&mut self, report: &Report, asked: Option<f32>, failed: bool) {
        let asked = asked.expect("every sample drives the valve");
        assert!(asked.is_finite(), "the command is {asked}");
        // Half a unit in the last place of the limits.
        assert!(
            asked.abs() <= self.range * (1.0 + 1e-6),
            "{asked} of {}",
            self.range
        );
        let step = (asked - self.last).abs();
        assert!(
            !self.known || step <= self.step * (1.0 + 1e-5) + 1e-6,
            "a step of {step}, {} allowed",
            self.step
        );
        (self.last, self.known) = (asked, !failed);
        let setpoint = &report.setpoint;
        for number in [
            report.position,
            report.command,
            report.innovation.unwrap_or(0.0),
            setpoint.position,
            setpoint.velocity,
            setpoint.acceleration,
            setpoint.jerk,
        ] {
            assert!(number.is_finite(), "{report:?}");
        }
        // An axis that control finds outside of its travel may stay there, and come back. A
        // reference that begins is where the axis was in the sample before.
        if report.state.is_controlling() {
            let Travel { min, max } = self.travel;
            let slack = 1e-3 * (max - min);
            let outside = (min - setpoint.position).max(setpoint.position - max);
            let beyond = (min - report.position).max(report.position - max).max(0.0);
            assert!(
                outside <= beyond.max(self.outside) + slack,
                "setpoint {} of {min} to {max}",
                setpoint.position
            );
            self.outside = outside.max(beyond);
        } else {
            self.outside = f32::INFINITY;
        }
    }
}

/// A loop on its drive, and what is demanded of it.
#[derive(Clone)]
pub(crate) struct Bench {
    pub(crate) servo: Loop,
    pub(crate) axis: Axis,
    pub(crate) drive: Drive,
    pub(crate) watch: Watch,
    sample_time: f32,
    pub(crate) length: f32,
    /// State of the noise of the code.
    noise: u32,
}

impl Bench {
    /// A loop that was just built; none where the settings are refused.
    pub(crate) fn try_new(config: &Config, axis: Axis, bytes: &mut Bytes<'_>) -> Option<Self> {
        let servo = Loop::try_new(config, axis, Sensor::default(), Probe::default()).ok()?;
        let Travel { min, max } = config.travel;
        let length = max - min;
        let drive = Drive {
            position: min + length * (0.5 + 0.5 * bytes.share()),
            velocity: 0.0,
            thrust: 0.0,
            gain: 6.0 * length * bytes.share(),
            share: 0.02 * bytes.decades(1.0).min(50.0),
            dead_zone: 0.1 * bytes.share().abs(),
            ends: [min - 0.1 * length, max + 0.1 * length],
        };
        let watch = Watch {
            range: config.range,
            step: config.rate * config.sample_time,
            travel: config.travel,
            last: 0.0,
            known: true,
            outside: f32::INFINITY,
        };
        Some(Self {
            servo,
            axis,
            drive,
            watch,
            sample_time: config.sample_time,
            length,
            noise: 1,
        })
    }

    /// One sample of drive and loop.
    pub(crate) fn step(&mut self, fault: Fault) {
        self.drive.step(self.watch.last, self.sample_time);
        let code = (self.drive.position / self.axis.scale.units(1)) as i32;
        // A code that never changes is a fault: three codes, by a linear congruence.
        self.noise = self
            .noise
            .wrapping_mul(1_664_525)
            .wrapping_add(1_013_904_223);
        let code = code.saturating_add((self.noise >> 24) as i32 % 3 - 1);
        self.servo.sensor_mut().0 = fault.reading(code);
        self.servo.valve_mut().fails = fault == Fault::Valve;
        self.servo.valve_mut().asked = None;
        let report = self.servo.update();
        let asked = self.servo.valve_mut().asked;
        self.watch.look(&report, asked, fault == Fault::Valve);
    }
}

/// What is wrong with the sensor or the valve for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fault {
    None,
    Silent,
    Stuck(i32),
    Any(i32),
    Away(i32),
    Mirrored,
    Valve,
}

impl Fault {
    pub(crate) fn of(bytes: &mut Bytes<'_>, axis: Axis, length: f32) -> Self {
        match bytes.choice(6) {
            0 => Self::Silent,
            1 => Self::Stuck((length * bytes.share() / axis.scale.units(1)) as i32),
            2 => Self::Any(i32::from_le_bytes(bytes.take())),
            3 => Self::Away((length * bytes.share() / axis.scale.units(1)) as i32),
            4 => Self::Mirrored,
            _ => Self::Valve,
        }
    }

    const fn reading(self, code: i32) -> Option<i32> {
        match self {
            Self::None | Self::Valve => Some(code),
            Self::Silent => None,
            Self::Stuck(code) | Self::Any(code) => Some(code),
            Self::Away(offset) => Some(code.wrapping_add(offset)),
            Self::Mirrored => Some(code.wrapping_neg()),
        }
    }
}
