//! Coulomb friction that sticks: the drive force at rest, breakaway, and the friction learned from reversals.

use crate::math::within;
use crate::servo::design::StickSlipDesign;
use crate::servo::design::constants::{
    BREAKAWAY_LATENCY, BREAKAWAY_RATIO, FRICTION_LEARNING_SHARE, FRICTION_RANGE, MEAN_LAG_RATIO,
    REST_DRIVE_MAX_RATIO, REVERSAL_RAMP_MIN, STOP_HOLD_RATIO,
};
use crate::servo::motion::Motion;

/// Stick-slip friction as a state machine beside an observer: the axis moves in a direction, or sticks.
///
/// ```text
/// moving    x'' = p - friction sgn(x')
/// sticking  x' = x'' = 0,   p' = b0 flow
/// moving -> sticking: the velocity changes its sign while |p| < 1.2 friction
/// sticking -> moving: the mean of the measured position leaves the place of rest
/// ```
///
/// The *drive* p is the acceleration that the drive force alone would give. At rest it cannot be measured, but it is
/// known from the commands.
///
/// | symbol | field | unit |
/// |---|---|---|
/// | friction | `coulomb` | y/s^2 |
/// | p | `drive` | y/s^2 |
///
/// Known as: Karnopp model of stick-slip friction (Karnopp 1985), with breakaway above the Coulomb level.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StickSlip {
    design: StickSlipDesign,
    /// Coulomb friction of the model.
    nominal: f32,
    /// Present Coulomb friction: that of the model, corrected by the forces of reversals.
    coulomb: f32,
    /// Direction of motion; 0 while the axis sticks or the model has no friction.
    direction: f32,
    drive: f32,
    /// Direction of the motion that ended here; 0 when the drive since then is not known.
    stopped_from: f32,
    /// Samples since the axis began to stick, or to move.
    since: u32,
    /// Mean rate of the drive while the axis sticks.
    ramp: f32,
    /// Mean innovation while the axis sticks.
    innovation: f32,
}

/// The sign of a value that is not zero.
#[inline]
fn sign(value: f32) -> f32 {
    if value > 0.0 { 1.0 } else { -1.0 }
}

/// `friction` within [`FRICTION_RANGE`] of `nominal`.
#[inline]
fn bounded(friction: f32, nominal: f32) -> f32 {
    let [least, most] = FRICTION_RANGE.map(|share| share * nominal);
    if friction > most {
        most
    } else if friction > least {
        friction
    } else {
        least
    }
}

impl StickSlip {
    /// Friction of a model, at rest.
    pub(crate) const fn new(design: &StickSlipDesign, coulomb: f32) -> Self {
        Self {
            design: *design,
            nominal: coulomb,
            coulomb,
            direction: 0.0,
            drive: 0.0,
            stopped_from: 0.0,
            since: 0,
            ramp: 0.0,
            innovation: 0.0,
        }
    }

    /// Goes on with the friction of another model; the correction by reversals stays, within the range about it.
    pub(crate) fn retune(&mut self, coulomb: f32) {
        self.nominal = coulomb;
        self.coulomb = if self.coulomb > 0.0 {
            bounded(self.coulomb, coulomb)
        } else {
            coulomb
        };
    }

    /// Begins with a velocity and without drive.
    pub(crate) fn place(&mut self, velocity: f32) {
        self.innovation = 0.0;
        self.ramp = 0.0;
        self.drive = 0.0;
        self.direction = if velocity == 0.0 || velocity.is_nan() {
            0.0
        } else {
            sign(velocity)
        };
    }

    /// Whether the model has friction and the axis sticks.
    #[inline]
    pub(crate) fn sticks(&self) -> bool {
        self.coulomb > 0.0 && self.direction == 0.0
    }

    /// The drive p of an axis with this acceleration.
    #[inline]
    pub(crate) fn drive(&self, acceleration: f32) -> f32 {
        if self.sticks() {
            self.drive
        } else {
            acceleration + self.coulomb * self.direction
        }
    }

    /// Acceleration lost to friction, with the sign of the motion: at rest, all of the drive.
    #[inline]
    pub(crate) fn force(&self) -> f32 {
        if self.sticks() {
            self.drive
        } else {
            self.coulomb * self.direction
        }
    }

    /// Coulomb friction as it is now, as an acceleration.
    pub(crate) const fn coulomb(&self) -> f32 {
        self.coulomb
    }

    /// Drive at which the axis breaks away.
    pub(crate) fn breakaway(&self) -> f32 {
        BREAKAWAY_RATIO * self.coulomb
    }

    /// Samples since the axis began to stick, or to move.
    pub(crate) const fn since(&self) -> u32 {
        self.since
    }

    /// Limits the drive at rest to the friction: while the valve moves about its dead zone, no more is known.
    #[inline]
    pub(crate) fn limit_drive(&mut self) {
        let limited = within(self.drive, self.coulomb);
        if limited != self.drive {
            self.drive = limited;
            self.stopped_from = 0.0;
        }
    }

