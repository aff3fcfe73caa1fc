//! The commands from end to end.

use crate::common::{Scratch, json, stdout};
use serde_json::Value;

fn near(value: &Value, truth: f64, percent: f64) {
    let found = value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is no number"));
    let off = 100.0 * (found / truth - 1.0).abs();
    assert!(
        off <= percent,
        "{found} is {off:.3} % off {truth}, {percent} % allowed"
    );
}

#[test]
fn every_command_helps_with_an_example() {
    for command in ["demo", "simulate", "identify", "select"] {
        let text = stdout(&[command, "--help"]);
        assert!(text.contains("Example"), "{command}");
        assert!(text.contains(&format!("trendid {command}")), "{command}");
        assert!(text.contains("--json"), "{command}");
    }
    let text = stdout(&["--help"]);
    assert!(text.contains("Example") && text.contains("identify"));
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

#[test]
fn the_record_in_the_examples_is_what_simulate_writes() {
    let dir = Scratch::new("example");
    let file = dir.path("servo.csv");
    let arguments = "--seconds 4 --seed 1 --eta 500".split(' ');
    let arguments: Vec<&str> = ["simulate", "--out", &file]
        .into_iter()
        .chain(arguments)
        .collect();
    let _said = stdout(&arguments);
    let kept = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/data/servo.csv");
    assert_eq!(
        std::fs::read_to_string(file).unwrap(),
        std::fs::read_to_string(kept).unwrap()
    );
}

#[test]
fn what_simulate_writes_identify_finds() {
    let dir = Scratch::new("round");
    let file = dir.path("servo.csv");
    let text = stdout(&["simulate", "--out", &file, "--seconds", "4", "--seed", "11"]);
    assert!(text.contains("4000 samples"));
    let record = std::fs::read_to_string(&file).unwrap();
    assert!(
        record.contains("# truth: C = 2500"),
        "the truth is in the header"
    );

    let pictures = dir.path("pictures");
    let args = [
        "identify",
        &file,
        "--order",
        "3",
        "--integrator",
        "--json",
        "--plot",
        &pictures,
    ];
    let value = json(&args);
    near(&value["a"][1], 400.0, 0.5);
    near(&value["a"][2], 20.0, 0.5);
    assert_eq!(value["a"][0], 0.0);
    assert_eq!(value["inputs"][0]["name"], "u");
    near(&value["inputs"][0]["b"][0], 1e6, 0.5);
    assert_eq!(value["inputs"].as_array().unwrap().len(), 1);
    assert_eq!(value["sigma"].as_array().unwrap().len(), 3);
    assert_eq!(value["delay_s"], 0.0);
    assert!(value["fit_pct"].as_f64().unwrap() > 99.0);
    assert!(value["fit_x0c_pct"].as_f64().unwrap() > 99.0);
    assert!(value["fit_held_out"].as_bool().unwrap());
    assert!(value["ise"].as_f64().unwrap() > 0.0);
    near(&value["physical"]["gain"], 2500.0, 0.5);
    near(&value["physical"]["omega0"], 20.0, 0.5);
    near(&value["physical"]["damping"], 0.5, 0.5);
    for name in ["simulation.svg", "parameters.svg"] {
        assert!(
            std::fs::metadata(format!("{pictures}/{name}"))
                .unwrap()
                .len()
                > 1000,
            "{name}"
        );
    }

    let text = stdout(&["identify", &file, "--order", "3", "--integrator"]);
    assert!(text.contains("(s^3 + ") && text.contains(" s)"), "{text}");
    assert!(
        text.contains("+-") && text.contains("ISE") && text.contains("fit 99."),
        "{text}"
    );

    let chosen = json(&["select", &file, "--json"]);
    let best = &chosen["candidates"][chosen["recommended"].as_u64().unwrap() as usize];
    assert_eq!(
        (&best["order"], &best["integrator"]),
        (&3.into(), &true.into())
    );
    assert_eq!((&best["zeros"], &best["delay"]), (&0.into(), &0.into()));
    let text = stdout(&[
        "select",
        &file,
        "--integrator",
        "--filter",
        "20",
        "--delay",
        "0",
    ]);
    assert!(
        text.contains("<== recommended") && text.contains("fit x0+c"),
        "{text}"
    );
}

/// A plant with two inputs, delay, friction and offset, simulated by hand.
#[test]
fn delay_friction_and_several_inputs_are_found() {
    let dir = Scratch::new("miso");
    // y'' = -3 y' + 40 u(t - 4 dt) + 25 w(t - 4 dt) - 2 sgn(y') + 1, steps of 20 us.
    let (mut y, mut v) = (0.0_f64, 0.0_f64);
    let mut table = String::from("t,u,w,y,v\n");
    let u = |k: i64| if (k.max(0) / 170) % 2 == 0 { 1.0 } else { -0.8 };
    let w = |k: i64| if (k.max(0) / 410) % 3 == 0 { 0.9 } else { -0.4 };
    for k in 0..8000_i64 {
        table += &format!(
            "{:.3},{},{},{:.7},{:.6}\n",
            k as f64 * 1e-3,
            u(k),
            w(k),
            y,
            v
        );
        for _ in 0..50 {
            let dt = 2e-5;
            let a = -3.0 * v + 40.0 * u(k - 4) + 25.0 * w(k - 4) - 2.0 * v.signum() + 1.0;
            y += dt * v + 0.5 * dt * dt * a;
            v += dt * a;
        }
    }
    let file = dir.file("miso.csv", &table);
    for coulomb in [&["--coulomb"][..], &["--coulomb", "v"]] {
        let mut args = vec![
            "identify",
            file.as_str(),
            "--order",
            "2",
            "--integrator",
            "--constant",
        ];
        args.extend(["--input", "u", "--input", "w", "--delay", "auto", "--json"]);
        args.extend(coulomb);
        let value = json(&args);
        assert_eq!(value["delay_s"], 0.004, "{coulomb:?}");
        near(&value["a"][1], 3.0, 3.0);
        let inputs = value["inputs"].as_array().unwrap();
        let names: Vec<&str> = inputs.iter().map(|i| i["name"].as_str().unwrap()).collect();
        assert_eq!(names, ["u", "w", "sgn(v)", "1"]);
        for (input, truth) in inputs.iter().zip([40.0, 25.0, -2.0, 1.0]) {
            near(&input["b"][0], truth, 6.0);
        }
        assert!(value["fit_x0c_pct"].as_f64().unwrap() > 98.0);
    }
}

/// A spring-mass-damper with few samples in a period: the damping stands, and so do the gains.
#[test]
fn slow_sampling_loses_no_damping() {
    let dir = Scratch::new("slow");
    // y'' + 30 y' + 90000 y = 90000 u, ten samples in a period, u held: exact by its two real recursions.
    let (w, xi, dt) = (300.0_f64, 0.05_f64, 2.0e-3_f64);
    let wd = w * (1.0 - xi * xi).sqrt();
    let (decay, sine, cosine) = ((-xi * w * dt).exp(), (wd * dt).sin(), (wd * dt).cos());
    let rho = xi / (1.0 - xi * xi).sqrt();
    let (mut y, mut v) = (0.0_f64, 0.0_f64);
    let mut table = String::from("t,u,y\n");
    let mut state = 1_u32;
    let mut u = 1.0;
    for k in 0..4000 {
        if k % 4 == 0 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            u = if state >> 31 == 0 { 1.0 } else { -1.0 };
        }
        table += &format!("{:.3},{u},{y:.7}\n", f64::from(k) * dt);
        let e = y - u;
        y = u + decay * (e * (cosine + rho * sine) + v * sine);
        v = decay * (v * (cosine - rho * sine) - e * (1.0 + rho * rho) * sine);
    }
    let file = dir.file("slow.csv", &table);
    let value = json(&["identify", &file, "--order", "2", "--json"]);
    near(&value["a"][0], w * w, 0.01);
    near(&value["a"][1], 2.0 * xi * w, 0.1);
    near(&value["inputs"][0]["b"][0], w * w, 0.05);
    // A filter of the user's own is left alone, and is exact all the same.
    let value = json(&[
        "identify", &file, "--order", "2", "--filter", "200", "--json",
    ]);
    assert!(value["filter"].is_null() && value["filter_pole"] == 200.0);
    near(&value["a"][1], 2.0 * xi * w, 0.1);
    near(&value["inputs"][0]["b"][0], w * w, 0.05);
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
        assert!(with < 0.9 * without, "{option}");
        let per = |key: &str| option[key].as_f64();
        let cost = per("instructions_per_sample").or(per("instructions_per_call"));
        assert!(cost.unwrap() > 0.0, "{option}");
    }
    let text = stdout(&["options", "--seeds", "2"]);
    assert!(text.contains("| exact hold") && text.contains("seeds 500000 to 500001"));
}

/// Four drawn plants; more, and their confusion, by the command itself.
#[test]
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
