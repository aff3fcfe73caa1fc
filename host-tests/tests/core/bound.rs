//! The Cramer-Rao bound against figures obtained by another program for the same experiments.

use trendid_host_tests::oracles::cramer_rao::{InitialState, servo_bound_pct};
use trendid_host_tests::plants::servo::REFERENCE;
use trendid_host_tests::signals::experiment::Experiment;
use trendid_host_tests::signals::noise::{Condition, rms_about_mean};

/// Root mean square of the bound over the binary sequences of 100 seeds.
fn bound(ns_pct: f64, duration_s: f64, initial: InitialState) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for seed in 0..100 {
        let record =
            Experiment::reference(Condition::white_relative(ns_pct), duration_s).record(seed);
        let sigma = 1e-2 * ns_pct * rms_about_mean(&record.y_true);
        let bound = servo_bound_pct(&REFERENCE, record.dt, &record.u, sigma, initial)
            .expect("binary noise excites the servo");
        for i in 0..3 {
            sum[i] += bound[i] * bound[i] / 100.0;
        }
    }
    sum.map(f64::sqrt)
}

#[test]
fn relative_bound_agrees_with_the_prototype() {
    // N/S [%], duration [s], and the prototype's bound of C, w0, xi [%], which is given to one or
    // two digits.
    for (ns_pct, duration_s, expected) in [
        (1.2, 1.0, [0.05, 0.1, 0.2]),
        (8.0, 1.0, [0.34, 0.65, 1.3]),
        (42.0, 1.0, [1.7, 3.3, 6.5]),
        (42.0, 3.0, [0.8, 2.7, 4.9]),
    ] {
        let got = bound(ns_pct, duration_s, InitialState::PositionUnknown);
        println!("N/S {ns_pct} %, {duration_s} s: {got:.3?}, prototype {expected:?}");
        for i in 0..3 {
            assert!(
                (got[i] / expected[i] - 1.0).abs() < 0.1,
                "N/S {ns_pct} %, {duration_s} s: {got:?} against {expected:?}"
            );
        }
    }
}

#[test]
fn knowing_the_start_can_only_help() {
    let known = bound(8.0, 1.0, InitialState::Known);
    let position = bound(8.0, 1.0, InitialState::PositionUnknown);
    let nothing = bound(8.0, 1.0, InitialState::Unknown);
    println!("known {known:.3?}, position unknown {position:.3?}, unknown {nothing:.3?}");
    for i in 0..3 {
        assert!(known[i] < position[i] && position[i] < nothing[i]);
    }
}
