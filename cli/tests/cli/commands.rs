//! The commands from end to end.

use crate::common::{Scratch, json, near, stdout};

#[test]
fn every_command_helps_with_an_example() {
    for command in ["demo", "simulate", "identify", "select", "users"] {
        let text = stdout(&[command, "--help"]);
        assert!(text.contains("Example"), "{command}");
        assert!(text.contains(&format!("trendid {command}")), "{command}");
        assert!(text.contains("--json"), "{command}");
    }
    let text = stdout(&["--help"]);
    assert!(text.contains("Example") && text.contains("identify"));
}

#[test]
fn tune_gives_gains_with_margins_for_a_model() {
    let dir = Scratch::new("tune");
    let plant = ["--numerator", "1e6", "--denominator", "1,20,400,0"];
    let rest = [
        "--sample-time",
        "0.001",
        "--delay",
        "0.5",
        "--bandwidth",
        "4",
    ];
    let mut args = vec!["tune", "model"];
    args.extend(plant);
    args.extend(rest);
    let text = stdout(&args);
    for word in [
        "cascade",
        "\nPI, bandwidth", // this plant at this bandwidth has no use for a derivative
        "state feedback",
        "phase",
        "feedforward",
        "max sensitivity",
    ] {
        assert!(text.contains(word), "{word} is missing in {text}");
    }
    args.push("--json");
    let out = dir.path("pictures");
    args.extend(["--plot", &out]);
    let found = json(&args);
    let loops = found["loops"].as_array().unwrap();
    assert_eq!(loops.len(), 3);
    assert!(loops.iter().all(|l| l["margins"]["stable"] == true));
    near(&loops[0]["gains"]["kv"], 4.0, 0.001);
    for name in ["step", "bode"] {
        let svg = std::fs::read_to_string(format!("{out}/{name}.svg")).unwrap();
        assert!(svg.contains("state feedback"));
    }
}

#[test]
fn tune_of_a_record_holds_over_the_deviations_of_its_model() {
    let dir = Scratch::new("tune-record");
    let record = dir.path("servo.csv");
    stdout(&[
        "simulate",
        "--out",
        &record,
        "--seconds",
        "4",
        "--seed",
        "1",
        "--eta",
        "500",
    ]);
    let found = json(&[
        "tune",
        "record",
        &record,
        "--order",
        "3",
        "--integrator",
        "--delay",
        "0",
        "--json",
    ]);
    let first = &found["loops"][0];
    assert!(first["within_2_sigma"]["max_sensitivity"].as_f64().unwrap() <= 1.7);
}

#[test]
fn demo_shows_truth_beside_estimate_and_draws() {
    let dir = Scratch::new("demo");
    let out = dir.path("pictures");
    let text = stdout(&["demo", "--linear", "--out", &out]);
    for word in [
        "truth",
        "estimate",
        "sigma",
        "error",
        "C [mm/s]",
        "w0 [rad/s]",
        "xi",
    ] {
        assert!(text.contains(word), "{word} is missing in {text}");
    }
    let svg = std::fs::read_to_string(format!("{out}/transients.svg")).unwrap();
    assert!(svg.contains("estimate / truth"));
}

#[test]
fn demo_without_arguments_is_the_default() {
    let dir = Scratch::new("default");
    let here = dir.path("");
    let out = std::process::Command::new(env!("CARGO_BIN_EXE_trendid"))
        .current_dir(&here)
        .output()
        .unwrap();
    assert!(out.status.success());
    assert!(String::from_utf8_lossy(&out.stdout).contains("A simulated pneumatic axis"));
    assert!(std::fs::metadata(format!("{here}/out/loop-mass.svg")).is_ok());
}

