//! The axis at rest: when the valve rests, and how a sticking axis is made to move.

use crate::math::within;
use crate::servo::control::observer::Observer;
use crate::servo::design::StandstillDesign;
use crate::servo::design::constants::{
    HUNTING_HOPS_MAX, HUNTING_HOPS_MIN, HUNTING_WINDOW_GROWTH, PUSH_LEARNING_SHARE, PUSH_MAX,
    PUSH_RESTART_RATIO, PUSH_START, REST_WINDOW_ENTRY_RATIO, STICTION_RAMP_MIN,
};
use crate::servo::motion::Setpoint;

/// Rest window, breakaway push and hunting of an axis with friction that sticks.
///
/// Within the rest window the valve stays in the middle of its dead zone. A sticking axis beside its target gets a push
/// that grows until it moves; the push at which it moved is where the next one begins. Hops that are longer than the window
/// widen it: otherwise the axis would hunt, a limit cycle of stick-slip friction and integral action.
///
/// Known as: hunting, stick-slip compensation by a growing pulse (Armstrong-Helouvry, Dupont and Canudas de Wit 1994).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Standstill {
    design: StandstillDesign,
    /// Samples within the rest window.
    inside: u32,
    /// Flow that pushes the axis beside its target.
    push: f32,
    pushing: bool,
    /// How often the axis broke away beside the present target.
    hops: u16,
    /// Push at which the axis moved, downwards and upwards.
    moved_at: [f32; 2],
}

impl Standstill {
    pub(crate) const fn new(design: &StandstillDesign) -> Self {
        Self {
            design: *design,
            inside: 0,
            push: 0.0,
            pushing: false,
            hops: 0,
            moved_at: [PUSH_START; 2],
        }
    }

    /// The valve no longer rests.
    pub(crate) const fn wake(&mut self) {
        self.inside = 0;
    }

    /// Whether the valve rests because the axis stands within the window.
    #[inline]
    pub(crate) const fn rests(&self) -> bool {
        self.inside >= self.design.rest
    }

    /// Counts the samples in the window, and lets the push grow outside of it. Cost: about 40 instructions.
    #[inline]
    pub(crate) fn update(&mut self, r: &Setpoint, observer: &Observer) {
        let sticks = observer.sticks();
        let error = r.position - observer.motion().position;
        if !r.is_rest() {
            self.hops = 0;
        }
        self.grow(r.is_rest(), sticks, error, observer.friction().since());
        let still = sticks || observer.model().friction == 0.0;
        if !(self.design.rest_window > 0.0 && r.is_rest() && still) {
            self.inside = 0;
            return;
        }
        // Hops longer than the window would hunt for ever.
        let hops = self
            .hops
            .saturating_sub(HUNTING_HOPS_MIN)
            .min(HUNTING_HOPS_MAX);
        let wide = self.design.rest_window * (1.0 + HUNTING_WINDOW_GROWTH * f32::from(hops));
        // Wider while the valve rests, so that noise does not wake it.
        let window = if self.rests() {
            wide
        } else {
            REST_WINDOW_ENTRY_RATIO * wide
        };
        if within(error, window) != error {
            self.inside = 0;
        } else if !self.rests() {
            self.inside += 1;
        }
    }

    /// The push grows while the axis sticks, and is remembered when it moves.
    #[inline]
    fn grow(&mut self, at_rest: bool, sticks: bool, error: f32, since: u32) {
        let side = usize::from(error > 0.0);
        if sticks && at_rest {
            if !self.pushing {
                self.push = PUSH_RESTART_RATIO * self.moved_at[side];
            }
            // The longer it sticks, the less reliable is the dead zone.
            let haste = 1.0 + self.design.push_haste * since as f32;
            let next = self.push + self.design.push_growth * haste;
            self.push = if next < PUSH_MAX { next } else { PUSH_MAX };
            self.pushing = true;
            return;
        }
        if self.pushing && at_rest {
            self.hops = self.hops.saturating_add(1);
            // It moved: the dead zone of this side, where the next push begins.
            self.moved_at[side] += PUSH_LEARNING_SHARE * (self.push - self.moved_at[side]);
        }
        self.pushing = false;
    }

    /// The rate of the drive, over b0, that makes a sticking axis follow a reference in `direction`.
    ///
    /// The drive p is brought to where the axis breaks away, by `needed` beyond it, not slower than a ramp that grows.
    #[inline]
    pub(crate) fn follow(
        &self,
        direction: f32,
        error: f32,
        needed: f32,
        observer: &Observer,
        inverse_gain: f32,
    ) -> f32 {
        let friction = observer.friction();
        let goal = friction.breakaway() * direction + needed;
        let rate = (goal - observer.drive()) * self.design.stick_rate;
        // The drive is there and the axis still sticks: the drive estimate is wrong.
        let least = STICTION_RAMP_MIN
            * friction.coulomb()
            * (1.0 + self.design.ramp_haste * friction.since() as f32);
        let rate = if rate * direction > least {
            rate
        } else if error * direction > 0.0 {
            least * direction
        } else {
            rate
        };
        rate * inverse_gain
    }

    /// The flow that moves a sticking axis toward a target at rest: quickly to the friction, then slowly until it moves.
    #[inline]
    pub(crate) fn approach(&self, error: f32, observer: &Observer, inverse_gain: f32) -> f32 {
        let direction = if error > 0.0 { 1.0 } else { -1.0 };
        let missing = observer.friction().coulomb() - direction * observer.drive();
        let quick = if missing > 0.0 {
            missing * self.design.stick_rate * inverse_gain
        } else {
            0.0
        };
        direction * (quick + self.push)
    }
}
