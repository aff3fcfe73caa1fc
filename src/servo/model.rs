//! The model that the controller works with: an integrating drive behind a valve with dead zone and
//! offset.

use crate::servo::motion::Motion;

/// A position drive of third order behind a valve.
///
/// ```text
/// x''' = - a1 x' - a2 x'' + b0 (q(u) + offset)
/// q(u) = u - delta sgn(u)  for |u| > delta,  0 inside
/// ```
///
/// With Coulomb friction the drive force alone would give the acceleration p; while the
/// axis moves, `x'' = p - friction sgn(x')`, and it sticks while |p| stays below the breakaway.
///
/// | symbol | field | unit |
/// |---|---|---|
/// | a1 | `a1` | 1/s^2 |
/// | a2 | `a2` | 1/s |
/// | b0 | `b0` | y/s^3 per unit of u |
/// | delta | `dead_zone` | u |
/// | offset | `offset` | u |
/// | friction | `friction` | y/s^2 |
///
/// # Examples
/// ```
/// let model = trendid::servo::Model { dead_zone: 0.03, ..trendid::servo::Model::linear(400.0, 20.0, 1.0e6) };
/// assert!((model.flow(0.53) - 0.5).abs() < 1e-6);
/// assert_eq!(model.flow(0.02), 0.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[doc(alias = "ServoModel")]
pub struct Model {
    /// Square of the natural frequency.
    pub a1: f32,
    /// Twice damping times natural frequency.
    pub a2: f32,
    /// Gain of the command.
    pub b0: f32,
    /// Half width delta of the dead zone of the valve.
    pub dead_zone: f32,
    /// Effective command at a command of zero.
    pub offset: f32,
    /// Coulomb friction, as the acceleration that it takes away; 0 for a drive without friction.
    pub friction: f32,
}

impl Model {
    /// A drive without dead zone, offset and friction.
    pub const fn linear(a1: f32, a2: f32, b0: f32) -> Self {
        Self {
            a1,
            a2,
            b0,
            dead_zone: 0.0,
            offset: 0.0,
            friction: 0.0,
        }
    }

    /// Reads the model from theta = (a1, a2, b0 of u, b0 of sgn u, b1 of sgn v, constant).
    ///
    /// A dead zone or a friction of the wrong sign counts as 0. Nothing else is checked:
    /// the result may be unusable or not finite.
    pub fn from_parameters(theta: &[f32; 6]) -> Self {
        let [a1, a2, b0, null, coulomb, constant] = *theta;
        let delta = -null / b0;
        Self {
            a1,
            a2,
            b0,
            dead_zone: if delta > 0.0 { delta } else { 0.0 },
            offset: constant / b0,
            friction: if coulomb < 0.0 { -coulomb } else { 0.0 },
        }
    }

    /// Theta of this model, the inverse of [`Model::from_parameters`].
    pub fn parameters(&self) -> [f32; 6] {
        [
            self.a1,
            self.a2,
            self.b0,
            -self.b0 * self.dead_zone,
            -self.friction,
            self.b0 * self.offset,
        ]
    }

    /// The fields in the order in which they are stored, sent and shown: a1 in 1/s^2, a2 in 1/s, b0
    /// in y/s^3 per unit of u, dead zone and offset in units of u, friction in y/s^2.
    ///
    /// # Examples
    /// ```
    /// let model = trendid::servo::Model { offset: 0.01, ..trendid::servo::Model::linear(400.0, 20.0, 1.0e6) };
    /// assert_eq!(model.fields(), [400.0, 20.0, 1.0e6, 0.0, 0.01, 0.0]);
    /// assert_eq!(trendid::servo::Model::from_fields(model.fields()), model);
    /// ```
    pub const fn fields(&self) -> [f32; 6] {
        let Self {
            a1,
            a2,
            b0,
            dead_zone,
            offset,
            friction,
        } = *self;
        [a1, a2, b0, dead_zone, offset, friction]
    }

