//! Errors of a recorded file.

use std::path::PathBuf;

use thiserror::Error;

use super::resample::{LONGEST_GAP, RARE};
use crate::format::{counted, significant};

/// The column of the time stamps unless another one is named.
pub(super) const TIME: &str = "t";

/// How to do without the usual column of the time stamps.
fn by_time(wanted: &str) -> &'static str {
    match wanted {
        TIME => " (--time COL names the time stamps, --dt S does without)",
        _ => "",
    }
}

/// How to do without stamps of a clock that is too coarse for the rows.
fn by_interval(coarse: bool) -> &'static str {
    match coarse {
        true => "; where its clock is coarser than the rows, --dt S takes them as equally spaced",
        false => "",
    }
}

/// What the cells of a header that has one name only may lack.
fn by_separator(present: &str) -> &'static str {
    match present.contains("`, `") {
        true => "",
        false => " alone (expected names separated by `,`, `;` or a tab)",
    }
}

/// An error of a record, as one sentence with its place.
#[derive(Debug, Error, PartialEq)]
pub(crate) enum RecordError {
    /// The file cannot be opened or read.
    #[error("cannot read `{path}`: {reason}")]
    Unreadable { path: PathBuf, reason: String },
    /// There is no line with column names.
    #[error("`{path}` holds no header line with column names")]
    NoHeader { path: PathBuf },
    /// A wanted column is absent.
    #[error(
        "`{path}` has no column `{wanted}`; it has {present}{}{}",
        by_separator(present),
        by_time(wanted)
    )]
    MissingColumn {
        path: PathBuf,
        wanted: String,
        present: String,
    },
    /// Two columns have the same wanted name.
    #[error("`{path}` has more than one column `{name}`")]
    AmbiguousColumn { path: PathBuf, name: String },
    /// A line is shorter than the header.
    #[error("line {line} ends before column `{column}`: it has {found} of {expected} cells")]
    ShortLine {
        line: u64,
        column: String,
        found: usize,
        expected: usize,
    },
    /// A cell does not hold a number.
    #[error(
        "line {line}, column `{column}`: `{value}` is not a number (expected one like -1.5e-3)"
    )]
    NotANumber {
        line: u64,
        column: String,
        value: String,
    },
    /// A cell holds a number with a decimal comma.
    #[error("line {line}, column `{column}`: `{value}` has a decimal comma; write a point")]
    DecimalComma {
        line: u64,
        column: String,
        value: String,
    },
    /// A line is longer than the header.
    #[error(
        "line {line} has {found} cells under {expected} names; decimal commas need another separator, such as `;`, and then points"
    )]
    LongLine {
        line: u64,
        found: usize,
        expected: usize,
    },
    /// A line is longer or shorter than most, where that leaves a number in every wanted column.
    #[error(
        "line {line} has {found} cells (expected {expected}, as most lines): a separator too many or too few moves the numbers into other columns"
    )]
    OtherLength {
        line: u64,
        found: usize,
        expected: usize,
    },
    /// A quote opens in a line and does not close there.
    #[error("line {line}: a cell in quotes goes on to line {last} (expected each row in one line)")]
    OpenQuote { line: u64, last: u64 },
    /// A cell is a number, but NaN or infinite.
    #[error("line {line}, column `{column}`: `{value}` is not finite (expected a finite number)")]
    NotFinite {
        line: u64,
        column: String,
        value: String,
    },
    /// A cell holds a number that no f32 carries.
    #[error("line {line}, column `{column}`: `{value}` is too large (expected less than 3.4e38)")]
    TooLarge {
        line: u64,
        column: String,
        value: String,
    },
    /// The time stamps stay or go back.
    #[error(
        "line {line}: time does not advance, from {before} to {found} s (column `{column}`){}",
        by_interval(before == found)
    )]
    NoAdvance {
        line: u64,
        column: String,
        before: f64,
        found: f64,
    },
    /// The time stamps are not equally spaced.
    #[error(
        "line {line}: irregular time stamps, a step of {} s where {} s was expected (column `{column}`); --dt S takes the rows as equally spaced",
        significant(*found, 4), significant(*expected, 4)
    )]
    IrregularTime {
        line: u64,
        column: String,
        found: f64,
        expected: f64,
    },
    /// Samples are missing, more than can be filled.
    #[error(
        "line {line}: {} missing before it (column `{column}`), {all} of {of} in all; {LONGEST_GAP} in a row and {} % of all are filled at most: --from and --to choose a part without, --dt S takes the rows as equally spaced where none is missing",
        counted(*samples as usize, "sample"), 100 / RARE
    )]
    Missing {
        line: u64,
        column: String,
        samples: u64,
        all: usize,
        of: usize,
    },
    /// Rows without a number, more than can be filled, where no time stamps are read.
    #[error(
        "line {line}: {} without a number before it, {all} of {of} in all; {LONGEST_GAP} in a row and {} % of all are filled at most: --from and --to choose a part without, or take them out where they are no samples",
        counted(*rows, "row"), 100 / RARE
    )]
    Empty {
        line: u64,
        rows: usize,
        all: usize,
        of: usize,
    },
    /// The record or the chosen part of it is too short.
    #[error("only {} {part}, but at least {needed} are needed", counted(*found, "sample"))]
    TooFewSamples {
        found: usize,
        needed: usize,
        part: String,
    },
}
