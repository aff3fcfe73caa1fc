//! Cells of a table as numbers, and the names of its columns.

use std::path::Path;

use super::error::{RecordError, TIME};

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
