//! Samples that stand alone, as a wrong digit or a lost point makes them.
//!
//! What a cell in error by e does to the differences `d_k = y_k - (y_k-1 + y_k+1)/2` is known: e at
//! its place, -e/2 beside it. It is told where that is seen and nothing else in the record moves so
//! much from one sample to the next. A kink or a step of a signal has no such neighbours, and the
//! pulses of an excitation are as large as each other.

/// A sample is alone where no other difference is more than a third of its own. Of n differences of
/// noise with exponential tails, heavier than normal ones, the largest is about `ln n` deviations,
/// and one of three times that comes once in `n^2` records.
const LARGER: f64 = 3.0;

/// How near the differences beside it are to minus a half of its own: half way to 0, which a kink
/// has there.
const NEAR: f64 = 0.25;

/// A number that does not go with those around it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Alone {
    pub line: u64,
    pub column: String,
    pub value: f64,
    /// What the neighbours have between them.
    pub expected: f64,
}

/// The place of the sample that stands alone in a signal, and what its neighbours have there.
pub(super) fn alone(signal: &[f64]) -> Option<(usize, f64)> {
    let last = signal.len().checked_sub(1)?;
    let differences: Vec<f64> = signal
        .windows(3)
        .map(|w| w[1] - 0.5 * (w[0] + w[2]))
        .collect();
    let largest = |x: &(usize, &f64), y: &(usize, &f64)| x.1.abs().total_cmp(&y.1.abs());
    // The difference at k stands at k - 1.
    let (place, d) = differences.iter().enumerate().max_by(largest)?;
    let beside = |step: usize| differences.get(place.wrapping_add(step)).copied();
    let [before, after] = [beside(usize::MAX), beside(1)];
    let half = |other: Option<f64>| other.is_none_or(|other| (other / d + 0.5).abs() < NEAR);
    let none = |other: Option<f64>| other.is_none_or(|other| (other / d).abs() < NEAR);
    // The first and the last sample have one difference only, of minus a half.
    let (k, expected) = if half(before) && half(after) {
        (place + 1, 0.5 * (signal[place] + signal[place + 2]))
    } else if place == 0 && none(after) {
        (0, 2.0 * signal[1] - signal[2])
    } else if place + 2 == last && none(before) {
        (last, 2.0 * signal[last - 1] - signal[last - 2])
    } else {
        return None;
    };
    let others = differences.iter().enumerate();
    let others = others.filter(|(i, _)| i.abs_diff(place) > 1);
    let largest = others.fold(0.0, |m, (_, d)| d.abs().max(m));
    (largest > 0.0 && d.abs() > LARGER * largest).then_some((k, expected))
}