    /// The model with these [`fields`](Self::fields).
    pub const fn from_fields(fields: [f32; 6]) -> Self {
        let [a1, a2, b0, dead_zone, offset, friction] = fields;
        Self {
            a1,
            a2,
            b0,
            dead_zone,
            offset,
            friction,
        }
    }

    /// Flow of a command through dead zone and offset. Cost: about 8 instructions.
    #[inline]
    pub fn flow(&self, command: f32) -> f32 {
        let beyond = if command > self.dead_zone {
            command - self.dead_zone
        } else if command < -self.dead_zone {
            command + self.dead_zone
        } else {
            0.0
        };
        beyond + self.offset
    }

    /// Flow of a command through a valve whose spool is off by the offset: `q(u + offset)`.
    ///
    /// Beyond the dead zone the same as [`Model::flow`]; within it this valve is closed, as a real
    /// one is.
    #[inline]
    pub(crate) fn valve_flow(&self, command: f32) -> f32 {
        let spool = command + self.offset;
        if spool > self.dead_zone {
            spool - self.dead_zone
        } else if spool < -self.dead_zone {
            spool + self.dead_zone
        } else {
            0.0
        }
    }

    /// The command for a requested flow; the jump of 2 delta at zero is a steep line of half width
    /// `blend`.
    ///
    /// `blend` is a flow and positive; beyond it the inverse is exact.
    #[inline]
    pub fn command(&self, flow: f32, blend: f32) -> f32 {
        let wanted = flow - self.offset;
        if wanted > blend {
            wanted + self.dead_zone
        } else if wanted < -blend {
            wanted - self.dead_zone
        } else {
            wanted + self.dead_zone * wanted / blend
        }
    }

    /// The command for a requested flow through a valve whose spool is off by the offset; within
    /// `blend` of none the jump of the dead zone is a steep line.
    #[inline]
    pub(crate) fn valve_command(&self, flow: f32, blend: f32) -> f32 {
        let jump = if flow > blend {
            self.dead_zone
        } else if flow < -blend {
            -self.dead_zone
        } else {
            self.dead_zone * flow / blend
        };
        flow + jump - self.offset
    }

    /// The flow for which [`Model::valve_command`] gives this command.
    #[inline]
    pub(crate) fn valve_flow_of(&self, command: f32, blend: f32) -> f32 {
        let spool = command + self.offset;
        let edge = blend + self.dead_zone;
        if spool > edge {
            spool - self.dead_zone
        } else if spool < -edge {
            spool + self.dead_zone
        } else {
            spool * blend / edge
        }
    }

    /// Moves `motion` on by `time` seconds under a held flow.
    ///
    /// Taylor series of the solution to the fourth derivative of velocity: the error per
    /// step is below (w0 time)^4/24 of the movement, 1e-8 for 20 rad/s at 1 ms.
    /// Cost: about 30 instructions.
    #[inline]
    pub fn advance(&self, motion: &mut Motion, flow: f32, time: f32) {
        let Motion {
            position: x,
            velocity: v,
            acceleration: a,
        } = *motion;
        let jerk = self.b0 * flow - self.a1 * v - self.a2 * a;
        let snap = -self.a1 * a - self.a2 * jerk;
        let crackle = -self.a1 * jerk - self.a2 * snap;
        let half = 0.5 * time;
        let third = time * (1.0 / 3.0);
        motion.position = x + time * (v + half * (a + third * jerk));
        motion.velocity = v + time * (a + half * (jerk + third * snap));
        motion.acceleration = a + time * (jerk + half * (snap + third * crackle));
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        self.a1.is_finite()
            && self.a2.is_finite()
            && self.b0.is_finite()
            && self.dead_zone.is_finite()
            && self.offset.is_finite()
            && self.friction.is_finite()
    }
}

#[cfg(test)]
mod tests;
