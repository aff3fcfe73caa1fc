//! Observer of velocity, acceleration and disturbance on the identified model, with friction that sticks.

use crate::math::within;
use crate::servo::model::ServoModel;
use crate::servo::motion::Motion;

/// Luenberger observer with a constant disturbance at the input of the model.
///
/// ```text
/// x' = v      v' = a      a' = - a1 v - a2 a + b0 (flow + d)      d' = 0
/// correction by (y - x): l1, l2, l3, l4 times Delta
/// s^4 + (l1+a2) s^3 + (l2+a2 l1+a1) s^2 + (l3+a2 l2+a1 l1) s + b0 l4 = (s + w)^3 (s + 0.3 w)
/// without disturbance:  l4 = 0 and the first four terms divided by s are (s + w)^3
/// ```
///
/// d is what the controller subtracts: it is the integral action, and because the
/// observer sees the command that was really set it does not wind up.
///
/// A drive with Coulomb friction has a second state of being: it sticks. Then position stays,
/// and the *drive* p, the acceleration that the drive force alone would give, goes on by
/// `p' = b0 flow`: it cannot be measured, but it is known from the commands. It sticks when the
/// velocity changes its sign while |p| is below the breakaway; it starts when the measured
/// position leaves the place of rest.
///
/// # Examples
/// ```
/// use trendid::{Motion, Observer, ServoModel};
/// let mut observer = Observer::new(ServoModel::linear(400.0, 20.0, 1.0e6), 120.0, 0.001);
/// observer.place(Motion { position: 5.0, ..Motion::default() });
/// for _ in 0..500 {
///     observer.predict(0.0);
///     observer.correct(6.0);
/// }
/// assert!((observer.motion().position - 6.0).abs() < 1e-3);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observer {
    model: ServoModel,
    motion: Motion,
    disturbance: f32,
    /// Direction of friction; 0 while it sticks or has none.
    direction: f32,
    /// The drive p while it sticks.
    drive: f32,
    /// Coulomb friction as it is now: that of the model, corrected by what reversals take.
    friction: f32,
    /// Direction of the motion that ended here, 0 when the drive since then is not known.
    before: f32,
    /// Samples since it began to stick, or to move.
    since: u16,
    /// Mean rate of the drive while it sticks.
    ramp: f32,
    /// Mean innovation while it sticks.
    creep: f32,
    /// Mean innovation at which it starts to move.
    start: f32,
    /// Velocity below which friction rules.
    slow: f32,
    /// Share of the disturbance that is forgotten per sample of slow motion.
    forget: f32,
    /// Whether there is a disturbance in the model of the observer.
    disturbed: bool,
    gain: [f32; 4],
    rate: f32,
    sample_time: f32,
}

/// Largest disturbance, as a flow: more than the full command is no disturbance.
const DISTURBANCE: f32 = 1.0;

/// The pole of the disturbance over the three of the motion.
const SLOWER: f32 = 0.3;

/// Breakaway over Coulomb friction: a drive that stops is held up to it, and one that is not measured starts at it.
const HOLD: f32 = 1.2;

/// Drive over Coulomb friction that no resting axis is believed to have: the dead zone is not known so well.
const BREAK: f32 = 4.0;

/// Rate of the drive over friction, per s, above which a start tells the friction.
const QUICK: f32 = 10.0;

/// Share of a new friction in the mean.
const LEARN: f32 = 0.5;

/// Breakaway over Coulomb friction at a reversal.
const BREAKAWAY: f32 = 1.5;

/// Friction over that of the model, at least and at most.
const GRIP: [f32; 2] = [0.25, 4.0];

/// Time in s by which valve and mean are late.
const LATE: f32 = 0.005;

/// Share of a new innovation in the mean while it sticks.
const CREEP: f32 = 0.2;

/// Samples in which the place of rest is found.
const SETTLING: u16 = 6;

/// Samples within which a start that ends is taken for none.
const FALSE_START: u16 = 25;

/// Movement over its mean when it is noticed.
const LAG: f32 = 2.0;

/// `friction` within the shares [`GRIP`] of `nominal`.
#[inline]
fn bounded(friction: f32, nominal: f32) -> f32 {
    let [least, most] = GRIP.map(|share| share * nominal);
    if friction > most {
        most
    } else if friction > least {
        friction
    } else {
        least
    }
}

impl Observer {
    /// An observer at rest in zero with three poles at `-rate` (rad/s) and that of the disturbance at 0.3 of it.
    ///
    /// `rate` times `sample_time` should stay below 0.3: the correction is a rectangle.
    pub fn new(model: ServoModel, rate: f32, sample_time: f32) -> Self {
        Self::build(model, rate, sample_time, true)
    }

