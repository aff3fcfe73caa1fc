//! Bad input ends with exit code 2, nothing on standard output and one sentence
//! that names the place.

use crate::common::{Scratch, trendid};

/// The sentence of a refusal, after its exit code and its shape were checked.
pub(crate) fn sentence(args: &[&str]) -> String {
    let out = trendid(args);
    let text = String::from_utf8(out.stderr).unwrap();
    assert_eq!(out.status.code(), Some(2), "{args:?}: {text}");
    assert!(out.stdout.is_empty(), "{args:?} printed to stdout");
    let line = text
        .strip_prefix("error: ")
        .unwrap_or_else(|| panic!("{args:?}: {text}"));
    assert_eq!(line.lines().count(), 1, "one sentence: {text}");
    line.trim_end().to_owned()
}

/// `identify` over a table with a first-order structure.
pub(crate) fn identified(name: &str, table: &str, more: &[&str]) -> String {
    let dir = Scratch::new(name);
    let file = dir.file("r.csv", table);
    let mut args = vec!["identify", file.as_str(), "--order", "1"];
    args.extend(more);
    sentence(&args).replace(&file, "r.csv")
}

pub(crate) fn table(rows: usize, row: impl Fn(usize) -> String) -> String {
    let lines: Vec<String> = (0..rows).map(row).collect();
    format!("# [V] and [mm]\nt,u,y\n{}\n", lines.join("\n"))
}

#[test]
fn a_missing_file() {
    assert_eq!(
        sentence(&["identify", "no/such.csv", "--order", "2"]),
        "cannot read `no/such.csv`: no such file"
    );
    assert_eq!(
        sentence(&["select", "no/such.csv", "--json"]),
        "cannot read `no/such.csv`: no such file"
    );
}

#[test]
fn a_missing_column() {
    let text = table(50, |k| format!("{k},{},{k}", k % 2));
    assert_eq!(
        identified("column", &text, &["--input", "w"]),
        "`r.csv` has no column `w`; it has `t`, `u`, `y`"
    );
    assert_eq!(
        identified("velocity", &text, &["--coulomb", "v"]),
        "`r.csv` has no column `v`; it has `t`, `u`, `y`"
    );
    assert_eq!(
        identified("time", &text, &["--time", "s"]),
        "`r.csv` has no column `s`; it has `t`, `u`, `y`"
    );
}

#[test]
fn a_cell_that_is_no_number() {
    let text = table(50, |k| {
        if k == 7 {
            "7,1,1.2.3".into()
        } else {
            format!("{k},{},{k}", k % 2)
        }
    });
    assert_eq!(
        identified("cell", &text, &[]),
        "line 10, column `y`: `1.2.3` is not a number (expected one like -1.5e-3)"
    );
    let text = table(50, |k| {
        if k == 7 {
            "7,inf,1".into()
        } else {
            format!("{k},{},{k}", k % 2)
        }
    });
    assert_eq!(
        identified("infinite", &text, &[]),
        "line 10, column `u`: `inf` is not finite (expected a finite number)"
    );
}

#[test]
fn irregular_time_stamps() {
    let text = table(50, |k| {
        format!(
            "{},{},{k}",
            if k < 30 { k as f64 } else { k as f64 + 0.5 },
            k % 2
        )
    });
    assert_eq!(
        identified("time-stamps", &text, &[]),
        "line 33: irregular time stamps, a step of 1.500 s where 1.000 s was expected (column `t`); --dt S takes the rows as equally spaced"
    );
}

#[test]
fn too_few_samples() {
    let text = table(19, |k| format!("{k},{},{k}", k % 2));
    assert_eq!(
        identified("few", &text, &[]),
        "too few samples: 19 for 2 parameters, at least 20 are needed"
    );
    let text = table(50, |k| format!("{k},{},{k}", k % 2));
    assert_eq!(
        identified("span", &text, &["--from", "10", "--to", "10"]),
        "only 1 sample between 10 s and 10 s, but at least 2 are needed"
    );
}

#[test]
fn signals_that_do_not_move() {
    let text = table(50, |k| format!("{k},0.5,{k}"));
    assert_eq!(
        identified("still", &text, &[]),
        "the input `u` never changes over the 50 samples: nothing excites the plant"
    );
    let text = table(50, |k| format!("{k},{},3", k % 2));
    assert_eq!(
        identified("dead", &text, &[]),
        "the output never changes over the 50 samples: there is nothing to identify"
    );
}

#[test]
fn an_order_that_the_data_cannot_carry() {
    // One sine excites two parameters, not eight.
    let wave = |k: usize, phase: f64| (k as f64 * 0.0126 - phase).sin();
    let text = table(3000, |k| {
        format!(
            "{:.3},{:.6},{:.6}",
            k as f64 * 1e-3,
            wave(k, 0.0),
            wave(k, 0.4)
        )
    });
    let dir = Scratch::new("order");
    let file = dir.file("r.csv", &text);
    for (order, zeros, parameters) in [("3", "2", 6), ("4", "3", 8)] {
        let args = ["identify", &file, "--order", order, "--zeros", zeros];
        let said = sentence(&args);
        let expected = format!(
            "the data cannot carry a model of order {order} with {parameters} parameters: "
        );
        assert!(said.starts_with(&expected), "{said}");
    }
    // Two columns that are one signal.
    let twin = sentence(&[
        "identify", &file, "--order", "1", "--input", "u", "--input", "u",
    ]);
    assert!(
        twin.ends_with("b0[u], b0[u] cannot be told apart"),
        "{twin}"
    );
}

