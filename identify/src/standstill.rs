//! Where a drive stands still, held by friction.
//!
//! `sgn(v)` is no model of sticking: at rest friction balances whatever acts. There the equation of
//! a drive behind an integrator holds with no force at all, so its inputs are zero for as long as
//! it rests.

/// A standstill lasts at least this share of the record, and at least so many samples.
const SHARE: f64 = 0.01;
const SHORTEST: usize = 20;

/// It moves at most this share of the whole movement, or so many steps of the sensor, or so many
/// times the noise.
const REST: f64 = 1e-4;
const STEPS: f64 = 2.0;
const NOISE: f64 = 6.0;

/// But never more than this share.
const MOVES: f64 = 2e-3;

/// The samples at which an output stands still; none where it never does.
pub fn standstill(y: &[f64]) -> Option<Vec<bool>> {
    let n = y.len();
    let window = ((SHARE * n as f64) as usize).max(SHORTEST);
    if n < 3 * window {
        return None;
    }
    let limit = limit(y)?;
    let mut still = vec![false; n];
    let mut any = false;
    // Where a window begins in which all samples are within the limit, by the running extremes of
    // halves of windows.
    let half = window / 2;
    let parts: Vec<(f64, f64)> = y.chunks(half).map(extremes).collect();
    let mut first = 0;
    while first < parts.len() {
        let (mut low, mut high) = parts[first];
        let mut last = first;
        while last + 1 < parts.len() {
            let (l, h) = parts[last + 1];
            if high.max(h) - low.min(l) > limit {
                break;
            }
            (low, high) = (low.min(l), high.max(h));
            last += 1;
        }
        if high - low <= limit && last > first {
            let (mut from, mut to) = (first * half, ((last + 1) * half).min(n));
            // To the sample at which it came to rest, and to the one at which it leaves.
            let rests = |y: f64| high.max(y) - low.min(y) <= limit;
            while from > 0 && rests(y[from - 1]) {
                from -= 1;
            }
            while to < n && rests(y[to]) {
                to += 1;
            }
            still[from..to].fill(true);
            any = true;
        }
        first = last + 1;
    }
    any.then_some(still)
}

/// How far an output may move at rest; `None` where it never moves.
fn limit(y: &[f64]) -> Option<f64> {
    let (low, high) = extremes(y);
    let range = high - low;
    let steps = y
        .windows(2)
        .map(|w| (w[1] - w[0]).abs())
        .filter(|d| *d > 0.0);
    let step = steps.fold(f64::INFINITY, f64::min);
    if !(range > 0.0 && step.is_finite()) {
        return None;
    }
    // White noise of variance 1 has second differences of variance 6.
    let seconds = y.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).powi(2));
    let mut seconds: Vec<f64> = seconds.collect();
    seconds.sort_by(f64::total_cmp);
    let noise = (seconds[seconds.len() / 2] / (6.0 * 0.455)).sqrt();
    let limit = (REST * range).max(STEPS * step).max(NOISE * noise);
    Some(limit.min(MOVES * range))
}

fn extremes(y: &[f64]) -> (f64, f64) {
    let extend = |(low, high): (f64, f64), y: &f64| (low.min(*y), high.max(*y));
    y.iter().fold((f64::INFINITY, f64::NEG_INFINITY), extend)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rest_is_found_and_a_reversal_is_none() {
        // A quarter moves there, a quarter back, the rest stands, all in steps of 1e-3.
        let y: Vec<f64> = (0..4000)
            .map(|k| {
                let way = match k {
                    0..1000 => f64::from(k),
                    1000..2000 => f64::from(2000 - k),
                    _ => 0.0,
                };
                (way * 0.37).round() * 1e-3
            })
            .collect();
        let still = standstill(&y).expect("a standstill");
        assert!(!still[..1990].iter().any(|s| *s));
        assert!(still[2050..].iter().all(|s| *s));
        let moving: Vec<f64> = (0..4000).map(|k| (0.01 * f64::from(k)).sin()).collect();
        assert_eq!(standstill(&moving), None);
        assert_eq!(standstill(&[1.0; 500]), None);
    }
}
