//! Records: one line per sample, as `trendid identify` and `trendid select` take them.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use trendid_link::code;
use trendid_link::telemetry::{Identity, Sample};

use crate::claimed::Claimed;

/// Header of a record.
const COLUMNS: &str = "t,u,y,r,v,e,state,reason,tick";

/// Samples after which a record ends: an hour and a half at 1 kHz, some 400 MB.
const LONGEST: u64 = 5_400_000;

/// A record that is being written.
pub(crate) struct Recorder {
    file: BufWriter<File>,
    pub path: PathBuf,
    sample_time: f64,
    first: Option<u32>,
    next: u32,
    pub rows: u64,
}

impl Recorder {
    /// Begins a record of the machine in a file of its own.
    pub(crate) fn begin(claimed: Claimed, identity: &Identity) -> Result<Self, String> {
        let Claimed { path, file } = claimed;
        let named = |error: std::io::Error| format!("{}: {error}", path.display());
        let mut file = BufWriter::new(file);
        let Identity {
            name,
            unit,
            sample_time,
            travel: [min, max],
            ..
        } = identity;
        writeln!(file, "# {name}; sample_time = {sample_time} s, unit = {unit}, travel = {min} .. {max}")
            .and_then(|()| writeln!(file, "# t [s]; u command of the valve, held; y measured position, r setpoint [{unit}]; v observed velocity [{unit}/s]; e innovation [{unit}]"))
            .and_then(|()| writeln!(file, "{COLUMNS}"))
            .map_err(named)?;
        Ok(Self {
            file,
            path,
            sample_time: f64::from(*sample_time),
            first: None,
            next: 0,
            rows: 0,
        })
    }

    /// Takes a sample; an error ends the record.
    pub(crate) fn take(&mut self, sample: &Sample) -> Result<(), String> {
        let first = *self.first.get_or_insert(sample.tick);
        if self.rows > 0 && sample.tick != self.next {
            return Err("a sample is missing: the record ends before it".into());
        }
        if self.rows >= LONGEST {
            return Err(format!("the record has {LONGEST} samples"));
        }
        self.next = sample.tick.wrapping_add(1);
        self.rows += 1;
        let t = f64::from(sample.tick.wrapping_sub(first)) * self.sample_time;
        let Sample {
            command,
            position,
            setpoint: [setpoint, _],
            velocity,
            state,
            reason,
            tick,
            ..
        } = *sample;
        let innovation = sample.innovation.map(|e| e.to_string()).unwrap_or_default();
        let reason = match reason {
            code::NO_REASON => String::new(),
            reason => reason.to_string(),
        };
        writeln!(
            self.file,
            "{t:.6},{command},{position},{setpoint},{velocity},{innovation},{state},{reason},{tick}"
        )
        .map_err(|error| format!("{}: {error}", self.path.display()))
    }

    /// Writes what waits.
    pub(crate) fn finish(mut self) -> Result<(PathBuf, u64), String> {
        self.file
            .flush()
            .map_err(|error| format!("{}: {error}", self.path.display()))?;
        Ok((self.path, self.rows))
    }
}

/// A row of a record.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    pub tick: u32,
    pub command: f32,
    pub position: f32,
    pub setpoint: f32,
    pub velocity: f32,
    pub innovation: Option<f32>,
    pub state: u8,
    pub reason: Option<u8>,
}

/// A record that was read.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rows {
    pub unit: String,
    pub sample_time: f64,
    pub travel: [f32; 2],
    pub rows: Vec<Row>,
}

/// Reads a record; a refusal names file, line, column, value and what was expected.
pub(crate) fn read(path: &Path) -> Result<Rows, String> {
    let text = fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    parse(&text).map_err(|why| format!("{}: {why}", path.display()))
}

fn parse(text: &str) -> Result<Rows, String> {
    let mut rows = Vec::new();
    let (mut unit, mut header, mut times) = (String::from("mm"), false, Vec::new());
    let mut travel = [f32::INFINITY, f32::NEG_INFINITY];
    for (line, words) in (1..).zip(text.lines()) {
        if let Some(comment) = words.strip_prefix('#') {
            if let Some((_, rest)) = comment.split_once("unit = ") {
                unit = rest
                    .split(',')
                    .next()
                    .unwrap_or("mm")
                    .trim()
                    .chars()
                    .take(8)
                    .collect();
            }
        } else if !header {
            if words != COLUMNS {
                return Err(format!(
                    "line {line}: `{words}` is not the header `{COLUMNS}`"
                ));
            }
            header = true;
        } else {
            let (time, row) = row(words).map_err(|why| format!("line {line}: {why}"))?;
            travel = [travel[0].min(row.position), travel[1].max(row.position)];
            times.push(time);
            rows.push(row);
        }
    }
    let ([first, .., last], [begin, .., end]) = (&times[..], &rows[..]) else {
        return Err("it has fewer than two samples".into());
    };
    // Over the whole of it, since each time is rounded; a sample that was taken out has its number.
    let samples = end.tick.wrapping_sub(begin.tick);
    let sample_time = (last - first) / f64::from(samples);
    if !(sample_time > 0.0 && sample_time < 10.0) {
        return Err(format!(
            "its sample time of {sample_time} s is not within 0..10"
        ));
    }
    Ok(Rows {
        unit,
        sample_time,
        travel,
        rows,
    })
}