    /// Counts a sample.
    #[inline]
    pub(crate) const fn tick(&mut self) {
        self.since = self.since.saturating_add(1);
    }

    /// One sample at rest while the drive changes by `rate` per s; the acceleration if it breaks away by force.
    #[inline]
    pub(crate) fn hold(&mut self, rate: f32) -> Option<f32> {
        self.drive += self.design.sample_time * rate;
        self.ramp += self.design.mean_share * (rate - self.ramp);
        if self.design.breakaway_distance == f32::INFINITY {
            // Without measurements the axis can only break away by force.
            let limit = STOP_HOLD_RATIO * self.coulomb;
            if within(self.drive, limit) == self.drive {
                return None;
            }
            self.direction = sign(self.drive);
            return Some(self.drive - self.coulomb * self.direction);
        }
        self.drive = within(self.drive, REST_DRIVE_MAX_RATIO * self.coulomb);
        None
    }

    /// One sample of motion: the drive stays known in case the start was a false one.
    #[inline]
    pub(crate) fn carry(&mut self, change: f32) {
        self.drive += change;
    }

    /// Where the velocity has changed its sign: sticks, or reverses. Corrects `motion` accordingly.
    #[inline]
    pub(crate) fn stop(&mut self, motion: &mut Motion) {
        let friction = self.coulomb;
        if !(friction > 0.0 && motion.velocity * self.direction <= 0.0) {
            return;
        }
        let measured = self.design.breakaway_distance != f32::INFINITY;
        let false_start = self.since < self.design.false_start && measured;
        let drive = if false_start {
            within(self.drive, REST_DRIVE_MAX_RATIO * friction)
        } else {
            self.drive(motion.acceleration)
        };
        let hold = STOP_HOLD_RATIO * friction;
        self.since = 0;
        if !false_start && (drive > hold || drive < -hold) {
            self.direction = sign(drive);
            motion.acceleration = drive - friction * self.direction;
            return;
        }
        self.drive = drive;
        self.stopped_from = self.direction;
        self.direction = 0.0;
        self.innovation = 0.0;
        self.ramp = 0.0;
        motion.velocity = 0.0;
        motion.acceleration = 0.0;
    }

    /// Takes an innovation at rest and corrects `motion`, which starts where the axis is seen to move.
    #[inline]
    pub(crate) fn observe(&mut self, innovation: f32, motion: &mut Motion) {
        if self.since < self.design.finding {
            // The place of rest is not known yet.
            motion.position += self.design.finding_share * innovation;
            return;
        }
        self.innovation += self.design.mean_share * (innovation - self.innovation);
        motion.position += self.design.drift_share * innovation;
        let limit = self.design.breakaway_distance;
        if self.innovation > limit || self.innovation < -limit {
            // The mean lags behind a movement that grows.
            self.break_away(MEAN_LAG_RATIO * self.innovation, motion);
        }
    }

    /// The axis has begun to move, and is seen `distance` from its place of rest.
    ///
    /// The drive exceeds the breakaway, which is not known, since a time t and by `ramp t`, which is:
    /// `x = ramp t^3 / 6`. Newton's method for t is + - x / only.
    #[inline(never)]
    fn break_away(&mut self, distance: f32, motion: &mut Motion) {
        self.since = 0;
        let direction = sign(distance);
        let ramp = self.ramp * direction;
        let ramp = if ramp > self.coulomb {
            ramp
        } else {
            self.coulomb
        };
        let cube = 6.0 * distance * direction / ramp;
        let mut t = 0.02;
        for _ in 0..8 {
            t = (2.0 * t + cube / (t * t)) * (1.0 / 3.0);
        }
        if self.stopped_from == -direction && ramp > REVERSAL_RAMP_MIN * self.coulomb {
            let drive = self.drive * direction;
            let end = drive - ramp * (t + BREAKAWAY_LATENCY);
            // A drive at its limit carries no information: then the friction is at least the present one.
            let saturated = drive >= REST_DRIVE_MAX_RATIO * self.coulomb && end < self.breakaway();
            self.learn(if saturated { self.breakaway() } else { end });
        }
        self.direction = direction;
        motion.position += distance;
        motion.velocity = 0.5 * direction * ramp * t * t;
        motion.acceleration = direction * within(ramp * t, self.coulomb);
    }

    /// Learns the friction from a reversal that ended at a drive of `end` in the new direction.
    ///
    /// The drive went from `a - friction` at the stop to `breakaway` at the start. Both ends scale with the
    /// friction, and the change between them is known from the commands, for any assumed friction.
    #[inline]
    fn learn(&mut self, end: f32) {
        let seen = (end + self.coulomb) * (1.0 / (1.0 + BREAKAWAY_RATIO));
        let next = self.coulomb + FRICTION_LEARNING_SHARE * (seen - self.coulomb);
        self.coulomb = bounded(next, self.nominal);
    }
}
