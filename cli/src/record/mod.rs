//! Recorded drives: reading a CSV table of time stamps and signals, and
//! refusing in one sentence what no identification could use.

mod alone;
mod cells;
mod error;
mod lines;
mod notes;
mod resample;
mod rounded;
#[cfg(test)]
mod tests;
mod timing;

use std::borrow::Cow;
use std::io::Read;
use std::path::Path;

pub(crate) use alone::Alone;
use alone::alone;
use cells::unit_of;
pub(crate) use error::RecordError;
use lines::{Lines, Table};
pub(crate) use notes::Notes;
#[cfg(test)]
pub(crate) use resample::Resampling;
use timing::{Timing, timing};

/// The column of the time stamps.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Clock<'a> {
    pub column: &'a str,
    /// Its unit in s; without it that in the name of the column, or s.
    pub unit: Option<f64>,
    /// The sampling interval in s, where no column is read.
    pub dt: Option<f64>,
    /// Whether the signals after the first are held between their samples, not straight: how jitter
    /// is taken out.
    pub held: bool,
    /// First and last time stamp in s; those outside are not judged.
    pub span: [Option<f64>; 2],
}

#[cfg(test)]
impl Clock<'_> {
    /// Seconds in a column `t`.
    pub(crate) const SECONDS: Self = Self {
        column: "t",
        unit: None,
        dt: None,
        held: true,
        span: [None; 2],
    };
}

/// Equally sampled signals read from one file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Record {
    /// Comment lines of the file in their order, without the leading `#`.
    pub comments: Vec<String>,
    /// Time of the first sample in s.
    pub start: f64,
    /// Sampling interval in s.
    pub dt: f64,
    /// What is said of the file.
    pub notes: Notes,
    /// The signals in the order in which they were asked for.
    pub signals: Vec<Vec<f64>>,
}

impl Record {
    /// Reads the `signals` of the CSV file at `path`, or of the standard input for `-`, sampled at
    /// the stamps of a column.
    ///
    /// Lines starting with `#` are comments; cells are separated by commas,
    /// semicolons or tabs, whichever the header has most of, as many in each row.
    /// Quoted cells, CRLF, a byte order mark and Latin-1 are understood. Columns that are not asked
    /// for need not hold numbers. Stamps with jitter are moved to equal intervals, and
    /// few missing samples filled on straight lines; those of a clock as coarse as the intervals
    /// give the interval by the line through all of them.
    ///
    /// # Errors
    ///
    /// [`RecordError`] names the first thing that is wrong and its line.
    pub(crate) fn read(path: &Path, clock: Clock, signals: &[String]) -> Result<Self, RecordError> {
        let bytes = bytes(path, &mut std::io::stdin())?;
        Self::parse(path, &bytes, clock, signals)
    }

