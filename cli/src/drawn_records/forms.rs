//! One record in many forms, from a file and in pieces, and with decimal commas.

use std::io::{Error, ErrorKind, Read};
use std::path::Path;

use super::{Drive, read};
use crate::draws::Uniform;
use crate::record::{self, Clock, RecordError, Resampling};

/// How a file writes its table.
struct Form {
    time: &'static str,
    /// Counts of the stamps in a second.
    counts: f64,
    separator: char,
    line_end: &'static str,
    quoted: bool,
    byte_order_mark: bool,
    latin_1: bool,
    spaces: bool,
    exponents: bool,
    /// Whether numbers have decimal commas.
    commas: bool,
    /// Whether those stand without quotes among commas that separate the cells.
    bare: bool,
    comments: bool,
    /// Whether there are columns that nobody asks for, and whether they come first.
    others: Option<bool>,
    /// Time of the first stamp in s.
    start: f64,
}

impl Form {
    fn of(draw: &mut Uniform) -> Self {
        let (time, counts) = draw.one(&[
            ("t", 1.0),
            ("t [s]", 1.0),
            ("Time (s)", 1.0),
            ("t_ms", 1e3),
            ("time [ms]", 1e3),
            ("Timestamp (ms)", 1e3),
            ("t_us", 1e6),
            ("Time [\u{b5}s]", 1e6),
            ("time_ns", 1e9),
            ("t [min]", 1.0 / 60.0),
        ]);
        Self {
            time,
            counts,
            separator: draw.one(&[',', ';', '\t']),
            line_end: draw.one(&["\n", "\r\n", "\r"]),
            quoted: draw.yes(),
            byte_order_mark: draw.yes(),
            latin_1: draw.yes(),
            spaces: draw.yes(),
            exponents: draw.yes(),
            commas: false,
            bare: false,
            comments: draw.yes(),
            others: draw.one(&[None, Some(false), Some(true)]),
            start: draw.one(&[0.0, -3.0, 17.25, 86_400.0]),
        }
    }

    fn text(&self, drive: &Drive, draw: &mut Uniform) -> Vec<u8> {
        let mut text = match self.byte_order_mark && !self.latin_1 {
            true => "\u{feff}".to_owned(),
            false => String::new(),
        };
        let mut names = vec![self.time, "u", "w", "y"];
        // A name with the separators of other files in its unit.
        let others = self
            .others
            .map(|first| (first, "v [m/s, rms]", "note \u{b0}"));
        self.line(&mut text, &mut names, others);
        for (k, [t, u, w, y]) in drive.rows.iter().enumerate() {
            if self.comments && draw.below(9) == 0 {
                text += draw.one(&["# remark, with; separators", "", "   "]);
                text += self.line_end;
            }
            let [t, y] = [(t + self.start) * self.counts, (y * 1e6).round() / 1e6];
            let cells = [t, *u, *w, y].map(|value| self.number(value));
            let mut cells: Vec<&str> = cells.iter().map(String::as_str).collect();
            let note = if k % 3 == 0 { "start" } else { "" };
            self.line(
                &mut text,
                &mut cells,
                self.others.map(|first| (first, "NaN", note)),
            );
        }
        match self.latin_1 {
            true => text
                .chars()
                .map(|c| u8::try_from(u32::from(c)).unwrap_or(b'?'))
                .collect(),
            false => text.into_bytes(),
        }
    }

    fn number(&self, value: f64) -> String {
        let text = match self.exponents {
            true => format!("{value:e}"),
            false => format!("{value}"),
        };
        match self.commas {
            true => text.replace('.', ","),
            false => text,
        }
    }

    fn line<'a>(
        &self,
        text: &mut String,
        cells: &mut Vec<&'a str>,
        others: Option<(bool, &'a str, &'a str)>,
    ) {
        if let Some((first, a, b)) = others {
            let at = if first { 0 } else { cells.len() };
            cells.splice(at..at, [a, b]);
        }
        let space = if self.spaces { " " } else { "" };
        // Those in a name never stand bare.
        let may_be_apart = |cell: &str| !self.bare || cell.contains('[');
        let apart = |cell: &str| may_be_apart(cell) && cell.contains(self.separator);
        let quoted = |cell: &&str| match self.quoted || apart(cell) {
            true => format!("\"{cell}\""),
            false => format!("{space}{cell}{space}"),
        };
        let cells: Vec<String> = cells.iter().map(quoted).collect();
        *text += &cells.join(&self.separator.to_string());
        *text += self.line_end;
    }
}

