//! Stage 2: random levels of the command for random times, within a band of the travel.

use crate::math::sqrt;
use crate::servo::commissioning::standstill::Standing;

/// Band about its middle, and the range of the middle, in travels.
const BAND: f32 = 0.15;
pub(super) const MIDDLE: [f32; 2] = [0.28, 0.72];
/// Oscillation, in travels, that has to fade: from the outermost middle of the band it reaches the
/// end of the travel. It fades to this part.
const SWING: f32 = MIDDLE[0] - BAND;
const CALM: f32 = 0.5;
/// Command over the limit that keeps an oscillation from an end.
const CALMING: f32 = 0.35;
/// Places beyond which the command leads inwards whatever else.
const SAFE: [f32; 2] = [0.05, 0.95];
/// Least, first and largest amplitude of the flow.
const AMPLITUDE: [f32; 3] = [0.07, 0.2, 0.4];
/// Least and longest hold over half a period of the axis.
const HOLD: [f32; 2] = [0.2, 0.9];
/// Movement within two half periods, in travels, below which the amplitude grows and above which it
/// shrinks.
const MOVEMENT: [f32; 2] = [0.025, 0.1];
/// Growth and shrinking of the amplitude.
const GROWTH: f32 = 1.4;
const SHRINKING: f32 = 0.8;

/// Levels, holds and signs drawn at random; known as APRBS (Isermann and Munchhof 2011).
///
/// Levels and holds are drawn again at every reversal, forced ones too: two levels alone cannot
/// distinguish a dead zone from a gain. The place where the axis will be when a reversed command
/// takes effect decides about reversals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sweep {
    random: u32,
    middle: f32,
    /// Half a period of the axis in s.
    half: f32,
    dead_zone: f32,
    offset: f32,
    amplitude: f32,
    limit: f32,
    /// Command along the sign of the axis, and the time for which it is still held.
    level: f32,
    left: f32,
    /// Range of the positions in the present look, and its time.
    low: f32,
    high: f32,
    looked: f32,
    /// Commands that move an axis that stays, upward and downward.
    pushes: [f32; 2],
    /// Whether the axis has stayed since the present level began, and whether that is being tested.
    stays: bool,
    tests: bool,
    /// Whether it waits for an oscillation to fade.
    calms: bool,
    /// Whether the level shows whether the axis obeys.
    proves: bool,
}

impl Sweep {
    pub(crate) fn new(place: f32, half: f32, dead_zone: f32, limit: f32, attempt: u32) -> Self {
        let [low, high] = MIDDLE;
        let middle = if place < low {
            low
        } else if place > high {
            high
        } else {
            place
        };
        Self {
            random: (attempt + 1).wrapping_mul(0x9E37_79B9) | 1,
            middle,
            half,
            dead_zone,
            offset: 0.0,
            amplitude: AMPLITUDE[1],
            limit,
            level: 0.0,
            left: 0.0,
            low: place,
            high: place,
            looked: 0.0,
            pushes: [0.0; 2],
            stays: false,
            tests: false,
            calms: false,
            proves: false,
        }
    }

    /// Whether a place is within the safe travel.
    pub(crate) fn is_safe(&self, y: f32) -> bool {
        let [low, high] = SAFE;
        y > low && y < high
    }

    /// Half a period of the axis in s.
    pub(crate) const fn half(&self) -> f32 {
        self.half
    }

    /// Commands that move an axis that stays, upward and downward.
    pub(crate) const fn pushes(&mut self, pushes: [f32; 2]) {
        self.pushes = pushes;
    }

    /// Takes what the last sample has shown: a direction that is used up makes way for the other
    /// one.
    pub(crate) fn take(&mut self, standing: Standing) {
        match standing {
            Standing::Moved => (self.stays, self.tests) = (false, false),
            Standing::Exhausted => {
                self.tests = true;
                self.push(self.level <= 0.0);
            }
            Standing::HeldByFriction | Standing::Unresponsive => {}
        }
    }

    /// Time scale and valve of the axis, from a model.
    pub(crate) const fn inform(&mut self, half: f32, dead_zone: f32, offset: f32) {
        self.half = half;
        self.dead_zone = dead_zone;
        self.offset = offset;
    }

