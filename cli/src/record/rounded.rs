//! Time stamps of equal intervals that are rounded to a clock as coarse as they are.
//!
//! A clock that counts in steps of r writes `t0 + k dt` as a multiple of r at most r away, always
//! to the same side of it or to the nearest one: the stamps lie within a band of the height r about
//! a line over the rows. Steps of such stamps differ, or are 0, but in an order that has one slope
//! only: where rows are missing, or written twice, the band is wider, unless that happens at equal
//! distances. One or two other steps lie within such a band whatever they are.

/// Other steps than most, from which on a band is no chance.
const OTHERS: usize = 3;

/// Decimal places of a stamp in its own unit that are looked at.
const PLACES: i32 = 9;

/// How far from a whole number of its last place a stamp may be, in parts of it: digits that f64
/// has no room for behind a date in s.
const WHOLE: f64 = 0.02;

/// Halvings of the interval of slopes: to the last digit.
const HALVINGS: usize = 60;

/// Stamps that are rounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rounded {
    /// The step of their clock in s.
    pub(super) clock: f64,
    /// The sampling interval in s.
    pub(super) dt: f64,
}

/// The stamps after the first as whole numbers of its last decimal place in a unit of s, and that
/// place in s.
fn counts(stamps: &[f64], unit: f64) -> Option<(Vec<i64>, f64)> {
    let first = stamps.first()?;
    let in_places = |places: i32| {
        let place = unit * 10_f64.powi(-places);
        let count = |t: &f64| {
            let count = (t - first) / place;
            let whole = (count - count.round()).abs() <= WHOLE && count.abs() < 1e15;
            whole.then_some(count.round() as i64)
        };
        let counts: Option<Vec<i64>> = stamps.iter().map(count).collect();
        counts.map(|counts| (counts, place))
    };
    (0..=PLACES).find_map(in_places)
}

fn common_divisor(mut a: i64, mut b: i64) -> i64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a.abs()
}

/// Steps other than the most frequent one.
fn others(counts: &[i64]) -> usize {
    let mut steps: Vec<i64> = counts.windows(2).map(|w| w[1] - w[0]).collect();
    steps.sort_unstable();
    let most = steps.chunk_by(|a, b| a == b).map(<[i64]>::len).max();
    steps.len() - most.unwrap_or(0)
}

/// The height of the band about a line of this slope over the rows, and the rows at its upper and
/// its lower edge.
fn band(counts: &[i64], slope: f64) -> (f64, [usize; 2]) {
    let mut edges = [(f64::NEG_INFINITY, 0), (f64::INFINITY, 0)];
    for (k, count) in counts.iter().enumerate() {
        let off = *count as f64 - k as f64 * slope;
        if off > edges[0].0 {
            edges[0] = (off, k);
        }
        if off < edges[1].0 {
            edges[1] = (off, k);
        }
    }
    (edges[0].0 - edges[1].0, [edges[0].1, edges[1].1])
}

/// The stamps as those of a coarse clock, in a `unit` of so many s; `None` where they are none, or
/// where the clock is not told from what is missing.
pub(super) fn rounded(stamps: &[f64], unit: f64) -> Option<Rounded> {
    let (counts, place) = counts(stamps, unit)?;
    let steps = counts.windows(2).map(|w| w[1] - w[0]);
    if steps.clone().any(|step| step < 0) || others(&counts) < OTHERS {
        return None;
    }
    let clock = steps.fold(0, common_divisor);
    let intervals = (counts.len() - 1) as f64;
    let span = (counts[counts.len() - 1] - counts[0]) as f64;
    // The ends are off by a step of the clock at most. The height of the band is a convex function
    // of the slope: it falls with the slope where its upper edge is behind its lower one.
    let off = clock as f64 / intervals;
    let [mut low, mut high] = [span / intervals - off, span / intervals + off];
    for _ in 0..HALVINGS {
        let slope = 0.5 * (low + high);
        let (_, [upper, lower]) = band(&counts, slope);
        if upper > lower {
            low = slope;
        } else {
            high = slope;
        }
    }
    let slope = 0.5 * (low + high);
    let (height, _) = band(&counts, slope);
    (slope > 0.0 && height <= clock as f64 * (1.0 + 1e-9)).then_some(Rounded {
        clock: clock as f64 * place,
        dt: slope * place,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows every `dt` ms on a clock of `clock` ms.
    fn stamps(rows: usize, dt: f64, clock: f64) -> Vec<f64> {
        let of = |k: usize| 1e-3 * clock * ((0.3 + k as f64 * dt) / clock).floor();
        (0..rows).map(of).collect()
    }

    #[test]
    fn a_coarse_clock_is_found_with_the_interval() {
        for (dt, clock) in [
            (0.3, 1.0),
            (0.7, 1.0),
            (1.005, 1.0),
            (2.5, 1.0),
            (20.0, 15.625),
        ] {
            let found = rounded(&stamps(2000, dt, clock), 1.0).expect("a clock");
            assert!(
                (found.clock / (1e-3 * clock) - 1.0).abs() < 1e-9,
                "{found:?}"
            );
            let off = 1e3 * found.dt - dt;
            assert!(off.abs() < clock / 2000.0, "{dt}: {found:?}");
        }
    }

    #[test]
    fn rows_that_are_missing_or_written_twice_are_no_clock() {
        let mut regular = stamps(1000, 1.0, 1.0);
        assert_eq!(rounded(&regular, 1.0), None);
        for row in [900, 403, 30, 11] {
            regular.remove(row);
        }
        assert_eq!(rounded(&regular, 1.0), None);
        let mut twice = stamps(1000, 1.0, 1.0);
        for row in [900, 403, 30, 11] {
            twice.insert(row, twice[row]);
        }
        assert_eq!(rounded(&twice, 1.0), None);
    }
}
