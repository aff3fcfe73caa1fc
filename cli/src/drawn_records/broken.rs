//! One cell or line broken: refused with its line, or no other number is touched and what was done
//! is said.

use super::{Drive, read};
use crate::draws::Uniform;
use crate::record::{Clock, Record, Resampling};

/// What a slip of an editor or a lost byte puts in.
const BYTES: &[u8] = b"0123456789.,;-+eE \"\t#xn";

/// Words of loggers that have no number, and numbers that are none of this record.
const WORDS: &[&str] = &[
    "", "-", "nan", "inf", "1e999", "NA", "0x10", "1,5", "1.5.2", "1_000", "\"", "\"1", "1e300",
];

/// A table with a line that was broken.
struct Broken {
    text: String,
    /// The line, from 1.
    line: usize,
    what: &'static str,
}

impl Broken {
    /// The columns t, u, w, y, another number and a note.
    fn of(drive: &Drive, draw: &mut Uniform) -> Self {
        let mut lines = vec!["t,u,w,y,v,note".to_owned()];
        for [t, u, w, y] in &drive.rows {
            let note = draw.one(&["", "start"]);
            lines.push(format!("{t:.3},{u},{w},{y:.6},{:.3},{note}", 0.1 * y));
        }
        let row = 1 + draw.below(lines.len() - 2);
        let old = lines[row].clone();
        let place = draw.below(old.len());
        let [head, tail] = [&old[..place], &old[place..]];
        let byte = char::from(draw.one(BYTES));
        let kinds = [
            "drop", "insert", "replace", "swap", "cut", "twice", "lost", "joined", "cell",
        ];
        let what = draw.one(&kinds);
        match what {
            "drop" => lines[row] = format!("{head}{}", &tail[1..]),
            "insert" => lines[row] = format!("{head}{byte}{tail}"),
            "replace" => lines[row] = format!("{head}{byte}{}", &tail[1..]),
            "swap" => lines.swap(row, row + 1),
            "cut" => lines[row] = head.to_owned(),
            "twice" => lines.insert(row, old),
            "lost" => drop(lines.remove(row)),
            "joined" => lines[row] = old + &lines.remove(row + 1),
            _ => {
                let mut cells: Vec<&str> = old.split(',').collect();
                let cell = draw.below(4);
                cells[cell] = draw.one(WORDS);
                lines[row] = cells.join(",");
            }
        }
        Self {
            text: lines.join("\n") + "\n",
            line: row + 1,
            what,
        }
    }
}

/// How many numbers differ, in the broken row and in all others.
fn differences(found: &Record, plain: &Record, row: usize) -> [usize; 2] {
    let mut count = [0, 0];
    for (found, plain) in found.signals.iter().zip(&plain.signals) {
        for (k, (found, plain)) in found.iter().zip(plain).enumerate() {
            count[usize::from(k != row)] += usize::from(found != plain);
        }
    }
    count
}

#[test]
fn a_broken_line_is_refused_or_touches_no_other_number() {
    let (mut refused, mut said, mut alone) = (0, 0, 0);
    for seed in 1..=1500 {
        let mut draw = Uniform::of(seed);
        let drive = Drive::of(&mut draw, 400, 0.0, 0.01);
        let plain = read(drive.table(3).as_bytes(), Clock::SECONDS).expect("the plain record");
        let broken = Broken::of(&drive, &mut draw);
        let (line, what) = (broken.line, broken.what);
        let at = broken.text.lines().nth(line - 1).unwrap_or_default();
        match read(broken.text.as_bytes(), Clock::SECONDS) {
            Err(error) => {
                refused += 1;
                let error = error.to_string();
                let near = (line - 1..=line + 1).any(|l| error.starts_with(&format!("line {l}")));
                assert!(near, "{seed}, {what} in line {line}, {at}: {error}");
            }
            // Stamps that are moved or filled move what is around them, and it is said.
            Ok(found) if found.notes.resampling != Resampling::default() => said += 1,
            // The record begins with its second row, as its first stamp says.
            Ok(found) if line == 2 && found.start == drive.dt => {
                let rest: Vec<_> = plain.signals.iter().map(|s| s[1..].to_vec()).collect();
                assert_eq!(found.signals, rest, "{seed}, {what}");
            }
            Ok(found) => {
                assert_eq!(
                    found.len(),
                    plain.len(),
                    "{seed}, {what} in line {line}, {at}"
                );
                let [here, elsewhere] = differences(&found, &plain, line - 2);
                assert!(
                    here <= 1 && elsewhere == 0,
                    "{seed}, {what} in line {line}, {at}: {here} and {elsewhere} numbers differ"
                );
                alone += found.notes.alone.len();
            }
        }
    }
    println!("refused {refused}, moved or filled and said {said}, standing alone {alone}");
    assert!(refused > 500 && said > 50 && alone > 20);
}

/// A number of which a digit or the point is wrong so that nothing else of the record is as far
/// from its neighbours.
#[test]
fn a_number_that_stands_alone_is_named() {
    for seed in 1..=200 {
        let mut draw = Uniform::of(seed);
        let mut drive = Drive::of(&mut draw, 400, 0.0, 0.01);
        let clean = read(drive.table(3).as_bytes(), Clock::SECONDS).expect("a record");
        assert!(
            clean.notes.alone.is_empty(),
            "{seed}: {:?}",
            clean.notes.alone
        );
        let row = draw.one(&[0, 1, 2, 57, 398, 399]);
        let column = 1 + draw.below(3);
        let right = drive.rows[row][column];
        let wrong = right + draw.one(&[-999.0, 50.0, 1e6]);
        drive.rows[row][column] = wrong;
        let found = read(drive.table(3).as_bytes(), Clock::SECONDS).expect("a record");
        let [alone] = found.notes.alone.as_slice() else {
            panic!("{seed}: {:?}", found.notes.alone);
        };
        let name = ["u", "w", "y"][column - 1];
        assert_eq!(
            (alone.line, alone.column.as_str()),
            (row as u64 + 2, name),
            "{seed}"
        );
        assert!((alone.value - wrong).abs() < 1e-5, "{seed}: {alone:?}");
        assert!(
            (alone.expected - right).abs() <= 6.0,
            "{seed}: {alone:?} {right}"
        );
    }
}
