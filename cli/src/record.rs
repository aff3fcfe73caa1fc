//! Recorded drives: reading a CSV table of time stamps and signals, and
//! refusing in one sentence what no identification could use.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// Largest departure of a time step from the sampling interval, relative to
/// the interval; time stamps are often rounded in the file.
const STEP_TOLERANCE: f64 = 0.01;

/// What is wrong with a record, as one sentence with its place.
#[derive(Debug, Error, PartialEq)]
pub enum RecordError {
    /// The file cannot be opened or read.
    #[error("cannot read `{path}`: {reason}")]
    Unreadable { path: PathBuf, reason: String },
    /// There is no line with column names.
    #[error("`{path}` holds no header line with column names")]
    NoHeader { path: PathBuf },
    /// A wanted column is absent.
    #[error("`{path}` has no column `{wanted}`; it has {present}")]
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
    /// A cell is a number, but NaN or infinite.
    #[error("line {line}, column `{column}`: `{value}` is not finite (expected a finite number)")]
    NotFinite {
        line: u64,
        column: String,
        value: String,
    },
    /// The time stamps are not equally spaced.
    #[error(
        "line {line}: irregular time stamps, a step of {found:.6} s where {expected:.6} s was expected (column `{column}`)"
    )]
    IrregularTime {
        line: u64,
        column: String,
        found: f64,
        expected: f64,
    },
    /// The record or the chosen part of it is too short.
    #[error("only {found} samples {part}, but at least {needed} are needed")]
    TooFewSamples {
        found: usize,
        needed: usize,
        part: String,
    },
}

/// Equally sampled signals read from one file.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// Comment lines of the file in their order, without the leading `#`.
    pub comments: Vec<String>,
    /// Time of the first sample in s.
    pub start: f64,
    /// Sampling interval in s.
    pub dt: f64,
    /// The signals in the order in which they were asked for.
    pub signals: Vec<Vec<f64>>,
}

impl Record {
    /// Reads the `signals` of the CSV file at `path`, sampled at the stamps
    /// (in s) of the column `time`.
    ///
    /// Lines starting with `#` are comments; cells are separated by commas, or
    /// by semicolons or tabs when the header has no comma. Quoted cells, CRLF
    /// and a byte order mark are understood. Columns that are not asked for
    /// need not hold numbers.
    ///
    /// # Errors
    ///
    /// [`RecordError`] names the first thing that is wrong and its line.
    pub fn read(path: &Path, time: &str, signals: &[String]) -> Result<Self, RecordError> {
        let bytes = std::fs::read(path).map_err(|e| RecordError::Unreadable {
            path: path.to_owned(),
            reason: match e.kind() {
                std::io::ErrorKind::NotFound => "no such file".into(),
                std::io::ErrorKind::IsADirectory => "it is a directory".into(),
                _ => e.to_string(),
            },
        })?;
        Self::parse(path, &bytes, time, signals)
    }

    fn parse(
        path: &Path,
        bytes: &[u8],
        time: &str,
        signals: &[String],
    ) -> Result<Self, RecordError> {
        let text = String::from_utf8_lossy(bytes);
        let text = text.trim_start_matches('\u{feff}');
        let mut comments = Vec::new();
        // The reader counts no comments and blank lines, so they are taken out
        // here and the number of each line that stays is kept.
        let (mut table, mut numbers) = (String::with_capacity(text.len()), Vec::new());
        for (number, line) in (1..).zip(text.lines()) {
            match line.trim() {
                "" => {}
                l if l.starts_with('#') => comments.push(l[1..].trim().to_owned()),
                _ => {
                    table.push_str(line);
                    table.push('\n');
                    numbers.push(number);
                }
            }
        }
        let header = table.lines().next().ok_or_else(|| RecordError::NoHeader {
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
            .from_reader(table.as_bytes());
        let unreadable = |e: csv::Error| RecordError::Unreadable {
            path: path.to_owned(),
            reason: e.to_string(),
        };
        let names = rows.headers().map_err(unreadable)?.clone();

        let mut wanted = vec![position(path, &names, time)?];
        for name in signals {
            wanted.push(position(path, &names, name)?);
        }
        let mut columns: Vec<Vec<f64>> = vec![Vec::new(); wanted.len()];
        let mut lines = Vec::new();
        for row in rows.records() {
            let row = row.map_err(unreadable)?;
            let place = row.position().map_or(0, |p| p.line() as usize - 1);
            let line = numbers.get(place).copied().unwrap_or(0);
            if row.iter().all(str::is_empty) {
                continue;
            }
            for (values, &c) in columns.iter_mut().zip(&wanted) {
                values.push(cell(line, &names, &row, c)?);
            }
            lines.push(line);
        }

        let stamps = columns.remove(0);
        let dt = sampling_interval(&stamps, &lines, time)?;
        Ok(Self {
            comments,
            start: stamps[0],
            dt,
            signals: columns,
        })
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.signals.first().map_or(0, Vec::len)
    }

    /// The samples with `from <= t <= to` (in s, on the record's own clock),
    /// at least `needed` of them.
    ///
    /// # Errors
    ///
    /// [`RecordError::TooFewSamples`] when less than `needed` remain.
    pub fn window(
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
            signals: self
                .signals
                .iter()
                .map(|s| s[first..last].to_vec())
                .collect(),
        })
    }
}

