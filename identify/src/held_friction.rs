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
    let inputs = problem.signals.inputs.iter().enumerate();
    let inputs: Vec<_> = inputs.filter(|(c, _)| *c != place).collect();
    let (whole, part) = (delay.floor() as usize, delay - delay.floor());
    let force = |k: usize| {
        let of = inputs.iter().map(|(c, input)| {
            let (whole, part) = match input.delayed {
                true => (whole, part),
                false => (0, 0.0),
            };
            let at = |k: usize, d: usize| input.samples[k.saturating_sub(d)];
            let late = |k: usize| at(k, whole) + part * (at(k, whole + 1) - at(k, whole));
            let next = (k + 1).min(input.samples.len() - 1);
            let u = match input.hold {
                Hold::Zero => late(k),
                Hold::First => 0.5 * (late(k) + late(next)),
                Hold::Mean => late(next),
            };
            estimate.b[*c][0] * u
        });
        of.sum::<f64>() + estimate.constant
    };
    let mut v = 0.0;
    let w = (0..problem.samples()).map(|k| {
        if !problem.signals.acts(k) {
            v = 0.0;
            return 0.0;
        }
        let (next, w) = interval(v, force(k), [damping, friction], problem.signals.dt);
        v = next;
        w
    });
    Some(w.collect())
}

/// The place of the friction among the inputs.
pub(crate) fn coulomb(problem: &Problem) -> Option<usize> {
    let inputs = &problem.signals.inputs;
    inputs.iter().position(|input| input.name == COULOMB)
}

/// Velocity after an interval of `dt` under a constant force, and the mean of w over it.
fn interval(v: f64, force: f64, [damping, friction]: [f64; 2], dt: f64) -> (f64, f64) {
    let share = (force / friction).clamp(-1.0, 1.0);
    if v == 0.0 {
        let moved = after(0.0, force - friction * share, damping, dt);
        return (if share.abs() < 1.0 { 0.0 } else { moved }, share);
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
        return (after(v, drive, damping, dt), w);
    }
    let (next, rest) = interval(0.0, force, [damping, friction], dt - stop);
    (next, (w * stop + rest * (dt - stop)) / dt)
}

fn after(v: f64, drive: f64, damping: f64, t: f64) -> f64 {
    let decay = (-damping * t).exp_m1();
    let integral = if damping * t < 1e-12 {
        t
    } else {
        -decay / damping
    };
    v * (1.0 + decay) + drive * integral
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_stops_where_friction_holds_it_and_leaves_where_it_does_not() {
        // Without damping: 1 m/s against 0.5 + 1.5 stops after 0.5 s, and stays.
        let (v, w) = interval(1.0, -0.5, [0.0, 1.5], 1.0);
        assert_eq!(v, 0.0);
        assert!((w - (0.5 - 0.5 / 3.0)).abs() < 1e-12, "{w}");
        // 1 m/s against 2.5 + 1.5 stops after 0.25 s and turns.
        let (v, w) = interval(1.0, -2.5, [0.0, 1.5], 1.0);
        assert!(
            (v + 0.75).abs() < 1e-12 && (w + 0.5).abs() < 1e-12,
            "{v} {w}"
        );
        // With damping: half way and half way are one way.
        let once = interval(1.0, -2.5, [3.0, 1.5], 0.2);
        let half = interval(1.0, -2.5, [3.0, 1.5], 0.1);
        let again = interval(half.0, -2.5, [3.0, 1.5], 0.1);
        assert!((once.0 - again.0).abs() < 1e-12);
        assert!((once.1 - 0.5 * (half.1 + again.1)).abs() < 1e-12);
        assert_eq!(interval(0.0, 0.6, [1.0, 1.5], 0.1), (0.0, 0.6 / 1.5));
    }
}
