//! Verdicts on models whose numbers the record does not tell.

use crate::common::{Scratch, json, stdout};

/// A lag of a tenth of a second, 90 ms late, behind steps at some samples.
fn steps(at: &[usize]) -> String {
    let (mut text, mut y) = ("t,u,y\n".to_owned(), 0.0);
    let level = |k: usize| at.iter().filter(|step| **step <= k).count() % 2;
    for k in 0..2000_usize {
        // What no structure holds, so that the fits are those of a record.
        let noise = 1e-3 * (k as f64 * k as f64 * 0.37).sin();
        text += &format!("{},{},{}\n", 0.01 * k as f64, level(k), y + noise);
        let acts = k.checked_sub(9).map_or(0, level) as f64;
        y += (1.0 - (-0.1_f64).exp()) * (3.0 * acts - y);
    }
    text
}

#[test]
fn a_record_of_one_step_is_said_where_the_delay_is_searched() {
    let dir = Scratch::new("one-step");
    let once = dir.file("once.csv", &steps(&[700]));
    let often = dir.file("often.csv", &steps(&[200, 450, 700, 1100, 1500, 1800]));
    let said = "doubtful: delay and parameters rest on one step";
    let of = |file: &str, delay: &str| {
        json(&["identify", file, "--order", "1", "--delay", delay, "--json"])
    };
    let searched = of(&once, "auto");
    assert_eq!(searched["poor_input"], "one step");
    assert_eq!(searched["verdict"], format!("poor; {said}"));
    for other in [of(&once, "9"), of(&often, "auto")] {
        assert!(other["poor_input"].is_null());
        assert!(!other["verdict"].as_str().unwrap().contains(said));
    }
    assert_eq!(of(&often, "auto")["verdict"], "good");
    // A delay that is missed by one sample: it fits, and the numbers are off.
    let missed = of(&often, "8");
    assert!(missed["fit_pct"].as_f64() > Some(80.0));
    let said = "fair; the record shows a delay of about";
    assert!(missed["verdict"].as_str().unwrap().starts_with(said));
    let verdict = missed["verdict"].as_str().unwrap();
    assert!(missed["fit_pct"].as_f64() > Some(80.0));
    assert!(
        verdict.starts_with("fair; the record shows a delay of about"),
        "{verdict}"
    );
    let said = "in doubt: the structure rests on one step, which no other signal confirms";
    let select = ["select", once.as_str(), "--max-order", "1"];
    assert!(stdout(&select).contains(said));
    let chosen = json(&[&select[..], &["--json"]].concat());
    assert_eq!(chosen["poor_input"], "one step");
    assert!(chosen["doubts"].as_array().unwrap().contains(&said.into()));
    let chosen = json(&["select", &often, "--max-order", "1", "--json"]);
    assert!(chosen["poor_input"].is_null());
    // Of the recommended structure the delay is an unknown, too.
    let best = &chosen["candidates"][chosen["recommended"].as_u64().unwrap() as usize];
    let [late, sigma] = ["delay_s", "delay_sigma_s"].map(|name| best[name].as_f64().unwrap());
    assert!((late - 0.09).abs() < 4.0 * sigma && best["delay"] == 9);
    assert!(stdout(&["select", &often, "--max-order", "1"]).contains("delay [samples]"));
}

#[test]
fn an_offset_that_the_model_does_not_hold_is_named_before_a_delay() {
    let dir = Scratch::new("offset");
    let steps = steps(&[200, 450, 700, 1100, 1500, 1800]);
    let lifted = |row: &str| {
        let (front, y) = row.rsplit_once(',').expect("cells");
        let y = y
            .parse::<f64>()
            .map_or("y".to_owned(), |y| (y - 0.3).to_string());
        format!("{front},{y}\n")
    };
    let file = dir.file("r.csv", &steps.lines().map(lifted).collect::<String>());
    let args = ["identify", &file, "--order", "2", "--delay", "9", "--json"];
    let found = json(&args);
    assert!(!found["delay_missed_s"].is_null());
    let remarks = found["remarks"].to_string();
    assert!(remarks.contains("`--constant` first"), "{remarks}");
    assert!(!remarks.contains("another delay"), "{remarks}");
}

#[test]
fn a_delay_beyond_the_record_is_none() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/data/servo.csv");
    let args = [
        "identify",
        file,
        "--order",
        "3",
        "--integrator",
        "--input",
        "y",
    ];
    let found = json(&[&args[..], &["--json"]].concat());
    let verdict = found["verdict"].as_str().unwrap();
    assert!(
        verdict.contains("the record does not tell the delay"),
        "{verdict}"
    );
    assert!(!verdict.contains("samples, not 0"), "{verdict}");
    assert!(found["delay_missed_s"].is_null() && found["delay_untold"] == true);
    let select = ["select", file, "--input", "y", "--max-order", "2"];
    assert!(!stdout(&select).contains(")e"));
}
