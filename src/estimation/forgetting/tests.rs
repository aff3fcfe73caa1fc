use super::*;

/// Without data the prior stays what it was: neither forgotten nor taken for knowledge.
#[test]
#[cfg_attr(miri, ignore = "millions of samples")]
fn a_prior_counts_for_no_more_than_it_says() {
    for std in [1.0_f32, 30.0, 1e3, 1e8] {
        for memory in [100.0_f32, 2e3, 1e5] {
            let forgetting = 1.0 - 1.0 / memory;
            let mut estimator = Estimator::<3>::new([0.5; 3], [std; 3], forgetting);
            let mut stabilised = StabilisedForgetting::new([0.5; 3], forgetting);
            stabilised.set_nominal_std(&[std; 3]);
            let limit = stabilised.bound().max(1.1 * std * std);
            for k in 0..300_000 {
                // The second parameter alone is seen.
                let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
                let _ = estimator.update(&[0.0, sign, 0.0], sign);
                stabilised.apply(&mut estimator);
                for i in [0, 2] {
                    let p = estimator.covariance(i, i);
                    assert!(p > 0.8 * std * std && p <= limit, "{std} {memory}: {p}");
                }
            }
            assert_eq!(estimator.theta()[0], 0.5);
        }
    }
}

#[test]
fn entries_that_change_no_digit_are_flushed_within_as_many_rounds_as_there_are_rows() {
    let mut estimator = Estimator::<4>::new([0.0; 4], [1.0; 4], 0.999);
    // A row of 1e-10 leaves entries of 1e-20 above the diagonal.
    let _ = estimator.update(&[1e-10; 4], 0.0);
    let entries = |estimator: &Estimator<4>| {
        let packed = estimator.factors();
        (0..4)
            .flat_map(|j| (0..j).map(move |i| packed[j][i]))
            .filter(|entry| *entry != 0.0)
            .count()
    };
    assert_eq!(entries(&estimator), 6);
    let mut stabilised = StabilisedForgetting::new([0.0; 4], 0.999);
    // 2N samples are a round; every second one flushes a row.
    for _ in 0..8 * 2 * 4 {
        stabilised.apply(&mut estimator);
    }
    estimator.finish_observation();
    assert_eq!(entries(&estimator), 0);
}

#[test]
fn the_variances_of_a_prior_are_kept_with_a_memory_and_without_one() {
    for forgetting in [1.0, 0.99] {
        let mut stabilised = StabilisedForgetting::<2>::new([1.0; 2], forgetting);
        stabilised.set_nominal_std(&[3.0; 2]);
        assert_eq!(stabilised.own_variances(), [(true, 9.0); 2]);
        assert_eq!(stabilised.bound() > 0.0, forgetting < 1.0);
    }
}

#[test]
fn rows_that_are_left_out_hold_every_parameter_where_it_is() {
    let forgetting = 0.999;
    let mut estimator = Estimator::<3>::new([1.0, -2.0, 3.0], [1e6; 3], forgetting);
    let mut stabilised = StabilisedForgetting::new([0.0; 3], forgetting);
    let [left, ..] = stabilised.left();
    assert!(estimator.covariance(0, 0) > 1e3 * left);
    for k in 1..=3 {
        stabilised.hold(&mut estimator);
        estimator.finish_observation();
        // One after the other, each to what its observation alone leaves.
        for i in 0..3 {
            let held = estimator.covariance(i, i) <= 1.001 * left;
            assert_eq!(held, i < k, "{k} {i}");
        }
        assert_eq!(estimator.theta(), &[1.0, -2.0, 3.0]);
    }
}
