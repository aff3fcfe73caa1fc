//! Whether the axis does what it is commanded.

use crate::servo::monitoring::bounds::Bounds;
use crate::servo::monitoring::twin::Twin;
use crate::servo::supervision::state::Reason;

/// The measured displacement of the last few 1/w against the one that the commands let expect.
///
/// | expected | measured | reason |
/// |---|---|---|
/// | beyond 1.75 times the slack, what friction may hold | less than a fifth of what is beyond the slack, and slow | `Blocked` |
/// | beyond half the slack | the other way, both now and in the window, three times the slack apart | `WrongSign` or `ValveStuck` |
/// | any | beyond three times the expected and twice the slack | `ValveStuck` |
///
/// The slack is the displacement that a dead zone and an offset as wrong as a commissioning may leave them, friction,
/// noise and resolution make. A valve with a fifth to three times its gain obeys. Each must last: a period of noise or a
/// breakaway does not.
///
/// Against the command: with the wrong sign the axis moves the more, the more is commanded; a spool that is stuck moves it
/// by itself, and what is commanded makes no difference. The regression of the measured on the expected velocity
/// over the last 1.3/w tells them apart.
/// Cost: about 50 instructions.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Obedience {
    still: u32,
    opposite: u32,
    runaway: u32,
    /// Leaky means of expected and measured velocity, and of their products.
    mean: [f32; 2],
    square: [f32; 2],
    product: f32,
}

/// Share of the expected displacement below which there is no motion.
const STILL_SHARE: f32 = 0.2;
/// Expected displacements above which the valve is open by itself.
const RUNAWAY_RATIO: f32 = 3.0;
/// Slope of the regression below which the sign is wrong: some half of the gain, the other way.
const WRONG_SIGN_SLOPE: f32 = -0.4;
/// Share of the variance of the measured velocity that it must then explain.
const WRONG_SIGN_R_SQUARED: f32 = 0.6;
/// Rate of the regression over that of the displacements: what was before the fault is soon forgotten.
const REGRESSION_RATE: f32 = 3.0;

const fn count(samples: &mut u32, holds: bool) -> u32 {
    *samples = if holds { samples.saturating_add(1) } else { 0 };
    *samples
}

impl Obedience {
    /// One sample; the reason when the axis does not obey.
    #[inline]
    pub(crate) fn update(&mut self, twin: &Twin, velocity: f32, bounds: &Bounds) -> Option<Reason> {
        self.regress(twin.velocity(), velocity, REGRESSION_RATE * bounds.share);
        let (expected, measured) = (twin.expected(), twin.measured());
        let (e, m, slack) = (expected.abs(), measured.abs(), twin.slack(bounds));
        let slow = velocity.abs() < bounds.drift;
        let still = e > 1.75 * slack && slow && m < STILL_SHARE * (e - slack);
        let apart = expected * measured < 0.0 && twin.velocity() * velocity < 0.0;
        let opposite = apart && e > 0.5 * slack && m > 0.5 * slack && e + m > 3.0 * slack;
        let runaway = m > 2.0 * slack + RUNAWAY_RATIO * e;
        if count(&mut self.still, still) > bounds.no_motion {
            return Some(Reason::Blocked);
        }
        if count(&mut self.opposite, opposite) > bounds.opposite {
            return Some(self.against_reason());
        }
        if count(&mut self.runaway, runaway) > bounds.opposite {
            return Some(Reason::ValveStuck);
        }
        None
    }

    #[inline]
    fn regress(&mut self, expected: f32, measured: f32, rate: f32) {
        let share = if rate < 1.0 { rate } else { 1.0 };
        self.mean[0] += share * (expected - self.mean[0]);
        self.mean[1] += share * (measured - self.mean[1]);
        self.square[0] += share * (expected * expected - self.square[0]);
        self.square[1] += share * (measured * measured - self.square[1]);
        self.product += share * (expected * measured - self.product);
    }

    /// The reason for which an axis that runs to its end does so, when it is not its speed: it moves against the command.
    pub(crate) fn end_reason(&self, twin: &Twin, velocity: f32, bounds: &Bounds) -> Reason {
        let against = twin.velocity() * velocity < 0.0 && twin.velocity().abs() > bounds.end_speed;
        if against {
            self.against_reason()
        } else {
            Reason::TravelEnd
        }
    }

    fn against_reason(&self) -> Reason {
        if self.follows_the_other_way() {
            Reason::WrongSign
        } else {
            Reason::ValveStuck
        }
    }

    /// Whether the measured velocity is explained by the expected one with the other sign.
    fn follows_the_other_way(&self) -> bool {
        let [e, m] = self.mean;
        let (expected, measured) = (self.square[0] - e * e, self.square[1] - m * m);
        let product = self.product - e * m;
        product < WRONG_SIGN_SLOPE * expected
            && product * product > WRONG_SIGN_R_SQUARED * expected * measured
    }
}
