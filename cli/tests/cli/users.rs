//! `trendid users`.

use crate::common::{json, stdout, trendid};

#[test]
fn users_are_those_of_their_seeds_and_the_worst_of_them_are_named() {
    let args = [
        "users",
        "--population",
        "6",
        "--first-seed",
        "200001",
        "--worst",
        "--json",
    ];
    let found = json(&args);
    assert_eq!(found, json(&args));
    assert_eq!(found["users"], 6);
    let parts = found["parts"].as_array().unwrap();
    assert_eq!(parts[0]["part"], "all");
    assert_eq!(parts[0]["unsound"], 0);
    let times = parts.iter().filter(|part| part["by"] == "time");
    let readings: u64 = times.filter_map(|part| part["readings"].as_u64()).sum();
    assert_eq!(Some(readings), parts[0]["readings"].as_u64());
    let worst = found["worst"].as_array().unwrap();
    assert_eq!(worst.len(), 6);
    let deviations = |i: usize| worst[i]["deviations"].as_f64().unwrap();
    assert!((1..6).all(|i| deviations(i - 1) >= deviations(i)));
}

#[test]
fn one_structure_alone_prints_its_rows_and_the_filter_beside_it() {
    let text = stdout(&["users", "--population", "3", "--kind", "servo"]);
    assert!(
        text.contains("| structure: servo |") && !text.contains("lag"),
        "{text}"
    );
    assert!(text.contains("| extended Kalman filter |"), "{text}");
    let text = stdout(&["users", "--population", "3", "--kind", "lag"]);
    assert!(
        text.contains("| structure: lag |") && !text.contains("Kalman"),
        "{text}"
    );
}

#[test]
fn a_structure_that_does_not_exist_is_refused() {
    let out = trendid(&["users", "--kind", "pendulum"]);
    assert_eq!(out.status.code(), Some(2));
    assert!(out.stdout.is_empty());
}
