//! What is refused, and that it is named with its value and its limit.

use super::*;

fn refusal(model: &Model, around: &[Model], goal: Goal) -> String {
    tune(model, around, goal).expect_err("no gains").to_string()
}

#[test]
fn a_delay_that_nobody_knows_has_no_gains() {
    for (longest, said) in [
        (2.076, "4.0 samples of the controller and 2076.0 within"),
        (1e11, "1.0e14 within"),
        (f64::INFINITY, "inf within"),
        (f64::NAN, "NaN within"),
    ] {
        let around = [servo(0.0), servo(longest)];
        let error = refusal(&servo(4e-3), &around, AUTO);
        assert!(error.contains(said) && error.contains("200"), "{error}");
    }
    let known = tune(&servo(4e-3), &[servo(0.0), servo(0.02)], AUTO).expect("gains");
    assert_eq!(known.loops.len(), 3);
}

#[test]
fn absurd_numbers_are_named_with_their_limit() {
    let gain = |b: f64| Model {
        b: vec![b],
        ..servo(0.0)
    };
    for (b, said) in [(1e156, "1e156"), (-1e160, "-1e160"), (1e-200, "1e-200")] {
        let error = refusal(&gain(b), &[], AUTO);
        assert!(
            error.contains(said) && error.contains("1e-100 to 1e100"),
            "{error}"
        );
        let error = refusal(&servo(0.0), &[gain(b)], AUTO);
        assert!(error.contains("within two standard deviations"), "{error}");
    }
    let pole = |a: f64| Model {
        a: vec![a],
        b: vec![1.0],
        delay: 0.0,
    };
    for (a, said) in [
        (1e12, "1.000e9 radians per sample; up to 1e6 is possible"),
        (-1e6, "1.000e3 radians per sample; and it is unstable"),
    ] {
        let error = refusal(&pole(a), &[], AUTO);
        assert!(error.contains(said), "{error}");
    }
    let slow = Goal {
        bandwidth: Some(1e-6),
        ..AUTO
    };
    let error = refusal(&servo(0.0), &[], slow);
    assert!(error.contains("1e-6 rad/s, below 1e-5 rad/s"), "{error}");
}

#[test]
fn a_sample_time_that_is_none_is_named_before_the_delay_in_it() {
    let goal = Goal {
        sample_time: f64::NAN,
        bandwidth: None,
    };
    let error = refusal(&servo(f64::NAN), &[], goal);
    assert!(error.contains("sampling interval NaN s"), "{error}");
    let goal = Goal {
        sample_time: 1e-200,
        bandwidth: None,
    };
    let error = refusal(&servo(0.0), &[], goal);
    assert!(error.contains("1e-200 s; 1e-12 to 1e12 s"), "{error}");
}
