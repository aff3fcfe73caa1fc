//! Any sensor, any request, any setting of the position loop.
//!
//! The first byte chooses where a run begins: with settings from the bytes, or in one of the
//! situations of a usual axis that take seconds to come to (`START`). Those are simulated once
//! and copied, so that most bytes are spent on what happens there.

use std::sync::LazyLock;

use trendid::hardware::{Axis, PositionSensor, Scale, Valve};
use trendid::servo::store::Record;
use trendid::servo::{Config, Report, ServoLoop, Travel};

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

/// A drive that is quick to simulate: dead zone, velocity of second order with a damping of 0.5,
/// ends of the travel.
#[derive(Clone)]
struct Drive {
    position: f32,
    velocity: f32,
    /// What drives the velocity.
    thrust: f32,
    gain: f32,
    /// Natural frequency in rad per sample.
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

/// A loop on its drive, and what is demanded of it.
#[derive(Clone)]
struct Bench {
    servo: Loop,
    axis: Axis,
    drive: Drive,
    watch: Watch,
    sample_time: f32,
    length: f32,
    /// State of the noise of the code.
    noise: u32,
}

impl Bench {
    /// A loop that was just built; none where the settings are refused.
    fn try_new(config: &Config, axis: Axis, bytes: &mut Bytes<'_>) -> Option<Self> {
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
    fn step(&mut self, fault: Fault) {
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

/// Situations of one axis, each from a simulation that is the same every time: a commissioning at
/// some of its seconds, then control at rest, in a move, in a sine, with a slower and a quicker
/// drive, behind a fault.
static START: LazyLock<Vec<Bench>> = LazyLock::new(|| {
    let travel = Travel {
        min: 0.0,
        max: 400.0,
    };
    let axis = Axis {
        scale: Scale::new(0.005).expect("a scale"),
        reference: 0,
    };
    let config = Config::minimal(1e-3, travel);
    let mut bench = Bench::try_new(&config, axis, &mut Bytes::new(&[])).expect("usual settings");
    bench.drive.gain = 1500.0;
    bench.drive.dead_zone = 0.02;
    let mut found = vec![bench.clone()];
    let run = |bench: &mut Bench, samples: u32| {
        for _ in 0..samples {
            bench.step(Fault::None);
        }
    };
    bench.servo.commission();
    for _ in 0..60 {
        run(&mut bench, 250);
        if bench.servo.supervisor().state().is_controlling() {
            break;
        }
        found.push(bench.clone());
    }
    assert!(
        bench.servo.supervisor().state().is_controlling(),
        "{:?}",
        bench.servo.supervisor().state()
    );
    run(&mut bench, 1000);
    found.push(bench.clone());
    bench.servo.move_to(300.0).expect("a target");
    for samples in [20, 80, 200, 1500] {
        run(&mut bench, samples);
        found.push(bench.clone());
    }
    bench.servo.oscillate(20.0, 0.5).expect("a sine");
    run(&mut bench, 1300);
    found.push(bench.clone());
    for factor in [0.4, 5.0] {
        bench.drive.share *= factor;
        run(&mut bench, 700);
        found.push(bench.clone());
    }
    for fault in [Fault::Silent, Fault::Mirrored, Fault::Valve] {
        let mut stopped = bench.clone();
        for _ in 0..60 {
            stopped.step(fault);
        }
        found.push(stopped);
    }
    found
});

/// Runs what the bytes say.
///
/// # Panics
/// When something does not hold.
pub fn run(bytes: &[u8]) {
    let mut bytes = Bytes::new(bytes);
    let begin = usize::from(bytes.byte());
    // An eighth of the first bytes: with settings of their own.
    let mut bench = if begin < 32 {
        let (config, axis) = settings(&mut bytes);
        let Some(bench) = Bench::try_new(&config, axis, &mut bytes) else {
            return;
        };
        bench
    } else {
        START[begin % START.len()].clone()
    };
    let mut samples = 0_u32;
    while !bytes.is_empty() && samples < 20_000 {
        let mut fault = Fault::None;
        let count = match bytes.byte() {
            0..=79 => 1,
            80..=153 => u32::from(bytes.byte()) / 16,
            154..=157 => u32::from(bytes.byte()),
            158..=159 => 16 * u32::from(bytes.byte()),
            160..=199 => {
                fault = Fault::of(&mut bytes, bench.axis, bench.length);
                let count = u32::from(bytes.byte());
                if count < 224 { 1 + count / 16 } else { count }
            }
            _ => {
                let (length, min) = (bench.length, bench.watch.travel.min);
                request(&mut bench.servo, &mut bytes, length, min);
                1
            }
        };
        for _ in 0..count {
            samples += 1;
            bench.step(fault);
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
