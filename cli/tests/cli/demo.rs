//! The demonstration of the adaptive loop: keys of JSON, pictures, exit codes.

use crate::common::{Scratch, stdout, trendid};

const KEYS: [&str; 12] = [
    "scenario",
    "seed",
    "fixed",
    "verified_at_s",
    "steady_state_mm",
    "rise_ms",
    "overshoot_pct",
    "tracking_0p5hz_mm",
    "tracking_1hz_mm",
    "recovered_s",
    "state",
    "gains_kept",
];

#[test]
fn one_object_per_seed_with_every_key() {
    let dir = Scratch::new("demo-json");
    let out = dir.path("o");
    let text = stdout(&[
        "demo",
        "--scenario",
        "stuck-sensor",
        "--seed",
        "700",
        "--seeds",
        "2",
        "--json",
        "--out",
        &out,
    ]);
    let values: Vec<serde_json::Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON"))
        .collect();
    assert_eq!(values.len(), 2);
    for (value, seed) in values.iter().zip(700..) {
        for key in KEYS {
            assert!(value.get(key).is_some(), "{key} is missing in {value}");
        }
        assert_eq!(value["seed"], seed);
        assert_eq!(value["scenario"], "stuck-sensor");
        assert!(value["verified_at_s"].as_f64().unwrap() < 0.5, "{value}");
        assert_eq!(value["refused_rightly"], true, "{value}");
        assert_eq!(value["gains_kept"], true, "{value}");
    }
    let svg = std::fs::read_to_string(format!("{out}/loop-stuck-sensor.svg")).unwrap();
    assert!(svg.contains("state of the supervisor"));
}

#[test]
fn a_table_for_people() {
    let dir = Scratch::new("demo-table");
    let out = dir.path("o");
    let text = stdout(&[
        "demo",
        "--scenario",
        "blocked-axis",
        "--fixed",
        "--seed",
        "701",
        "--out",
        &out,
    ]);
    for words in ["model verified after [s]", "exciting", "fixed after"] {
        assert!(text.contains(words), "{words} is missing in {text}");
    }
}

#[test]
fn options_that_do_not_fit_are_refused() {
    for args in [
        &["demo", "--scenario", "earthquake"][..],
        &["demo", "--seeds", "0"],
        &["demo", "--seeds", "1001"],
        &["demo", "--seed", "18446744073709551615", "--seeds", "2"],
        &["demo", "--eta", "100"],
        &["demo", "--linear", "--fixed"],
    ] {
        let out = trendid(args);
        assert_eq!(out.status.code(), Some(2), "{args:?}");
        let said = String::from_utf8_lossy(&out.stderr).into_owned();
        assert!(said.starts_with("error: "), "{args:?}: {said}");
        assert!(out.stdout.is_empty(), "{args:?}");
    }
}
