//! Seeds, time stamps and cells that are none, and records that no structure holds.

use crate::common::{Scratch, trendid};
use crate::refusals::{identified, sentence, table};

#[test]
fn seeds_that_are_too_large_and_runs_that_are_too_many() {
    let last = "18446744073709551615";
    for (command, count) in [
        (&["loop"][..], "--seeds"),
        (&["loop", "--json"], "--seeds"),
        (&["loop"], "--population"),
        (&["drives"], "--drives"),
        (&["sigma"], "--seeds"),
        (&["options"], "--seeds"),
        (&["select"], "--simulated"),
        (&["paper", "table1"], "--seeds"),
        (&["paper", "table2"], "--seeds"),
    ] {
        let said = |first: &str, n: &str| {
            let more = [count, n, "--first-seed", first];
            sentence(&[command, &more].concat())
        };
        assert_eq!(
            said(last, "1"),
            format!("--first-seed {last} is too large: at most 9223372036854775807 for 1 seed"),
            "{command:?}"
        );
        let many = said("1", last);
        let expected = format!("{count} {last} is not between 1 and 1000");
        assert!(many.starts_with(&expected), "{command:?}: {many}");
    }
}

#[test]
fn time_stamps_that_do_not_advance() {
    let text = table(50, |k| format!("{},{},{k}", 50 - k, k % 2));
    assert_eq!(
        identified("falling", &text, &[]),
        "line 4: time does not advance, from 50 to 49 s (column `t`)"
    );
    let text = table(50, |k| format!("{},{},{k}", k - k / 30, k % 2));
    assert_eq!(
        identified("twice", &text, &[]),
        "line 33: time does not advance, from 29 to 29 s (column `t`); where its clock is coarser than the rows, --dt S takes them as equally spaced"
    );
}

#[test]
fn a_cell_that_is_too_large() {
    let text = table(50, |k| match k {
        7 => "7,1,-1e300".into(),
        _ => format!("{k},{},{k}", k % 2),
    });
    assert_eq!(
        identified("large", &text, &[]),
        "line 10, column `y`: `-1e300` is too large (expected less than 3.4e38)"
    );
}

#[test]
fn orders_and_zeros_that_are_no_whole_numbers() {
    for (values, expected) in [
        (
            ["--order", "two", "--zeros", "0"],
            "'--order <M>': expected a whole number from 1 to 4",
        ),
        (
            ["--order", "2", "--zeros", "0.5"],
            "'--zeros <K>': expected a whole number from 0 to 3",
        ),
    ] {
        let out = trendid(&[&["identify", "x.csv"], &values[..]].concat());
        let said = String::from_utf8(out.stderr).unwrap();
        assert_eq!(out.status.code(), Some(2), "{said}");
        assert!(said.contains(expected), "{said}");
    }
}

#[test]
fn structures_of_which_none_holds() {
    // Two noises that have nothing to do with each other.
    let mut state = 1_u32;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state >> 20
    };
    let rows: Vec<String> = (0..400)
        .map(|k| format!("{k},{},{}", noise(), noise()))
        .collect();
    let text = table(400, |k| rows[k].clone());
    let dir = Scratch::new("none-holds");
    let file = dir.file("r.csv", &text);
    let said = sentence(&["identify", &file, "--order", "3", "--zeros", "1"]);
    assert!(
        said.ends_with("try --integrator, or `trendid select`"),
        "{said}"
    );
    let said = sentence(&["select", &file, "--max-order", "1"]);
    assert!(
        said.starts_with("no structure of order 1 to 1 holds; 2 of 2: "),
        "{said}"
    );
    assert!(said.ends_with("standard deviations)"), "{said}");
}

#[test]
fn a_record_without_the_usual_time_stamps() {
    let text = "time,u,y\n0,1,2\n1,0,3\n";
    assert_eq!(
        identified("no-t", text, &[]),
        "`r.csv` has no column `t`; it has `time`, `u`, `y` (--time COL names the time stamps, --dt S does without)"
    );
    let dir = Scratch::new("wide");
    let wide = dir.path("r.csv");
    std::fs::write(&wide, b"\xff\xfet\0,\0u\0").unwrap();
    let said = sentence(&["identify", &wide, "--order", "1"]);
    assert!(said.ends_with("it is UTF-16 (expected UTF-8)"), "{said}");
}

#[test]
fn options_that_would_do_nothing() {
    for more in [
        &["--linear", "--family", "hydraulic"][..],
        &["--linear", "--usual"],
    ] {
        let said = sentence(&[&["loop"], more].concat());
        assert_eq!(said, format!("{} needs --population N", more[1]));
    }
    for args in [
        &["loop", "--family", "hydraulic"][..],
        &["loop", "--population", "1", "--faults", "1", "--commission"],
        &[
            "identify", "x.csv", "--order", "1", "--dt", "1", "--time", "s",
        ],
    ] {
        let out = trendid(args);
        assert_eq!(out.status.code(), Some(2), "{args:?}");
        assert!(out.stdout.is_empty(), "{args:?}");
    }
}

#[test]
fn one_sine_with_a_delay_that_is_searched() {
    let sine = table(2000, |k| {
        let at = |k: usize| (0.02 * k as f64).sin();
        format!(
            "{},{},{}",
            0.01 * k as f64,
            at(k),
            3.0 * at(k.saturating_sub(9))
        )
    });
    assert_eq!(
        identified("sine", &sine, &["--delay", "auto"]),
        "not identifiable, because one sine as the input fixes two numbers, its gain and its phase, and 3 are unknown with the delay: give the delay, or excite with more than one frequency"
    );
    let dir = Scratch::new("sine-select");
    let file = dir.file("r.csv", &sine);
    assert_eq!(
        sentence(&["select", &file, "--constant"]),
        "no structure is identifiable, because one sine as the input fixes two numbers, its gain and its phase: excite with more than one frequency, or give the delay"
    );
}
