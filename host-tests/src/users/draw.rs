//! One user: its drive, its sensor, what it tells and what happens to it.
//!
//! All that has a range of more than a factor of two is even in its logarithm.

use rand::RngExt;

use crate::random::{Random, log_uniform};
use crate::signals::noise::numbered;
use crate::users::command::Command;
use crate::users::kind::Kind;

/// Sample time \[s\].
pub const SAMPLE_TIME: [f64; 2] = [0.25e-3, 10e-3];
/// Natural frequency, or the pole of a model that has no pair of them \[rad/s\].
pub const OMEGA: [f64; 2] = [2.0, 100.0];
/// Damping.
pub const DAMPING: [f64; 2] = [0.1, 1.2];
/// Bandwidth that is told over the natural frequency.
pub const BANDWIDTH: [f64; 2] = [0.4, 2.5];
/// Ranges and noise that are told over the true ones.
pub const TOLD: [f64; 2] = [0.1, 10.0];
/// Size of a command, in its unit.
pub const INPUT_UNIT: [f64; 2] = [1e-3, 1e3];
/// Size of a motion, in its unit.
pub const OUTPUT_UNIT: [f64; 2] = [1e-6, 1e6];
/// Static gain, or travel in 1/w, in sizes of motion and command.
pub const GAIN: [f64; 2] = [0.3, 1.5];
/// A zero over the natural frequency.
pub const ZERO: [f64; 2] = [0.5, 5.0];
/// The fourth pole over the natural frequency.
pub const POLE: [f64; 2] = [1.0, 4.0];
/// Length of a record in 1/w.
pub const LENGTH: [f64; 2] = [30.0, 300.0];
/// Samples of a record at least and at most, whatever its length.
pub const SAMPLES: [usize; 2] = [200, 60_000];
/// Standard deviation of the noise over the motion (rms about its mean), where there is noise.
pub const NOISE: [f64; 2] = [1e-4, 0.1];
/// Resolution of a sensor over the motion, where it is seen.
pub const RESOLUTION: [f64; 2] = [1e-5, 1e-2];
/// Place of the motion in motions (rms), where it is not at zero.
pub const PLACE: [f64; 2] = [1.0, 1e4];
/// Offset of the valve over the command, where there is one.
pub const OFFSET: [f64; 2] = [-0.1, 0.1];
/// Half width of the dead zone over the command.
pub const DEAD_ZONE: [f64; 2] = [0.01, 0.15];
/// Bandwidth that is told at last over the natural frequency, where it is told anew.
pub const RETUNED: [f64; 2] = [0.7, 1.5];
/// Memories \[s\], where there is one.
pub const MEMORIES: [f64; 3] = [0.5, 2.0, 10.0];

/// Streams of random numbers of a seed, beside those of the signals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub enum Purpose {
    /// The user.
    User = 6,
    /// Positions that are no numbers, and spikes.
    Interruptions = 7,
    /// Samples that are missed.
    Gaps = 8,
}

/// The stream of a purpose of a seed.
pub fn stream(seed: u64, purpose: Purpose) -> Random {
    numbered(seed, purpose as u64)
}

/// A sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Standard deviation of its white noise over the motion.
    pub noise: f64,
    /// Its resolution over the motion; 0 for one that is not seen.
    pub resolution: f64,
    /// Where the motion is, in motions.
    pub place: f64,
}

/// What the identifier is told, over the truth where there is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Told {
    /// Bandwidth over the natural frequency.
    pub bandwidth: f64,
    /// Range of the command over its rms.
    pub input_range: f64,
    /// Range of the output over its rms about the mean.
    pub output_range: f64,
    /// Noise over that of the record; `None` leaves what the identifier takes.
    pub noise: Option<f64>,
    /// Memory \[s\].
    pub memory: Option<f64>,
    /// Bandwidth over the natural frequency that is told after 25/w.
    pub retuned: Option<f64>,
}

/// What happens now and then.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interruptions {
    /// Samples are missed under the command of before: 0.2 to 6/w, every 20/w.
    pub gaps: bool,
    /// One position of 300 is no number.
    pub nans: bool,
    /// One position of 500 is off by up to three motions.
    pub spikes: bool,
}

