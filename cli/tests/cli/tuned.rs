//! What `tune record` says beside the gains.

use crate::common::{Scratch, stdout, trendid};
use crate::refusals::sentence;

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

/// The numbers in front of words in a line.
fn coefficients(line: &str, words: &[&str]) -> Vec<f64> {
    let tokens: Vec<&str> = line
        .split_whitespace()
        .map(|t| t.trim_end_matches(';'))
        .collect();
    let before = |word: &&str| {
        let pairs = tokens.windows(2).filter(|pair| pair[1] == *word);
        let mut numbers = pairs.filter_map(|pair| pair[0].parse::<f64>().ok());
        numbers
            .next_back()
            .unwrap_or_else(|| panic!("no {word} in {line}"))
    };
    words.iter().map(before).collect()
}

/// Slow loops sampled fast: the coefficients of the difference equation are differences of nearly
/// equal numbers, whose sums are the integral part.
#[test]
fn the_difference_equation_that_is_printed_integrates() {
    for (denominator, bandwidth) in [
        ("1,20,400,0", "auto"),
        ("1,0.01,0", "0.05"),
        ("1,3,2", "5"),
        ("1,0.1,0", "0.4"),
    ] {
        let args = ["--denominator", denominator, "--bandwidth", bandwidth];
        let model = [
            "tune",
            "model",
            "--numerator",
            "1e3",
            "--sample-time",
            "0.001",
        ];
        let text = stdout(&[&model[..], &args].concat());
        let line = |part: &str| text.lines().find(|l| l.contains(part)).expect(part);
        let [u1, u2, e, e1, e2] =
            coefficients(line("or, the derivative"), &["u1", "u2", "e", "e1", "e2"])[..]
        else {
            panic!("{text}");
        };
        let (beta, integral) = (-u2, coefficients(line("e = r - y; d = "), &["e"])[0]);
        // 1 - u1 q - u2 q^2 = (1 - q)(1 - beta q), and what is left of the others for q = 1.
        assert!((1.0 - u1 - u2).abs() < 1e-5 * (1.0 - beta), "{text}");
        let left = (e + e1 + e2) / (integral * (1.0 - beta));
        assert!((left - 1.0).abs() < 1e-4, "{left}: {text}");
    }
}

#[test]
fn a_bandwidth_with_which_the_loop_is_unstable_has_no_gains() {
    let model = [
        "tune",
        "model",
        "--numerator",
        "1e3",
        "--denominator",
        "1,3,2,0",
    ];
    let args = [
        "--sample-time",
        "0.001",
        "--delay",
        "100",
        "--bandwidth",
        "60",
    ];
    let text = stdout(&[&model[..], &args].concat());
    for kind in ["cascade", "pid"] {
        let refused = format!("no {kind}: the loop would be unstable at this bandwidth");
        assert!(text.contains(&refused), "{text}");
    }
}

const SERVO: [&str; 6] = [
    "tune",
    "model",
    "--denominator",
    "1,20,400,0",
    "--sample-time",
    "0.001",
];

#[test]
fn values_with_a_minus_are_values() {
    let zero = stdout(&[&SERVO[..], &["--numerator", "-1,50"]].concat());
    assert!(zero.contains("y / u = (-s + 50.00) / "), "{zero}");
    for (args, said) in [
        (
            &["--numerator", "1", "--delay", "-1"][..],
            "its delay is -0.001 s, not 0 or more",
        ),
        (
            &["--numerator", "1", "--sample-time", "-1"],
            "the sampling interval -1 s is not a positive number",
        ),
        (
            &["--numerator", "1", "--sample-time", "nan"],
            "the sampling interval NaN s is not a positive number",
        ),
    ] {
        let model = match args.contains(&"--sample-time") {
            true => &SERVO[..4],
            false => &SERVO[..],
        };
        let found = sentence(&[model, args].concat());
        assert!(found.contains(said), "{found}");
    }
    let bandwidth = [&SERVO[..], &["--numerator", "1", "--bandwidth", "-5"]].concat();
    let found = trendid(&bandwidth);
    let found = String::from_utf8_lossy(&found.stderr).into_owned();
    assert!(
        found.contains("expected a number of rad/s above 0"),
        "{found}"
    );
}

#[test]
fn a_picture_that_cannot_be_written_leaves_nothing_printed() {
    let dir = Scratch::new("tune-plot");
    let file = dir.file("taken", "");
    let found = sentence(&[&SERVO[..], &["--numerator", "1e6", "--plot", &file]].concat());
    assert!(found.contains("cannot make the directory"), "{found}");
}

/// A loop that rises long after a dozen of its crossovers.
#[test]
fn a_slow_step_has_a_rise_time() {
    let model = [
        "tune",
        "model",
        "--numerator",
        "90.2",
        "--denominator",
        "1,3.754,90.56",
        "--sample-time",
        "0.01",
        "--delay",
        "2.7",
    ];
    let text = stdout(&model);
    let rises: Vec<&str> = text.lines().filter(|l| l.contains("rise (10")).collect();
    assert!(!rises.is_empty(), "{text}");
    for line in rises {
        assert!(
            !line.contains("NaN") && !line.contains("not within"),
            "{text}"
        );
    }
    let dir = Scratch::new("tune-slow");
    let pictures = dir.path("pictures");
    stdout(&[&model[..], &["--plot", &pictures]].concat());
}

/// Noise beside a square wave: the delay is some samples, and millions within its deviations.
#[test]
fn a_record_that_does_not_tell_the_delay_has_no_gains() {
    let row = |k: usize| {
        let (u, noise) = ([-1, 1][k / 20 % 2], (k * k * 7919 + 3 * k) % 1009);
        format!("{:.2},{u},{noise}\n", 0.01 * k as f64)
    };
    let rows: String = (0..200).map(row).collect();
    let dir = Scratch::new("tune-noise");
    let file = dir.file("noise.csv", &format!("t,u,y\n{rows}"));
    let args = ["tune", "record", &file, "--order", "2", "--integrator"];
    let found = sentence(&args);
    assert!(found.contains("its delay is not known, "), "{found}");
    assert!(found.contains("more than 200: give the delay"), "{found}");
    let given = stdout(&[&args[..], &["--delay", "0"]].concat());
    assert!(given.contains("WARNING: the model"), "{given}");
}
