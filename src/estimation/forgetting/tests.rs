use super::*;
use crate::estimation::postponed::PAUSE;

/// Without data the prior stays what it was: neither forgotten nor taken for knowledge.
#[test]
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

/// N r eps lambda^-2N of one parameter with lambda = 0.99.
const BOUND: f32 = 2.0 * 16_384.0 * 0.01 / (0.99 * 0.99);

#[test]
fn every_second_sample_observes_one_parameter_after_the_other() {
    let mut estimator = Estimator::<3>::new([1.0; 3], [1e4; 3], 0.99);
    let mut stabilised = StabilisedForgetting::new([0.0; 3], 0.99);
    for sample in 1..=6 {
        stabilised.apply(&mut estimator);
        estimator.finish_observation();
        for i in 0..3 {
            let observed = estimator.covariance(i, i) < 2e4;
            assert_eq!(observed, sample >= 2 * (i + 1), "{sample} {i}");
        }
    }
}

#[test]
fn every_second_round_is_counted() {
    let mut estimator = Estimator::<3>::new([1.0; 3], [1.0; 3], 0.99);
    let mut stabilised = StabilisedForgetting::new([0.0; 3], 0.99);
    for sample in 1..=48 {
        let found = stabilised.turn(&mut estimator, true);
        let wanted = (sample % 12 == 0).then_some(sample / 12);
        assert_eq!(found, wanted, "{sample}");
    }
}

#[test]
fn what_is_known_well_is_not_observed() {
    // s = 2e-6 r/2.
    for (share, observed) in [(0.99, false), (1.01, true)] {
        let std = libm::sqrtf(share * 2e-6 * 16_384.0);
        let mut estimator = Estimator::<1>::new([1.0], [std], 0.99);
        let before = estimator.clone();
        let mut stabilised = StabilisedForgetting::new([1e6], 0.99);
        stabilised.set_nominal([1e6]);
        for _ in 0..2 {
            stabilised.apply(&mut estimator);
        }
        estimator.finish_observation();
        assert_eq!(estimator.theta() != before.theta(), observed, "{share}");
    }
}

#[test]
fn a_nominal_value_follows_what_is_known_to_a_tenth_of_the_bound() {
    for (share, known) in [(0.99, true), (1.01, false)] {
        for (brings, set, heeds) in [
            (true, false, true),
            (false, false, true),
            (true, true, true),
            (true, false, false),
        ] {
            let std = libm::sqrtf(0.1 * share * BOUND);
            let mut estimator = Estimator::<1>::new([3.0], [std], 0.99);
            let mut stabilised = StabilisedForgetting::new([1.0], 0.99);
            assert!((stabilised.bound() / BOUND - 1.0).abs() < 1e-4);
            stabilised.set_nominal_std(&[0.5]);
            if set {
                stabilised.set_nominal([1.0]);
            }
            stabilised.heed(heeds);
            for _ in 0..2 {
                let _ = stabilised.turn(&mut estimator, brings);
            }
            let shown = known && brings && heeds;
            let follows = shown && !set;
            assert_eq!(stabilised.nominal(), &[if follows { 3.0 } else { 1.0 }]);
            // A prior that the data support is none any more.
            assert_eq!(stabilised.own_variances()[0].0, !shown);
        }
    }
}

#[test]
fn nominal_values_are_set_replaced_and_let_go() {
    let std = libm::sqrtf(0.05 * BOUND);
    let mut estimator = Estimator::<1>::new([3.0], [std], 0.99);
    let mut stabilised = StabilisedForgetting::new([1.0], 0.99);
    let mut round = |stabilised: &mut StabilisedForgetting<1>| {
        for _ in 0..2 {
            stabilised.apply(&mut estimator);
        }
        *stabilised.nominal()
    };
    stabilised.set_nominal([1.0]);
    stabilised.set_own([7.0]);
    stabilised.replace_nominal([2.0]);
    // It goes on as it was, set.
    assert_eq!(round(&mut stabilised), [2.0]);
    assert_eq!(stabilised.own_variances(), [(false, 7.0)]);
    stabilised.follow([1.5]);
    assert_eq!(stabilised.nominal(), &[1.5]);
    assert_eq!(stabilised.own_variances(), [(false, 0.0)]);
    assert!((round(&mut stabilised)[0] - 3.0).abs() < 0.1);
}

