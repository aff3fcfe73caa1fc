//! A file as lines and cells: what is a comment, what a header, what a row.

use std::borrow::Cow;
use std::path::Path;

use super::cells::{cell, position, surplus, time_position};
use super::error::RecordError;

/// The wanted columns of a table.
pub(super) struct Table {
    /// Name of the column of the time stamps.
    pub(super) time: String,
    /// The time stamps where they are wanted, then the signals.
    pub(super) columns: Vec<Vec<f64>>,
    /// Number of the line of each row.
    pub(super) numbers: Vec<u64>,
    /// Those of the rows between the first and the last that have empty cells only; a blank line is
    /// none.
    pub(super) empty: Vec<u64>,
}

/// The lines of a file by what they are.
pub(super) struct Lines {
    pub(super) comments: Vec<String>,
    /// Header and rows.
    table: String,
    /// Number of each line of the table in the file.
    numbers: Vec<u64>,
}

impl Lines {
    /// The CSV reader counts no comments and blank lines, so they are taken out here and the number
    /// of each line that stays is kept.
    pub(super) fn of(text: &str) -> Self {
        let mut lines = Self {
            comments: Vec::new(),
            table: String::with_capacity(text.len()),
            numbers: Vec::new(),
        };
        for (number, line) in (1..).zip(with_line_feeds(text).lines()) {
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
    pub(super) fn columns(
        &self,
        path: &Path,
        time: Option<&str>,
        signals: &[String],
    ) -> Result<Table, RecordError> {
        let header = self.table.lines().next();
        let header = header.ok_or_else(|| RecordError::NoHeader {
            path: path.to_owned(),
        })?;
        let separator = delimiter(header);
        let mut rows = csv::ReaderBuilder::new()
            .delimiter(separator)
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
        let (mut numbers, mut lengths, mut points) = (Vec::new(), Lengths::default(), false);
        let (mut row, mut empty) = (csv::StringRecord::new(), Vec::new());
        while rows.read_record(&mut row).map_err(unreadable)? {
            let place = row.position().map_or(0, |p| p.line() as usize - 1);
            let number = |place: usize| self.numbers.get(place).copied().unwrap_or(0);
            let (line, last) = (number(place), rows.position().line() as usize - 2);
            if last > place {
                return Err(RecordError::OpenQuote {
                    line,
                    last: number(last),
                });
            }
            if row.iter().all(str::is_empty) {
                // Before the first row there is none to be missing.
                empty.extend((!numbers.is_empty()).then_some(line));
                continue;
            }
            surplus(line, &names, &row)?;
            for (values, &c) in columns.iter_mut().zip(&wanted) {
                values.push(cell(line, &names, &row, c)?);
            }
            numbers.push(line);
            lengths.count(row.len(), line);
            points |= row.iter().any(|cell| cell.contains('.'));
        }
        // With a decimal comma the last cell, one of a column that nobody asks for, may be empty.
        let commas = separator == b',' && !points && !wanted.contains(&(names.len() - 1));
        lengths.check(commas.then_some(names.len()))?;
        let last = numbers.last().copied().unwrap_or(0);
        empty.retain(|line| *line < last);
        Ok(Table {
            time: time.unwrap_or_default(),
            columns,
            numbers,
            empty,
        })
    }
}

/// A carriage return alone ends a line, too.
fn with_line_feeds(text: &str) -> Cow<'_, str> {
    match text.contains('\r') {
        true => Cow::Owned(text.replace("\r\n", "\n").replace('\r', "\n")),
        false => Cow::Borrowed(text),
    }
}

/// What separates the cells: of comma, semicolon and tab the one that the header has most of, a
/// name in quotes aside.
fn delimiter(header: &str) -> u8 {
    let plain: String = header.split('"').step_by(2).collect();
    let count = |d: &u8| plain.matches(char::from(*d)).count();
    // Of equals the last one is taken.
    [b'\t', b';', b',']
        .into_iter()
        .max_by_key(count)
        .unwrap_or(b',')
}

/// How many cells the rows have: a separator too many or too few moves the cells behind it into
/// other columns, where they are numbers as well.
#[derive(Default)]
struct Lengths(Vec<Length>);

/// Rows with the same number of cells.
struct Length {
    cells: usize,
    rows: usize,
    /// The first line of them.
    line: u64,
}

impl Lengths {
    fn count(&mut self, cells: usize, line: u64) {
        match self.0.iter_mut().find(|length| length.cells == cells) {
            Some(length) => length.rows += 1,
            None => self.0.push(Length {
                cells,
                rows: 1,
                line,
            }),
        }
    }

    /// Refuses the first row that is longer or shorter than most, or longer than some names.
    fn check(&self, names: Option<usize>) -> Result<(), RecordError> {
        let Some(usual) = self.0.iter().max_by_key(|length| length.rows) else {
            return Ok(());
        };
        if let Some(other) = self.0.iter().find(|length| length.cells != usual.cells) {
            return Err(RecordError::OtherLength {
                line: other.line,
                found: other.cells,
                expected: usual.cells,
            });
        }
        match names.filter(|names| usual.cells > *names) {
            Some(names) => Err(RecordError::LongLine {
                line: usual.line,
                found: usual.cells,
                expected: names,
            }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, signal: &str) -> Result<Table, RecordError> {
        Lines::of(text).columns(Path::new("x.csv"), Some("t"), &[signal.to_owned()])
    }

    /// Whose fraction would stand under the name of the notes.
    #[test]
    fn an_empty_last_cell_hides_no_decimal_comma() {
        let refused = read("t,y,note\n0,1,5,\n1,2,5,\n", "y").err();
        let wanted = RecordError::LongLine {
            line: 2,
            found: 4,
            expected: 3,
        };
        assert_eq!(refused, Some(wanted));
        // A separator behind each row: with points, or behind what is asked for.
        for text in ["t,y,note\n0,1.5,5,\n1,2,5,\n", "t,v,y\n0,1,5,\n1,2,5,\n"] {
            assert!(read(text, "y").is_ok(), "{text}");
        }
        assert!(read("t;y;note\n0;1;5;\n1;2;5;\n", "y").is_ok());
    }
}
