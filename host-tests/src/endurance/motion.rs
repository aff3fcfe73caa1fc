//! Commands without end.

use crate::random::Random;
use rand::RngExt;

use crate::signals::noise::{Stream, generator};
use crate::signals::shift_register::ShiftRegister;

/// What the axis is asked to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// Binary noise of +-0.4, where two sizes are needed of +-0.2 and +-0.4.
    Binary,
    /// No command.
    Rest,
    /// A constant command; it turns where the position exceeds 10^7.
    Speed(f64),
    /// A sine.
    Sine {
        /// Of the command.
        amplitude: f64,
        /// Frequency in Hz.
        hz: f64,
    },
    /// 5 s of binary noise, then 195 s of rest.
    StopAndGo,
    /// Proportional feedback of the measured position to a reference that steps by at most 2 every
    /// 20 s.
    SmallSteps,
    /// A day in parts of one minute: binary noise, rest, speeds, sines, small steps.
    Day,
}

/// The parts of [`Motion::Day`].
const DAY: [Motion; 12] = [
    Motion::Binary,
    Motion::Rest,
    Motion::Speed(0.1),
    Motion::Rest,
    Motion::Sine {
        amplitude: 0.1,
        hz: 0.5,
    },
    Motion::SmallSteps,
    Motion::Speed(-0.1),
    Motion::Sine {
        amplitude: 0.02,
        hz: 0.1,
    },
    Motion::Rest,
    Motion::Sine {
        amplitude: 0.4,
        hz: 3.0,
    },
    Motion::SmallSteps,
    Motion::Rest,
];

/// The state of a motion.
#[derive(Clone, Debug)]
pub struct Commands {
    register: ShiftRegister,
    random: Random,
    bit: f64,
    /// Whether binary noise has two sizes: a dead zone or friction cannot be distinguished from a
    /// gain with one.
    two_sizes: bool,
    reference: f64,
    anchor: Option<f64>,
    turned: bool,
    rate: f64,
    gain: f64,
    dt: f64,
}

impl Commands {
    /// For a drive of this bandwidth (rad/s) and velocity gain.
    pub fn new(seed: u64, bandwidth: f64, velocity_gain: f64, two_sizes: bool, dt: f64) -> Self {
        let mut random = generator(seed, Stream::Excitation);
        Self {
            register: ShiftRegister::new(11, random.random_range(1..2048)),
            random,
            bit: 0.4,
            two_sizes,
            reference: 0.0,
            anchor: None,
            turned: false,
            // One bit lasts as long as that of 50 ms at 20 rad/s.
            rate: bandwidth * dt,
            gain: 0.25 * bandwidth / velocity_gain,
            dt,
        }
    }

    /// The command of sample k of the motion, from the measured position.
    pub fn next(&mut self, motion: Motion, k: u64, y: f64) -> f64 {
        if k == 0 {
            self.anchor = None;
            self.reference = 0.0;
        }
        match motion {
            Motion::Rest => 0.0,
            Motion::Binary => {
                let (now, before) = (k as f64 * self.rate, (k as f64 - 1.0) * self.rate);
                if now.floor() != before.floor() {
                    let size = match self.two_sizes && self.random.random::<bool>() {
                        true => 0.2,
                        false => 0.4,
                    };
                    self.bit = match self.register.next() {
                        Some(true) => size,
                        _ => -size,
                    };
                }
                self.bit
            }
            Motion::Speed(u) => {
                if y.abs() > 1e7 {
                    self.turned = y * u > 0.0;
                }
                if self.turned { -u } else { u }
            }
            Motion::Sine { amplitude, hz } => {
                amplitude * (std::f64::consts::TAU * hz * k as f64 * self.dt).sin()
            }
            Motion::StopAndGo => match k % 200_000 {
                part @ ..5_000 => self.next(Motion::Binary, part + 1, y),
                _ => 0.0,
            },
            Motion::SmallSteps => {
                if k.is_multiple_of(20_000) {
                    self.reference = 4.0 * self.random.random::<f64>() - 2.0;
                }
                let anchor = *self.anchor.get_or_insert(y);
                (self.gain * (anchor + self.reference - y)).clamp(-0.4, 0.4)
            }
            Motion::Day => {
                let part = DAY[(k / 60_000) as usize % DAY.len()];
                self.next(part, k % 60_000, y)
            }
        }
    }
}
