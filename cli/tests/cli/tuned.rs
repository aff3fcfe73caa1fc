//! What `tune record` says beside the gains.

use crate::common::{Scratch, stdout};

#[test]
fn gains_come_with_what_speaks_against_their_model() {
    let dir = Scratch::new("tune-doubts");
    let record = dir.path("servo.csv");
    stdout(&["simulate", "--out", &record, "--seconds", "4"]);
    let text = std::fs::read_to_string(&record).unwrap();
    // The directions in columns of their own, and noise in the place of the position.
    let mut split = String::from("t,up,down,noise,y\n");
    for (k, line) in text
        .lines()
        .filter(|l| !l.starts_with(['#', 't']))
        .enumerate()
    {
        let cells: Vec<&str> = line.split(',').collect();
        let u: f64 = cells[1].parse().unwrap();
        let noise = (k * k * 7919 + 3 * k) % 1009;
        let (up, down) = (u.max(0.0), 0.5 * u.min(0.0));
        split += &format!("{},{up},{down},{noise},{}\n", cells[0], cells[2]);
    }
    let file = dir.file("split.csv", &split);
    let tune = |more: &[&str]| {
        let args = ["tune", "record", &file, "--order", "3", "--integrator"];
        [&args[..], more]
            .concat()
            .into_iter()
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let run = |more: &[&str]| {
        let args = tune(more);
        stdout(&args.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let both = run(&["--input", "up", "--input", "down"]);
    assert!(both.contains("verdict: good"), "{both}");
    assert!(both.contains("\ny / up = "), "{both}");
    assert!(both.contains("gains are for up; down, 2.0"), "{both}");
    assert!(
        both.contains(" is among the models within 2 sigma"),
        "{both}"
    );
    let other = run(&["--input", "up", "--input", "noise"]);
    assert!(other.contains("times its gain, is not used"), "{other}");
    let far = run(&[
        "--input",
        "up",
        "--input",
        "down",
        "--filter",
        "12",
        "--bandwidth",
        "400",
        "--json",
    ]);
    let far: serde_json::Value = serde_json::from_str(&far).unwrap();
    let warning = far["loops"][0]["warning"].as_str().unwrap();
    assert!(
        warning.contains("times the rate of the filter"),
        "{warning}"
    );
    assert_eq!(far["record"]["input"], "up");
    let poor = run(&["--input", "noise", "--delay", "0", "--filter", "12"]);
    assert!(poor.contains("\nWARNING: the model is "), "{poor}");
}
