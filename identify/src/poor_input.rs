//! Inputs that do not tell a delay from the rest of a model.

use crate::error::Error;
use crate::problem::Problem;
use crate::search::{Choice, Freedom};
use crate::signals::Signals;

/// Condition index of an input and its second difference from which a regression on both is taken
/// for degraded (Belsley, Kuh and Welsch 1980, section 3.2: strong from 30 on).
///
/// Of two columns of length one with the correlation -r it is `sqrt((1 + r)/(1 - r))`; the two are
/// one column, `u'' = -w^2 u`, for one sine alone.
const DEGRADED: f64 = 30.0;

/// What one sine fixes: its gain and its phase.
const OF_ONE_SINE: usize = 2;

/// An input that says too little for a delay that is searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PoorInput {
    /// One frequency has one gain and one phase: two equations for parameters and delay.
    Sine,
    /// All is in one transient, which no second one confirms.
    Step,
}

impl PoorInput {
    /// Its name, for people and machines.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sine => "one sine",
            Self::Step => "one step",
        }
    }

    /// That of a problem whose delay is searched; `None` where it is given.
    ///
    /// # Errors
    /// [`Error::OneSine`] where it has more unknowns than equations.
    pub(crate) fn of_search(problem: &Problem, freedom: Freedom) -> Result<Option<Self>, Error> {
        if freedom.delay != Choice::Auto {
            return Ok(None);
        }
        let poor = Self::of(problem.signals);
        // A constant is fixed by the mean; a second input, which does not wait, tells more.
        let constant = usize::from(problem.structure.constant);
        let unknowns = problem.parameter_names().len() - constant + 1;
        match poor {
            Some(Self::Sine) if unknowns > OF_ONE_SINE && problem.signals.inputs.len() == 1 => {
                Err(Error::OneSine { unknowns })
            }
            _ => Ok(poor),
        }
    }

    /// What all delayed inputs of a record are at best; `None` where one of them says more.
    pub fn of(signals: &Signals) -> Option<Self> {
        let delayed = signals.inputs.iter().filter(|input| input.delayed);
        let mut each = delayed.map(|input| Self::of_samples(input.samples));
        match each.next() {
            // Two inputs are two frequencies or two transients.
            Some(only) if each.next().is_none() => only,
            _ => None,
        }
    }

    fn of_samples(u: &[f64]) -> Option<Self> {
        let steps = u.windows(2).filter(|pair| pair[0] != pair[1]).count();
        if steps == 1 {
            return Some(Self::Step);
        }
        // u'' = -w^2 (u - mean)
        let n = u.len().saturating_sub(2) as f64;
        let pairs = || u.windows(3).map(|w| (w[1], w[0] - 2.0 * w[1] + w[2]));
        let sum = |f: &dyn Fn((f64, f64)) -> f64| pairs().map(f).sum::<f64>();
        let (x, y) = (sum(&|p| p.0) / n, sum(&|p| p.1) / n);
        let xx = sum(&|p| (p.0 - x).powi(2));
        let xy = sum(&|p| (p.0 - x) * (p.1 - y));
        let yy = sum(&|p| (p.1 - y).powi(2));
        let ratio = DEGRADED * DEGRADED;
        let r = (ratio - 1.0) / (ratio + 1.0);
        (xy < -r * (xx * yy).sqrt()).then_some(Self::Sine)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_sine_and_one_step_are_told_from_richer_inputs() {
        let of = |u: &dyn Fn(f64) -> f64| {
            let u: Vec<f64> = (0..3000).map(|k| u(f64::from(k))).collect();
            PoorInput::of_samples(&u)
        };
        for w in [1e-3, 0.01, 0.1, 1.0] {
            assert_eq!(of(&|k| 0.3 + (w * k).sin()), Some(PoorInput::Sine), "{w}");
            // Of whole periods 3 % of a third harmonic are told, 0.5 % are not.
            assert_eq!(of(&|k| (w * k).sin() + 0.3 * (3.0 * w * k).sin()), None);
            assert_eq!(of(&|k| (w * k).sin() + 0.03 * (3.0 * w * k).sin()), None);
            let nearly = of(&|k| (w * k).sin() + 0.005 * (3.0 * w * k).sin());
            assert_eq!(nearly.is_some(), w > 1e-3, "{w}");
            assert_eq!(of(&|k| (w * k * (1.0 + k / 1000.0)).sin()), None, "{w}");
        }
        assert_eq!(
            of(&|k| if k > 700.0 { 1.0 } else { 0.0 }),
            Some(PoorInput::Step)
        );
        assert_eq!(of(&|k| (k / 100.0).floor().rem_euclid(2.0)), None);
        assert_eq!(of(&|k| (k * k * 0.37).sin().signum()), None);
    }
}