/// A user.
#[derive(Clone, Debug, PartialEq)]
pub struct User {
    /// Its seed.
    pub seed: u64,
    /// Structure of the drive and of the model.
    pub kind: Kind,
    /// Sample time \[s\].
    pub sample_time: f64,
    /// Natural frequency w \[rad/s\].
    pub omega: f64,
    /// Damping.
    pub damping: f64,
    /// Denominator, ascending, monic.
    pub a: Vec<f64>,
    /// Numerator, ascending.
    pub b: Vec<f64>,
    /// Sizes of command and motion, in their units.
    pub sizes: [f64; 2],
    /// Offset of the valve over the command.
    pub offset: f64,
    /// Half width of its dead zone over the command.
    pub dead_zone: f64,
    /// How it is moved.
    pub command: Command,
    /// Where in its range the command lies, 0 to 1.
    pub pace: f64,
    /// Length of the record in samples.
    pub samples: usize,
    /// Its sensor.
    pub sensor: Sensor,
    /// What it tells.
    pub told: Told,
    /// What happens.
    pub interruptions: Interruptions,
}

/// Structures as often as they are drawn: the one to start with three times.
const DRAWN: [Kind; 2] = [Kind::Servo, Kind::Servo];

impl User {
    /// The user of a seed; of one kind only where it is given.
    pub fn of(seed: u64, kind: Option<Kind>) -> Self {
        let mut random = stream(seed, Purpose::User);
        let random = &mut random;
        let place = random.random_range(0..Kind::ALL.len() + DRAWN.len());
        let any = Kind::ALL.into_iter().chain(DRAWN).nth(place);
        let kind = kind.or(any).unwrap_or(Kind::Servo);
        let mut within = |[low, high]: [f64; 2]| log_uniform(random, low, high);
        let sample_time = within(SAMPLE_TIME);
        let (omega, damping) = (within(OMEGA), within(DAMPING));
        let sizes = [within(INPUT_UNIT), within(OUTPUT_UNIT)];
        let gain = within(GAIN) * sizes[1] / sizes[0];
        let further = [omega * within(ZERO), omega * within(POLE)];
        let (a, b) = kind.coefficients(omega, damping, gain, further);
        let length = within(LENGTH) / (omega * sample_time);
        let commands = Command::of(kind.integrates());
        Self {
            seed,
            kind,
            sample_time,
            omega,
            damping,
            a,
            b,
            sizes,
            samples: (length as usize).clamp(SAMPLES[0], SAMPLES[1]),
            command: commands[random.random_range(0..commands.len())],
            pace: random.random(),
            offset: valve_offset(kind, random),
            dead_zone: dead_zone(kind, random),
            sensor: Sensor::of(kind, random),
            told: Told::of(kind, random),
            interruptions: Interruptions {
                gaps: random.random_bool(0.1),
                nans: random.random_bool(0.1),
                spikes: random.random_bool(0.05),
            },
        }
    }

    /// w times the sample time.
    pub fn angle(&self) -> f64 {
        self.omega * self.sample_time
    }
}

fn valve_offset(kind: Kind, random: &mut Random) -> f64 {
    let drawn = random.random_range(OFFSET[0]..OFFSET[1]);
    let has = random.random_bool(0.3) && kind.has_offset();
    if has { drawn } else { 0.0 }
}

fn dead_zone(kind: Kind, random: &mut Random) -> f64 {
    let drawn = random.random_range(DEAD_ZONE[0]..DEAD_ZONE[1]);
    if kind == Kind::ServoDeadZone {
        drawn
    } else {
        0.0
    }
}

/// A value of the range, or 0 but in so many cases.
fn sometimes(random: &mut Random, share: f64, [low, high]: [f64; 2]) -> f64 {
    let drawn = log_uniform(random, low, high);
    if random.random_bool(share) {
        drawn
    } else {
        0.0
    }
}

impl Sensor {
    fn of(kind: Kind, random: &mut Random) -> Self {
        let place = sometimes(random, 0.2, PLACE);
        Self {
            noise: sometimes(random, 0.85, NOISE),
            resolution: sometimes(random, 0.25, RESOLUTION),
            place: if kind.integrates() { place } else { 0.0 },
        }
    }
}

impl Told {
    fn of(kind: Kind, random: &mut Random) -> Self {
        let factor = |random: &mut Random| log_uniform(random, TOLD[0], TOLD[1]);
        let memory = random.random_range(0..2 * MEMORIES.len());
        let memory = MEMORIES.get(memory).copied();
        let retuned = log_uniform(random, RETUNED[0], RETUNED[1]);
        Self {
            bandwidth: log_uniform(random, BANDWIDTH[0], BANDWIDTH[1]),
            input_range: factor(random),
            output_range: factor(random),
            noise: Some(factor(random)).filter(|_| random.random_bool(0.5)),
            // The estimate of a dead zone needs one.
            memory: match kind {
                Kind::ServoDeadZone => memory.or(Some(2.0)),
                _ => memory,
            },
            retuned: Some(retuned).filter(|_| random.random_bool(0.1)),
        }
    }
}