fn row(words: &str) -> Result<(f64, Row), String> {
    let cells: Vec<&str> = words.split(',').collect();
    let names: Vec<&str> = COLUMNS.split(',').collect();
    if cells.len() != names.len() {
        return Err(format!(
            "{} cells where {} are expected",
            cells.len(),
            names.len()
        ));
    }
    let number = |place: usize| -> Result<f64, String> {
        let (cell, name) = (cells[place], names[place]);
        cell.parse()
            .ok()
            .filter(|x: &f64| x.is_finite() && x.abs() < 1e30)
            .ok_or_else(|| format!("column {name}: `{cell}` is not a finite number"))
    };
    let small = |place: usize| -> Result<u8, String> {
        let (cell, name) = (cells[place], names[place]);
        cell.parse()
            .map_err(|_| format!("column {name}: `{cell}` is not a whole number within 0..=255"))
    };
    let (tick, name) = (cells[8], names[8]);
    let row = Row {
        tick: tick
            .parse()
            .map_err(|_| format!("column {name}: `{tick}` is not a whole number of 32 bits"))?,
        command: number(1)? as f32,
        position: number(2)? as f32,
        setpoint: number(3)? as f32,
        velocity: number(4)? as f32,
        innovation: match cells[5] {
            "" => None,
            _ => Some(number(5)? as f32),
        },
        state: small(6)?,
        reason: match cells[7] {
            "" => None,
            _ => Some(small(7)?),
        },
    };
    Ok((number(0)?, row))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(tick: u32) -> Sample {
        Sample {
            tick,
            state: 7,
            reason: 3,
            position: 1.25,
            command: -0.5,
            innovation: tick.is_multiple_of(2).then_some(1e-7),
            ..Sample::default()
        }
    }

    #[test]
    fn a_record_is_read_as_it_was_written_and_ends_at_a_gap() {
        let folder = std::env::temp_dir().join(format!("trendid-record-{}", std::process::id()));
        let path = folder.join("a.csv");
        let identity = Identity {
            sample_time: 1e-3,
            unit: "mm".try_into().unwrap(),
            ..Identity::default()
        };
        let claimed = Claimed::create(path.clone()).unwrap();
        let mut recorder = Recorder::begin(claimed, &identity).unwrap();
        for tick in 100..200 {
            recorder.take(&sample(tick)).unwrap();
        }
        assert!(recorder.take(&sample(201)).is_err());
        assert_eq!(recorder.finish().unwrap().1, 100);
        let back = read(&path).unwrap();
        assert!((back.sample_time - 1e-3).abs() < 1e-9 && back.unit == "mm");
        assert_eq!(back.rows.len(), 100);
        let row = &back.rows[50];
        assert_eq!((row.tick, row.state, row.reason), (150, 7, Some(3)));
        assert_eq!(
            (row.position, row.command, row.innovation),
            (1.25, -0.5, Some(1e-7))
        );
        assert_eq!(back.rows[51].innovation, None);
        // A file that is there is not overwritten.
        assert!(Claimed::create(path).is_err());
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn the_sample_time_is_that_of_the_whole_record() {
        let exact = 1.0 / 3000.0;
        let begin = u32::MAX - 100;
        let mut text = format!("{COLUMNS}\n");
        // Two samples were taken out by hand.
        for k in (0..300).filter(|k| ![7, 8].contains(k)) {
            let (t, tick) = (f64::from(k) * exact, begin.wrapping_add(k));
            text += &format!("{t:.6},0,1,0,0,,0,,{tick}\n");
        }
        let found = parse(&text).unwrap().sample_time;
        assert!((found / exact - 1.0).abs() < 1e-5, "{found}");
    }

    #[test]
    fn what_is_wrong_is_named() {
        let head = format!("# x, unit = mm, y\n{COLUMNS}\n");
        let refused = |rows: &str| parse(&format!("{head}{rows}")).unwrap_err();
        assert!(refused("0,0,1").contains("line 3: 3 cells where 9"));
        assert!(refused("0,0,NaN,0,0,,0,,1").contains("column y: `NaN`"));
        assert!(refused("0,0,1,0,0,,x,,1").contains("column state: `x`"));
        for tick in ["1.5", "-1", "1e10", ""] {
            assert!(refused(&format!("0,0,1,0,0,,0,,{tick}")).contains("column tick"));
        }
        let one = "0,0,1,0,0,,0,,7";
        assert!(refused(&format!("{one}\n{one}")).contains("sample time"));
        assert!(refused("0,0,1,0,0,,0,,1").contains("fewer than two"));
        assert!(
            parse("a,b\n")
                .unwrap_err()
                .contains("line 1: `a,b` is not the header")
        );
    }
}
