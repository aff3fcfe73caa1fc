//! Any sensor, any request, any setting of the position loop.

use trendid::hardware::{Axis, PositionSensor, Valve};
use trendid::servo::store::Record;
use trendid::servo::{Report, ServoLoop, Travel};

use crate::bytes::Bytes;
use crate::servo_settings::{model, settings};

/// The reading that comes next.
#[derive(Clone, Debug, Default)]
struct Sensor(Option<i32>);

impl PositionSensor for Sensor {
    type Error = ();

    fn counts(&mut self) -> Result<i32, ()> {
        self.0.ok_or(())
    }
}

/// A valve that notes what it was asked for.
#[derive(Clone, Debug, Default)]
struct Probe {
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

type Loop = ServoLoop<Sensor, Probe>;

/// A drive that is quick to simulate: dead zone, first-order velocity, ends of the travel.
struct Drive {
    position: f32,
    velocity: f32,
    gain: f32,
    share: f32,
    dead_zone: f32,
    ends: [f32; 2],
}

impl Drive {
    fn step(&mut self, command: f32, sample_time: f32) {
        let flow = if command.abs() > self.dead_zone {
            command - self.dead_zone * command.signum()
        } else {
            0.0
        };
        self.velocity += self.share * (self.gain * flow - self.velocity);
        self.position += sample_time * self.velocity;
        let inside = self.position.clamp(self.ends[0], self.ends[1]);
        if inside != self.position {
            (self.position, self.velocity) = (inside, 0.0);
        }
    }
}

/// Where the last command stood, and what is allowed from there.
struct Watch {
    range: f32,
    step: f32,
    travel: Travel,
    last: f32,
    /// Whether the last command reached the valve.
    known: bool,
    /// How far the setpoint was outside of the travel.
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
        // An axis that control finds outside of its travel may stay there, and come back.
        if report.state.is_controlling() {
            let Travel { min, max } = self.travel;
            let slack = 1e-3 * (max - min);
            let outside = (min - setpoint.position).max(setpoint.position - max);
            let beyond = (min - report.position).max(report.position - max).max(0.0);
            assert!(
                outside <= beyond + slack || outside <= self.outside + slack,
                "setpoint {} of {min} to {max}",
                setpoint.position
            );
            self.outside = outside.max(0.0);
        } else {
            self.outside = f32::INFINITY;
        }
    }
}

/// Runs what the bytes say.
///
/// # Panics
/// When something does not hold.
pub fn run(bytes: &[u8]) {
    let mut bytes = Bytes::new(bytes);
    let (config, axis) = settings(&mut bytes);
    let Ok(mut servo) = Loop::try_new(&config, axis, Sensor::default(), Probe::default()) else {
        return;
    };
    let Travel { min, max } = config.travel;
    let length = max - min;
    let mut drive = Drive {
        position: min + length * (0.5 + 0.5 * bytes.share()),
        velocity: 0.0,
        gain: 6.0 * length * bytes.share(),
        share: 0.02 * bytes.decades(1.0).min(50.0),
        dead_zone: 0.1 * bytes.share().abs(),
        ends: [min - 0.1 * length, max + 0.1 * length],
    };
    let mut watch = Watch {
        range: config.range,
        step: config.rate * config.sample_time,
        travel: config.travel,
        last: 0.0,
        known: true,
        outside: f32::INFINITY,
    };
    let mut samples = 0_u32;
    while !bytes.is_empty() && samples < 20_000 {
        let mut fault = Fault::None;
        let count = match bytes.byte() {
            0..=79 => 1,
            80..=159 => 16 * u32::from(bytes.byte()),
            160..=199 => {
                fault = Fault::of(&mut bytes, axis, length);
                1 + u32::from(bytes.byte())
            }
            _ => {
                request(&mut servo, &mut bytes, length, min);
                1
            }
        };
        for _ in 0..count {
            samples += 1;
            drive.step(watch.last, config.sample_time);
            let code = (drive.position / axis.scale.units(1)) as i32;
            servo.sensor_mut().0 = fault.reading(code);
            servo.valve_mut().fails = fault == Fault::Valve;
            servo.valve_mut().asked = None;
            let report = servo.update();
            let asked = servo.valve_mut().asked;
            watch.look(&report, asked, fault == Fault::Valve);
        }
    }
}

/// What is wrong with the sensor or the valve for a while.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    Silent,
    Stuck(i32),
    Any(i32),
    Away(i32),
    Mirrored,
    Valve,
}

impl Fault {
    fn of(bytes: &mut Bytes<'_>, axis: Axis, length: f32) -> Self {
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

/// What a user may ask for; a refused request changes nothing.
fn request(servo: &mut Loop, bytes: &mut Bytes<'_>, length: f32, min: f32) {
    let kind = bytes.choice(10);
    let before = (bytes.byte() == 0).then(|| format!("{servo:?}"));
    let done = match kind {
        0..=2 => {
            servo.commission();
            Ok(())
        }
        3 => {
            servo.abort();
            Ok(())
        }
        4 => servo.move_to(bytes.any()),
        5 => servo.move_to(min + bytes.signal(length)),
        6 => servo.oscillate(bytes.signal(0.1 * length), bytes.signal(3.0)),
        7 => {
            servo.skip(u32::from(bytes.byte()) % 8);
            Ok(())
        }
        8 => servo.install(model(bytes, length)),
        _ => servo.resume(&Record {
            model: model(bytes, length),
            std: [1.0; 6],
            delay: bytes.signal(0.004),
            sign: bytes.signal(1.0).signum(),
            noise: bytes.signal(0.01),
            dead_volume: bytes.signal(0.5),
        }),
    };
    if let (Err(_), Some(before)) = (done, before) {
        assert_eq!(
            before,
            format!("{servo:?}"),
            "a refused request changed something"
        );
    }
}