#[test]
fn variances_of_nominal_values_are_of_the_prior_or_as_they_were_set() {
    let mut stabilised = StabilisedForgetting::<3>::new([0.0; 3], 0.99);
    stabilised.set_nominal_std(&[3.0, 0.0, 100.0]);
    stabilised.set_own([5.0, 7.0, 11.0]);
    let own = [(true, 9.0), (false, 7.0), (true, 1e4)];
    assert_eq!(stabilised.own_variances(), own);
    // N r eps, but never less than what the prior alone is known to.
    let left = 3.0 * 2.0 * 16_384.0 * 0.01;
    let found = stabilised.nominal_variances();
    for (found, wanted) in found.iter().zip([(left, 9.0), (left, 7.0), (1e4, 1e4)]) {
        assert!((found.0 / wanted.0 - 1.0).abs() < 1e-4, "{found:?}");
        assert_eq!(found.1, wanted.1);
    }
}

#[test]
fn a_prior_leaves_itself_and_observations_what_there_is_within_their_bound() {
    let stabilised = StabilisedForgetting::<2>::new([0.0; 2], 0.99);
    let bound = stabilised.bound();
    let whole = |own: (bool, f32), now: f32| stabilised.lacking(own, now, 0.0)[0];
    assert_eq!(whole((true, 2.0 * bound), 1.0), 2.0 * bound);
    // Set, the same variance counts as observations of the value: between an eighth and all.
    let least = bound / (1.0 + PAUSE as f32);
    for (now, kept) in [
        (0.0, least),
        (0.5 * bound, 0.5 * bound),
        (9.0 * bound, bound),
    ] {
        assert_eq!(whole((false, 2.0 * bound), now), kept);
    }
    assert_eq!(whole((true, 1.0), 0.0), 1.0);
    // What P lacks of it, by the noise that it counts.
    assert_eq!(stabilised.lacking((false, 5.0), 0.0, 0.5), [5.0, 2.5]);
}

#[test]
fn a_nominal_value_that_is_set_is_as_well_known_as_its_estimate() {
    let near = |found: f32, wanted: f32| {
        assert!((found / wanted - 1.0).abs() < 1e-5, "{found}, not {wanted}");
    };
    let mut stabilised = StabilisedForgetting::<2>::new([0.0; 2], 0.99);
    let prior = 1e3 * stabilised.bound();
    let p = [[4.0, 30.0], [30.0, prior]];
    // Of values that follow: P alone, by the noise of the data.
    stabilised.set_known([1.0, 2.0], &p, 0.01);
    assert_eq!(stabilised.nominal(), &[1.0, 2.0]);
    let [(_, first), (_, last)] = stabilised.own_variances();
    near(first, 0.04);
    near(last, 0.01 * prior);
    // The last one is that of a prior, which the data have not shown: it keeps its own variance,
    // whatever their noise is, and the first one has its share of that.
    let mut stabilised = StabilisedForgetting::<2>::new([0.0; 2], 0.99);
    stabilised.set_nominal_std(&[0.0, libm::sqrtf(prior)]);
    stabilised.set_known([1.0, 2.0], &p, 0.01);
    stabilised.unsupported = [0.0; 2];
    let [(_, first), (_, last)] = stabilised.own_variances();
    near(last, prior);
    let share = 30.0 / prior;
    near(first, 0.04 + share * share * 0.99 * prior);
    // Again, before any more data: as well known as before.
    stabilised.set_known([1.0, 2.0], &[[4.0, 0.0], [0.0, stabilised.bound()]], 0.01);
    near(stabilised.own_variances()[1].1, prior);
    // More noise than was expected: P says enough.
    stabilised.set_known([1.0, 2.0], &[[4.0, 0.0], [0.0, 1.0]], 1e9);
    near(stabilised.own_variances()[1].1, 1e9);
}

#[test]
fn the_last_nominal_value_may_follow_where_the_others_are_set() {
    let std = libm::sqrtf(0.05 * BOUND);
    for follows in [false, true] {
        let mut estimator = Estimator::<2>::new([3.0; 2], [std; 2], 0.99);
        let mut stabilised = StabilisedForgetting::new([1.0; 2], 0.99);
        stabilised.set_nominal([1.0; 2]);
        stabilised.set_own([7.0; 2]);
        if follows {
            stabilised.let_last_follow();
        }
        for _ in 0..4 {
            stabilised.apply(&mut estimator);
        }
        let [first, last] = *stabilised.nominal();
        assert_eq!(first, 1.0);
        assert_eq!((last - 3.0).abs() < 0.1, follows, "{last}");
        let own = if follows { 0.0 } else { 7.0 };
        assert_eq!(stabilised.own_variances(), [(false, 7.0), (false, own)]);
    }
}