#[test]
fn a_record_is_the_same_in_every_form() {
    for seed in 1..=400 {
        let mut draw = Uniform::of(seed);
        let drive = Drive::of(&mut draw, 60, 0.0, 0.01);
        let plain = read(drive.table(6).as_bytes(), Clock::SECONDS).expect("the plain record");
        let form = Form::of(&mut draw);
        let text = form.text(&drive, &mut draw);
        let shown = String::from_utf8_lossy(&text).into_owned();
        let found = read(&text, Clock::SECONDS).unwrap_or_else(|e| panic!("{seed}: {e}\n{shown}"));
        assert_eq!(found.signals, plain.signals, "{seed}\n{shown}");
        let piped = record::bytes(
            Path::new("-"),
            &mut Pieces {
                left: &text,
                next: 0,
            },
        );
        assert_eq!(piped.as_deref(), Ok(&*text), "{seed}");
        assert!(
            (found.dt / drive.dt - 1.0).abs() < 1e-6,
            "{seed}: {}",
            found.dt
        );
        assert!(
            (found.start - form.start).abs() < 1e-6,
            "{seed}: {}",
            found.start
        );
        assert!(
            found.notes.alone.is_empty() && found.notes.resampling == Resampling::default(),
            "{seed}"
        );
        let said = found.notes.granted.is_some();
        assert_eq!(said, form.counts != 1.0, "{seed} {:?}", found.notes.granted);
        // Without its stamps, at their interval.
        let clock = Clock {
            dt: Some(drive.dt),
            ..Clock::SECONDS
        };
        let found = read(&text, clock).expect("without stamps");
        assert_eq!(
            (found.signals, found.dt),
            (plain.signals, drive.dt),
            "{seed}"
        );
    }
}

/// What comes in pieces of a few bytes, with interruptions between them.
struct Pieces<'a> {
    left: &'a [u8],
    next: usize,
}

impl Read for Pieces<'_> {
    fn read(&mut self, into: &mut [u8]) -> Result<usize, Error> {
        self.next = (self.next + 5) % 8;
        if self.next == 2 {
            return Err(ErrorKind::Interrupted.into());
        }
        let piece = (self.next + 1).min(into.len()).min(self.left.len());
        let (now, later) = self.left.split_at(piece);
        into[..piece].copy_from_slice(now);
        self.left = later;
        Ok(piece)
    }
}

/// The line of the first row with a decimal comma in what is read, with its column and its cell.
fn first_comma(form: &Form, drive: &Drive, text: &[u8]) -> Option<(usize, &'static str, String)> {
    let text = String::from_utf8_lossy(text).replace("\r\n", "\n");
    let text = text.replace('\r', "\n");
    let lines = text.lines().enumerate().filter(|(_, line)| {
        let line = line.trim();
        !line.is_empty() && !line.starts_with('#')
    });
    for ((place, _), [t, u, w, y]) in lines.skip(1).zip(&drive.rows) {
        let [t, y] = [(t + form.start) * form.counts, (y * 1e6).round() / 1e6];
        // In the order in which the columns are asked for.
        for (name, value) in [(form.time, t), ("y", y), ("u", *u), ("w", *w)] {
            let cell = form.number(value);
            if cell.contains(',') {
                return Some((place + 1, name, cell));
            }
        }
    }
    None
}

#[test]
fn decimal_commas_are_refused_with_their_place() {
    let (mut named, mut longer) = (0, 0);
    for seed in 1..=400 {
        let mut draw = Uniform::of(seed);
        let drive = Drive::of(&mut draw, 60, 0.0, 0.01);
        let form = Form {
            commas: true,
            bare: seed % 2 == 0,
            ..Form::of(&mut draw)
        };
        let text = form.text(&drive, &mut draw);
        let shown = String::from_utf8_lossy(&text).into_owned();
        let (line, column, value) = first_comma(&form, &drive, &text).expect("a comma");
        let error = read(&text, Clock::SECONDS).expect_err(&format!("{seed}\n{shown}"));
        match error {
            RecordError::DecimalComma { .. } => {
                named += 1;
                let wanted = format!(
                    "line {line}, column `{column}`: `{value}` has a decimal comma; write a point"
                );
                assert_eq!(error.to_string(), wanted, "{seed}\n{shown}");
            }
            // Where the cells are separated by commas, too.
            RecordError::LongLine { line: found, .. } => {
                longer += 1;
                assert_eq!(found, line as u64, "{seed}\n{shown}");
                assert!(form.bare && form.separator == ',' && !form.quoted, "{seed}");
            }
            other => panic!("{seed}: {other}\n{shown}"),
        }
    }
    println!("named {named}, as rows that are too long {longer}");
    assert!(named > 200 && longer > 20);
}
