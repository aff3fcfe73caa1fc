//! Cells of a table as numbers, and time stamps as a sampling interval.

use std::path::Path;

use super::error::{RecordError, TIME};
use super::resample::{LONGEST_GAP, RARE, Resampling};

/// Largest departure of a time step from the sampling interval, relative to
/// the interval; time stamps are often rounded in the file.
const STEP_TOLERANCE: f64 = 0.01;

/// Departures below this are jitter, and the samples are moved; from half a step on nothing says to
/// which sample a stamp belongs.
const JITTER: f64 = 1.0 / 3.0;

/// Columns that a refusal names at most.
const NAMED: usize = 20;

/// Characters of a cell that a refusal repeats at most.
const REPEATED: usize = 40;

/// The largest number that the core can carry.
const LARGEST: f64 = f32::MAX as f64;

/// A cell as a terminal can show it, whatever bytes the file holds.
pub(super) fn printable(text: &str) -> String {
    let shown = text.chars().take(REPEATED);
    let mut shown: String = shown
        .flat_map(|c| match c.is_control() {
            true => c.escape_default().collect::<Vec<_>>(),
            false => vec![c],
        })
        .collect();
    if text.chars().nth(REPEATED).is_some() {
        shown += "...";
    }
    shown
}

/// The words of a name in lower case.
fn words(name: &str) -> impl DoubleEndedIterator<Item = String> {
    let words = name.split(|c: char| !c.is_alphanumeric());
    words.filter(|word| !word.is_empty()).map(str::to_lowercase)
}

/// The unit of a time by its word, and how many s it is.
fn unit(word: &str) -> Option<(&'static str, f64)> {
    match word {
        "s" | "sec" | "secs" | "second" | "seconds" => Some(("s", 1.0)),
        "ms" | "msec" | "millis" | "milliseconds" => Some(("ms", 1e-3)),
        "us" | "\u{b5}s" | "\u{3bc}s" | "usec" | "micros" | "microseconds" => Some(("us", 1e-6)),
        "ns" | "nsec" | "nanos" | "nanoseconds" => Some(("ns", 1e-9)),
        "min" | "minutes" => Some(("min", 60.0)),
        "h" | "hours" => Some(("h", 3600.0)),
        _ => None,
    }
}

/// The unit other than s that the name of a column of time stamps ends with, and how many s it is.
pub(super) fn unit_of(name: &str) -> Option<(&'static str, f64)> {
    let last = words(name).next_back()?;
    unit(&last).filter(|(_, seconds)| *seconds != 1.0)
}

/// What to say where the stamps are whole seconds: they may count something else.
pub(super) fn whole_seconds(stamps: &[f64], name: &str) -> Option<String> {
    let whole = stamps.len() > 1 && stamps.iter().all(|t| t.fract() == 0.0);
    whole.then(|| {
        format!("`{name}` holds whole numbers, taken for s: --time-unit ms where they count ms")
    })
}

/// Where the time stamps are: without a column `t`, in the only one whose name begins with `t`,
/// `time` or `timestamp` and ends with a unit, in small or capital letters.
pub(super) fn time_position(
    path: &Path,
    names: &csv::StringRecord,
    wanted: &str,
) -> Result<usize, RecordError> {
    let found = position(path, names, wanted);
    if wanted != TIME || found.is_ok() {
        return found;
    }
    let counts_time = |name: &str| {
        let mut words = words(name);
        let stem = words.next();
        let stem = matches!(stem.as_deref(), Some("t" | "time" | "timestamp"));
        stem && words.next_back().is_some_and(|last| unit(&last).is_some())
    };
    let mut columns = names.iter().enumerate().filter(|(_, n)| counts_time(n));
    match (columns.next(), columns.next()) {
        (Some((column, _)), None) => Ok(column),
        _ => found,
    }
}

/// Where the wanted column is.
pub(super) fn position(
    path: &Path,
    names: &csv::StringRecord,
    wanted: &str,
) -> Result<usize, RecordError> {
    let mut hits = names.iter().enumerate().filter(|(_, n)| *n == wanted);
    let Some((first, _)) = hits.next() else {
        return Err(RecordError::MissingColumn {
            path: path.to_owned(),
            wanted: wanted.to_owned(),
            present: names
                .iter()
                .take(NAMED)
                .map(|n| format!("`{}`", printable(n)))
                .collect::<Vec<_>>()
                .join(", "),
        });
    };
    if hits.next().is_some() {
        return Err(RecordError::AmbiguousColumn {
            path: path.to_owned(),
            name: wanted.to_owned(),
        });
    }
    Ok(first)
}

/// The number in a column of a row.
pub(super) fn cell(
    line: u64,
    names: &csv::StringRecord,
    row: &csv::StringRecord,
    c: usize,
) -> Result<f64, RecordError> {
    let column = printable(&names[c]);
    let Some(text) = row.get(c) else {
        return Err(RecordError::ShortLine {
            line,
            column,
            found: row.len(),
            expected: names.len(),
        });
    };
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value.abs() > LARGEST => Err(RecordError::TooLarge {
            line,
            column,
            value: printable(text),
        }),
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(RecordError::NotFinite {
            line,
            column,
            value: printable(text),
        }),
        Err(_) if text.replacen(',', ".", 1).parse::<f64>().is_ok() => {
            Err(RecordError::DecimalComma {
                line,
                column,
                value: printable(text),
            })
        }
        Err(_) => Err(RecordError::NotANumber {
            line,
            column,
            value: printable(text),
        }),
    }
}

/// Refuses a row with more cells than the header has names, as decimal commas make them.
pub(super) fn surplus(
    line: u64,
    names: &csv::StringRecord,
    row: &csv::StringRecord,
) -> Result<(), RecordError> {
    let surplus = row.iter().skip(names.len()).any(|cell| !cell.is_empty());
    match surplus {
        true => Err(RecordError::LongLine {
            line,
            found: row.len(),
            expected: names.len(),
        }),
        false => Ok(()),
    }
}

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
}

/// The sampling interval of the stamps: their median step decides what is irregular and what is
/// missing, their whole span gives the figure.
pub(super) fn timing(stamps: &[f64], lines: &[u64], column: &str) -> Result<Timing, RecordError> {
    if stamps.len() < 2 {
        return Err(RecordError::TooFewSamples {
            found: stamps.len(),
            needed: 2,
            part: "in the record".into(),
        });
    }
    let steps: Vec<f64> = stamps.windows(2).map(|w| w[1] - w[0]).collect();
    // A step that does not advance is wrong even when most of them are so.
    if let Some(k) = steps.iter().position(|&s| s <= 0.0) {
        return Err(RecordError::NoAdvance {
            line: lines[k + 1],
            column: column.to_owned(),
            before: stamps[k],
            found: stamps[k + 1],
        });
    }
    let median = median(steps.clone());
    let intervals = |step: f64| (step / median).round().max(1.0);
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
    let long = |step: &f64| intervals(*step) > (LONGEST_GAP + 1) as f64;
    let gap = steps.iter().position(long).or_else(|| {
        let first = steps.iter().position(|step| intervals(*step) > 1.0);
        first.filter(|_| filled.saturating_mul(RARE) > stamps.len())
    });
    if let Some(k) = gap {
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
    })
}
