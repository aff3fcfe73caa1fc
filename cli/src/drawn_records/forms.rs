//! One record in many forms, and the same drive under jitter and with missing rows.

use super::{Draw, Drive, read};
use crate::record::{Clock, Record, Resampling};
use trendid_identify::{
    Choice, Freedom, Hold, Input, Options, Problem, Signals, Structure, identify,
};

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
    comments: bool,
    /// Whether there are columns that nobody asks for, and whether they come first.
    others: Option<bool>,
    /// Time of the first stamp in s.
    start: f64,
}

impl Form {
    fn of(draw: &mut Draw) -> Self {
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
            comments: draw.yes(),
            others: draw.one(&[None, Some(false), Some(true)]),
            start: draw.one(&[0.0, -3.0, 17.25, 86_400.0]),
        }
    }

    fn text(&self, drive: &Drive, draw: &mut Draw) -> Vec<u8> {
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
            let cells = [t, *u, *w, y].map(|value| match self.exponents {
                true => format!("{value:e}"),
                false => format!("{value}"),
            });
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
        let quoted = |cell: &&str| match self.quoted || cell.contains(self.separator) {
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
        let mut draw = Draw::of(seed);
        let drive = Drive::of(&mut draw, 60, 0.0, 0.01);
        let plain = read(drive.table(6).as_bytes(), Clock::SECONDS).expect("the plain record");
        let form = Form::of(&mut draw);
        let text = form.text(&drive, &mut draw);
        let shown = String::from_utf8_lossy(&text).into_owned();
        let found = read(&text, Clock::SECONDS).unwrap_or_else(|e| panic!("{seed}: {e}\n{shown}"));
        assert_eq!(found.signals, plain.signals, "{seed}\n{shown}");
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

/// Deviations of the model of a record from the truth, in standard deviations.
fn deviations(record: &Record, truth: &[f64]) -> Vec<f64> {
    let input = |name, c: usize| Input {
        name,
        samples: &record.signals[c],
        delayed: true,
        hold: Hold::Zero,
    };
    let signals = Signals {
        dt: record.dt,
        output: &record.signals[0],
        inputs: vec![input("u", 1), input("w", 2)],
        standstill: None,
    };
    let structure = Structure::of_order(1);
    let problem = Problem::new(&signals, structure, Options::default()).expect("a problem");
    let freedom = Freedom {
        delay: Choice::Given(0),
        ..Freedom::default()
    };
    let e = identify(&problem, freedom, 0, &())
        .expect("a model")
        .estimate;
    let each = truth.iter().zip(e.theta.iter().zip(&e.sigma));
    each.map(|(truth, (found, sigma))| (found - truth) / sigma)
        .collect()
}

/// Rows that are missing are not known: what the inputs did in them is in the noise.
#[test]
fn jitter_and_missing_rows_are_within_the_deviations() {
    let mut all = Vec::new();
    for seed in 1..=40_u64 {
        let mut draw = Draw::of(seed);
        let jitter = draw.one(&[0.0, 0.02, 0.08, 0.15]);
        let noise = draw.one(&[1e-2, 1e-3, 1e-4]);
        let mut drive = Drive::of(&mut draw, 1500, jitter, noise);
        let missing = draw.one(&[0, 1, 10]);
        for _ in 0..missing {
            let row = 1 + draw.below(drive.rows.len() - 2);
            drive.rows.remove(row);
        }
        let record = read(drive.table(9).as_bytes(), Clock::SECONDS).expect("a record");
        let resampling = record.notes.resampling;
        assert_eq!(resampling.filled, missing, "{seed}");
        assert_eq!(resampling.jitter.is_some(), jitter > 0.01, "{seed}");
        let z = deviations(&record, &drive.truth);
        assert!(z.iter().all(|z| z.abs() < 5.0), "{seed}: {z:?}");
        all.extend(z);
    }
    let rms = (all.iter().map(|z| z * z).sum::<f64>() / all.len() as f64).sqrt();
    println!("rms {rms:.2}");
    assert!(rms < 1.5, "{rms}");
}