    pub(crate) fn parse(
        path: &Path,
        bytes: &[u8],
        clock: Clock,
        signals: &[String],
    ) -> Result<Self, RecordError> {
        if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
            return Err(RecordError::Unreadable {
                path: path.to_owned(),
                reason: "it is UTF-16 (expected UTF-8)".into(),
            });
        }
        // What is no UTF-8 is Latin-1, in which a spreadsheet writes a micro sign or a degree.
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => Cow::Borrowed(text),
            Err(_) => Cow::Owned(bytes.iter().map(|b| char::from(*b)).collect()),
        };
        let lines = Lines::of(text.trim_start_matches('\u{feff}'));
        let wanted_time = clock.dt.is_none().then_some(clock.column);
        let mut table = lines.columns(path, wanted_time, signals)?;
        let time = cells::printable(&table.time);
        let (mut stamps, unit, granted) = stamps(&mut table, &clock, &time);
        if let Some(rows) = timing::within(&stamps, clock.span) {
            for column in table.columns.iter_mut().chain([&mut stamps]) {
                *column = rows.iter().map(|row| column[*row]).collect();
            }
            table.numbers = rows.iter().map(|row| table.numbers[*row]).collect();
        }
        let columns = signals.iter().zip(&table.columns);
        let alone = columns.filter_map(|(name, column)| {
            let (place, expected) = alone(column)?;
            Some(Alone {
                line: table.numbers[place],
                column: cells::printable(name),
                value: column[place],
                expected,
            })
        });
        let alone: Vec<Alone> = alone.collect();
        let timing = match clock.dt {
            Some(dt) => timing::of_rows(&stamps, dt, &table.numbers)?,
            None => timing((&stamps, unit), &table.numbers, &time)?,
        };
        let Timing { dt, samples, .. } = timing;
        let mut signals = table.columns;
        if timing.resampling.is_any() {
            signals = resample::resampled(&stamps, (dt, samples), &signals, clock.held);
        }
        Ok(Self {
            comments: lines.comments,
            start: stamps.first().copied().unwrap_or(0.0),
            dt,
            notes: Notes {
                granted,
                resampling: timing.resampling,
                clock: timing.clock,
                alone,
            },
            signals,
        })
    }

    /// Number of samples.
    pub(crate) fn len(&self) -> usize {
        self.signals.first().map_or(0, Vec::len)
    }

    /// The samples with `from <= t <= to` (in s, on the record's own clock),
    /// at least `needed` of them.
    ///
    /// # Errors
    ///
    /// [`RecordError::TooFewSamples`] when less than `needed` remain.
    pub(crate) fn window(
        &self,
        from: Option<f64>,
        to: Option<f64>,
        needed: usize,
    ) -> Result<Self, RecordError> {
        // Half a sample of slack, so that a stamp equal to a bound is inside
        // whatever its rounding.
        let index = |t: f64| ((t - self.start) / self.dt).round().max(0.0) as usize;
        let n = self.len();
        let first = from.map_or(0, index).min(n);
        let last = match to {
            Some(t) if t < self.start => first,
            // What is far beyond the end is the largest index.
            Some(t) => index(t).saturating_add(1).clamp(first, n),
            None => n,
        };
        if last - first < needed {
            let part = match (from, to) {
                (None, None) => "in the record".to_owned(),
                _ => format!(
                    "between {} s and {} s",
                    from.unwrap_or(self.start),
                    to.unwrap_or(self.start + (n.max(1) - 1) as f64 * self.dt)
                ),
            };
            return Err(RecordError::TooFewSamples {
                found: last - first,
                needed,
                part,
            });
        }
        Ok(Self {
            comments: self.comments.clone(),
            start: self.start + first as f64 * self.dt,
            dt: self.dt,
            notes: self.notes.clone(),
            signals: self
                .signals
                .iter()
                .map(|s| s[first..last].to_vec())
                .collect(),
        })
    }
}

/// What a file holds, or for `-` a reader.
pub(crate) fn bytes(path: &Path, stdin: &mut dyn Read) -> Result<Vec<u8>, RecordError> {
    let bytes = if path.as_os_str() == "-" {
        let mut bytes = Vec::new();
        stdin.read_to_end(&mut bytes).map(|_| bytes)
    } else {
        std::fs::read(path)
    };
    bytes.map_err(|e| RecordError::Unreadable {
        path: path.to_owned(),
        reason: match e.kind() {
            std::io::ErrorKind::NotFound => "no such file".into(),
            std::io::ErrorKind::IsADirectory => "it is a directory".into(),
            _ => e.to_string(),
        },
    })
}

/// The time stamps in s, taken out of a table, the unit in s that they are written in, and what was
/// taken for granted of them.
fn stamps(table: &mut Table, clock: &Clock, time: &str) -> (Vec<f64>, f64, Option<String>) {
    if let Some(dt) = clock.dt {
        // A row without numbers is a sample that is missing.
        let place = |(row, line): (usize, &u64)| row + table.empty.partition_point(|e| e < line);
        let places = table.numbers.iter().enumerate().map(place);
        return (places.map(|k| k as f64 * dt).collect(), 1.0, None);
    }
    let counts = table.columns.remove(0);
    let by_name = unit_of(&table.time);
    let unit = clock.unit.or(by_name.map(|(_, unit)| unit));
    let granted = match (clock.unit, by_name) {
        (Some(_), _) => None,
        (None, Some((name, _))) => Some(format!("`{time}` counts {name} by its name")),
        (None, None) => cells::whole_seconds(&counts, time),
    };
    let unit = unit.unwrap_or(1.0);
    let stamps = counts.iter().map(|t| unit * t).collect();
    (stamps, unit, granted)
}