    /// An observer of the motion alone, with three poles at `-rate`: what remains is the model's error.
    pub fn undisturbed(model: ServoModel, rate: f32, sample_time: f32) -> Self {
        Self::build(model, rate, sample_time, false)
    }

    fn build(model: ServoModel, rate: f32, sample_time: f32, disturbed: bool) -> Self {
        let mut observer = Self {
            model,
            motion: Motion::default(),
            disturbance: 0.0,
            direction: 0.0,
            drive: 0.0,
            friction: model.friction,
            before: 0.0,
            since: 0,
            ramp: 0.0,
            creep: 0.0,
            start: f32::INFINITY,
            slow: 0.0,
            forget: 0.2 * rate * sample_time,
            disturbed,
            gain: [0.0; 4],
            rate,
            sample_time,
        };
        observer.tune(model);
        observer
    }

    /// How far a resting axis must seem to have moved to count as moving; four standard deviations of the noise are good.
    ///
    /// `slow` is the velocity below which friction rules and no disturbance is learned.
    pub fn set_start(&mut self, distance: f32, slow: f32) {
        self.start = distance;
        self.slow = slow;
    }

    /// Goes on with another model; the observed motion and disturbance stay.
    pub fn tune(&mut self, model: ServoModel) {
        let w = self.rate;
        let [q3, q2, q1, q0] = if self.disturbed {
            let d = SLOWER * w;
            [
                3.0 * w + d,
                3.0 * w * (w + d),
                w * w * (w + 3.0 * d),
                w * w * w * d,
            ]
        } else {
            [3.0 * w, 3.0 * w * w, w * w * w, 0.0]
        };
        let l1 = q3 - model.a2;
        let l2 = q2 - model.a2 * l1 - model.a1;
        let l3 = q1 - model.a2 * l2 - model.a1 * l1;
        let l4 = q0 / model.b0;
        let t = self.sample_time;
        self.gain = [t * l1, t * l2, t * l3, t * l4];
        self.model = model;
        self.friction = if self.friction > 0.0 {
            bounded(self.friction, model.friction)
        } else {
            model.friction
        };
    }

    /// Begins at a motion, without disturbance.
    pub fn place(&mut self, motion: Motion) {
        self.motion = motion;
        self.disturbance = 0.0;
        self.creep = 0.0;
        self.ramp = 0.0;
        self.drive = 0.0;
        self.direction = if motion.velocity > 0.0 {
            1.0
        } else if motion.velocity < 0.0 {
            -1.0
        } else {
            0.0
        };
    }

    /// Whether the model has friction and the drive sticks.
    #[inline]
    pub fn sticks(&self) -> bool {
        self.friction > 0.0 && self.direction == 0.0
    }

    /// The drive p: the acceleration that the drive force alone would give.
    #[inline]
    pub fn drive(&self) -> f32 {
        if self.sticks() {
            self.drive
        } else {
            self.motion.acceleration + self.friction * self.direction
        }
    }

    /// Believes no more of the drive than friction itself, while the valve creeps about its dead zone.
    #[inline]
    pub fn doubt_drive(&mut self) {
        let believed = within(self.drive, self.friction);
        if believed != self.drive {
            self.drive = believed;
            self.before = 0.0;
        }
    }

    /// One sample on under the flow that was in force. Cost: about 50 instructions.
    #[inline]
    pub fn predict(&mut self, flow: f32) {
        self.since = self.since.saturating_add(1);
        if self.sticks() {
            let rate = self.model.b0 * flow;
            self.drive += self.sample_time * rate;
            self.ramp += CREEP * (rate - self.ramp);
            if self.start == f32::INFINITY {
                // By itself, without measurements, it can only start by force.
                let breakaway = HOLD * self.friction;
                if within(self.drive, breakaway) != self.drive {
                    self.move_off(if self.drive > 0.0 { 1.0 } else { -1.0 });
                }
                return;
            }
            self.drive = within(self.drive, BREAK * self.friction);
            return;
        }
        // Goes on beside the motion: should the start turn out to be none, the drive is still known.
        self.drive += self.sample_time * self.model.b0 * flow;
        self.model
            .advance(&mut self.motion, flow + self.disturbance, self.sample_time);
        self.turn();
    }

    /// Sticks, or reverses friction, where the velocity has changed its sign.
    #[inline]
    fn turn(&mut self) {
        let friction = self.friction;
        if !(friction > 0.0 && self.motion.velocity * self.direction <= 0.0) {
            return;
        }
        let false_start = self.since < FALSE_START && self.start != f32::INFINITY;
        let drive = if false_start {
            within(self.drive, BREAK * friction)
        } else {
            self.drive()
        };
        let hold = HOLD * friction;
        self.since = 0;
        if false_start {
            self.stick(drive);
        } else if drive > hold || drive < -hold {
            self.direction = if drive > 0.0 { 1.0 } else { -1.0 };
            self.motion.acceleration = drive - friction * self.direction;
        } else {
            self.stick(drive);
        }
    }

