//! What `trendid simulate` writes is found by `trendid identify`.

use crate::common::{Scratch, json, near, stdout};

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
}

#[test]
fn drawn_drives_are_found_and_their_parts_add_up() {
    let rows = json(&["drives", "--drives", "40", "--first-seed", "5001", "--json"]);
    let rows = rows.as_array().unwrap();
    let drives = |i: usize| rows[i]["drives"].as_u64().unwrap();
    assert_eq!(rows.len(), 10);
    assert_eq!(
        (drives(0), drives(0)),
        (drives(2) + drives(4), drives(6) + drives(8))
    );
    for i in 0..3 {
        let of = |row: usize, field: &str| rows[row][field][i].as_f64().unwrap();
        assert!(of(0, "median_error_pct") < of(0, "p90_error_pct"));
        assert!(of(2, "median_error_pct") < of(4, "median_error_pct"));
        assert!(of(0, "within_3_pct") >= 90.0 && of(0, "within_1_pct") < of(0, "within_3_pct"));
    }
}

#[test]
fn a_simulated_record_is_reported_and_its_structure_selected() {
    let dir = Scratch::new("selected");
    let file = dir.path("servo.csv");
    let _said = stdout(&["simulate", "--out", &file, "--seconds", "4", "--seed", "11"]);
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
        near(&value["delay_s"], 0.004, 0.01);
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
    // y'' + 30 y' + 90000 y = 90000 u, ten samples in a period, u held: exact by its two real
    // recursions.
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

/// Columns u and y of a record, from seed.
fn columns(dir: &Scratch, seed: &str) -> Vec<[f64; 2]> {
    let file = dir.path(&format!("{seed}.csv"));
    let _said = stdout(&["simulate", "--out", &file, "--seconds", "6", "--seed", seed]);
    let text = std::fs::read_to_string(file).unwrap();
    let rows = text
        .lines()
        .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    let number = |cell: Option<&str>| cell.unwrap().parse::<f64>().unwrap();
    rows.map(|row| {
        let mut cells = row.split(',').skip(1);
        [number(cells.next()), number(cells.next())]
    })
    .collect()
}

#[test]
fn a_valve_with_a_dead_zone_is_found_behind_its_two_inputs() {
    const WIDTH: f64 = 0.05;
    let dir = Scratch::new("dead-zone");
    // The drive is linear: the sum of two records is a record, of four levels, each of which is
    // reached through the valve.
    let mut text = String::from("t,u,y\n");
    let (one, other) = (columns(&dir, "12"), columns(&dir, "13"));
    for (k, ([u1, y1], [u2, y2])) in one.into_iter().zip(other).enumerate() {
        let passes = u1 + 0.5 * u2;
        let command = passes + WIDTH * passes.signum();
        text += &format!("{},{command},{}\n", 1e-3 * k as f64, y1 + 0.5 * y2);
    }
    let file = dir.file("valve.csv", &text);
    let identify = |more: &[&str]| {
        let args = ["identify", &file, "--order", "3", "--integrator", "--json"];
        json(&[&args, more].concat())
    };
    for width in ["0.05", "0.03", "0"] {
        // Inside of every width no command lasts: the inputs are the same.
        let value = identify(&["--dead-zone", width]);
        near(&value["physical"]["gain"], 2500.0, 1.0);
        near(&value["physical"]["omega0"], 20.0, 1.0);
        assert_eq!(value["inputs"][1]["name"], "sgn(u)");
        let b = |k: usize| value["inputs"][k]["b"][0].as_f64().unwrap();
        near(&(-b(1) / b(0)).into(), WIDTH, 5.0);
    }
    // Without them the gain takes the dead zone.
    let gain = identify(&[])["physical"]["gain"].as_f64().unwrap();
    assert!((gain / 2500.0 - 1.0).abs() > 0.05, "{gain}");
}
