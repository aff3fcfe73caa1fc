//! Exact simulation of linear inputs, holds and the refit.

use super::*;
use crate::estimate::Reading;
use crate::problem::{Options, Structure};
use crate::signals::{Input, Signals};

/// A model without covariance.
fn model(a: &[f64], b: f64, constant: f64) -> Estimate {
    Estimate {
        theta: Vec::new(),
        sigma: Vec::new(),
        covariance: Vec::new(),
        a: a.to_vec(),
        b: vec![vec![b]],
        constant,
        reading: Reading {
            gain: None,
            omega0: None,
            damping: None,
            time_constants: Vec::new(),
            poles: None,
            stable: true,
        },
        reading_sigma: None,
    }
}

fn simulated(
    (u, hold): (&[f64], Hold),
    y: &[f64],
    dt: f64,
    model: &Estimate,
    delay: usize,
) -> Option<FreeRun> {
    let input = Input {
        name: "u",
        samples: u,
        delayed: true,
        hold,
    };
    let signals = Signals {
        dt,
        output: y,
        inputs: vec![input],
        standstill: None,
    };
    let structure = Structure {
        integrator: true,
        constant: true,
        ..Structure::of_order(model.a.len())
    };
    let problem = Problem::new(&signals, structure, Options::default()).expect("a problem");
    problem.free_run(model, delay as f64, y.len() / 2..y.len())
}

#[test]
fn a_model_fits_its_own_response_from_any_state_and_offset() {
    // y'' + 3 y' = 2 u(t - 3 dt) + 0.4 from y = 5, y' = -1, by its velocity: v' = -3 v + f.
    let dt = 0.01;
    let u: Vec<f64> = (0..600)
        .map(|k| if (k / 70) % 2 == 0 { 1.0 } else { -0.7 })
        .collect();
    let (mut y, mut v, decay) = (vec![5.0], -1.0_f64, (-3.0_f64 * dt).exp());
    for k in 0..599_usize {
        let end = (2.0 * u[k.saturating_sub(3)] + 0.4) / 3.0;
        y.push(y[k] + end * dt + (v - end) * (1.0 - decay) / 3.0);
        v = end + (v - end) * decay;
    }
    let run = |constant, delay| {
        let model = model(&[0.0, 3.0], 2.0, constant);
        simulated((&u, Hold::Zero), &y, dt, &model, delay).expect("a simulation")
    };
    let exact = run(0.4, 3);
    assert!(exact.fit_x0 > 99.999_999, "{}", exact.fit_x0);
    assert!((exact.y[299] - y[599]).abs() < 1e-8);
    // The constant is refitted for the second figure only.
    let without = run(0.0, 3);
    assert!(without.fit_x0 < 90.0 && without.fit_x0c > 99.999_999);
    assert!(run(0.4, 0).fit_x0c < 99.5);
    // What runs away is not a fit.
    let unstable = model(&[-1.0, -5e3], 2.0, 0.4);
    assert_eq!(simulated((&u, Hold::Zero), &y, dt, &unstable, 3), None);
    let overflowing = model(&[f64::MAX, f64::MAX], 2.0, 0.4);
    assert_eq!(simulated((&u, Hold::Zero), &y, dt, &overflowing, 3), None);
}

#[test]
fn a_first_order_hold_goes_straight_to_the_next_sample() {
    // y' = u with u = t: the straight line is exact, the held one is not.
    let dt = 0.1;
    let t: Vec<f64> = (0..200).map(|k| f64::from(k) * dt).collect();
    let y: Vec<f64> = t.iter().map(|t| 0.5 * t * t).collect();
    let model = model(&[0.0], 1.0, 0.0);
    let fit = |hold| simulated((&t, hold), &y, dt, &model, 0).expect("a simulation");
    assert!(fit(Hold::First).fit_x0 > 99.999_999);
    assert!(fit(Hold::Zero).fit_x0 < 99.9);
}

#[test]
fn the_refit_is_a_projection_whatever_the_columns() {
    let t = DVector::from_fn(50, |k, _| k as f64);
    let one = DVector::from_element(50, 1.0);
    let target = t.map(|t| 3.0 - 0.25 * t);
    let noise = DVector::from_fn(50, |k, _| if k % 2 == 0 { 1.0 } else { -1.0 });
    // A column that repeats another one changes nothing, nor does one of zeros.
    let columns = [t.clone(), one.clone(), t.clone(), DVector::zeros(50)];
    let combined = |weights: &[f64]| {
        let parts = columns.iter().zip(weights).map(|(c, w)| c * *w);
        parts.fold(DVector::zeros(50), |sum, part| sum + part)
    };
    let (weights, left) = refit(&columns, &target).expect("a fit");
    assert!((combined(&weights) - &target).amax() < 1e-9 && left.norm_squared() < 1e-15);
    let (weights, of_fit) = refit(&columns, &noise).expect("a fit");
    let left = &noise - combined(&weights);
    assert!((&left - of_fit).norm() < 1e-9 * left.norm());
    assert!(left.dot(&one).abs() < 1e-9 && left.dot(&t).abs() < 1e-7);
}

#[test]
fn columns_that_differ_by_little_are_two() {
    // A slow pole beside a constant: their difference, a ramp, is 1e-8 of either.
    let one = DVector::from_element(2000, 1.0);
    let ramp = DVector::from_fn(2000, |k, _| k as f64 / 2000.0 - 0.5);
    let slow = &one + &ramp * 1e-8;
    let (_, alone) = refit(std::slice::from_ref(&one), &ramp).expect("a fit");
    let (weights, both) = refit(&[one.clone(), slow.clone()], &ramp).expect("a fit");
    let [alone, both] = [alone, both].map(|left| left.norm_squared());
    assert!(alone > 0.99 * ramp.norm_squared());
    // Of the ramp eight digits are in the columns.
    assert!(both < 1e-10 * alone, "{both} {alone}");
    let found = one * weights[0] + slow * weights[1];
    assert!((found - ramp).amax() < 1e-4);
}