fn position(path: &Path, names: &csv::StringRecord, wanted: &str) -> Result<usize, RecordError> {
    let mut hits = names.iter().enumerate().filter(|(_, n)| *n == wanted);
    let Some((first, _)) = hits.next() else {
        return Err(RecordError::MissingColumn {
            path: path.to_owned(),
            wanted: wanted.to_owned(),
            present: names
                .iter()
                .map(|n| format!("`{n}`"))
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

fn cell(
    line: u64,
    names: &csv::StringRecord,
    row: &csv::StringRecord,
    c: usize,
) -> Result<f64, RecordError> {
    let column = names[c].to_owned();
    let Some(text) = row.get(c) else {
        return Err(RecordError::ShortLine {
            line,
            column,
            found: row.len(),
            expected: names.len(),
        });
    };
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(RecordError::NotFinite {
            line,
            column,
            value: text.to_owned(),
        }),
        Err(_) => Err(RecordError::NotANumber {
            line,
            column,
            value: text.to_owned(),
        }),
    }
}

/// The sampling interval that all stamps keep: their median step decides what
/// is irregular, their whole span gives the figure.
fn sampling_interval(stamps: &[f64], lines: &[u64], column: &str) -> Result<f64, RecordError> {
    if stamps.len() < 2 {
        return Err(RecordError::TooFewSamples {
            found: stamps.len(),
            needed: 2,
            part: "in the record".into(),
        });
    }
    let steps: Vec<f64> = stamps.windows(2).map(|w| w[1] - w[0]).collect();
    let mut sorted = steps.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted[sorted.len() / 2];
    let irregular = |k: usize, expected: f64| RecordError::IrregularTime {
        line: lines[k + 1],
        column: column.to_owned(),
        found: steps[k],
        expected,
    };
    // A step that does not advance is wrong even when most of them are so.
    if median <= 0.0 {
        let k = steps.iter().position(|&s| s <= 0.0).unwrap_or(0);
        return Err(irregular(k, steps.iter().copied().fold(0.0, f64::max)));
    }
    if let Some(k) = steps
        .iter()
        .position(|s| (s - median).abs() > STEP_TOLERANCE * median)
    {
        return Err(irregular(k, median));
    }
    Ok((stamps[stamps.len() - 1] - stamps[0]) / steps.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str, signals: &[&str]) -> Result<Record, RecordError> {
        let signals: Vec<String> = signals.iter().map(|s| (*s).to_owned()).collect();
        Record::parse(Path::new("x.csv"), text.as_bytes(), "t", &signals)
    }

    fn refusal(text: &str) -> String {
        parse(text, &["u", "y"]).unwrap_err().to_string()
    }

    #[test]
    fn signals_come_in_the_order_asked_for_with_the_comments() {
        let r = parse(
            "# a valve\n# [mm]\nt,u,y\n0.5,1,2\n0.6,3,4\n0.7,5,6\n",
            &["y", "u"],
        )
        .unwrap();
        assert_eq!(r.comments, ["a valve", "[mm]"]);
        assert_eq!(r.signals, [[2.0, 4.0, 6.0], [1.0, 3.0, 5.0]]);
        assert_eq!(r.start, 0.5);
        assert!((r.dt - 0.1).abs() < 1e-12);
    }

    #[test]
    fn spreadsheet_habits_are_understood() {
        let plain = parse("t,u,y\n0,1,2\n1,3,4\n", &["u", "y"]).unwrap();
        for text in [
            "\u{feff}t,u,y\r\n0,1,2\r\n1,3,4\r\n",
            "\"t\",\"u\",\"y\"\n\"0\",\"1\",\"2\"\n1,3,4",
            "t;u;y\n0;1;2\n1;3;4\n",
            "t\tu\ty\n0\t1\t2\n1\t3\t4\n",
            " t , u , y \n 0 , 1 , 2 \n\n 1 , 3 , 4 \n\n",
        ] {
            assert_eq!(parse(text, &["u", "y"]).unwrap(), plain, "{text:?}");
        }
    }

    #[test]
    fn columns_not_asked_for_may_hold_anything() {
        assert!(parse("t,u,y,note\n0,1,2,start\n1,3,4,\n", &["u", "y"]).is_ok());
    }

    #[test]
    fn a_missing_file_is_named() {
        let e = Record::read(Path::new("no/such.csv"), "t", &[]).unwrap_err();
        assert_eq!(e.to_string(), "cannot read `no/such.csv`: no such file");
    }

    #[test]
    fn a_missing_column_names_what_exists() {
        assert_eq!(
            refusal("t,v,y\n0,1,2\n1,3,4\n"),
            "`x.csv` has no column `u`; it has `t`, `v`, `y`"
        );
        assert_eq!(
            refusal("t,u,u,y\n0,1,2,3\n"),
            "`x.csv` has more than one column `u`"
        );
        assert_eq!(
            refusal("# only words\n\n"),
            "`x.csv` holds no header line with column names"
        );
    }

    #[test]
    fn a_bad_cell_is_named_with_line_and_column() {
        // Comments, quotes and blank lines count as lines of the file.
        let text = "# one\n# two\nt,u,y\n0,1,2\n\n1,3,abc\n";
        assert_eq!(
            refusal(text),
            "line 6, column `y`: `abc` is not a number (expected one like -1.5e-3)"
        );
        assert_eq!(
            refusal("t,u,y\r\n0,1,2\r\n1,,4\r\n"),
            "line 3, column `u`: `` is not a number (expected one like -1.5e-3)"
        );
        assert_eq!(
            refusal("t,u,y\n0,1,2\n1,NaN,4\n"),
            "line 3, column `u`: `NaN` is not finite (expected a finite number)"
        );
        assert_eq!(
            refusal("t,u,y\n0,1,2\n1,3\n"),
            "line 3 ends before column `y`: it has 2 of 3 cells"
        );
    }

    #[test]
    fn the_first_irregular_step_is_named() {
        let text = "t,u,y\n0,1,2\n0.1,3,4\n0.2,3,4\n0.35,3,4\n0.45,3,4\n";
        assert_eq!(
            refusal(text),
            "line 5: irregular time stamps, a step of 0.150000 s where 0.100000 s was expected (column `t`)"
        );
        assert!(
            refusal("t,u,y\n0,1,2\n0,3,4\n0,3,4\n").starts_with("line 3: irregular time stamps")
        );
        assert!(
            refusal("t,u,y\n2,1,2\n1,3,4\n0,3,4\n").starts_with("line 3: irregular time stamps")
        );
        // A step within one percent is the rounding of the file.
        assert!(parse("t,u,y\n0,1,2\n0.1004,3,4\n0.2,3,4\n", &["u"]).is_ok());
    }

    #[test]
    fn too_few_samples_are_counted() {
        assert_eq!(
            refusal("t,u,y\n"),
            "only 0 samples in the record, but at least 2 are needed"
        );
        let r = parse("t,u,y\n0,1,2\n1,3,4\n2,5,6\n3,7,8\n", &["u"]).unwrap();
        assert_eq!(
            r.window(Some(1.0), Some(2.0), 3).unwrap_err().to_string(),
            "only 2 samples between 1 s and 2 s, but at least 3 are needed"
        );
        assert!(r.window(Some(9.0), None, 1).is_err());
        assert!(r.window(None, Some(-1.0), 1).is_err());
    }

    #[test]
    fn a_window_keeps_both_bounds() {
        let r = parse("t,u,y\n0,1,2\n1,3,4\n2,5,6\n3,7,8\n", &["u"]).unwrap();
        let w = r.window(Some(1.0), Some(2.0), 2).unwrap();
        assert_eq!((w.start, w.signals[0].clone()), (1.0, vec![3.0, 5.0]));
        assert_eq!(r.window(None, None, 4).unwrap(), r);
    }
}
