//! Stage 1b: a relay about the start, which is brake, test of the sign and first time scale at
//! once.
//!
//! A swing goes as far to one side of the place of the relay as to the other. Near an end of the
//! travel the place is therefore further inwards: as far as an excitation goes, and as what the
//! axis has swung needs. A flow inwards never brings an oscillation nearer to the end, so that the
//! way there is safe, whatever swing a stop has let go.
//!
//! Nobody knows yet how late the motion comes. A switch that follows the one before sooner than a
//! motion its command is the answer to an earlier command, so that it shows neither sign nor time
//! scale: a loop that is late by half a period of its own obeys either sign. And noise switches
//! nothing: the place ahead must leave what noise makes of position and velocity.

mod standing;

use crate::math::{larger, sqrt};
use crate::servo::commissioning::ends::at_end;
use crate::servo::commissioning::probe::LATENESS;
use crate::servo::commissioning::rest::Still;
use crate::servo::motion::alpha_beta_gamma::AlphaBetaGamma;

/// Time in s by which the velocity leads the position.
const LEAD: f32 = 0.04;
/// Standard deviations of the place ahead within which nothing switches.
const DEVIATIONS: f32 = 3.0;
/// Switches that end the stage, the one at the first movement included, and its longest time in s.
const SWITCHES: u32 = 3;
const TIME_MAX: f32 = 0.8;
/// Command over that at the first movement, its least value, and its growth per s beyond this time
/// on one side.
const RATIO: f32 = 1.5;
const COMMAND_MIN: f32 = 0.08;
const GROWTH: f32 = 1.0;
const GROWTH_AFTER: f32 = 0.05;
/// Time in s of inward command after which an axis this far out (travels) that gains this speed
/// (travels per s) outward within the last 30 ms obeys the other sign.
const SIGN_TIME: f32 = 0.15;
const SIGN_DISTANCE: f32 = 0.03;
const SIGN_SPEED: f32 = 0.1;
const SIGN_LOOK: f32 = 0.03;
/// The same for an axis that runs away fast: time in s, and outward speed in travels per s, at
/// least twice the first one.
const FAST_TIME: f32 = 0.06;
const FAST_SPEED: f32 = 0.25;
/// The same for a slow one: time in s, and the speed in travels per s gained over three looks, in
/// each of them.
///
/// The command grows, so that the flow under the wrong sign does and the axis gains speed for ever;
/// under the right one the drive that the first movement left is used up by then: at most the flow
/// of an offset of 0.08 for the time scale of the axis, against an inward command that grows at 1
/// per s.
const LATE_TIME: f32 = 0.2;
const LATE_SPEED: f32 = 0.02;
/// Room to an end over what the axis has swung on the other side of the place: a relay that drives
/// an oscillation makes the next swing larger. The least room, in travels, that of
/// [`inner`](crate::servo::motion::Travel::inner).
const ROOM: f32 = 2.0;
const ROOM_MIN: f32 = 0.1;
/// Changes of the sign that are one too many.
const FLIPS_MAX: u32 = 3;

/// What the relay has led to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Relayed {
    /// This command is next, with this sign of the valve.
    Command { command: f32, sign: f32 },
    /// The axis obeys: half a period of the relay in s.
    Obeys { half: f32, sign: f32 },
    /// The axis moves as it likes.
    Disobeys,
}

/// The relay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Relay {
    /// Where the axis stood, and the place about which it is driven.
    start: f32,
    place: f32,
    /// Whether the sign has shown itself: only a flow inwards brings an axis off an end, and one of
    /// the other sign would have driven on inwards what turned towards the end.
    shown: bool,
    /// Hysteresis, and command at the first movement.
    hysteresis: f32,
    command: f32,
    sign: f32,
    /// The largest command so far.
    largest: f32,
    time: f32,
    /// Time since the last switch and the interval before it.
    since: f32,
    half: f32,
    switches: u32,
    flips: u32,
    /// Side of the axis that is braked: 1 above, -1 below.
    side: f32,
    /// Where it was when that began.
    braked: f32,
    /// -1 while an axis that stays is driven the other way, and where it then stood.
    turned: f32,
    stood: f32,
    /// Outward speed at the begin or the last switch, some 30 ms ago, and the time since.
    first: f32,
    before: f32,
    looked: f32,
    /// What the outward speed gained in the two looks before.
    gains: [f32; 2],
}

impl Relay {
    /// How far on the other side the place ahead must be for a switch: half a movement that counts,
    /// and more than noise makes of it.
    pub(crate) fn hysteresis(still: &Still, tracking: &AlphaBetaGamma) -> f32 {
        let led = LEAD * tracking.velocity_noise();
        let noise = still.sigma * sqrt(1.0 + led * led);
        larger(0.5 * still.detection, DEVIATIONS * noise)
    }

