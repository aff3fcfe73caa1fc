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
        assert!(value["verified_at_s"].as_f64().unwrap() < 3.0, "{value}");
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

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn a_population_has_exactly_its_keys() {
    let text = stdout(&[
        "loop",
        "--population",
        "2",
        "--first-seed",
        "5",
        "--usual",
        "--json",
        "--worst",
    ]);
    let value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let motion = [
        "controlled",
        "end_stop_pct",
        "end_stop_max_mm_s",
        "given_up_pct",
        "limit_cycle_pct",
        "undetected_cycle_pct",
        "steady_state_median_mm",
        "steady_state_p90_mm",
        "small_step_median_mm",
        "wear_median",
        "sine_no_worse_pct",
        "small_sine_no_worse_pct",
    ];
    let others = [
        "axes",
        "accepted_pct",
        "accepted_6s_pct",
        "verified_median_s",
        "verified_p95_s",
        "refused",
        "wrong_reason_pct",
        "wrong_sign_pct",
        "w0_within_10pct",
        "c_within_20pct",
        "grossly_wrong_pct",
        "dead_zone_p90",
        "offset_p90",
        "delay_p90_ms",
        "commissioning_struck_pct",
        "fixed_gains",
        "baseline",
        "baseline_same_axes",
        "worst",
    ];
    assert_keys(&value, &[&motion[..], &others[..]].concat());
    for name in ["fixed_gains", "baseline", "baseline_same_axes"] {
        assert_keys(&value[name], &motion);
    }
    assert_eq!(value["axes"], 2);
    assert_eq!(value["baseline"]["controlled"], 2);
}

fn assert_keys(value: &serde_json::Value, keys: &[&str]) {
    let mut found: Vec<&str> = value
        .as_object()
        .expect("an object")
        .keys()
        .map(String::as_str)
        .collect();
    let mut wanted = keys.to_vec();
    found.sort_unstable();
    wanted.sort_unstable();
    assert_eq!(found, wanted);
}
