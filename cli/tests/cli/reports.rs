//! What `identify` and `select` say beside the model: sigmas, remarks, what was left out.

use crate::common::{Scratch, json, near, piped, stdout};

/// A record of `n` samples every 10 ms: `t,u,w,y` with a binary input u and a slower one w.
fn record(n: usize, mut plant: impl FnMut(usize, f64, f64) -> f64) -> String {
    let mut state = 7_u32;
    let mut u = 1.0;
    let mut text = String::from("t,u,w,y\n");
    for k in 0..n {
        if k % 8 == 0 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            u = if state >> 31 == 0 { 1.0 } else { -1.0 };
        }
        let w = if (k / 130) % 2 == 0 { 0.5 } else { -0.5 };
        text += &format!("{:.2},{u},{w},{:.7}\n", k as f64 * 0.01, plant(k, u, w));
    }
    text
}

/// `y' = -2 y + 6 u + 3 w`, u and w held, measured with a ripple of 1e-4.
fn lag() -> String {
    let (decay, mut y) = ((-0.02_f64).exp(), 0.0);
    record(3000, move |k, u, w| {
        let now = y;
        y = decay * y + (3.0 * u + 1.5 * w) * (1.0 - decay);
        now + if k * 7919 % 13 < 6 { 1e-4 } else { -1e-4 }
    })
}

#[test]
fn every_number_has_its_sigma() {
    let dir = Scratch::new("sigma");
    let file = dir.file("lag.csv", &lag());
    let args = [
        "identify", &file, "--order", "1", "--input", "u", "--input", "w", "--filter", "2",
    ];
    let text = stdout(&args);
    // The values are compared in JSON; here every line of one has its deviation.
    for name in ["static gain K  ", "static gain K of w", "time constant [s]"] {
        let line = text.lines().find(|l| l.trim().starts_with(name));
        let line = line.unwrap_or_else(|| panic!("{name} is missing in {text}"));
        assert!(line.contains(" +- ") && !line.contains('?'), "{line}");
    }
    let value = json(&[&args[..], &["--json"]].concat());
    let physical = &value["physical"];
    let sigma = &physical["sigma"];
    for (found, truth, sigma) in [
        (&physical["gain"], 3.0, &sigma["gain"]),
        (
            &physical["further_gains"]["w"],
            1.5,
            &sigma["further_gains"]["w"],
        ),
        (
            &physical["time_constants_s"][0],
            0.5,
            &sigma["time_constants_s"][0],
        ),
    ] {
        let off = (found.as_f64().unwrap() - truth).abs();
        let sigma = sigma.as_f64().expect("a sigma");
        assert!(sigma > 0.0 && off < 0.01 * truth, "{found} {truth} {sigma}");
    }
}

#[test]
fn a_force_balance_is_in_units_of_its_input() {
    let dir = Scratch::new("balance");
    // y'' = -3 y' + 40 w: inertia 1/40, viscous 3/40.
    let (mut y, mut v, decay) = (0.0, 0.0, (-0.03_f64).exp());
    let text = record(3000, |_, u, _| {
        let (now, end) = (y, 40.0 * u / 3.0);
        y += end * 0.01 + (v - end) * (1.0 - decay) / 3.0;
        v = end + (v - end) * decay;
        now
    });
    let file = dir.file("drive.csv", &text.replacen("t,u,w,y", "t,torque,w,y", 1));
    let args = [
        "identify",
        &file,
        "--order",
        "2",
        "--integrator",
        "--input",
        "torque",
        "--filter",
        "3",
    ];
    let text = stdout(&args);
    assert!(
        text.contains("inertia [torque]") && text.contains("viscous [torque]"),
        "{text}"
    );
    let physical = &json(&[&args[..], &["--json"]].concat())["physical"];
    let off = physical["inertia"].as_f64().unwrap() / 0.025 - 1.0;
    assert!(off.abs() < 0.01, "{off}");
    assert!(physical["sigma"]["inertia"].as_f64().is_some());
}

#[test]
fn a_pole_is_accepted_as_it_is_printed() {
    let dir = Scratch::new("pole");
    let file = dir.file("lag.csv", &lag());
    let run = |pole| stdout(&["identify", &file, "--order", "1", "--filter", pole]);
    assert_eq!(run("-1.71"), run("1.71"));
    assert!(run("-1.71").contains("filter poles at -1.71 rad/s"));
}

