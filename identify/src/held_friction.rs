//! The friction of a force balance as its model has it: the sign of the velocity that the model
//! makes of the inputs, and at rest the share of the friction that holds it there.
//!
//! ```text
//! v' = f - a v - F w     w = sgn(v), at rest f/F in [-1, 1]     f = sum b u + constant
//! ```
//!
//! Known as: Coulomb friction in the sense of Filippov; simulated regressors (Janot, Vandanjon and
//! Gautier 2014). A velocity out of measured positions turns late behind its filter, chatters with
//! the noise around a reversal and shows no rest that is short; that of the model does neither, and
//! no noise of the output is in it.

use trendid::trends::Hold;

use crate::derived::COULOMB;
use crate::estimate::Estimate;
use crate::problem::Problem;

/// Means of w over the sample intervals of a record; `None` for another structure than an inertia
/// with viscous friction, and for friction or damping below zero.
pub fn signs(problem: &Problem, estimate: &Estimate, delay: f64) -> Option<Vec<f64>> {
    let structure = problem.structure;
    if !(structure.integrator && structure.order == 2 && structure.zeros == 0) {
        return None;
    }
    let place = coulomb(problem)?;
    let (damping, friction) = (estimate.a[1], -estimate.b[place][0]);
    if !(damping >= 0.0 && friction > 0.0) {
        return None;
    }
    let b = |c: usize| (c != place).then(|| estimate.b[c][0]);
    let force = Force::of(problem, b, delay);
    let motion = force.motion(problem, 0.0, estimate.constant, [damping, friction]);
    Some(motion.map(|interval| interval.w).collect())
}

/// What presses in the sample intervals: a command that comes within an interval leaves the one
/// before in force until then.
pub(crate) struct Force {
    /// Before and behind that moment.
    values: [Vec<f64>; 2],
    /// When it is, as a part of an interval.
    part: f64,
}

impl Force {
    /// That of the inputs `delay` samples late; `b` has the coefficient of those that press.
    pub(crate) fn of(problem: &Problem, b: impl Fn(usize) -> Option<f64>, delay: f64) -> Self {
        let (whole, part) = (delay.floor() as usize, delay - delay.floor());
        let mut values = [(); 2].map(|()| vec![0.0; problem.samples()]);
        for (c, input) in problem.signals.inputs.iter().enumerate() {
            let Some(b) = b(c) else {
                continue;
            };
            let (whole, part) = if input.delayed {
                (whole, part)
            } else {
                (0, 0.0)
            };
            let at = |k: usize, d: usize| input.samples[k.saturating_sub(d)];
            let late = |k: usize| at(k, whole) + part * (at(k, whole + 1) - at(k, whole));
            for k in 0..input.samples.len() {
                let next = (k + 1).min(input.samples.len() - 1);
                let u = match input.hold {
                    Hold::Zero if input.delayed => [at(k, whole + 1), at(k, whole)],
                    Hold::Zero => [at(k, 0); 2],
                    Hold::First => [0.5 * (late(k) + late(next)); 2],
                    Hold::Mean => [late(next); 2],
                };
                for (force, u) in values.iter_mut().zip(u) {
                    force[k] += b * u;
                }
            }
        }
        Self { values, part }
    }

    /// The largest one.
    pub(crate) fn largest(&self) -> f64 {
        let all = self.values.iter().flatten();
        all.fold(0.0, |m, force| m.max(force.abs()))
    }

    /// The sample intervals of a motion from a velocity on, under a constant force more; nothing
    /// moves where a rest is measured.
    pub(crate) fn motion(
        &self,
        problem: &Problem,
        mut v: f64,
        constant: f64,
        balance: [f64; 2],
    ) -> impl Iterator<Item = Interval> {
        let signals = problem.signals;
        let [before, behind] = &self.values;
        let pairs = before.iter().zip(behind).enumerate();
        pairs.map(move |(k, (before, behind))| {
            let until = self.part * signals.dt;
            let interval = match signals.acts(k) {
                true if until > 0.0 => {
                    let first = Interval::of(v, before + constant, balance, until);
                    let v = first.velocity;
                    let then = Interval::of(v, behind + constant, balance, signals.dt - until);
                    first.then(then, self.part)
                }
                true => Interval::of(v, behind + constant, balance, signals.dt),
                false => Interval::REST,
            };
            v = interval.velocity;
            interval
        })
    }
}

/// The place of the friction among the inputs.
pub(crate) fn coulomb(problem: &Problem) -> Option<usize> {
    let inputs = &problem.signals.inputs;
    inputs.iter().position(|input| input.name == COULOMB)
}

