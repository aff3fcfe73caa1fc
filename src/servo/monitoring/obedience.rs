//! Whether the axis does what it is commanded.

use crate::servo::monitoring::bounds::Bounds;
use crate::servo::monitoring::closing::Closing;
use crate::servo::monitoring::response::Response;
use crate::servo::monitoring::shortfall::{Short, Shortfall};
use crate::servo::monitoring::twin::Twin;
use crate::servo::supervision::state::Reason;

/// The measured motion against the one that the commands let expect.
///
/// | measured | monitor | reason |
/// |---|---|---|
/// | none | [`Shortfall`] | `Blocked` |
/// | the other way | [`Shortfall`], then [`Response`] and [`Closing`] | `WrongSign`, `ValveStuck` or `Blocked` |
/// | beyond three times the expected and twice the slack, for 1/(2 w) | displacements of the last 4/w | `ValveStuck` |
///
/// The slack is the displacement that a dead zone and an offset as wrong as a commissioning may
/// leave them, friction, noise and resolution make. Cost: about 100 instructions.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Obedience {
    shortfall: Shortfall,
    response: Response,
    closing: Closing,
    runaway: u32,
}

/// What an axis is found to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Conduct {
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
    /// Begins beside a swing of this speed, of which the expectation knows nothing.
    pub(crate) fn beside(speed: f32) -> Self {
        Self {
            shortfall: Shortfall::beside(speed),
            ..Self::default()
        }
    }

    /// One sample; `at_end`: the axis is at an end of its travel.
    #[inline]
    pub(crate) fn update(
        &mut self,
        twin: &Twin,
        velocity: f32,
        at_end: bool,
        bounds: &Bounds,
    ) -> Conduct {
        let closing = self.closing.is_active();
        let weight = self.closing.weight(at_end);
        self.response.update(twin.flow(), velocity, weight, bounds);
        if closing {
            return match self.closing.update(velocity, &self.response) {
                Some(reason) => Conduct::Disobeys(reason),
                None => Conduct::Against,
            };
        }
        let short =
            self.shortfall
                .update(twin.velocity(), self.response.commanded(), velocity, bounds);
        let (e, m) = (twin.expected().abs(), twin.measured().abs());
        let runs_away = m > 2.0 * twin.slack(bounds) + RUNAWAY_RATIO * e;
        self.runaway = if runs_away {
            self.runaway.saturating_add(1)
        } else {
            0
        };
        match short {
            Some(Short::Standing) => Conduct::Disobeys(Reason::Blocked),
            Some(Short::Against) => self.against(velocity, bounds),
            None if self.runaway > bounds.opposite => Conduct::Disobeys(Reason::ValveStuck),
            None => Conduct::Nothing,
        }
    }

    /// Whether the valve is being closed to find out why the axis moves against its commands.
    pub(crate) const fn is_closing(&self) -> bool {
        self.closing.is_active()
    }

    /// Displacement by which a swing may set the axis and its expectation apart.
    pub(crate) const fn swing(&self) -> f32 {
        self.shortfall.swing()
    }

    /// What an axis does that runs to its end: when it is not its speed, it moves against its
    /// commands.
    pub(crate) fn at_end(&mut self, twin: &Twin, velocity: f32, bounds: &Bounds) -> Conduct {
        if Shortfall::is_against(twin.velocity(), velocity, bounds) {
            self.against(velocity, bounds)
        } else {
            Conduct::Disobeys(Reason::TravelEnd)
        }
    }

    fn against(&mut self, velocity: f32, bounds: &Bounds) -> Conduct {
        self.closing.begin(velocity, &self.response, bounds);
        Conduct::Against
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::servo::model::Model;
    use crate::servo::monitoring::bounds::example;

    #[test]
    fn a_swing_is_that_of_the_motion_that_was_expected() {
        let bounds = example::bounds(&Model::linear(400.0, 16.0, 4e5));
        let mut obedience = Obedience::default();
        let mut alone = Shortfall::default();
        for velocity in [100.0, -100.0] {
            let _ = alone.update(velocity, velocity, velocity, &bounds);
            let shortfall = &mut obedience.shortfall;
            let _ = shortfall.update(velocity, velocity, velocity, &bounds);
        }
        assert!(alone.swing() > 0.1, "{}", alone.swing());
        assert_eq!(obedience.swing(), alone.swing());
    }
}