#[test]
fn a_record_comes_from_the_standard_input_and_in_ms() {
    let dir = Scratch::new("stdin");
    let text = lag();
    let file = dir.file("lag.csv", &text);
    let from_file = json(&["identify", &file, "--order", "1", "--filter", "2", "--json"]);
    let mut lines = text.lines();
    let mut in_ms = lines.next().expect("a header").replacen('t', "t_ms", 1) + "\n";
    for line in lines {
        let (t, rest) = line.split_once(',').expect("cells");
        let t: f64 = t.parse().expect("a time");
        in_ms += &format!("{:.0},{rest}\n", 1e3 * t);
    }
    let from_ms = [
        "identify",
        "-",
        "--order",
        "1",
        "--filter",
        "2",
        "--json",
        "--time",
        "t_ms",
        "--time-unit",
        "ms",
    ];
    let out = piped(&from_ms, &in_ms);
    let from_stdin: serde_json::Value = serde_json::from_slice(&out.stdout).expect("JSON");
    let a = |value: &serde_json::Value| value["a"][0].as_f64().expect("a number");
    assert!((a(&from_file) / a(&from_stdin) - 1.0).abs() < 1e-5);
}

#[test]
fn a_long_delay_is_found() {
    let dir = Scratch::new("late");
    let (decay, mut y, mut line) = ((-0.02_f64).exp(), 0.0, vec![0.0; 14]);
    let text = record(3000, |_, u, _| {
        let now = y;
        line.push(u);
        y = decay * y + 3.0 * line.remove(0) * (1.0 - decay);
        now
    });
    let file = dir.file("late.csv", &text);
    let args = [
        "identify", &file, "--order", "1", "--filter", "2", "--delay",
    ];
    let said = stdout(&[&args[..], &["auto"]].concat());
    assert!(said.contains("delay 14.000"), "{said}");
    let said = stdout(&[&args[..], &["14"]].concat());
    assert!(said.contains("delay 14 samples, "), "{said}");
    let value = json(&[&args[..], &["auto", "--json"]].concat());
    assert_eq!(value["delay_at_end"], false);
}

/// Inputs from before the record, which a delay asks for, are not made up.
#[test]
fn a_delay_of_many_samples_is_found_behind_an_axis() {
    const LATE: usize = 150;
    let dir = Scratch::new("late-axis");
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/data/servo.csv");
    let record = std::fs::read_to_string(path).expect("the record of the examples");
    let rows: Vec<Vec<&str>> = (record.lines().skip(6))
        .map(|line| line.split(',').collect())
        .collect();
    let mut text = String::from("t,u,y\n");
    for (now, late) in rows.iter().skip(LATE).zip(&rows) {
        text += &format!("{},{},{}\n", now[0], now[1], late[2]);
    }
    let file = dir.file("late.csv", &text);
    let args = ["--order", "3", "--integrator", "--delay", "auto", "--json"];
    let found = json(&[&["identify", &file], &args[..]].concat());
    let delay = 1e3 * found["delay_s"].as_f64().expect("a delay");
    assert!((delay - LATE as f64).abs() <= 0.5, "{delay}");
    near(&found["physical"]["gain"], 2500.0, 1.0);
}

#[test]
fn what_speaks_against_a_model_is_said() {
    let dir = Scratch::new("against");
    // An integrator with a drift that the model has no constant for.
    let mut y = 0.0;
    let text = record(3000, |_, u, _| {
        let now = y;
        y += 0.01 * (2.0 * u + 3.0);
        now
    });
    let file = dir.file("drift.csv", &text);
    let args = [
        "identify",
        &file,
        "--order",
        "1",
        "--integrator",
        "--filter",
        "5",
    ];
    let said = stdout(&args);
    assert!(
        said.contains("fits only with the constant refitted"),
        "{said}"
    );
    let held = stdout(&[&args[..], &["--constant"]].concat());
    assert!(
        !held.contains("refitted:") && !held.contains("poor"),
        "{held}"
    );
    // A plant that runs away.
    let mut y = 0.1;
    let text = record(1500, |_, u, _| {
        let now = y;
        y = y * (0.002_f64).exp() + 0.01 * u;
        now
    });
    let file = dir.file("unstable.csv", &text);
    let said = stdout(&["identify", &file, "--order", "1", "--filter", "5"]);
    assert!(said.contains("the model is unstable"), "{said}");
}

#[test]
fn structures_that_are_left_out_are_named() {
    let dir = Scratch::new("dropped");
    let file = dir.file(
        "short.csv",
        &lag().lines().take(46).collect::<Vec<_>>().join("\n"),
    );
    let args = ["select", &file, "--filter", "20", "--delay", "0"];
    let text = stdout(&args);
    assert!(text.contains("dropped because"), "{text}");
    assert!(
        text.contains("too few samples: 45 for 5 parameters, at least 50 are needed"),
        "{text}"
    );
    let value = json(&[&args[..], &["--json"]].concat());
    let count = |key: &str| value[key].as_array().expect("a list").len();
    // Orders 1 to 3 with and without integrator: 1 + 2 + 3 numbers of zeros each; one delay.
    assert_eq!(count("candidates") + count("dropped"), 12);
    assert!(value["dropped"][0]["reason"].as_str().is_some());
}
