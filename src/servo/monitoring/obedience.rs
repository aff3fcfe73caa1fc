//! Whether the axis does what it is commanded.

use crate::servo::monitoring::bounds::Bounds;
use crate::servo::monitoring::twin::Twin;
use crate::servo::supervision::state::Reason;

/// The measured displacement of the last few 1/w against the one that the commands let expect.
///
/// | expected | measured | reason |
/// |---|---|---|
/// | beyond twice the slack | less than a fifth of it | `Blocked` |
/// | beyond the slack | beyond the slack, the other way | `WrongSign` or `ValveStuck` |
/// | any | beyond three times the expected and twice the slack | `ValveStuck` |
///
/// The slack is the displacement that a dead zone and an offset as wrong as a commissioning may leave them, friction,
/// noise and resolution make. A valve with a fifth to three times its gain obeys. Each must last: a period of noise or a
/// breakaway does not.
///
/// Against the command: with the wrong sign the axis moves the more, the more is commanded; a spool that is stuck moves it
/// by itself, and what is commanded makes no difference. The regression of the measured on the expected velocity
/// over the same window tells them apart.
/// Cost: about 50 instructions.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Obedience {
    still: u32,
    opposite: u32,
    runaway: u32,
    /// Leaky means of expected and measured velocity, and of their products.
    mean: [f32; 2],
    square: f32,
    product: f32,
}

/// Share of the expected displacement below which there is no motion.
const STILL_SHARE: f32 = 0.2;
/// Expected displacements above which the valve is open by itself.
const RUNAWAY_RATIO: f32 = 3.0;
/// Slope of the regression below which the sign is wrong: half of the gain, the other way.
const WRONG_SIGN_SLOPE: f32 = -0.5;

const fn count(samples: &mut u32, holds: bool) -> u32 {
    *samples = if holds { samples.saturating_add(1) } else { 0 };
    *samples
}

impl Obedience {
    /// One sample; the reason when the axis does not obey.
    #[inline]
    pub(crate) fn update(&mut self, twin: &Twin, velocity: f32, bounds: &Bounds) -> Option<Reason> {
        self.regress(twin.velocity(), velocity, bounds.share);
        let (expected, measured) = (twin.expected(), twin.measured());
        let (e, m, slack) = (expected.abs(), measured.abs(), bounds.slack);
        let still = e > 2.0 * slack && m < STILL_SHARE * e;
        let opposite = expected * measured < 0.0 && e > slack && m > slack;
        let runaway = m > 2.0 * slack + RUNAWAY_RATIO * e;
        if count(&mut self.still, still) > bounds.no_motion {
            return Some(Reason::Blocked);
        }
        if count(&mut self.opposite, opposite) > bounds.opposite {
            return Some(if self.slope() < WRONG_SIGN_SLOPE {
                Reason::WrongSign
            } else {
                Reason::ValveStuck
            });
        }
        if count(&mut self.runaway, runaway) > bounds.opposite {
            return Some(Reason::ValveStuck);
        }
        None
    }

    #[inline]
    fn regress(&mut self, expected: f32, measured: f32, share: f32) {
        self.mean[0] += share * (expected - self.mean[0]);
        self.mean[1] += share * (measured - self.mean[1]);
        self.square += share * (expected * expected - self.square);
        self.product += share * (expected * measured - self.product);
    }

    /// Slope of the measured over the expected velocity.
    fn slope(&self) -> f32 {
        let variance = self.square - self.mean[0] * self.mean[0];
        if variance > 0.0 {
            (self.product - self.mean[0] * self.mean[1]) / variance
        } else {
            0.0
        }
    }
}