    /// A relay about `start`, or the place nearest to it with room to the ends, after a `command`
    /// moved the axis to `side` of it.
    pub(crate) fn new(start: f32, hysteresis: f32, command: f32, sign: f32, side: f32) -> Self {
        let command = RATIO * command;
        let shown = at_end(start) && (side > 0.0) == (start < 0.5);
        let (place, side) = if start < ROOM_MIN {
            (ROOM_MIN, -1.0)
        } else if start > 1.0 - ROOM_MIN {
            (1.0 - ROOM_MIN, 1.0)
        } else {
            (start, side)
        };
        Self {
            start,
            shown,
            place,
            hysteresis,
            command: if command > COMMAND_MIN {
                command
            } else {
                COMMAND_MIN
            },
            sign,
            largest: 0.0,
            time: 0.0,
            since: 0.0,
            half: 0.0,
            switches: 1,
            flips: 0,
            side,
            braked: place,
            turned: 1.0,
            stood: start,
            first: 0.0,
            before: 0.0,
            looked: 0.0,
            gains: [0.0; 2],
        }
    }

    /// The largest command so far.
    pub(crate) const fn largest(&self) -> f32 {
        self.largest
    }

    /// Whether the axis is so far from where it began that it has moved.
    pub(crate) const fn is_away(&self, y: f32) -> bool {
        (y - self.start).abs() > SIGN_DISTANCE
    }

    /// The command that surely moves the axis, as one at a first movement.
    pub(crate) fn moving(&self) -> f32 {
        self.largest / RATIO
    }

    /// Takes a position and a velocity.
    pub(crate) fn update(&mut self, y: f32, v: f32, step: f32, amplitude: f32) -> Relayed {
        self.time += step;
        self.since += step;
        self.looked += step;
        self.leave_room(y, v);
        let ahead = y + LEAD * v - self.place;
        if ahead * self.side < -self.hysteresis {
            self.side = -self.side;
            self.braked = y;
            self.half = self.since;
            let answers = self.since > LATENESS;
            self.switches = if answers { self.switches + 1 } else { 1 };
            self.since = 0.0;
            self.looked = 0.0;
            self.before = self.side * v;
            self.first = self.before;
            self.gains = [0.0; 2];
            if self.flips > 0 {
                // What stopped an axis that had run away is more than what turns it.
                self.command = COMMAND_MIN.max(0.5 * self.command);
            }
        }
        if self.looked > SIGN_LOOK && self.runs_away(y, v) {
            // What drove it out brakes it.
            self.command = self.size(amplitude);
            self.gains = [0.0; 2];
            self.first = self.side * v;
            self.sign = -self.sign;
            self.flips += 1;
            self.since = 0.0;
            self.half = 0.0;
            self.switches = 1;
            // The other sign deserves the time that the first one had.
            self.time = 0.0;
        }
        if self.flips > FLIPS_MAX {
            return Relayed::Disobeys;
        }
        let over = self.switches >= SWITCHES || self.time > TIME_MAX;
        if over && self.half > 0.0 {
            return Relayed::Obeys {
                half: self.half,
                sign: self.sign,
            };
        }
        if self.time > 2.0 * TIME_MAX {
            return Relayed::Disobeys;
        }
        let size = self.size(amplitude);
        self.largest = self.largest.max(size);
        Relayed::Command {
            command: -self.turned * self.sign * self.side * size,
            sign: self.sign,
        }
    }

    /// The place leaves room to the nearer end of the travel for what the axis has swung inwards
    /// while it was braked; an axis that has turned nearer to the end goes inwards from there, as
    /// at the begin.
    fn leave_room(&mut self, y: f32, v: f32) {
        let (inward, end) = if self.place < 0.5 {
            (1.0, 0.0)
        } else {
            (-1.0, 1.0)
        };
        if self.side != inward || inward * v > 0.0 {
            return;
        }
        let swing = inward * (y - self.braked);
        let place = end + inward * ROOM * swing;
        if inward * (place - self.place) > 0.0 {
            self.place = place;
            if inward * (place - y) > 0.0 {
                self.side = -inward;
                self.shown = true;
                self.switches = 1;
                self.since = 0.0;
                self.half = 0.0;
                self.looked = 0.0;
                self.before = 0.0;
                self.first = 0.0;
                self.gains = [0.0; 2];
            }
        }
    }

    /// Looks at the outward speed: whether it grows as only the flow under the wrong sign lets it.
    fn runs_away(&mut self, y: f32, v: f32) -> bool {
        let outward = self.side * v;
        let gained = outward - self.before;
        let [last, before] = self.gains;
        self.gains = [gained, last];
        self.before = outward;
        self.looked = 0.0;
        if self.shown && self.switches == 1 {
            return false;
        }
        let out = self.side * (y - self.place) > SIGN_DISTANCE;
        let slowly = self.since > SIGN_TIME && out;
        let fast = self.since > FAST_TIME
            && outward > FAST_SPEED
            && outward > 2.0 * self.first
            && self.switches == 1;
        let steadily = gained > 0.0 && last > 0.0 && before > 0.0;
        let ever = self.since > LATE_TIME && out && steadily && gained + last + before > LATE_SPEED;
        outward > 0.0 && ((slowly || fast) && gained > SIGN_SPEED || ever)
    }

    /// The size of the command: it grows while the axis stays on one side.
    fn size(&self, amplitude: f32) -> f32 {
        let late = self.since - GROWTH_AFTER;
        let grown = self.command + if late > 0.0 { GROWTH * late } else { 0.0 };
        if grown < amplitude { grown } else { amplitude }
    }
}

#[cfg(test)]
mod tests;
