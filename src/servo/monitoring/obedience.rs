//! Whether the axis does what it is commanded.

use crate::servo::monitoring::bounds::Bounds;
use crate::servo::monitoring::closing::Closing;
use crate::servo::monitoring::mirror::Mirror;
use crate::servo::monitoring::shortfall::{Short, Shortfall};
use crate::servo::monitoring::twin::Twin;
use crate::servo::supervision::state::Reason;

/// The measured motion against the one that the commands let expect.
///
/// | measured | monitor | reason |
/// |---|---|---|
/// | none | [`Shortfall`] | `Blocked` |
/// | the other way | [`Shortfall`], then [`Mirror`] and [`Closing`] | `WrongSign`, `ValveStuck` or `Blocked` |
/// | beyond three times the expected and twice the slack, for 1/(2 w) | displacements of the last 4/w | `ValveStuck` |
///
/// The slack is the displacement that a dead zone and an offset as wrong as a commissioning may leave them, friction,
/// noise and resolution make.
/// Cost: about 100 instructions.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Obedience {
    shortfall: Shortfall,
    mirror: Mirror,
    closing: Closing,
    runaway: u32,
}

/// What an axis is found to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Found {
    /// What it is commanded, as far as is known.
    Nothing,
    /// It moves against its commands: the valve must close, which also shows why.
    Against,
    /// It does not obey, for this reason.
    Disobeys(Reason),
}

/// Expected displacements above which the valve is open by itself.
const RUNAWAY_RATIO: f32 = 3.0;

impl Obedience {
    /// One sample.
    #[inline]
    pub(crate) fn update(&mut self, twin: &Twin, velocity: f32, bounds: &Bounds) -> Found {
        if self.closing.is_active() {
            return match self.closing.update(velocity) {
                Some(reason) => Found::Disobeys(reason),
                None => Found::Against,
            };
        }
        self.mirror.update(twin.velocity(), velocity, bounds);
        let short = self.shortfall.update(twin.velocity(), velocity, bounds);
        let (e, m) = (twin.expected().abs(), twin.measured().abs());
        let runs_away = m > 2.0 * twin.slack(bounds) + RUNAWAY_RATIO * e;
        self.runaway = if runs_away {
            self.runaway.saturating_add(1)
        } else {
            0
        };
        match short {
            Some(Short::Standing) => Found::Disobeys(Reason::Blocked),
            Some(Short::Against) => self.against(velocity, bounds),
            None if self.runaway > bounds.opposite => Found::Disobeys(Reason::ValveStuck),
            None => Found::Nothing,
        }
    }

    /// Displacement by which a swing may set the axis and its expectation apart.
    pub(crate) const fn swing(&self) -> f32 {
        self.shortfall.swing()
    }

    /// What an axis does that runs to its end: when it is not its speed, it moves against its commands.
    pub(crate) fn at_end(&mut self, twin: &Twin, velocity: f32, bounds: &Bounds) -> Found {
        if Shortfall::is_against(twin.velocity(), velocity, bounds) {
            self.against(velocity, bounds)
        } else {
            Found::Disobeys(Reason::TravelEnd)
        }
    }

    fn against(&mut self, velocity: f32, bounds: &Bounds) -> Found {
        let mirrored = self.mirror.is_mirrored();
        self.closing.begin(velocity, mirrored, bounds);
        Found::Against
    }
}