#[test]
fn demo_is_accurate_and_its_sigma_is_honest() {
    let dir = Scratch::new("seeds");
    let out = dir.path("o");
    let seeds = 300..320;
    let mut within = 0;
    for seed in seeds.clone() {
        let seed = seed.to_string();
        let run = |more: &[&str]| {
            json(
                &[
                    &["demo", "--linear", "--json", "--seed", &seed, "--out", &out],
                    more,
                ]
                .concat(),
            )
        };
        // Under the noise of the default.
        let value = run(&[]);
        for (name, percent) in [("C", 0.2), ("w0", 0.2), ("xi", 0.4)] {
            let p = &value["parameters"][name];
            near(&p["estimate"], p["truth"].as_f64().unwrap(), percent);
        }
        assert!(value["tss_ms"].as_f64().unwrap() < 200.0, "seed {seed}");
        // White noise alone, well above the 0.01 % that sampling costs: what sigma is about.
        let value = run(&["--w", "0", "--eps", "0", "--eta", "200"]);
        for name in ["C", "w0", "xi"] {
            let p = &value["parameters"][name];
            let off = p["estimate"].as_f64().unwrap() - p["truth"].as_f64().unwrap();
            within += usize::from(off.abs() <= 3.0 * p["sigma"].as_f64().unwrap());
        }
    }
    println!("seeds {seeds:?}: {within} of 60 within 3 sigma");
    assert!(within >= 57, "{within} of 60 within 3 sigma");
}

/// Nine options: what they cost is counted, and each gains on records it was not tuned on.
#[test]
fn every_option_gains() {
    let value = json(&[
        "options",
        "--seeds",
        "20",
        "--first-seed",
        "700000",
        "--json",
    ]);
    let options = value["options"].as_array().unwrap();
    assert_eq!(options.len(), 9);
    for option in options {
        let worst = |key: &str| {
            let list = option[key].as_array().unwrap();
            // Without a reading there is no number.
            list.iter()
                .map(|e| e.as_f64().unwrap_or(f64::INFINITY))
                .fold(0.0, f64::max)
        };
        let (without, with) = (worst("rms_without_pct"), worst("rms_with_pct"));
        // Without a column for its beginning a structure is read as with it, by sums beside the
        // recursion: the column is no worse.
        let stood_for = option["option"] == "start as a parameter";
        let limit = if stood_for { 1.0 } else { 0.9 };
        assert!(with < limit * without, "{option}");
        let per = |key: &str| option[key].as_f64();
        let cost = per("instructions_per_sample").or(per("instructions_per_call"));
        // A price may be negative: filtered trends cost less than raw ones with their differences.
        assert!(cost.is_some_and(f64::is_finite), "{option}");
    }
    let text = stdout(&["options", "--seeds", "2"]);
    assert!(text.contains("| exact hold") && text.contains("seeds 500000 to 500001"));
}

/// Four drawn plants; more, and their confusion, by the command itself.
#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn structures_of_simulated_plants_are_found() {
    let args = ["select", "--simulated", "4", "--first-seed", "1"];
    let value = json(&[&args[..], &["--json"]].concat());
    assert_eq!(
        (&value["plants"], &value["first_seed"]),
        (&4.into(), &1.into())
    );
    assert!(value["hit_pct"].as_f64().unwrap() >= 75.0, "{value}");
    assert!(
        value["confusion"]
            .as_object()
            .is_some_and(|rows| !rows.is_empty())
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_table_that_cannot_be_written_is_an_error() {
    use std::process::{Command, Stdio};
    let record = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/data/servo.csv");
    let run = |to: Stdio| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_trendid"));
        command.args(["identify", record, "--order", "3", "--integrator"]);
        command.stdout(to).stderr(Stdio::piped()).spawn().unwrap()
    };
    let full = std::fs::File::create("/dev/full").unwrap();
    let out = run(full.into()).wait_with_output().unwrap();
    assert_eq!(out.status.code(), Some(2));
    let said = String::from_utf8(out.stderr).unwrap();
    assert!(
        said.starts_with("error: cannot write to standard output: "),
        "{said}"
    );
    // A reader that has gone away has what it wanted.
    let mut gone = run(Stdio::piped());
    drop(gone.stdout.take());
    let out = gone.wait_with_output().unwrap();
    assert!(out.status.success() && out.stderr.is_empty());
}
