//! Time stamps as a sampling interval.

use super::error::RecordError;
use super::resample::{LONGEST_GAP, RARE, Resampling};
use super::rounded::rounded;

/// Largest departure of a time step from the sampling interval, relative to
/// the interval; time stamps are often rounded in the file.
const STEP_TOLERANCE: f64 = 0.01;

/// Departures below this are jitter, and the samples are moved; from half a step on nothing says to
/// which sample a stamp belongs.
const JITTER: f64 = 1.0 / 3.0;

/// The middle one of some steps; 0 of none.
fn median(mut steps: Vec<f64>) -> f64 {
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(0.0)
}

/// The rows whose stamps lie in a span, half a step of slack included; `None` for all of them, as
/// where less than two do.
pub(super) fn within(stamps: &[f64], [from, to]: [Option<f64>; 2]) -> Option<Vec<usize>> {
    from.or(to)?;
    let steps = stamps.windows(2).map(|w| (w[1] - w[0]).abs());
    let slack = 0.5 * median(steps.collect());
    let is_in = |stamp: f64| {
        from.is_none_or(|from| stamp >= from - slack) && to.is_none_or(|to| stamp <= to + slack)
    };
    let rows: Vec<usize> = (0..stamps.len())
        .filter(|row| is_in(stamps[*row]))
        .collect();
    (rows.len() >= 2).then_some(rows)
}

/// What the time stamps are.
pub(super) struct Timing {
    /// The sampling interval.
    pub dt: f64,
    /// How many samples there would be at equal intervals.
    pub samples: usize,
    /// What they lack of equal intervals.
    pub resampling: Resampling,
    /// The step in s of a coarse clock that they are rounded to, of rows that are equally spaced.
    pub clock: Option<f64>,
}

/// How many intervals a step is.
fn intervals(step: f64, median: f64) -> f64 {
    (step / median).round().max(1.0)
}

/// The first step over more missing samples than are filled, of which there are so many in all.
fn gap(steps: &[f64], median: f64, missing: usize) -> Option<usize> {
    let over = |samples: usize| move |step: &f64| intervals(*step, median) > (samples + 1) as f64;
    let long = steps.iter().position(over(LONGEST_GAP));
    long.or_else(|| {
        let first = steps.iter().position(over(0));
        first.filter(|_| missing.saturating_mul(RARE) > steps.len() + 1)
    })
}

/// Stamps at multiples of an interval that is given; the samples of rows without numbers are
/// missing between them.
pub(super) fn of_rows(stamps: &[f64], dt: f64, lines: &[u64]) -> Result<Timing, RecordError> {
    let steps: Vec<f64> = stamps.windows(2).map(|w| w[1] - w[0]).collect();
    let all: f64 = steps.iter().map(|step| intervals(*step, dt)).sum();
    let filled = (all as usize).saturating_sub(steps.len());
    if let Some(k) = gap(&steps, dt, filled) {
        return Err(RecordError::Empty {
            line: lines[k + 1],
            rows: intervals(steps[k], dt) as usize - 1,
            all: filled,
            of: filled + stamps.len(),
        });
    }
    Ok(Timing {
        dt,
        samples: stamps.len() + filled,
        resampling: Resampling {
            jitter: None,
            filled,
        },
        clock: None,
    })
}

/// The sampling interval of the stamps in s, which are written in a `unit` of so many: their median
/// step decides what is irregular and what is missing, their whole span gives the figure; where
/// they are those of a coarse clock, the line through all of them.
pub(super) fn timing(
    (stamps, unit): (&[f64], f64),
    lines: &[u64],
    column: &str,
) -> Result<Timing, RecordError> {
    if stamps.len() < 2 {
        return Err(RecordError::TooFewSamples {
            found: stamps.len(),
            needed: 2,
            part: "in the record".into(),
        });
    }
    let steps: Vec<f64> = stamps.windows(2).map(|w| w[1] - w[0]).collect();
    let median = median(steps.clone());
    let regular = |step: &f64| (step / median - 1.0).abs() <= STEP_TOLERANCE;
    if !steps.iter().all(regular)
        && let Some(clock) = rounded(stamps, unit)
    {
        return Ok(Timing {
            dt: clock.dt,
            samples: stamps.len(),
            resampling: Resampling::default(),
            clock: Some(clock.clock),
        });
    }
    // A step that does not advance is wrong even when most of them are so.
    if let Some(k) = steps.iter().position(|&s| s <= 0.0) {
        return Err(RecordError::NoAdvance {
            line: lines[k + 1],
            column: column.to_owned(),
            before: stamps[k],
            found: stamps[k + 1],
        });
    }
    let intervals = |step: f64| intervals(step, median);
    let departure = |step: f64| (step / median - intervals(step)).abs();
    if let Some(k) = steps.iter().position(|s| departure(*s) > JITTER) {
        return Err(RecordError::IrregularTime {
            line: lines[k + 1],
            column: column.to_owned(),
            found: steps[k],
            expected: median,
        });
    }
    let all: f64 = steps.iter().map(|step| intervals(*step)).sum();
    let filled = (all as usize).saturating_sub(steps.len());
    if let Some(k) = gap(&steps, median, filled) {
        return Err(RecordError::Missing {
            line: lines[k + 1],
            column: column.to_owned(),
            samples: intervals(steps[k]) as u64 - 1,
            all: filled,
            of: filled.saturating_add(stamps.len()),
        });
    }
    let largest = steps.iter().map(|step| departure(*step));
    let largest = largest.fold(0.0, f64::max);
    Ok(Timing {
        dt: (stamps[stamps.len() - 1] - stamps[0]) / all,
        samples: stamps.len() + filled,
        resampling: Resampling {
            jitter: (largest > STEP_TOLERANCE).then_some(largest),
            filled,
        },
        clock: None,
    })
}
