//! Samples with jitter moved to equal intervals, missing ones filled.
//!
//! The first signal is an output: read between its samples. An input that is held from sample to
//! sample counts with its mean over each interval, which is what a drive integrates; one that goes
//! straight is read as the output.

/// Samples missing in a row that are filled at most: a straight line misses the curvature over the
/// gap squared.
pub(super) const LONGEST_GAP: usize = 3;

/// One sample of so many may be missing: what the input was meanwhile is not known.
pub(super) const RARE: usize = 100;

/// What was done to have equal intervals.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Resampling {
    /// The largest departure of a time step from the interval, relative to it, where the samples
    /// were moved.
    pub jitter: Option<f64>,
    /// Missing samples that were filled.
    pub filled: usize,
}

impl Resampling {
    /// Whether anything was done.
    pub(super) fn is_any(self) -> bool {
        self != Self::default()
    }
}

/// The signals every `dt` from the first stamp on, so many samples; stamps ascend.
pub(super) fn resampled(
    stamps: &[f64],
    (dt, samples): (f64, usize),
    signals: &[Vec<f64>],
    held: bool,
) -> Vec<Vec<f64>> {
    let of = |(c, signal): (usize, &Vec<f64>)| match held && c > 0 {
        true => means(stamps, (dt, samples), signal),
        false => between(stamps, (dt, samples), signal),
    };
    signals.iter().enumerate().map(of).collect()
}

/// The last stamp at or before `t`, searched from `from` on.
fn before(stamps: &[f64], from: usize, t: f64) -> usize {
    let later = stamps[from..].iter().position(|stamp| *stamp > t);
    later.map_or(stamps.len() - 1, |k| (from + k).saturating_sub(1))
}

/// On straight lines between the samples.
fn between(stamps: &[f64], (dt, samples): (f64, usize), signal: &[f64]) -> Vec<f64> {
    let mut place = 0;
    let at = |k: usize| {
        let t = stamps[0] + k as f64 * dt;
        place = before(stamps, place, t);
        match (stamps.get(place + 1), signal.get(place + 1)) {
            (Some(next), Some(value)) => {
                let share = (t - stamps[place]) / (next - stamps[place]);
                signal[place] + share * (value - signal[place])
            }
            _ => signal[place],
        }
    };
    (0..samples).map(at).collect()
}

/// Means over each interval of what is held from stamp to stamp.
fn means(stamps: &[f64], (dt, samples): (f64, usize), signal: &[f64]) -> Vec<f64> {
    let mut place = 0;
    let over = |k: usize| {
        let (mut t, end) = (stamps[0] + k as f64 * dt, stamps[0] + (k + 1) as f64 * dt);
        place = before(stamps, place, t);
        let (mut i, mut sum) = (place, 0.0);
        while let Some(next) = stamps.get(i + 1).filter(|next| **next < end) {
            sum += signal[i] * (next - t);
            t = *next;
            i += 1;
        }
        (sum + signal[i] * (end - t)) / dt
    };
    (0..samples).map(over).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_stays_a_ramp_and_a_held_input_keeps_its_integral() {
        let stamps = [0.0, 1.2, 1.9, 3.1, 4.0];
        let ramp: Vec<f64> = stamps.iter().map(|t| 2.0 * t).collect();
        let steps = vec![1.0, 0.0, 3.0, 1.0, 1.0];
        let found = resampled(&stamps, (1.0, 5), &[ramp, steps], true);
        for (k, y) in found[0].iter().enumerate() {
            assert!((y - 2.0 * k as f64).abs() < 1e-12);
        }
        let wanted = [1.0, 0.2 + 3.0 * 0.1, 3.0, 3.0 * 0.1 + 0.9, 1.0];
        for (found, wanted) in found[1].iter().zip(wanted) {
            assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
        }
    }
}