    /// A number from 0 to 1; xorshift (Marsaglia 2003).
    fn draw(&mut self) -> f32 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 17;
        self.random ^= self.random << 5;
        (self.random >> 8) as f32 * (1.0 / 16_777_216.0)
    }

    /// The next command along the sign of the axis at a position, velocity and acceleration. Cost:
    /// about 80 instructions.
    pub(crate) fn update(&mut self, y: f32, v: f32, a: f32, step: f32) -> f32 {
        self.look(y, step);
        self.left -= step;
        self.proves &= self.left > 0.0;
        if let Some(inward) = self.swings(y, v, a).filter(|_| !self.proves) {
            self.level = inward * CALMING * self.limit - self.offset;
            self.left = 0.0;
            return self.level;
        }
        let ahead = y + (0.45 * self.half + 0.012) * v - self.middle;
        let end = y + (0.6 * self.half + 0.015) * v;
        let outward = (end > SAFE[1] && self.level > 0.0) || (end < SAFE[0] && self.level < 0.0);
        let beyond = (ahead > BAND && self.level > 0.0) || (ahead < -BAND && self.level < 0.0);
        if (outward || beyond) && !self.tests {
            let inward = if self.level > 0.0 { -1.0 } else { 1.0 };
            self.next(inward, if outward { 0.7 * self.limit } else { 0.0 });
        } else if self.left <= 0.0 && self.stays && self.level != 0.0 {
            // Friction holds it: the same direction goes on until it moves or is used up.
            self.push(self.level > 0.0);
        } else if self.left <= 0.0 {
            let error = (y + 0.3 * self.half * v - self.middle) / BAND;
            let share = 0.45 * if error < 0.0 { -error } else { error };
            let inwards = 0.5 + if share < 0.45 { share } else { 0.45 };
            let inward = if error > 0.0 { -1.0 } else { 1.0 };
            let sign = if self.draw() < inwards {
                inward
            } else {
                -inward
            };
            self.next(sign, 0.0);
        }
        self.level
    }

    /// Where the axis swings so far that it has to calm down: the direction in which it is pushed
    /// meanwhile.
    ///
    /// With the valve closed an axis of natural frequency `w` swings about `y + a / w^2` by at most
    /// `sqrt(v^2 + (a / w)^2) / w`. Reversals feed the oscillation of a lightly damped axis, at
    /// worst by their whole flow each time; none comes while it swings further than from the
    /// outermost middle of the band to the end of the travel. A flow away from an end never brings
    /// the oscillation nearer to that end, whatever its phase: it moves the middle by at least as
    /// much as it feeds the swing.
    fn swings(&mut self, y: f32, v: f32, a: f32) -> Option<f32> {
        let per_frequency = core::f32::consts::FRAC_1_PI * self.half;
        let middle = y + per_frequency * per_frequency * a;
        let swing = per_frequency * sqrt(v * v + per_frequency * per_frequency * a * a);
        self.calms = swing > if self.calms { CALM * SWING } else { SWING };
        if !self.calms {
            return None;
        }
        let [low, high] = SAFE;
        Some(match (middle - swing < low, middle + swing > high) {
            (true, false) => 1.0,
            (false, true) => -1.0,
            _ => 0.0,
        })
    }

    /// Goes on in the same direction, with a level that surely moves an axis that stays, for the
    /// period within which a swing goes back.
    pub(crate) fn prove(&mut self) {
        self.push(self.level > 0.0);
        self.left = 2.0 * self.half;
        self.proves = true;
    }

    /// Whether it shows whether the axis obeys.
    pub(crate) const fn proves(&self) -> bool {
        self.proves
    }

    /// A level that moves an axis that stays.
    fn push(&mut self, upward: bool) {
        let [up, down] = self.pushes;
        let (sign, least) = if upward { (1.0, up) } else { (-1.0, down) };
        self.next(sign, least);
    }

    /// Draws a level of this sign and at least this size, and its time.
    fn next(&mut self, sign: f32, least: f32) {
        self.stays = true;
        let part = 0.35 + 1.15 * self.draw();
        let flow = (self.amplitude - 0.6 * self.dead_zone) * part;
        let flow = if flow > 0.05 { flow } else { 0.05 };
        let size = self.dead_zone + flow;
        let size = if size > least { size } else { least };
        let level = sign * size - self.offset;
        self.level = if level > self.limit {
            self.limit
        } else if level < -self.limit {
            -self.limit
        } else {
            level
        };
        let [least, most] = HOLD;
        self.left = self.half * (least + (most - least) * self.draw());
        self.proves = false;
    }

    /// The amplitude follows the movement within two half periods.
    fn look(&mut self, y: f32, step: f32) {
        self.low = if y < self.low { y } else { self.low };
        self.high = if y > self.high { y } else { self.high };
        self.looked += step;
        if self.looked < 2.0 * self.half {
            return;
        }
        let moved = self.high - self.low;
        let [least, _, most] = AMPLITUDE;
        if moved < MOVEMENT[0] {
            self.amplitude = (GROWTH * self.amplitude).min(most);
        } else if moved > MOVEMENT[1] {
            self.amplitude = (SHRINKING * self.amplitude).max(least);
        }
        (self.low, self.high, self.looked) = (y, y, 0.0);
    }
}

#[cfg(test)]
mod tests;
