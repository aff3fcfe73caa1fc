//! A position that stays although the command drives the axis: friction, a stuck sensor, or no
//! motion at all.

mod known;
mod time_scale;

use crate::math::{larger, smaller};
use crate::servo::commissioning::defiance::Defiance;
use crate::servo::commissioning::ends::at_end;
use crate::servo::commissioning::predictor::Theta;
use crate::servo::commissioning::probe::RATE;
use crate::servo::commissioning::reach::Reach;
use crate::servo::commissioning::standstill::known::Known;

/// Part of the command at the first movement that is surely not flow: half of it, as for the dead
/// zone of a start.
const CLOSED: f32 = 0.5;
/// Drive that moves an axis from wherever friction holds it, over the drive that moved it first. At
/// the first movement friction was overcome from rest, u^2 / (2 rate) of a ramp; from the other
/// side it takes twice that. With half of the command taken for dead zone, a valve without any
/// needs 2 * 4 / 1.5 of what is counted.
const FIRST_DRIVES: f32 = 5.4;
/// Twice the largest offset of a valve, by which the other direction than that of the first
/// movement may open later.
const OTHER_SIDE: f32 = 0.16;
/// Command of an axis that stays over that of the first movement: it moves the axis.
const MOVING_COMMAND: f32 = 1.5;
/// Part of the drive that friction held in good work, over which more is needed.
const HELD_RATIO: f32 = 1.5;

/// The drive of an axis whose code changes over that of one whose code stays: noise may hide a slow
/// motion.
const NOISY: f32 = 2.0;
/// The same in s before anything is known of the time scale.
const LAG_FIRST: f32 = 0.08;

/// Part of what friction may hold from one side to the other that stops an axis in motion.
const ONE_SIDE: f32 = 0.5;
/// Part of that lag for which the other direction has been tried before a movement is its answer.
const TRIED: f32 = 0.5;

/// What a position that stays means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Standing {
    /// The axis has moved on.
    Moved,
    /// It stays, and friction explains that.
    HeldByFriction,
    /// It stays, and the present direction should have moved it.
    Exhausted,
    /// Neither direction moved what must move.
    Unresponsive,
}

/// Drive that friction may hold after a command that grew to this size has moved the axis.
fn first_drives(command: f32) -> f32 {
    let flow = (1.0 - CLOSED) * command;
    FIRST_DRIVES * flow * flow / (2.0 * RATE)
}

/// The drive since the position last left the band of a movement that counts.
///
/// The drive is the integral of the flow `|u| - dead zone` along the sign, in s: at rest the force
/// on the axis follows it. What friction can hold is a band of the drive; a wider one, used up in
/// both directions, is no friction. The first movement had the same gain, so that none is needed.
/// Cost: about 40 instructions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Standstill {
    anchor: f32,
    detection: f32,
    /// Command at the first movement, and what the valve may need more upward and downward.
    command: f32,
    margin: [f32; 2],
    /// Commands beyond which it opens, upward and downward: half of that command, with a model its
    /// dead zone. That is at most the whole command, which has moved the axis: a model that has
    /// seen a fault may have one as wide as all commands.
    opens: [f32; 2],
    /// Drive that friction may hold before there is a model, and the largest that it held in good
    /// work.
    first: f32,
    held: f32,
    /// A period in s as the relay has it, and what is known before there is a model.
    period: f32,
    relayed: Known,
    /// The drive, with its range so far.
    drive: f32,
    low: f32,
    high: f32,
    /// Directions that are used up: upward, downward.
    used: [bool; 2],
    /// Whether the code has changed since then, and while the direction before was used up.
    changes: bool,
    changed: bool,
    /// Whether the axis moved one way when the drive that way was used up and the other one tried.
    turned: bool,
    /// What the model says.
    known: Known,
    /// How it moves against its drive.
    defiance: Defiance,
    defies: Option<f32>,
    /// How far a swing takes it.
    reach: Reach,
}

impl Standstill {
    /// After a `command` that grew at the rate of the probe has moved the axis to `place`, in this
    /// direction along its sign.
    pub(crate) fn new(place: f32, detection: f32, command: f32, upward: bool) -> Self {
        let margin = if upward {
            [0.0, OTHER_SIDE]
        } else {
            [OTHER_SIDE, 0.0]
        };
        Self {
            anchor: place,
            detection,
            command,
            margin,
            opens: margin.map(|margin| CLOSED * command + margin),
            first: first_drives(command),
            relayed: Known {
                late: LAG_FIRST,
                swing: f32::INFINITY,
                ..Known::default()
            },
            ..Self::default()
        }
    }

