//! A number of a record that is wrong is named beside the model, and where there is none.

use crate::common::{Scratch, json, stdout, trendid};
use crate::refusals::sentence;

/// `y' = 5 (2 u - y)` every 10 ms with a number of its own in row 200.
fn lag(wrong: &str) -> String {
    let (decay, mut y, mut state, mut u) = ((-0.05_f64).exp(), 0.0, 7_u32, 1.0);
    let mut text = String::from("t,u,y\n");
    for k in 0..600 {
        if k % 9 == 0 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            u = if state >> 31 == 0 { 1.0 } else { -1.0 };
        }
        let ripple = if k * 7919 % 13 < 6 { 1e-3 } else { -1e-3 };
        let cell = match k {
            200 if !wrong.is_empty() => wrong.to_owned(),
            _ => format!("{:.5}", y + ripple),
        };
        text += &format!("{:.2},{u},{cell}\n", 0.01 * f64::from(k));
        y = decay * y + 2.0 * u * (1.0 - decay);
    }
    text
}

#[test]
fn a_wrong_number_is_named_beside_the_model() {
    let dir = Scratch::new("wrong-number");
    let file = dir.file("r.csv", &lag("64118"));
    let said = "line 202, column `y`: 64118 stands alone (expected about ";
    for args in [
        &["identify", &file, "--order", "1"][..],
        &["select", &file, "--max-order", "1", "--delay", "0"],
    ] {
        let out = trendid(args);
        // A model with a warning, or a refusal with its cause.
        let text = String::from_utf8([out.stdout, out.stderr].concat()).unwrap();
        assert!(text.contains(said), "{text}");
    }
    let found = json(&["identify", &file, "--order", "1", "--json"]);
    assert_eq!(found["alone"][0]["line"], 202);
    let right = dir.file("right.csv", &lag(""));
    let found = json(&["identify", &right, "--order", "1", "--json"]);
    assert_eq!(found["alone"].as_array().map(Vec::len), Some(0));
    assert!(!stdout(&["identify", &right, "--order", "1"]).contains("alone"));
}

#[test]
fn a_refusal_names_the_number_that_may_be_its_cause() {
    let dir = Scratch::new("wrong-cause");
    let file = dir.file("r.csv", &lag("1e30"));
    let said = sentence(&["identify", &file, "--order", "3", "--zeros", "2"]);
    assert!(
        said.contains("; line 202, column `y`: 1.000e30 stands alone"),
        "{said}"
    );
}
