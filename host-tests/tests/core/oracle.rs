//! What the trends give on a noise-free record, and that the two ways to a filtered trend are one.

use trendid_host_tests::oracles::least_squares::{
    Regression, Structure, evaluated_output, least_squares,
};
use trendid_host_tests::oracles::trends::{
    Hold, Scheme, applied, chain_held, chain_output, input_trend, output_trend,
};
use trendid_host_tests::paper::offline::batch_error_pct;
use trendid_host_tests::plants::polynomial::monic;
use trendid_host_tests::plants::servo::{REFERENCE, Servo};
use trendid_host_tests::signals::excitation::Excitation;
use trendid_host_tests::signals::experiment::Experiment;
use trendid_host_tests::signals::noise::Condition;

/// Largest magnitudes over the seeds.
fn worst(scheme: Scheme, f: Option<&[f64]>) -> [f64; 3] {
    let mut worst = [0.0_f64; 3];
    for seed in 1000..1020 {
        let record = Experiment::reference(Condition::CLEAN, 1.0).record(seed);
        let e = batch_error_pct(&record, scheme, f);
        for i in 0..3 {
            worst[i] = worst[i].max(e[i].abs());
        }
    }
    worst
}

#[test]
fn noise_free_second_of_binary_noise() {
    let f = monic(&[20.0; 3]);
    let goodwin = worst(Scheme::Goodwin, None);
    let tustin = worst(Scheme::Tustin, None);
    let filtered = worst(Scheme::Tustin, Some(&f));
    println!("largest error of C, w0, xi [%] over 20 sequences of 1 s");
    println!("raw Goodwin     {goodwin:.4?}");
    println!("raw Tustin      {tustin:.4?}");
    println!("filtered Tustin {filtered:.4?}");
    println!("filtered Goodwin {:.4?}", worst(Scheme::Goodwin, Some(&f)));
    for (i, limit) in [0.4, 0.1, 0.5].into_iter().enumerate() {
        assert!(tustin[i] < limit, "raw Tustin {tustin:?}");
        assert!(goodwin[i] > tustin[i], "raw Goodwin {goodwin:?}");
        assert!(filtered[i] < 0.01, "filtered Tustin {filtered:?}");
    }
}

#[test]
fn chain_and_trend_then_filter_are_the_same_numbers() {
    let record = Experiment::reference(Condition::white(100.0), 1.0).record(1001);
    for m in 1..=4 {
        // The difference equation loses (dt * pole)^-m of the digits, the chain does not: four
        // poles at 1 ms would compare the rounding of the former (1e-9), so order 4 reads the
        // record as one of 5 ms.
        let dt = if m == 4 { 5e-3 } else { 1e-3 };
        let f = monic(&[20.0, 25.0, 30.0, 22.0][..m]);
        for scheme in [Scheme::Goodwin, Scheme::Tustin] {
            let same = |operator: &[f64], chain: &[f64], x: &[f64], what: &str| {
                let two = applied(operator, scheme, Some(&f), dt, x);
                let scale = two.iter().fold(0.0_f64, |s, v| s.max(v.abs()));
                let gap = two
                    .iter()
                    .zip(chain)
                    .fold(0.0_f64, |g, (a, b)| g.max((a - b).abs()));
                println!("{scheme:?} m {m} {what}: {:.1e}", gap / scale);
                assert!(scale > 0.0 && gap < 1e-9 * scale, "{scheme:?} m {m} {what}");
            };
            let y_chain = chain_output(scheme, &f, dt, &record.y);
            for i in 0..=m {
                let operator = output_trend(scheme, m, i, dt);
                same(&operator, &y_chain[i], &record.y, &format!("y {i}"));
            }
            let u_chain = chain_held(scheme, &f, dt, &record.u);
            assert_eq!(u_chain.len(), m);
            for i in 0..m {
                let operator = input_trend(scheme, Hold::Zero, m, i, dt);
                same(&operator, &u_chain[i], &record.u, &format!("u {i}"));
            }
        }
    }
}

#[test]
fn first_order_hold_suits_an_input_that_is_not_held() {
    // A smooth input sampled, acting in straight lines.
    let dt = 5e-3;
    let multisine = Excitation::Multisine {
        amplitude: 3.0,
        first_hz: 0.4,
        lines: 12,
    };
    let u = multisine.sequence(801, dt, 3);
    let mut plant = REFERENCE.plant(dt);
    let y: Vec<f64> = u
        .windows(2)
        .map(|w| {
            let y = plant.output();
            plant.step_ramp(&w[..1], &w[1..]);
            y
        })
        .collect();
    let f = monic(&[20.0; 3]);
    let fit = |hold| {
        let mut structure = Structure::servo();
        structure.inputs[0].hold = hold;
        let rows = Regression::new(&structure, Scheme::Tustin, Some(&f), dt, &[&u[..800]], &y);
        let theta = least_squares(&rows.phi, &rows.target, None).unwrap().theta;
        Servo::from_coefficients(theta[0], theta[1], theta[2])
            .unwrap()
            .error_pct(&REFERENCE)
    };
    let (first, zero) = (fit(Hold::First), fit(Hold::Zero));
    println!("first-order hold {first:.3?} %, zero-order hold {zero:.3?} %");
    assert!(first[2].abs() < 0.5 && zero[2].abs() > 5.0 * first[2].abs());
}

#[test]
fn output_evaluation_predicts_from_the_past_only() {
    let record = Experiment::reference(Condition::CLEAN, 0.5).record(1002);
    let structure = Structure::servo();
    let theta = [400.0, 20.0, 1e6];
    let evaluate = |y: &[f64], theta: &[f64]| {
        evaluated_output(
            &structure,
            Scheme::Tustin,
            theta,
            record.dt,
            &[&record.u],
            y,
        )
    };
    let (y_hat, iq, iv) = evaluate(&record.y, &theta);
    assert_eq!(y_hat.len(), record.len() - 3);
    println!("true parameters: IQ {iq:.1e} mm^2, IV {iv:.1e} mm");
    // What is left is the discretisation at the edges of the input, far below the effect of a wrong
    // parameter.
    let (_, wrong, _) = evaluate(&record.y, &[400.0, 20.0, 0.8e6]);
    assert!(iq < 1e-6 && wrong > 20.0 * iq, "IQ {iq}, wrong {wrong}");
    // A changed y(k) must not move the prediction of y(k), only later ones.
    let mut disturbed = record.y.clone();
    disturbed[100] += 1.0;
    let (moved, ..) = evaluate(&disturbed, &theta);
    assert!((moved[100 - 3] - y_hat[100 - 3]).abs() < 1e-9);
    assert!((moved[101 - 3] - y_hat[101 - 3]).abs() > 0.1);
}