    /// Sticks from now on, under `drive`.
    #[inline]
    fn stick(&mut self, drive: f32) {
        self.drive = drive;
        self.before = self.direction;
        self.direction = 0.0;
        self.creep = 0.0;
        self.ramp = 0.0;
        self.motion.velocity = 0.0;
        self.motion.acceleration = 0.0;
    }

    /// Begins to move in `direction` by force.
    #[inline]
    fn move_off(&mut self, direction: f32) {
        self.direction = direction;
        self.motion.acceleration = self.drive - self.friction * direction;
    }

    /// Has begun to move, and is seen `distance` from its place.
    ///
    /// The drive exceeds the breakaway, which is not known, since a time t and by `ramp t`, which is:
    /// `x = ramp t^3 / 6`. Newton's method for t is + - x / only.
    #[inline(never)]
    fn moved_off(&mut self, distance: f32) {
        self.since = 0;
        let direction = if distance > 0.0 { 1.0 } else { -1.0 };
        let ramp = self.ramp * direction;
        let ramp = if ramp > self.friction {
            ramp
        } else {
            self.friction
        };
        let cube = 6.0 * distance * direction / ramp;
        let mut t = 0.02;
        for _ in 0..8 {
            t = (2.0 * t + cube / (t * t)) * (1.0 / 3.0);
        }
        if self.before == -direction && ramp > QUICK * self.friction {
            let drive = self.drive * direction;
            let end = drive - ramp * (t + LATE);
            // At its bound the drive has long stopped to count: then friction is not less than believed.
            let bound = drive >= BREAK * self.friction && end < self.breakaway();
            self.learn(if bound { self.breakaway() } else { end });
        }
        self.direction = direction;
        self.motion = Motion {
            position: self.motion.position + distance,
            velocity: 0.5 * direction * ramp * t * t,
            acceleration: direction * within(ramp * t, self.friction),
        };
    }

    /// Learns the friction from a reversal that ended at a drive of `end` in the new direction.
    ///
    /// The drive went from `a - friction` at the stop to `breakaway` at the start. Both ends scale with the
    /// friction, and the way between them is known from the commands, whatever was believed before.
    #[inline]
    fn learn(&mut self, end: f32) {
        let seen = (end + self.friction) * (1.0 / (1.0 + BREAKAWAY));
        let next = self.friction + LEARN * (seen - self.friction);
        self.friction = bounded(next, self.model.friction);
    }

    /// Takes a measured position; gives the innovation. Cost: about 30 instructions.
    #[inline]
    pub fn correct(&mut self, y: f32) -> f32 {
        let innovation = y - self.motion.position;
        if self.sticks() {
            if self.since < SETTLING {
                // The place of rest is not known yet.
                self.motion.position += 0.3 * innovation;
                return innovation;
            }
            self.creep += CREEP * (innovation - self.creep);
            self.motion.position += 0.02 * innovation;
            if self.creep > self.start || self.creep < -self.start {
                // The mean lags behind a movement that grows.
                self.moved_off(LAG * self.creep);
            }
            return innovation;
        }
        self.motion.position += self.gain[0] * innovation;
        self.motion.velocity += self.gain[1] * innovation;
        self.motion.acceleration += self.gain[2] * innovation;
        if self.friction > 0.0 && within(self.motion.velocity, self.slow) == self.motion.velocity {
            // Slow motion is ruled by friction, which is no flow.
            self.disturbance -= self.forget * self.disturbance;
        } else {
            let d = self.disturbance + self.gain[3] * innovation;
            self.disturbance = within(d, DISTURBANCE);
        }
        self.turn();
        innovation
    }

    /// Samples since the axis began to stick, or to move.
    pub(crate) const fn since(&self) -> u16 {
        self.since
    }

    /// What friction takes of the acceleration, with the sign of the motion that it hinders: while it sticks, all of the drive.
    #[inline]
    pub fn friction(&self) -> f32 {
        if self.sticks() {
            self.drive
        } else {
            self.friction * self.direction
        }
    }

    /// Coulomb friction as it is now, as an acceleration: the model's, corrected by what reversals take.
    pub const fn coulomb(&self) -> f32 {
        self.friction
    }

    /// Drive at which the axis breaks loose.
    pub fn breakaway(&self) -> f32 {
        BREAKAWAY * self.friction
    }

    /// The observed motion.
    pub const fn motion(&self) -> Motion {
        self.motion
    }

    /// The observed disturbance, as a flow.
    pub const fn disturbance(&self) -> f32 {
        self.disturbance
    }

    /// The model in use.
    pub const fn model(&self) -> &ServoModel {
        &self.model
    }
}
