//! Records of real drives against their published parameters.
//!
//! The records are not part of the project (docs/results.md says where they are from), so these
//! tests are left out of a plain run, which lists them as ignored. With the records as CSV files in
//! one directory:
//!
//! ```text
//! TRENDID_RECORDS=DIRECTORY cargo test --release -p trendid-cli records -- --ignored --nocapture
//! ```

use std::path::Path;

use crate::common::{json, stdout};
use serde_json::Value;

/// The path of a record.
///
/// # Panics
/// Without `TRENDID_RECORDS`, or where its directory has no such file.
pub(crate) fn record(name: &str) -> String {
    let dir = std::env::var_os("TRENDID_RECORDS")
        .expect("TRENDID_RECORDS does not name the directory of the records");
    let path = Path::new(&dir).join(name);
    assert!(path.is_file(), "no record {}", path.display());
    path.display().to_string()
}

fn off_percent(value: &Value, truth: f64) -> f64 {
    100.0 * (value.as_f64().expect("a number") / truth - 1.0)
}

/// Prints and checks one figure.
fn within(what: &str, value: &Value, truth: f64, band: f64) {
    let off = off_percent(value, truth);
    println!("{what}: {value}, {off:+.2} % off {truth} (band {band} %)");
    assert!(
        off.abs() <= band,
        "{what}: {value} is {off:+.2} % off {truth}"
    );
}

const DRIVE: [&str; 6] = [
    "--order",
    "2",
    "--integrator",
    "--coulomb",
    "--constant",
    "--json",
];

/// Reference: Janot, Gautier, Brunot, Data Set and Reference Models of EMPS, 2019.
#[test]
#[ignore = "needs the records: TRENDID_RECORDS=DIRECTORY"]
fn emps_is_as_published() {
    let file = record("emps.csv");
    let found = json(&[&["identify", &file], &DRIVE[..]].concat());
    within("emps b", &found["inputs"][0]["b"][0], 0.3696, 5.0);
    within("emps a", &found["a"][1], 2.140, 10.0);
    within("emps Coulomb", &found["inputs"][1]["b"][0], -0.2144, 8.0);
    println!(
        "emps fit: {} % x0, {} % x0+c",
        found["fit_pct"], found["fit_x0c_pct"]
    );
    assert!(found["fit_x0c_pct"].as_f64().unwrap() > 97.0);
    // The sentence of the introduction works as it stands.
    let text = stdout(&[
        "identify",
        &file,
        "--order",
        "2",
        "--integrator",
        "--coulomb",
        "--constant",
    ]);
    assert!(text.contains("(s^2 + "), "{text}");
}

/// Reference: means over ten repeats, with the offset as a separate term.
#[test]
#[ignore = "needs the records: TRENDID_RECORDS=DIRECTORY"]
fn servo_motor_is_as_its_repeats() {
    for name in ["lorenz_S1_1.csv", "lorenz_S1_2.csv"] {
        let file = record(name);
        // After 8 s the axis rests: the standstill is found and left out.
        for (span, coulomb) in [
            (&["--to", "8"][..], &[][..]),
            (&["--to", "8"], &["v"]),
            (&[], &[]),
        ] {
            let mut args = vec!["identify", &file, "--order", "2", "--integrator"];
            args.extend(span);
            args.extend(["--constant", "--json", "--coulomb"]);
            args.extend(coulomb);
            let found = json(&args);
            let still = found["standstill_s"].as_f64().expect("a time");
            assert!((still - if span.is_empty() { 2.0 } else { 0.0 }).abs() < 0.1);
            let physical = &found["physical"];
            within(
                &format!("{name} {coulomb:?} J"),
                &physical["inertia"],
                1.66e-4,
                7.0,
            );
            within(
                &format!("{name} {coulomb:?} B"),
                &physical["viscous"],
                8.57e-5,
                10.0,
            );
            within(
                &format!("{name} {coulomb:?} Fc"),
                &physical["coulomb"],
                0.01555,
                4.0,
            );
        }
    }
}

/// Reference: output-error model of second order.
#[test]
#[ignore = "needs the records: TRENDID_RECORDS=DIRECTORY"]
fn dryer_has_its_static_gain_and_delay() {
    let file = record("dryer.csv");
    let found = json(&[
        "identify",
        &file,
        "--order",
        "2",
        "--constant",
        "--delay",
        "auto",
        "--json",
    ]);
    within("dryer K", &found["physical"]["gain"], 0.935, 3.0);
    within("dryer a0", &found["a"][0], 28.9, 15.0);
    within("dryer a1", &found["a"][1], 11.28, 15.0);
    assert!((found["delay_s"].as_f64().unwrap() - 0.157).abs() < 0.02);
}

