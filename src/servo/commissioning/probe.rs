//! Stage 1: growing triangles of the command until the axis moves.

use crate::servo::commissioning::rest::Still;

/// Slope of the command per s, and where a triangle before has moved nothing.
pub(crate) const RATE: f32 = 1.5;
const PASSING_RATE: f32 = 6.0;
/// Peaks of the triangles, each there and back on both sides.
///
/// A dead zone of 0.15, an offset of 0.08 and friction that takes some flow to overcome are within
/// the first one, so that few axes wait for the next. A sensor that is stuck shows none of it: the
/// time of the first triangle is that of a blind motion.
const PEAKS: [f32; 2] = [0.45, 0.65];
/// Time in s by which the motion comes after the command that caused it.
pub(crate) const LATENESS: f32 = 0.02;

/// What the triangles have led to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Probed {
    /// This command is next.
    Command(f32),
    /// The axis moved: sign of the valve, and the size of the command that did it.
    Moved { sign: f32, command: f32 },
    /// No code has changed for as long as the first triangles take.
    SameCode,
    /// The largest command moved nothing.
    Still,
}

/// The triangles, and the mean of the last positions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Probe {
    time: f32,
    recent: [f32; 3],
    /// Time in s since the code changed.
    quiet: f32,
}

impl Probe {
    /// The command after `time` s; `None` when all triangles are over.
    fn command(mut time: f32, scale: f32) -> Option<f32> {
        if time < 0.0 {
            return Some(0.0);
        }
        let mut tried = 0.0;
        for peak in PEAKS {
            let peak = scale * peak;
            let passing = tried / PASSING_RATE;
            let half = passing + (peak - tried) / RATE;
            for sign in [1.0, -1.0] {
                if time < 2.0 * half {
                    let from_end = if time < half { time } else { 2.0 * half - time };
                    let size = if from_end < passing {
                        PASSING_RATE * from_end
                    } else {
                        tried + RATE * (from_end - passing)
                    };
                    return Some(sign * size);
                }
                time -= 2.0 * half;
            }
            tried = peak;
        }
        None
    }

    /// Whether one direction has moved nothing: that of an axis at an end leads into it, and its
    /// drive has grown all the same.
    pub(crate) fn has_turned(&self, scale: f32) -> bool {
        self.time > 2.0 * scale * PEAKS[0] / RATE
    }

    /// Takes a position. `scale` is 1 or less and shrinks the triangles.
    pub(crate) fn update(
        &mut self,
        y: f32,
        same_code: bool,
        still: &Still,
        step: f32,
        scale: f32,
    ) -> Probed {
        if self.time == 0.0 {
            self.recent = [y; 3];
        }
        self.quiet = if same_code { self.quiet + step } else { 0.0 };
        self.recent = [y, self.recent[0], self.recent[1]];
        let mean = (self.recent[0] + self.recent[1] + self.recent[2]) * (1.0 / 3.0);
        let drifted = still.drift * (still.since + self.time);
        let away = mean - (still.place + drifted);
        // A drift that begins with the rest grows for some time constants: of a quick axis, which
        // is soon at an end, to at most twice its mean.
        let (up, down) = if drifted > 0.0 {
            (drifted, 0.0)
        } else {
            (0.0, drifted)
        };
        if away > still.detection + up || away < down - still.detection {
            let late = Self::command(self.time - LATENESS, scale).unwrap_or(0.0);
            let same = (away > 0.0) == (late >= 0.0);
            let now = Self::command(self.time, scale).unwrap_or(0.0);
            let command = if late < 0.0 { -late } else { late };
            return Probed::Moved {
                sign: if same { 1.0 } else { -1.0 },
                command: if command > 0.0 { command } else { now.abs() },
            };
        }
        self.time += step;
        let first = 4.0 * scale * PEAKS[0] / RATE;
        if self.quiet > first {
            return Probed::SameCode;
        }
        Self::command(self.time, scale).map_or(Probed::Still, Probed::Command)
    }
}

#[cfg(test)]
mod tests;
