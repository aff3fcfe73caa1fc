//! Options whose value is none, or that would do nothing.

use crate::common::{Scratch, stdout, trendid};
use crate::refusals::{identified, sentence, table};

/// A lag behind steps of one.
fn lag() -> String {
    let mut y = 0.0;
    let rows: Vec<String> = (0..600)
        .map(|k| {
            let u = k / 40 % 2;
            let row = format!("{},{u},{y}", 0.01 * f64::from(k));
            y += 0.1 * (f64::from(u) - y);
            row
        })
        .collect();
    table(600, |k| rows[k].clone())
}

#[test]
fn negative_numbers_have_their_own_sentence() {
    let memory = identified("negative-memory", &lag(), &["--memory", "-1"]);
    assert_eq!(
        memory,
        "a memory of -1 s is not longer than two samples (0.02 s)"
    );
    for command in [
        &["identify", "x.csv", "--order", "1"][..],
        &["select", "x.csv"],
    ] {
        for (option, value, said) in [
            (
                "--delay",
                "-1",
                "expected a number of samples from 0 to 512, or `auto`",
            ),
            ("--dt", "-0.001", "expected a number of seconds above 0"),
        ] {
            let out = trendid(&[command, &[option, value]].concat());
            let text = String::from_utf8(out.stderr).unwrap();
            assert_eq!(out.status.code(), Some(2));
            assert!(text.contains(said), "{command:?} {option}: {text}");
        }
    }
}

#[test]
fn a_scheme_that_would_do_nothing() {
    let dir = Scratch::new("select-goodwin");
    let file = dir.file("r.csv", &lag());
    let said = sentence(&["select", &file, "--scheme", "goodwin"]);
    assert!(
        said.contains("`--scheme goodwin` is possible in `identify` only"),
        "{said}"
    );
}

#[test]
fn a_dead_zone_that_swallows_the_input() {
    let said = identified("swallowed", &lag(), &["--dead-zone", "1"]);
    assert_eq!(
        said,
        "the dead zone of 1 swallows the whole input `u`, which goes up to 1.000 at most: give a narrower one"
    );
}

#[test]
fn pictures_that_cannot_be_written_leave_the_output_empty() {
    let dir = Scratch::new("no-pictures");
    let (file, taken) = (dir.file("r.csv", &lag()), dir.file("taken", ""));
    for more in [&[][..], &["--json"]] {
        let args = ["identify", &file, "--order", "1", "--plot", &taken];
        let said = sentence(&[&args, more].concat());
        assert!(said.contains("taken"), "{said}");
    }
}

#[test]
fn a_simulated_record_goes_to_the_standard_output() {
    let args = ["simulate", "--out", "-", "--seconds", "2", "--seed", "3"];
    let dir = Scratch::new("to-stdout");
    let file = dir.path("r.csv");
    let _said = stdout(&[&["simulate", "--out", &file], &args[3..]].concat());
    assert_eq!(stdout(&args), std::fs::read_to_string(file).unwrap());
    let said = sentence(&[&args[..], &["--json"]].concat());
    assert!(said.contains("where --json has no place"), "{said}");
}
