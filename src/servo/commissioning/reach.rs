//! How far back a swing takes an axis against its command.

use crate::math::{larger, sqrt};
use crate::servo::commissioning::defiance::MOVEMENTS;
use crate::servo::commissioning::probe::LATENESS;
use crate::servo::motion::Motion;

/// Swings behind their middle that no axis reaches.
const SWINGS: f32 = 2.0;
/// Standard deviations of the acceleration that are no swing.
const DEVIATIONS: f32 = 4.5;

/// The place behind which no swing takes an axis while its command keeps its direction.
///
/// Behind a closed valve a drive of natural frequency `w` swings about `m = y + a / w^2` by at most
/// `s = sqrt(v^2 + (a / w)^2) / w`, less with friction. A flow moves that middle its own way, so
/// that from any moment on nothing brings the drive behind `m - s`. The acceleration that the
/// filter shows of a swing lags by up to 42 degrees, and its middle is off by up to 0.7 s, which
/// `m - 2 s` contains. Noise `n` of the acceleration moves the middle by `n / w^2` one way and
/// takes as much from each of two swings, of which the second one contains a part: with three
/// deviations and a half of that more added to the swing, nothing of it is left.
///
/// What is behind the largest `m - 2 s` since the motion began to follow the command is there for
/// another reason: the wrong sign, a valve that does not obey, or a `w` that is wrong. That is
/// known within a part of a period; what surely is no swing takes a whole one
/// ([`Defiance`](crate::servo::commissioning::defiance::Defiance)). Cost: about 40 instructions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Reach {
    /// 1/w in s.
    per_frequency: f32,
    /// What noise may look like of the accelerations of two swings, in travels per s^2; in travels
    /// what is no swing: that over w^2, and movements that count.
    noise: f32,
    margin: f32,
    /// Direction of the command, and the time in s since it began.
    direction: f32,
    time: f32,
    /// The place along the direction, once the motion follows the command.
    rear: f32,
}

impl Reach {
    /// The time scale 1/w in s, the noise of the acceleration in travels per s^2, and a movement
    /// that counts.
    pub(crate) const fn inform(&mut self, per_frequency: f32, noise: f32, detection: f32) {
        self.per_frequency = per_frequency;
        self.noise = SWINGS * DEVIATIONS * noise;
        self.margin = MOVEMENTS * detection + self.noise * per_frequency * per_frequency;
    }

    /// Another time scale 1/w in s.
    pub(crate) const fn rescale(&mut self, per_frequency: f32) {
        let (before, now) = (self.per_frequency, per_frequency);
        self.margin += self.noise * (now * now - before * before);
        self.per_frequency = per_frequency;
    }

    /// Begins again.
    pub(crate) const fn restart(&mut self) {
        self.direction = 0.0;
    }

    /// Takes a motion in travels and the command from now on; whether the axis is out of reach of a
    /// swing by more than movements that count.
    pub(crate) fn update(&mut self, motion: &Motion, command: f32, step: f32) -> bool {
        let direction = 1.0_f32.copysign(command);
        if direction != self.direction || command == 0.0 {
            (self.direction, self.time) = (direction, 0.0);
            self.rear = f32::NEG_INFINITY;
            return false;
        }
        self.time += step;
        if !(self.time > LATENESS) {
            return false;
        }
        let v = motion.velocity;
        let a = self.per_frequency * motion.acceleration;
        let middle = direction * (motion.position + self.per_frequency * a);
        let swing = self.per_frequency * sqrt(v * v + a * a);
        self.rear = larger(self.rear, middle - SWINGS * swing);
        direction * motion.position < self.rear - self.margin
    }
}

#[cfg(test)]
mod tests;