    /// Takes a position, whether it has the code before, and the command along the sign from now
    /// on.
    pub(crate) fn update(
        &mut self,
        y: f32,
        same_code: bool,
        command: f32,
        step: f32,
        model: Option<&Theta>,
    ) -> Standing {
        self.changes |= !same_code;
        let known = self.known(model);
        let flow = self.flow(command);
        let held = larger(self.first, larger(known.held, HELD_RATIO * self.held));
        let late = known.late * flow.abs();
        let explained = [ONE_SIDE * held, known.swing];
        let scale = [self.detection, step];
        self.defies = self.defiance.update(y, [command, flow], explained, scale);
        let away = y - self.anchor;
        if away > self.detection || away < -self.detection {
            self.turned = self.is_turned(away > 0.0, flow, late);
            self.held = larger(self.held, self.high - self.low);
            self.stand(y);
            return Standing::Moved;
        }
        self.drive += step * flow;
        self.low = smaller(self.low, self.drive);
        self.high = larger(self.high, self.drive);
        let share = if self.changes { NOISY } else { 1.0 };
        let needed = share * (held + late);
        let mut up = self.drive - self.low > needed;
        let mut down = self.high - self.drive > needed;
        if (up || down) && at_end(y) {
            // A stop holds any force: what has pressed the axis on it has to be taken back first.
            (up, down) = (self.drive > needed, -self.drive > needed);
        }
        let used = [self.used[0] || up, self.used[1] || down];
        if used != self.used {
            // The code has the time of the last direction to change.
            self.changed = self.changes;
            self.changes = false;
        }
        self.used = used;
        if self.used == [true; 2] {
            Standing::Unresponsive
        } else if (up && flow > 0.0) || (down && flow < 0.0) {
            Standing::Exhausted
        } else {
            Standing::HeldByFriction
        }
    }

    /// Begins again at a place.
    const fn stand(&mut self, y: f32) {
        self.anchor = y;
        (self.drive, self.low, self.high) = (0.0, 0.0, 0.0);
        (self.used, self.changes) = ([false; 2], false);
    }

    /// Begins again where the axis has met an end of the travel.
    pub(crate) fn strike(&mut self, y: f32) {
        self.resume(y);
        self.turned = false;
    }

    /// Begins again where the axis has stopped behind a closed valve.
    pub(crate) fn resume(&mut self, y: f32) {
        self.stand(y);
        self.defiance = Defiance::default();
        self.reach.restart();
    }

    /// The sign is the other one: what moved the axis first is not known, at most the present
    /// command.
    pub(crate) fn mistook(&mut self, command: f32) {
        self.margin = [OTHER_SIDE; 2];
        if command > self.command {
            self.command = command;
            self.first = first_drives(command);
        }
        self.opens = self.opening(CLOSED);
    }

    /// Command that moves an axis that stays, upward or downward.
    pub(crate) const fn push(&self, upward: bool) -> f32 {
        let [up, down] = self.margin;
        MOVING_COMMAND * self.command + if upward { up } else { down }
    }

    /// Commands beyond which the valve opens when this part of the first one is no flow.
    fn opening(&self, part: f32) -> [f32; 2] {
        self.margin.map(|margin| part * self.command + margin)
    }

    /// Flow of a command.
    fn flow(&self, command: f32) -> f32 {
        let [up, down] = self.opens;
        if command > up {
            command - up
        } else if command < -down {
            command + down
        } else {
            0.0
        }
    }

    /// Whether the last movement was one that the other direction of the drive brought about.
    pub(crate) const fn turned(&self) -> bool {
        self.turned
    }

    /// The velocity in travels per s of an axis that moves against its drive and must not.
    pub(crate) const fn defies(&self) -> Option<f32> {
        self.defies
    }

    /// Whether a movement is the answer to the other direction: the drive this way was used up, and
    /// the one back has been tried for longer than the first one may come late.
    fn is_turned(&self, upward: bool, flow: f32, late: f32) -> bool {
        let back = if upward {
            self.high - self.drive
        } else {
            self.drive - self.low
        };
        let tried = (flow < 0.0) == upward && back > TRIED * late;
        self.used == [upward, !upward] && flow != 0.0 && tried
    }

    /// Whether the code has changed while the last direction was used up.
    pub(crate) const fn code_changes(&self) -> bool {
        self.changed
    }
}

#[cfg(test)]
mod tests;
