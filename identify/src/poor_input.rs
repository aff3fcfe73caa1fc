//! Inputs that do not tell a delay from the rest of a model.

use crate::signals::Signals;

/// Share of the energy of the second differences of an input, those of one sine, from which it is
/// one.
const OF_ONE_SINE: f64 = 0.99;

/// An input that says too little for a delay that is searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PoorInput {
    /// One frequency has one gain and one phase: two equations for two parameters and a delay.
    Sine,
    /// All is in one transient, which no second one confirms: deviations of blocks are too small.
    Step,
}

impl PoorInput {
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
        (xy < 0.0 && xy * xy > OF_ONE_SINE * xx * yy).then_some(Self::Sine)
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
            assert_eq!(of(&|k| (w * k).sin() + 0.3 * (3.0 * w * k).sin()), None);
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