/// What happens in an interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Interval {
    /// Velocity at its end.
    pub(crate) velocity: f64,
    /// The way.
    pub(crate) way: f64,
    /// Mean of w.
    pub(crate) w: f64,
}

impl Interval {
    const REST: Self = Self {
        velocity: 0.0,
        way: 0.0,
        w: 0.0,
    };

    /// This one for a part of the time and another one for the rest of it.
    fn then(self, rest: Self, part: f64) -> Self {
        Self {
            velocity: rest.velocity,
            way: self.way + rest.way,
            w: self.w + (1.0 - part) * (rest.w - self.w),
        }
    }

    /// `dt` of the velocity `v` under a constant force.
    fn of(v: f64, force: f64, [damping, friction]: [f64; 2], dt: f64) -> Self {
        let share = (force / friction).clamp(-1.0, 1.0);
        if v == 0.0 {
            let (moved, way) = after(0.0, force - friction * share, damping, dt);
            let (velocity, way) = if share.abs() < 1.0 {
                (0.0, 0.0)
            } else {
                (moved, way)
            };
            return Self {
                velocity,
                way,
                w: share,
            };
        }
        let w = v.signum();
        let drive = force - friction * w;
        // v e^(-a t) + drive (1 - e^(-a t))/a = 0.
        let stop = match (v * drive < 0.0, damping) {
            (false, _) => f64::INFINITY,
            (true, 0.0) => -v / drive,
            (true, a) => (-a * v / drive).ln_1p() / a,
        };
        if stop >= dt {
            let (velocity, way) = after(v, drive, damping, dt);
            return Self { velocity, way, w };
        }
        let (_, way) = after(v, drive, damping, stop);
        let velocity = 0.0;
        let rest = Self::of(velocity, force, [damping, friction], dt - stop);
        Self { velocity, way, w }.then(rest, stop / dt)
    }
}

/// Velocity and way after the time t under a constant drive.
fn after(v: f64, drive: f64, damping: f64, t: f64) -> (f64, f64) {
    let x = damping * t;
    // (1 - e^-x)/x and (1 - (1 - e^-x)/x)/x.
    let [first, second] = match x < 1e-4 {
        true => [1.0 - x * (0.5 - x / 6.0), 0.5 - x * (1.0 / 6.0 - x / 24.0)],
        false => {
            let first = -(-x).exp_m1() / x;
            [first, (1.0 - first) / x]
        }
    };
    (
        v * (-x).exp() + drive * t * first,
        t * (v * first + drive * t * second),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_stops_where_friction_holds_it_and_leaves_where_it_does_not() {
        // Without damping: 1 m/s against 0.5 + 1.5 stops after 0.5 s and 0.25 m, and stays.
        let stays = Interval::of(1.0, -0.5, [0.0, 1.5], 1.0);
        assert_eq!(stays.velocity, 0.0);
        assert!((stays.w - (0.5 - 0.5 / 3.0)).abs() < 1e-12, "{stays:?}");
        assert!((stays.way - 0.25).abs() < 1e-12, "{stays:?}");
        // 1 m/s against 2.5 + 1.5 stops after 0.25 s and 0.125 m, and turns.
        let turns = Interval::of(1.0, -2.5, [0.0, 1.5], 1.0);
        assert!((turns.velocity + 0.75).abs() < 1e-12, "{turns:?}");
        assert!((turns.w + 0.5).abs() < 1e-12, "{turns:?}");
        assert!(
            (turns.way - (0.125 - 0.5 * 0.75 * 0.75)).abs() < 1e-12,
            "{turns:?}"
        );
        let held = Interval::of(0.0, 0.6, [1.0, 1.5], 0.1);
        assert_eq!([held.velocity, held.way, held.w], [0.0, 0.0, 0.6 / 1.5]);
    }

    #[test]
    fn half_an_interval_and_half_an_interval_are_one() {
        for damping in [0.0, 1e-5, 1e-3, 3.0, 300.0] {
            let balance = [damping, 1.5];
            let once = Interval::of(1.0, -2.5, balance, 0.2);
            let half = Interval::of(1.0, -2.5, balance, 0.1);
            let again = Interval::of(half.velocity, -2.5, balance, 0.1);
            assert!((once.velocity - again.velocity).abs() < 1e-12, "{damping}");
            assert!((once.way - half.way - again.way).abs() < 1e-12, "{damping}");
            assert!((once.w - 0.5 * (half.w + again.w)).abs() < 1e-12);
        }
    }
}
