//! How a user moves a drive.

use std::f64::consts::TAU;

use rand::RngExt;

use crate::random::{Random, log_uniform};
use crate::signals::excitation::Excitation;
use crate::signals::noise::numbered;

/// What a drive is asked to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Command {
    /// Binary noise, a bit of 0.8/w.
    Binary,
    /// One sine of 0.15 to 1.5 w.
    Sine,
    /// Steps to any level, each held for 3 to 10/w.
    Steps,
    /// Five sines of 0.1 to 1.5 w.
    Multisine,
    /// Pulses of 3/w with 15 to 50/w of rest between them.
    Pulses,
    /// A reference in triangles of 24 to 80/w, under proportional control of the position.
    Triangles,
    /// A reference that moves every 18 to 60/w, under proportional control of the position.
    Moves,
}

/// Stream of the pulses.
const PULSES: u64 = 5;

impl Command {
    /// All of them; the last two need a position.
    pub const ALL: [Self; 7] = [
        Self::Binary,
        Self::Sine,
        Self::Steps,
        Self::Multisine,
        Self::Pulses,
        Self::Triangles,
        Self::Moves,
    ];

    /// Those of a drive that integrates, and of one that does not.
    pub const fn of(integrates: bool) -> &'static [Self] {
        let all: &'static [Self] = &Self::ALL;
        if integrates { all } else { all.split_at(5).0 }
    }

    /// Name in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Binary => "binary noise",
            Self::Sine => "sine",
            Self::Steps => "steps",
            Self::Multisine => "multi-sine",
            Self::Pulses => "pulses",
            Self::Triangles => "triangles, controlled",
            Self::Moves => "moves, controlled",
        }
    }

    /// Whether the sequence is a reference, which a controller follows.
    pub const fn is_reference(self) -> bool {
        matches!(self, Self::Triangles | Self::Moves)
    }

    /// `n` commands of size 1, or references of three strokes, at intervals of `angle` / w; `pace`
    /// from 0 to 1 is where in its range the command lies.
    pub fn sequence(self, pace: f64, angle: f64, n: usize, seed: u64) -> Vec<f64> {
        let between = |low: f64, high: f64| low * (high / low).powf(pace);
        let made = match self {
            Self::Binary => Excitation::Prbs {
                amplitude: 1.0,
                hold_s: 0.8,
                bits: 11,
            },
            Self::Sine => Excitation::Multisine {
                amplitude: 1.0,
                first_hz: between(0.15, 1.5) / TAU,
                lines: 1,
            },
            Self::Steps => Excitation::Steps {
                amplitude: 1.0,
                hold_s: between(3.0, 10.0),
            },
            Self::Multisine => Excitation::Multisine {
                amplitude: 3.0,
                first_hz: between(0.1, 0.3) / TAU,
                lines: 5,
            },
            Self::Moves => Excitation::Steps {
                amplitude: 3.0,
                hold_s: between(18.0, 60.0),
            },
            Self::Triangles => return triangles(between(24.0, 80.0) / angle, n),
            Self::Pulses => return pulses(angle, n, &mut numbered(seed, PULSES)),
        };
        made.sequence(n, angle, seed)
    }
}

/// Triangles of so many samples between -3 and 3.
fn triangles(period: f64, n: usize) -> Vec<f64> {
    let at = |k: usize| 6.0 / TAU * 2.0 * (TAU * k as f64 / period).sin().asin();
    (0..n).map(at).collect()
}

fn pulses(angle: f64, n: usize, random: &mut Random) -> Vec<f64> {
    let mut u = Vec::with_capacity(n);
    while u.len() < n {
        let size = if random.random_bool(0.5) { 1.0 } else { -1.0 };
        for (level, time) in [(size, 3.0), (0.0, log_uniform(random, 15.0, 50.0))] {
            let samples = ((time / angle) as usize + 1).min(n - u.len());
            u.extend(std::iter::repeat_n(level, samples));
        }
    }
    u
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_its_size_and_its_length() {
        for command in Command::ALL {
            let u = command.sequence(0.5, 0.02, 5000, 3);
            let largest = u.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let bound = match command {
                Command::Multisine | Command::Triangles | Command::Moves => 3.0,
                _ => 1.0,
            };
            assert_eq!(u.len(), 5000, "{command:?}");
            assert!(
                largest <= bound + 1e-12 && largest > 0.5,
                "{command:?} {largest}"
            );
        }
    }
}
