//! An axis that moves against its commands, and why: the sign of valve or sensor, or a valve that
//! does not obey.

use crate::servo::commissioning::ends::{at_end, is_beyond};
use crate::servo::commissioning::probe::LATENESS;
use crate::servo::supervision::state::Reason;

/// Movements that count which the axis must go on where it should not.
pub(crate) const MOVEMENTS: f32 = 2.0;
/// Time in s for which the valve is closed, in half periods, and the part of its speed below
/// which an axis has slowed down.
const CLOSING_HALVES: f32 = 1.2;
const SLOWED: f32 = 0.5;

/// How far an axis has gone back against the command.
///
/// A flow of one direction moves the middle of the swing of a drive that way at every instant,
/// and about that middle the axis swings less and less. So the rearmost place within a whole
/// period stays the rearmost: every later one is `middle - swing` or more, of a middle further on
/// and a smaller swing. What friction had stored is overcome by half the drive that moves an axis
/// from wherever friction holds it. An axis that goes behind that place is driven by something
/// else. Cost: about 20 instructions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Defiance {
    /// Direction of the command, and since it began: the time in s of a flow, and the drive in s.
    direction: f32,
    time: f32,
    drive: f32,
    /// The place that the axis has reached furthest against it; the same when drive and time were
    /// used up, and the time since.
    rear: f32,
    mark: f32,
    beyond: f32,
}

impl Defiance {
    /// Whether a flow has driven it that way for longer than motion comes late.
    pub(crate) fn is_driven(&self) -> bool {
        self.time > LATENESS
    }

    /// Takes a position, the command from now on with the flow that it surely makes, the drive
    /// that friction explains and the time that a swing does; the velocity in travels per s of an
    /// axis that must not have it.
    pub(crate) fn update(
        &mut self,
        y: f32,
        [command, flow]: [f32; 2],
        [held, swings]: [f32; 2],
        [detection, step]: [f32; 2],
    ) -> Option<f32> {
        let direction = 1.0_f32.copysign(command);
        if direction != self.direction || command == 0.0 {
            *self = Self {
                direction,
                rear: y,
                ..Self::default()
            };
            return None;
        }
        if direction * (y - self.rear) < 0.0 {
            self.rear = y;
        }
        if flow != 0.0 {
            self.drive += step * flow.abs();
            self.time += step;
        }
        if !(self.drive > held && self.time > swings) {
            self.mark = self.rear;
            return None;
        }
        self.beyond += step;
        let against = direction * (self.mark - self.rear);
        (against > MOVEMENTS * detection).then(|| -direction * against / self.beyond)
    }
}

/// What a closed valve shows of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shown {
    /// Why it moved against its commands.
    Why(Reason),
    /// Nothing: an end of the travel has stopped it.
    Nothing,
    /// Nothing: it may have swung, and has stopped.
    Stops,
}

/// The valve is closed: what it drove slows down.
///
/// An end of the travel stops everything: of an axis that reaches it at speed nothing more is
/// learnt here. But no axis goes on beyond its travel: where the reading does, the sensor counts
/// the other way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ValveClosing {
    /// Direction and speed in travels per s when it began, and the time in s that is left.
    direction: f32,
    speed: f32,
    left: f32,
    /// Whether an end was reached at speed.
    strikes: bool,
    /// Whether a swing may be what moved it.
    doubtful: bool,
}

impl ValveClosing {
    /// After an axis with this half period moved at `velocity` against a flow.
    pub(crate) const fn new(velocity: f32, half: f32) -> Self {
        Self {
            direction: if velocity > 0.0 { 1.0 } else { -1.0 },
            speed: velocity.abs(),
            left: CLOSING_HALVES * half + 2.0 * LATENESS,
            strikes: false,
            doubtful: false,
        }
    }

    /// The same of an axis that may have swung: over when it stops, and at the latest then.
    pub(crate) const fn in_doubt(velocity: f32, half: f32) -> Self {
        Self {
            doubtful: true,
            ..Self::new(velocity, half)
        }
    }

    /// The velocity in travels per s with which it began, or the largest since.
    #[cfg(test)]
    pub(crate) const fn velocity(&self) -> f32 {
        self.direction * self.speed
    }

    /// Takes a position and a velocity; what that has shown, in the last sample.
    pub(crate) fn update(&mut self, y: f32, v: f32, step: f32) -> Option<Shown> {
        if is_beyond(y) {
            return Some(Shown::Why(Reason::WrongSign));
        }
        self.left -= step;
        let speed = self.direction * v;
        if self.doubtful {
            return (speed <= 0.0 || self.left < 0.0).then_some(Shown::Stops);
        }
        self.speed = self.speed.max(speed);
        let slowed = !self.strikes && speed < SLOWED * self.speed;
        self.strikes |= at_end(y) && !slowed;
        (self.left < 0.0 || slowed && at_end(y)).then_some(if slowed {
            Shown::Why(Reason::WrongSign)
        } else if self.strikes {
            Shown::Nothing
        } else {
            Shown::Why(Reason::ValveStuck)
        })
    }
}

#[cfg(test)]
mod tests;
