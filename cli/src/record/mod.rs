//! Recorded drives: reading a CSV table of time stamps and signals, and
//! refusing in one sentence what no identification could use.

mod cells;
mod error;
mod resample;
#[cfg(test)]
mod tests;

use std::io::Read;
use std::path::Path;

use cells::{Timing, cell, position, surplus, time_position, timing, unit_of};
pub(crate) use error::RecordError;
pub(crate) use resample::Resampling;

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

/// Equally sampled signals read from one file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Record {
    /// Comment lines of the file in their order, without the leading `#`.
    pub comments: Vec<String>,
    /// Time of the first sample in s.
    pub start: f64,
    /// Sampling interval in s.
    pub dt: f64,
    /// What was done to have equal intervals.
    pub resampling: Resampling,
    /// What was taken for granted of the time stamps, in one sentence.
    pub granted: Option<String>,
    /// The signals in the order in which they were asked for.
    pub signals: Vec<Vec<f64>>,
}

impl Record {
    /// Reads the `signals` of the CSV file at `path`, or of the standard input for `-`, sampled at
    /// the stamps of a column.
    ///
    /// Lines starting with `#` are comments; cells are separated by commas, or
    /// by semicolons or tabs when the header has no comma. Quoted cells, CRLF
    /// and a byte order mark are understood. Columns that are not asked for
    /// need not hold numbers. Stamps with jitter are moved to equal intervals, and
    /// few missing samples filled on straight lines.
    ///
    /// # Errors
    ///
    /// [`RecordError`] names the first thing that is wrong and its line.
    pub(crate) fn read(path: &Path, clock: Clock, signals: &[String]) -> Result<Self, RecordError> {
        let bytes = if path.as_os_str() == "-" {
            let mut bytes = Vec::new();
            std::io::stdin().read_to_end(&mut bytes).map(|_| bytes)
        } else {
            std::fs::read(path)
        };
        let bytes = bytes.map_err(|e| RecordError::Unreadable {
            path: path.to_owned(),
            reason: match e.kind() {
                std::io::ErrorKind::NotFound => "no such file".into(),
                std::io::ErrorKind::IsADirectory => "it is a directory".into(),
                _ => e.to_string(),
            },
        })?;
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
        let text = String::from_utf8_lossy(bytes);
        let lines = Lines::of(text.trim_start_matches('\u{feff}'));
        if let Some(dt) = clock.dt {
            let Table { columns, .. } = lines.columns(path, None, signals)?;
            return Ok(Self {
                comments: lines.comments,
                start: 0.0,
                dt,
                resampling: Resampling::default(),
                granted: None,
                signals: columns,
            });
        }
        let table = lines.columns(path, Some(clock.column), signals)?;
        let by_name = unit_of(&table.time);
        let time = cells::printable(&table.time);
        let unit = match (clock.unit, by_name) {
            (Some(unit), _) | (None, Some((_, unit))) => unit,
            (None, None) => 1.0,
        };
        let mut columns = table.columns.into_iter();
        let counts = columns.next().unwrap_or_default();
        let granted = match (clock.unit, by_name) {
            (Some(_), _) => None,
            (None, Some((name, _))) => Some(format!("`{time}` counts {name} by its name")),
            (None, None) => cells::whole_seconds(&counts, &time),
        };
        let mut stamps: Vec<f64> = counts.iter().map(|t| unit * t).collect();
        let mut signals: Vec<Vec<f64>> = columns.collect();
        let mut numbers = table.numbers;
        if let Some(rows) = cells::within(&stamps, clock.span) {
            for column in signals.iter_mut().chain([&mut stamps]) {
                *column = rows.iter().map(|row| column[*row]).collect();
            }
            numbers = rows.iter().map(|row| numbers[*row]).collect();
        }
        let Timing {
            dt,
            samples,
            resampling,
        } = timing(&stamps, &numbers, &time)?;
        if resampling.is_any() {
            signals = resample::resampled(&stamps, (dt, samples), &signals, clock.held);
        }
        Ok(Self {
            comments: lines.comments,
            start: stamps[0],
            dt,
            resampling,
            granted,
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
            Some(t) => (index(t) + 1).clamp(first, n),
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
            resampling: self.resampling,
            granted: self.granted.clone(),
            signals: self
                .signals
                .iter()
                .map(|s| s[first..last].to_vec())
                .collect(),
        })
    }
}

/// The wanted columns of a table.
struct Table {
    /// Name of the column of the time stamps.
    time: String,
    /// The time stamps where they are wanted, then the signals.
    columns: Vec<Vec<f64>>,
    /// Number of the line of each row.
    numbers: Vec<u64>,
}

/// The lines of a file by what they are.
struct Lines {
    comments: Vec<String>,
    /// Header and rows.
    table: String,
    /// Number of each line of the table in the file.
    numbers: Vec<u64>,
}

impl Lines {
    /// The CSV reader counts no comments and blank lines, so they are taken out here and the number
    /// of each line that stays is kept.
    fn of(text: &str) -> Self {
        let mut lines = Self {
            comments: Vec::new(),
            table: String::with_capacity(text.len()),
            numbers: Vec::new(),
        };
        for (number, line) in (1..).zip(text.lines()) {
            match line.trim() {
                "" => {}
                l if l.starts_with('#') => lines.comments.push(l[1..].trim().to_owned()),
                _ => {
                    lines.table.push_str(line);
                    lines.table.push('\n');
                    lines.numbers.push(number);
                }
            }
        }
        lines
    }

    /// The column `time` where one is wanted, then those of the signals.
    fn columns(
        &self,
        path: &Path,
        time: Option<&str>,
        signals: &[String],
    ) -> Result<Table, RecordError> {
        let header = self.table.lines().next();
        let header = header.ok_or_else(|| RecordError::NoHeader {
            path: path.to_owned(),
        })?;
        let delimiter = [b',', b';', b'\t']
            .into_iter()
            .find(|&d| header.contains(char::from(d)))
            .unwrap_or(b',');
        let mut rows = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(self.table.as_bytes());
        let unreadable = |e: csv::Error| RecordError::Unreadable {
            path: path.to_owned(),
            reason: e.to_string(),
        };
        let names = rows.headers().map_err(unreadable)?.clone();
        let mut wanted = Vec::new();
        if let Some(name) = time {
            wanted.push(time_position(path, &names, name)?);
        }
        let time = wanted.first().map(|c| names[*c].to_owned());
        for name in signals {
            wanted.push(position(path, &names, name)?);
        }
        let mut columns: Vec<Vec<f64>> = vec![Vec::new(); wanted.len()];
        let mut numbers = Vec::new();
        for row in rows.records() {
            let row = row.map_err(unreadable)?;
            let place = row.position().map_or(0, |p| p.line() as usize - 1);
            let line = self.numbers.get(place).copied().unwrap_or(0);
            if row.iter().all(str::is_empty) {
                continue;
            }
            surplus(line, &names, &row)?;
            for (values, &c) in columns.iter_mut().zip(&wanted) {
                values.push(cell(line, &names, &row, c)?);
            }
            numbers.push(line);
        }
        Ok(Table {
            time: time.unwrap_or_default(),
            columns,
            numbers,
        })
    }
}
