//! An axis that falls short of the velocity that its commands let expect.

use crate::math::larger;
use crate::servo::monitoring::bounds::Bounds;

/// How an axis falls short.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Short {
    /// It stands.
    Standing,
    /// It moves the other way.
    Against,
}

/// How far the axis falls short of its expectation, in one direction, beyond what a sound one does.
///
/// ```text
/// D <- max(0, D + Delta (|v_e| - s v - tolerance))       s: sign of the expected velocity v_e; begins again when s changes
/// tolerance = 0.06 C + 0.3 |v_e| + late |v_e'|
/// alarm when D > n friction/a1 + 2 (0.06 C / w + grain) + swing,   and v is below a fifth of v_e or the other way
/// n = 2 in motion, 3.5 where the axis stands and stood before
/// ```
///
/// Tolerance: dead zone and offset of the flow together; a velocity gain that loads, direction and
/// place change; and a delay that is wrong by `late`, half of it: the drive is the same at all
/// times, so that its motion comes as much sooner or later as its commands do, however many there
/// are. D is what is left: a sound axis stays behind by the deflection with which friction holds
/// it, and by a swing. A drive with little damping swings by `v / w` after a motion with v, in a
/// phase that nobody knows: `(1 - 2 xi) v / w` for the fastest recent motion that was as expected.
/// A loop that swings, near an end, where the drive is stiffer, faster than its model, has any
/// phase to its expectation, and in half a wave D grows to some `2 v / w`, under a load of three
/// times the mass sqrt(3) times that, and half as much again where the loop is unstable with that
/// load and the next half wave is larger by a half: 5.2 v / w for the smaller one of the largest
/// recent speeds in both directions. A motion that runs away has only one direction.
///
/// While friction holds the expectation, s is the sign of what is commanded: an axis with less
/// friction than its model already moves that way.
///
/// An axis stands when its path since then, forth and back, is below a fifth of what is expected;
/// one that is displaced against its commands by more than friction, noise and resolution can does
/// not, however little that is beside a large command. A
/// breakaway of 2.5 times the Coulomb friction holds one that stood before for longer than a motion
/// falls short, by as much as a code may stay. One that moved, and seems to stand all at once, is
/// not held by friction: its sensor may be stuck, and the axis on its way to an end.
///
/// D begins with the fault, whatever the axis did before, so that the full motion of a sensor that
/// fails at speed counts at once; a wrong sign counts twice.
///
/// Known as: cumulative sum test (Page 1954). Cost: about 40 instructions.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Shortfall {
    short: f32,
    /// Expected and measured displacement since the axis is short.
    expected: f32,
    measured: f32,
    /// Path of the axis since then, forth and back.
    path: f32,
    /// Means of the latest expected and measured velocity, along the expected one.
    speed: f32,
    along: f32,
    /// The latest expected velocity, and the latest that was not zero.
    last: f32,
    way: f32,
    /// Largest recent velocities, upward and downward: the expected ones and the measured ones.
    peaks: [[f32; 2]; 2],
    /// Largest recent speed of a motion as expected, with a memory four times as long.
    fastest: f32,
    /// Displacement of a swing.
    swing: f32,
    /// Whether the axis stood before it was short.
    stood: bool,
    /// Samples for which the axis has been short and stood.
    standing: u32,
}

/// Share of the expected velocity that a sound axis may lack.
const GAIN_SHARE: f32 = 0.3;
/// Natural frequency under a load of three times the mass over that of the model.
const HEAVY: f32 = 0.58;
/// Share of the expected motion below which there is none.
const STANDING_SHARE: f32 = 0.2;

impl Shortfall {
    /// Begins beside a swing of this speed, of which the expectation knows nothing.
    pub(crate) fn beside(speed: f32) -> Self {
        Self {
            peaks: [[0.0; 2], [speed; 2]],
            ..Self::default()
        }
    }

    /// One sample: velocities as expected, as the valve lets expect, and as measured.
    #[inline]
    pub(crate) fn update(
        &mut self,
        expected: f32,
        commanded: f32,
        measured: f32,
        bounds: &Bounds,
    ) -> Option<Short> {
        let step = bounds.sample_time;
        let speed = expected.abs();
        let change = (expected - self.last).abs();
        self.last = expected;
        self.swing = self.swing_of(expected, measured, bounds);
        let way = if expected != 0.0 { expected } else { commanded };
        let turned = way * self.way < 0.0;
        if way != 0.0 {
            self.way = way;
        }
        let along = if self.way > 0.0 { measured } else { -measured };
        let tolerance = bounds.drift + GAIN_SHARE * speed + bounds.short.late_rate * change;
        let short = self.short + step * (speed - along - tolerance);
        if turned || !(short > 0.0) {
            self.short = 0.0;
            self.expected = 0.0;
            self.measured = 0.0;
            self.path = 0.0;
            self.speed = speed;
            self.along = along;
            self.stood = along.abs() <= STANDING_SHARE * speed;
            self.standing = 0;
            return None;
        }
        self.short = short;
        let share = bounds.short.share;
        self.speed += share * (speed - self.speed);
        self.along += share * (along - self.along);
        self.expected += step * speed;
        self.measured += step * along;
        self.path += step * along.abs();
        let lacks = self.measured < STANDING_SHARE * self.expected;
        let alarm = lacks && short > bounds.short.level + self.swing;
        let little = STANDING_SHARE * self.speed;
        let moved = self.path > STANDING_SHARE * self.expected;
        let held = self.stood && short <= bounds.short.held + self.swing;
        let stands = alarm && !(moved || held) && self.along.abs() <= little;
        self.standing = if stands {
            self.standing.saturating_add(1)
        } else {
            0
        };
        if self.standing > bounds.opposite {
            Some(if self.is_displaced(bounds) {
                Short::Against
            } else {
                Short::Standing
            })
        } else if alarm && self.along < -little {
            Some(Short::Against)
        } else {
            None
        }
    }

    /// The displacement of a swing: of the one that follows the fastest recent motion, or of the
    /// one that is seen, whichever is larger.
    #[inline]
    fn swing_of(&mut self, expected: f32, measured: f32, bounds: &Bounds) -> f32 {
        let kept = 1.0 - HEAVY * bounds.share;
        let mut swing = 0.0;
        for ([up, down], velocity) in self.peaks.iter_mut().zip([expected, measured]) {
            *up = larger(kept * *up, velocity);
            *down = larger(kept * *down, -velocity);
            swing = larger(swing, if up < down { *up } else { *down });
        }
        let kept = 1.0 - 0.25 * bounds.share;
        self.fastest *= kept;
        if !(self.short > 0.0) {
            // A motion that runs away is no excuse for itself.
            self.fastest = larger(self.fastest, larger(expected.abs(), measured.abs()));
        }
        larger(bounds.short.swing * swing, bounds.short.ring * self.fastest)
    }

    /// The displacement of a swing, by which the axis and its expectation may be apart.
    pub(crate) const fn swing(&self) -> f32 {
        self.swing
    }

    /// Whether the axis is where nothing but a drive can have moved it, against its commands.
    pub(crate) fn is_displaced(&self, bounds: &Bounds) -> bool {
        -self.measured > bounds.short.level
    }

    /// Whether the axis moves against what its commands let expect.
    pub(crate) fn is_against(expected: f32, measured: f32, bounds: &Bounds) -> bool {
        expected * measured < 0.0 && expected.abs() > bounds.end_speed
    }
}

#[cfg(test)]
mod tests;
