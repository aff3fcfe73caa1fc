//! The window about a target within which the valve rests, and how hunting widens it.

use crate::math::within;

/// Numbers of the window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RestDesign {
    /// Smallest window: noise and resolution.
    pub(crate) least: f32,
    /// Largest window, from the model; at least the smallest.
    pub(crate) most: f32,
    /// Whether friction can hold the axis: an approach ends where it stands.
    pub(crate) sticky: bool,
    /// Command per unit of the error by which a valve at rest leads an axis that nothing holds; 0
    /// of one that friction holds.
    pub(crate) lead: f32,
}

/// A window that hunting widens.
///
/// A hop of stick-slip of length h, with integral action, is a limit cycle exactly when it exceeds
/// the window on both sides. Each hunt - a hop past the target and out of the window, or a second
/// way through it without a stop - widens it by 1.25: the cycle ends after
/// `log(h / 2 W) / log 1.25` hops. A stop at the first attempt narrows it again. It is kept from
/// target to target.
///
/// What no window ends widens none: where friction ends an approach, the first way through is its
/// overshoot, and an axis that slips from its rest was moved by what drifts, see
/// [`Holding`](crate::servo::control::holding::Holding).
///
/// An axis that nothing holds rests behind a closed valve. Where it leaves the window by far after
/// it was well inside, the approach begins again, which is one more turn of such a cycle, though it
/// may be on one side of the target only. That is a hunt, too.
///
/// Known as: hunting of stiction and integral action (Armstrong-Helouvry, Dupont and Canudas de
/// Wit 1994).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RestWindow {
    design: RestDesign,
    window: f32,
    resting: bool,
    /// Error with which the valve came to rest last.
    rested_at: f32,
    /// Side of the target where the axis was beyond the window last, and whether it has gone to the
    /// other one before; 0 since the reference came to rest or the axis stood.
    side: f32,
    crossed: bool,
    /// Whether an axis that nothing holds was well inside of the window since then, and has not
    /// left it by far.
    inside: bool,
    hunts: u16,
    stopped: bool,
}

/// Windows within which integral action is frozen while friction may hold the axis, and beyond
/// which an axis that nothing holds has left its window by far.
const FROZEN: f32 = 1.5;
/// Part of the window within which an axis is well inside of it: where nothing holds it, there the
/// valve closes, and integral action waits.
pub(super) const INSIDE: f32 = 0.5;
const WIDER: f32 = 1.25;
const NARROWER: f32 = 0.8;
/// Part of the window that stays with another model.
const KEPT: f32 = 0.5;
/// Window that wakes the valve over the one at which it rests: noise does not wake it.
const WAKE: f32 = 1.3;

impl RestWindow {
    pub(crate) const fn new(design: &RestDesign) -> Self {
        Self {
            design: *design,
            window: design.least,
            resting: false,
            rested_at: 0.0,
            side: 0.0,
            crossed: !design.sticky,
            inside: false,
            hunts: 0,
            stopped: false,
        }
    }

    /// Goes on with other limits.
    pub(crate) fn redesign(&mut self, design: &RestDesign) {
        self.design = *design;
        self.bound();
    }

    /// The loop is another one: half of what hunting has widened is forgotten. All of it would have
    /// to be learnt again, by hunting; none of it would keep what a wrong model made.
    pub(crate) fn forget(&mut self) {
        self.window *= KEPT;
        self.bound();
    }

    fn bound(&mut self) {
        if self.window > self.design.most {
            self.window = self.design.most;
        }
        if !(self.window > self.design.least) {
            self.window = self.design.least;
        }
    }

    /// The valve no longer rests.
    pub(crate) const fn wake(&mut self) {
        self.resting = false;
        self.inside = false;
        self.stands();
        self.hunts = 0;
        self.stopped = false;
    }

    /// What comes now is another motion.
    const fn stands(&mut self) {
        self.side = 0.0;
        self.crossed = !self.design.sticky;
    }

    fn hunt(&mut self) {
        self.hunts = self.hunts.saturating_add(1);
        self.window *= WIDER;
        self.bound();
    }

    /// A hop has led past the target, to where the axis sticks now.
    pub(crate) fn overshot(&mut self, error: f32) {
        if error.abs() > self.window {
            self.hunt();
        }
    }

    /// Takes the error of a sample; `still`: the axis stands. Cost: about 25 instructions.
    #[inline]
    pub(crate) fn update(&mut self, error: f32, still: bool) {
        let size = error.abs();
        if self.resting {
            self.resting = size <= WAKE * self.window;
            return;
        }
        if still {
            self.stands();
        }
        if !self.design.sticky {
            self.drift(size);
        }
        if size > self.window {
            let side = if error > 0.0 { 1.0 } else { -1.0 };
            if self.side * side < 0.0 {
                if self.crossed {
                    self.hunt();
                }
                self.crossed = true;
            }
            self.side = side;
        } else if still && (self.design.sticky || size < INSIDE * self.window) {
            (self.resting, self.rested_at) = (true, error);
            if !self.stopped && self.hunts == 0 {
                self.window *= NARROWER;
                self.bound();
                // The window that is in force holds the axis where it stopped.
                if size > self.window {
                    self.window = size;
                }
            }
            self.stopped = true;
        }
    }

    /// An error of an axis that nothing holds.
    #[inline]
    fn drift(&mut self, size: f32) {
        if size < INSIDE * self.window {
            self.inside = true;
        } else if self.inside && size > FROZEN * self.window {
            self.inside = false;
            self.hunt();
        }
    }

    /// Whether integral action waits at an error of a target at rest.
    ///
    /// An axis that nothing holds stands where the part of the dead zone that is not known takes
    /// the command: well inside of the window the valve closes, further out only integral action
    /// brings the axis nearer.
    pub(crate) fn freezes(&self, error: f32) -> bool {
        let (at_rest, windows) = match self.design.sticky {
            true => (false, FROZEN),
            false => (self.resting, INSIDE),
        };
        at_rest || within(error, windows * self.window) == error
    }

    /// Whether a hunt would widen the window.
    pub(crate) fn can_widen(&self) -> bool {
        self.window < self.design.most
    }

    /// Error with which the valve came to rest last.
    pub(crate) const fn rested_at(&self) -> f32 {
        self.rested_at
    }

    /// Whether friction can hold the axis.
    pub(crate) const fn sticky(&self) -> bool {
        self.design.sticky
    }

    /// Command by which a valve at rest leads an axis that nothing holds, at an error.
    pub(crate) const fn lead(&self, error: f32) -> f32 {
        self.design.lead * error
    }

    pub(crate) const fn rests(&self) -> bool {
        self.resting
    }

    pub(crate) const fn window(&self) -> f32 {
        self.window
    }
}

#[cfg(test)]
mod tests;
