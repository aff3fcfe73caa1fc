//! Rows without numbers, and spans beyond the record.

use crate::common::{Scratch, json};
use crate::refusals::{identified, sentence};

/// `y' = -2 y + 6 u` every 10 ms, with other lines in the place of some rows.
fn record(other: impl Fn(usize) -> Option<&'static str>) -> String {
    let (decay, mut y) = ((-0.02_f64).exp(), 0.0);
    let mut text = "t,u,y\n".to_owned();
    for k in 0..1500 {
        let u = f64::from(k as u32 / 70 % 2);
        let row = || format!("{},{u},{y}", 0.01 * k as f64);
        text += &(other(k).map_or_else(row, str::to_owned) + "\n");
        y = decay * y + 3.0 * (1.0 - decay) * u;
    }
    text
}

const EVERY: [&str; 2] = ["--dt", "0.01"];

#[test]
fn a_row_without_numbers_is_a_sample_that_is_missing() {
    for empty in [",,", " , , "] {
        let few = record(|k| (k % 200 == 30).then_some(empty));
        let dir = Scratch::new("few-empty");
        let file = dir.file("r.csv", &few);
        let found = json(&[&["identify", &file, "--order", "1", "--json"], &EVERY[..]].concat());
        assert_eq!(
            (&found["samples"], &found["filled"]),
            (&1500.into(), &8.into())
        );
        let rate = found["a"][0].as_f64().unwrap();
        assert!((rate - 2.0).abs() < 0.02, "{empty:?}: {rate}");
        // More than a few, or too many in a row.
        let many = record(|k| (k % 50 == 30).then_some(empty));
        let said = identified("many-empty", &many, &EVERY);
        let expected = "line 33: 1 row without a number before it, 30 of 1500 in all; ";
        assert!(said.starts_with(expected), "{said}");
        let long = record(|k| (300..304).contains(&k).then_some(empty));
        let said = identified("long-empty", &long, &EVERY);
        assert!(
            said.starts_with("line 306: 4 rows without a number"),
            "{said}"
        );
    }
}

#[test]
fn blank_lines_and_rows_at_the_end_are_no_samples() {
    let dir = Scratch::new("no-empty");
    let plain = record(|_| None);
    let ends = dir.file("ends.csv", &(plain.clone() + "\n,,\n\n\n"));
    let some = record(|k| (k % 50 == 30).then_some("")).replace("\n\n", "\n0,0,0\n\n");
    let some = dir.file("some.csv", &some);
    let spaced = dir.file("spaced.csv", &plain.replace('\n', "\n\n"));
    for file in [ends, some, spaced] {
        let found = json(&[&["identify", &file, "--order", "1", "--json"], &EVERY[..]].concat());
        assert_eq!(
            (&found["samples"], &found["filled"]),
            (&1500.into(), &0.into())
        );
    }
}

#[test]
fn a_span_that_ends_far_behind_the_record_is_the_rest_of_it() {
    let dir = Scratch::new("far-span");
    let file = dir.file("r.csv", &record(|_| None));
    let args = ["identify", &file, "--order", "1", "--json", "--to", "1e30"];
    assert_eq!(json(&args)["samples"], 1500);
    let beyond = ["identify", &file, "--order", "1", "--from", "1e30"];
    assert!(sentence(&beyond).starts_with("only 0 samples between"));
}
