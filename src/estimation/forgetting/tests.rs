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