/// Of one record a delay of 0.1 s simulates as well as the lag, whose parameter then is not
/// significant.
#[test]
#[ignore = "needs the records: TRENDID_RECORDS=DIRECTORY"]
fn a_delay_in_the_place_of_a_lag_is_in_doubt() {
    for (name, doubted) in [("eha_2_1", true), ("eha_1_4", false)] {
        let file = record(&format!("{name}.csv"));
        let inputs = ["--input", "u1", "--input", "u2", "--hold", "foh", "--json"];
        let value = json(&[&["select", &file], &inputs[..]].concat());
        let doubts = value["doubts"].as_array().expect("a list");
        let says = |doubt: &serde_json::Value| {
            doubt
                .as_str()
                .is_some_and(|doubt| doubt.contains("may stand for a lag"))
        };
        println!("{name}: {doubts:?}");
        assert_eq!(doubts.iter().any(says), doubted, "{name}");
    }
}

/// Reference: output error, asymmetric gains of extending and retracting; seven records of one rig.
#[test]
#[ignore = "needs the records: TRENDID_RECORDS=DIRECTORY"]
fn cylinder_has_its_lag_and_its_two_gains() {
    let records = [
        ("1_1", 10.33, 10.46, 13.92),
        ("1_3", 9.95, 11.22, 15.94),
        ("1_4", 9.9, 11.31, 16.28),
        ("2_1", 10.39, 9.41, 13.93),
        ("2_4", 8.81, 10.92, 16.24),
        ("4_2", 8.77, 9.43, 15.96),
        ("4_4", 7.99, 10.45, 16.22),
    ];
    for (name, a, extending, retracting) in records {
        let file = record(&format!("eha_{name}.csv"));
        let mut args = vec!["identify", &file, "--order", "2", "--integrator"];
        args.extend(["--constant", "--input", "u1", "--input", "u2"]);
        args.extend(["--hold", "foh", "--json"]);
        let found = json(&args);
        assert_eq!(found["method"], "instruments");
        within(&format!("eha_{name} a"), &found["a"][1], a, 10.0);
        let z = (found["a"][1].as_f64().unwrap() - a) / found["sigma"][0].as_f64().unwrap();
        assert!(z.abs() < 2.0, "eha_{name}: {z}");
        let physical = &found["physical"];
        let gain = |value: &Value| Value::from(1e3 * value.as_f64().unwrap());
        let unit = "[1e-3 mm/s/rpm]";
        within(
            &format!("eha_{name} K1 {unit}"),
            &gain(&physical["gain"]),
            extending,
            6.0,
        );
        let second = gain(&physical["further_gains"]["u2"]);
        within(&format!("eha_{name} K2 {unit}"), &second, retracting, 6.0);
        // Least squares stands beside it, and is low.
        assert!(found["least_squares"]["theta"][0].as_f64().unwrap() < 0.98 * a);
    }
}

/// Reference: an offline model with a hardening spring that simulates 98.3 %; nine samples in a
/// period.
#[test]
#[ignore = "needs the records: TRENDID_RECORDS=DIRECTORY"]
fn oscillator_keeps_its_damping() {
    let file = record("silverbox_multisine.csv");
    let mut args = vec!["identify", &file, "--order", "2", "--constant"];
    args.extend(["--hold", "foh", "--input", "u", "--input", "y^3", "--json"]);
    let found = json(&args);
    within("silverbox a0", &found["a"][0], 184_277.0, 0.5);
    within("silverbox a1", &found["a"][1], 41.82, 3.0);
    within("silverbox b", &found["inputs"][0]["b"][0], 193_587.0, 0.5);
    within("silverbox c", &found["inputs"][1]["b"][0], -7.688e5, 3.0);
    println!("silverbox fit: {} % x0", found["fit_pct"]);
    assert!(found["fit_pct"].as_f64().unwrap() > 98.0);
    // The filter is that of the model.
    let off = found["filter"][0].as_f64().unwrap() / found["a"][0].as_f64().unwrap() - 1.0;
    assert!(off.abs() < 1e-3, "{off}");
}

/// Reference: an offline model of second order that simulates 96.6 %, though the drive is of third.
#[test]
#[ignore = "needs the records: TRENDID_RECORDS=DIRECTORY"]
fn linear_drive_is_of_second_order_at_first_sight() {
    let file = record("camber_LinD_1mm.csv");
    let found = json(&["identify", &file, "--order", "2", "--constant", "--json"]);
    within("camber a0", &found["a"][0], 7046.0, 10.0);
    within("camber a1", &found["a"][1], 83.6, 10.0);
    within("camber b", &found["inputs"][0]["b"][0], 7134.0, 10.0);
}
