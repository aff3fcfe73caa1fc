//! What defects of valve and delay do to batch least squares of filtered trends, and which inputs
//! cure them.

use trendid_host_tests::oracles::least_squares::{
    InputTerms, Regression, Structure, least_squares,
};
use trendid_host_tests::oracles::trends::Scheme;
use trendid_host_tests::plants::linear::{Input, LinearPlant};
use trendid_host_tests::plants::polynomial::monic;
use trendid_host_tests::plants::servo::{REFERENCE, Servo};
use trendid_host_tests::signals::experiment::{Experiment, Record};
use trendid_host_tests::signals::noise::Condition;

/// Parameters `a1, a2`, one `b0` per input, and the constant when there is one.
fn parameters(record: &Record, u: &[&[f64]], delay: usize, constant: bool) -> Vec<f64> {
    let structure = Structure {
        inputs: u
            .iter()
            .map(|_| InputTerms {
                delay,
                ..InputTerms::held(&[0])
            })
            .collect(),
        constant,
        ..Structure::servo()
    };
    let f = monic(&[20.0; 3]);
    let rows = Regression::new(
        &structure,
        Scheme::Tustin,
        Some(&f),
        record.dt,
        u,
        &record.y,
    );
    let fit = least_squares(&rows.phi, &rows.target, None).expect("excited");
    fit.theta.as_slice().to_vec()
}

/// Signed errors of C, w0, xi \[%\].
fn errors(theta: &[f64]) -> [f64; 3] {
    Servo::from_coefficients(theta[0], theta[1], theta[2])
        .expect("a1 > 0")
        .error_pct(&REFERENCE)
}

fn worst(e: [f64; 3]) -> f64 {
    e.iter().fold(0.0, |w, v| w.max(v.abs()))
}

#[test]
fn an_offset_needs_the_constant_input() {
    let mut experiment = Experiment::reference(Condition::CLEAN, 1.0);
    experiment.valve.offset = 0.04;
    let record = experiment.record(2001);
    let without = errors(&parameters(&record, &[&record.u], 0, false));
    let theta = parameters(&record, &[&record.u], 0, true);
    let with = errors(&theta);
    let offset = theta[3] / theta[2];
    println!("offset 0.04 of 0.4: without {without:.3?} %, with {with:.4?} %, offset {offset:.5}");
    assert!(worst(without) > 5.0 && worst(with) < 0.02);
    assert!((offset / 0.04 - 1.0).abs() < 1e-3);
}

#[test]
fn a_dead_zone_is_measured_by_its_inputs() {
    let mut experiment = Experiment::closed_loop(Condition::CLEAN, 4.0);
    experiment.valve.dead_zone = 0.03;
    let record = experiment.record(2002);
    let without = errors(&parameters(&record, &[&record.u], 0, false));
    let modelled = |delta: f64| {
        let beyond = |u: f64| if u.abs() > delta { u } else { 0.0 };
        let linear: Vec<f64> = record.u.iter().map(|&u| beyond(u)).collect();
        let sign: Vec<f64> = linear
            .iter()
            .map(|&u| if u == 0.0 { 0.0 } else { u.signum() })
            .collect();
        let theta = parameters(&record, &[&linear, &sign], 0, true);
        (errors(&theta), -theta[3] / theta[2])
    };
    let (right, measured) = modelled(0.03);
    let (low, from_low) = modelled(0.02);
    println!("dead zone 0.03, closed loop, 4 s: without {without:.2?} %");
    println!("  delta 0.03: {right:.4?} %, measured {measured:.5}");
    println!("  delta 0.02: {low:.3?} %, measured {from_low:.5}");
    assert!(worst(without) > 5.0 && worst(right) < 0.05 && worst(low) < 3.0);
    assert!((measured - 0.03).abs() < 1e-4 && (from_low - 0.03).abs() < 2e-3);
}

#[test]
fn a_delay_must_be_in_the_structure() {
    let mut experiment = Experiment::reference(Condition::CLEAN, 1.0);
    let inputs = [Input::delayed(&[REFERENCE.b0()], 1)];
    experiment.plant = LinearPlant::with_inputs(&REFERENCE.a(), &inputs, 0.0, 1e-3).unwrap();
    let record = experiment.record(2003);
    let ignored = errors(&parameters(&record, &[&record.u], 0, false));
    let modelled = errors(&parameters(&record, &[&record.u], 1, false));
    println!("one sample of delay: ignored {ignored:.3?} %, modelled {modelled:.4?} %");
    assert!(worst(ignored) > 0.5 && worst(modelled) < 0.01);
}