#[test]
fn structures_that_are_none() {
    let text = table(500, |k| format!("{k},{},{}", (k / 7) % 2, k % 5));
    let dir = Scratch::new("structure");
    let file = dir.file("r.csv", &text);
    let refused = |more: &[&str]| {
        let mut args = vec!["identify", file.as_str()];
        args.extend(more);
        sentence(&args)
    };
    assert_eq!(
        refused(&["--order", "5"]),
        "the order 5 is not one of 1, 2, 3, 4"
    );
    assert_eq!(
        refused(&["--order", "0"]),
        "the order 0 is not one of 1, 2, 3, 4"
    );
    assert_eq!(
        refused(&["--order", "2", "--zeros", "2"]),
        "2 zeros need an order of at least 3, not 2"
    );
    assert_eq!(
        refused(&["--order", "2", "--memory", "0.5"]),
        "a memory of 0.5 s is not longer than two samples (2 s)"
    );
    let many = [
        "--input", "u", "--input", "u^2", "--input", "u^3", "--input", "u^4",
    ];
    assert_eq!(
        refused(&[&["--order", "1", "--coulomb"], &many[..]].concat()),
        "5 inputs were asked for, at most 4 are possible"
    );
    assert_eq!(
        refused(&[&["--order", "3", "--zeros", "2"], &many[..]].concat()),
        "the structure has 15 parameters, at most 10 are possible"
    );
    assert_eq!(
        refused(&["--order", "2", "--input", "u^x"]),
        "the power in `u^x` is not a digit from 1 to 9"
    );
}

#[test]
fn options_that_make_no_sense() {
    assert_eq!(
        sentence(&["demo", "--linear", "--eta=-1"]),
        "--eta -1.00 is not a width from 0 to 1000000 um"
    );
    assert_eq!(
        sentence(&["simulate", "--out", "x.csv", "--eta", "1e300"]),
        "--eta 1.00e300 is not a width from 0 to 1000000 um"
    );
    assert_eq!(
        sentence(&["demo", "--linear", "--filter", "3142"]),
        "filter poles at 3142 rad/s were asked for; below 3141.5927 rad/s, half of the sampling frequency, are possible"
    );
    assert_eq!(
        sentence(&["demo", "--linear", "--seconds", "0"]),
        "--seconds 0 is not between 0.1 and 600 s"
    );
    let said = sentence(&["simulate", "--out", "no/such/dir/s.csv"]);
    assert!(
        said.starts_with("cannot write `no/such/dir/s.csv`: "),
        "{said}"
    );
    // clap's own refusals have the same exit code.
    for args in [
        &["identify", "x.csv"][..],
        &["identify", "x.csv", "--order", "2", "--filter", "fast"],
        &["identify", "x.csv", "--order", "2", "--delay=-1"],
        &["unknown"],
    ] {
        let out = trendid(args);
        assert_eq!(out.status.code(), Some(2), "{args:?}");
        assert!(
            String::from_utf8_lossy(&out.stderr).starts_with("error: "),
            "{args:?}"
        );
    }
}

#[test]
fn a_picture_that_cannot_be_written() {
    let dir = Scratch::new("blocked");
    let file = dir.file("plain", "");
    let said = sentence(&["demo", "--linear", "--json", "--out", &file]);
    assert!(said.starts_with("cannot make the directory"), "{said}");
}

#[test]
fn an_image_that_is_not_there() {
    let said = sentence(&["pil", "--image", "no/image", "--samples", "5"]);
    assert!(
        said.starts_with("there is no image no/image; `cargo xtask pil` builds it"),
        "{said}"
    );
}

#[test]
fn options_of_the_processor_in_the_loop_that_make_no_sense() {
    for bad in [
        ["--samples", "0"],
        ["--faults", "0"],
        ["--failures", "1"],
        ["--scenario", "storm"],
    ] {
        let out = trendid(&["pil", bad[0], bad[1]]);
        let said = String::from_utf8(out.stderr).unwrap();
        assert_eq!(out.status.code(), Some(2), "{bad:?}");
        assert!(said.contains(bad[0]) && said.contains(bad[1]), "{said}");
    }
}

#[test]
fn no_users_and_seeds_beyond_all() {
    assert_eq!(
        sentence(&["users", "--population", "0"]),
        "--population 0 is not between 1 and 1000000"
    );
    let last = u64::MAX.to_string();
    let refusal = sentence(&["users", "--first-seed", &last]);
    assert!(
        refusal.starts_with(&format!("--first-seed {last} is too large")),
        "{refusal}"
    );
}
