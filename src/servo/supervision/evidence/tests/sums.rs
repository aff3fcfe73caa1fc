//! What the windows of an evidence add up to.

use super::*;

#[test]
fn earlier_windows_count_with_eight_tenths() {
    let mut evidence = Evidence::NONE;
    for bank in [POOR, GOOD, LOAD] {
        evidence.add(&alone(bank));
    }
    for (k, sum) in evidence.sums.iter().enumerate() {
        let exact = 0.8 * (0.8 * POOR[k] + GOOD[k]) + LOAD[k];
        assert!((sum - exact).abs() < 1e-5, "{k}: {sum}, not {exact}");
    }
    assert!((evidence.moved - 2.44).abs() < 1e-6);
    evidence.forget();
    assert_eq!(evidence, Evidence::NONE);
}

#[test]
fn a_share_of_the_windows_is_that_of_the_errors_in_errors_and_motion() {
    let window = Sums {
        bank: [
            0.0,
            25.0,
            100.0,
            300.0,
            1e9,
            f32::INFINITY,
            f32::NAN,
            0.0,
            0.0,
        ],
        challenger: Some(100.0),
        moved: 100.0,
    };
    let shares = window.shares();
    for (share, exact) in shares.bank.iter().zip([0.0, 0.2, 0.5, 0.75, 1.0, 1.0, 1.0]) {
        assert!((share - exact).abs() < 1e-6, "{share}, not {exact}");
    }
    assert_eq!((shares.challenger, shares.moved), (Some(0.5), 1.0));
}

#[test]
fn the_windows_of_a_challenger_are_added_up_without_those_before_it() {
    let mut evidence = Evidence::NONE;
    evidence.add(&alone(POOR));
    evidence.propose(&estimate(2.0));
    // One in which it did not run is none of its own.
    evidence.add(&alone(POOR));
    evidence.add(&window(GOOD, 0.25));
    evidence.add(&window(LOAD, 0.5));
    let Some(challenger) = evidence.challenger else {
        panic!("there is none");
    };
    assert_eq!((challenger.windows, challenger.moved), (2, 2.0));
    assert!((challenger.own - 0.75).abs() < 1e-6);
    for (k, sum) in challenger.bank.iter().enumerate() {
        assert!((sum - GOOD[k] - LOAD[k]).abs() < 1e-6, "{k}: {sum}");
    }
}
