//! What is added to a covariance, and what goes with a constant.

use super::*;

#[test]
fn what_a_prior_says_is_added_where_it_counted_for_more_than_the_noise_that_was_found() {
    let mut parts = Parts::new(filtered(), [1e2; 4], 0.999, 400);
    let none = parts.read().estimate();
    let std = [3e3, 0.0, 50.0, 0.0];
    parts.forgetting.set_nominal_std(&std);
    let p = parts.estimator.covariances();
    let units = *parts.regressor.units();
    let missing = parts.prior_noise * parts.prior_noise - parts.read().residual();
    assert!(missing > 0.0);
    let found = parts.read().estimate();
    let bound = parts.forgetting.bound();
    // A nominal value counts with what its observations alone leave, at most its own variance.
    let expected = |i: usize, j: usize| -> f32 {
        let of = |k: usize| {
            let own = std[k] * std[k];
            p[i][k] * p[j][k] * own * missing / (own.max(bound) * own.max(bound))
        };
        (of(0) + of(2)) * units[i] * units[j]
    };
    for i in 0..4 {
        for j in 0..4 {
            let added = found.covariance[i][j] - none.covariance[i][j];
            let size = (none.covariance[i][i] * none.covariance[j][j]).sqrt();
            assert!(
                (added - expected(i, j)).abs() < 1e-4 * size,
                "{i} {j}: {added}"
            );
        }
    }
    // Large enough to be seen at all.
    parts.prior_noise = 1e3;
    let found = parts.read().estimate().covariance[0][0];
    let exact = expected(0, 0) * (1e6 - parts.read().residual()) / missing;
    assert!(
        close(found - none.covariance[0][0], exact, 0.05),
        "{found} {exact}"
    );
    // A residual beyond the expected one: P says enough.
    parts.prior_noise = 1e-5;
    assert_eq!(parts.read().estimate().covariance, none.covariance);
}

/// What is added where scores say nothing, of so many rows and a nominal value known to `std`.
fn adds_what_nominal_values_leave(rows: u32, std: f32) {
    let mut parts = Parts::new(filtered(), [1e2; 4], 0.999, rows);
    parts.forgetting.set_nominal_std(&[std, 0.0, 0.0, 0.0]);
    let (p, units) = (parts.estimator.covariances(), *parts.regressor.units());
    let scores = [[0.0; 4]; 4];
    let found = parts.read().under(|theta, gain| {
        // Nothing was corrected: the estimate itself, and P.
        for j in 0..4 {
            assert!(close(theta[j], parts.estimator.theta()[j], 1e-5));
            assert!(close(gain[j][j], p[j][j], 1e-5));
        }
        Some(scores)
    });
    let found = found.expect("an estimate");
    let left = compensate(&parts.read(), &parts.read().regression(), true).left;
    let seen = parts.read().residual();
    let floor = parts.read().floor(20.0, &[0.0, 400.0, 20.0], &THETA);
    let variances = parts.forgetting.nominal_variances();
    for i in 0..4 {
        let errs = floor * found.theta[i];
        let mut exact = 1.01 * errs * errs;
        for (k, (whole, own)) in variances.into_iter().enumerate() {
            let noise = if own > 0.0 { own * 1e-4 } else { whole * seen };
            let weight = p[i][k] / whole * units[i];
            exact += weight * weight * noise;
        }
        exact += left[i] * left[i];
        assert!(
            close(found.covariance[i][i], exact, 0.01),
            "{i}: {} {exact}",
            found.covariance[i][i]
        );
    }
    assert!(parts.read().under(|_, _| None).is_none());
    let normalised = parts.read().normalised_theta();
    assert!((0..4).all(|j| close(normalised[j], parts.estimator.theta()[j], 1e-5)));
    assert_eq!(parts.read().known(), [false; 4]);
}

#[test]
fn a_nominal_value_counts_for_a_part_of_the_bound_where_the_data_say_more() {
    let mut parts = Parts::new(filtered(), [1e2; 4], 0.999, 400);
    let bound = parts.forgetting.bound();
    let mut p = [[0.0; 4]; 4];
    let small = 1e-3 * bound;
    p[0][0] = small;
    let eighth = 0.125 * bound;
    // As it was set, or of a prior: one that is wider than the bound leaves itself.
    for (prior, own, whole) in [
        (false, bound, eighth),
        (false, 2.0 * bound, eighth),
        (true, 0.5 * bound, eighth),
        (true, 2.0 * bound, 2.0 * bound),
    ] {
        parts.forgetting.set_own([0.0; 4]);
        parts.forgetting.set_nominal_std(&[0.0; 4]);
        if prior {
            let std = [libm::sqrtf(own), 0.0, 0.0, 0.0];
            parts.forgetting.set_nominal_std(&std);
        } else {
            parts.forgetting.set_own([own, 0.0, 0.0, 0.0]);
        }
        let mut found = [[0.0; 4]; 4];
        parts.read().add_nominal_values(&p, &mut found);
        let expected = own * parts.prior_noise * parts.prior_noise;
        let missing = expected - whole * parts.read().residual();
        let exact = small / whole * (small / whole) * missing;
        assert!(
            missing > 0.0 && close(found[0][0], exact, 1e-3),
            "{prior} {own}: {found:?} {exact}"
        );
    }
}

#[test]
fn scores_know_nothing_of_nominal_values_which_are_added() {
    adds_what_nominal_values_leave(400, 3e4);
    // Without rows a nominal value is all that is known.
    adds_what_nominal_values_leave(0, 1e2);
}

#[test]
fn a_constant_that_is_withdrawn_takes_its_share_of_everything_along() {
    let mut parts = Parts::new(filtered(), [1e2; 4], 1.0, 400);
    // All of it goes: a limit far beyond.
    parts.significance = 1e6;
    let read = parts.read();
    let found = read.estimate();
    assert!(found.theta[3].abs() < 1e-3 * THETA[3]);
    let (p, units) = (parts.estimator.covariances(), parts.regressor.units());
    let of_trends = read.trend_theta();
    for i in 0..3 {
        let moved = of_trends[i] - units[i] * parts.estimator.theta()[i];
        let exact = -units[i] * p[i][3] / p[3][3] * parts.estimator.theta()[3];
        assert!(
            (moved - exact).abs() < 1e-3 * exact.abs() + 1e-5 * THETA[i],
            "{i}: {moved} {exact}"
        );
    }
    let mut known = [[0.0; 4]; 4];
    for i in 0..4 {
        for j in 0..4 {
            known[i][j] = p[i][j] * NOISE;
        }
    }
    // An estimate that comes with its covariance: the same withdrawal.
    let direction = known.map(|row| row[3]);
    let other = read.with_covariance(parts.estimator.theta(), &known, Some(direction), 0.0);
    for i in 0..3 {
        assert!(close(other.theta[i], found.theta[i], 1e-3), "{i}");
    }
    assert!(other.theta[3].abs() < 1e-3 * THETA[3]);
    parts.significance = 0.0;
    let kept = parts
        .read()
        .with_covariance(parts.estimator.theta(), &known, Some(direction), 0.0);
    assert!(close(
        kept.theta[3],
        units[3] * parts.estimator.theta()[3],
        1e-4
    ));
    let floor = parts.read().floor(20.0, &[0.0, 400.0, 20.0], &THETA) * kept.theta[3];
    let exact = known[3][3] * units[3] * units[3] + 1.01 * floor * floor;
    assert!(close(kept.covariance[3][3], exact, 1e-4));
}

#[test]
fn without_a_memory_what_a_prior_says_is_added_where_it_shows() {
    let mut parts = Parts::new(raw(), [1e2; 4], 1.0, 400);
    let residual = parts.read().residual();
    // Twice the variance of the residual was expected.
    parts.prior_noise = libm::sqrtf(2.0 * residual);
    let none = parts.read().estimate().covariance;
    let p = parts.estimator.covariances();
    let units = *parts.regressor.units();
    for k in 0..4 {
        // A thousandth of the prior's variance is what is seen.
        for (share, shows) in [(0.98, true), (1.02, false)] {
            let own = share * 1e3 * p[k][k];
            let mut std = [0.0; 4];
            std[k] = libm::sqrtf(own);
            parts.forgetting.set_nominal_std(&std);
            let found = parts.read().estimate().covariance;
            for i in 0..4 {
                let added = found[i][i] - none[i][i];
                let part = p[i][k] * p[i][k] / own * residual * units[i] * units[i];
                let exact = if shows { part } else { 0.0 };
                assert!(
                    (added - exact).abs() < 1e-5 * none[i][i] + 0.01 * exact,
                    "{k} {i}"
                );
                assert!(i != k || part > 5e-4 * none[i][i]);
            }
        }
    }
}

#[test]
fn the_variance_of_a_constant_is_that_of_the_recursion_without_a_filter() {
    let parts = Parts::new(raw(), [1e2; 4], 1.0, 400);
    let read = parts.read();
    let exact = parts.estimator.covariance(3, 3) * read.residual();
    assert!(exact > 0.0 && close(read.constant_variance(), exact, 1e-5));
}

#[test]
fn a_constant_beyond_its_limit_stays() {
    let mut parts = Parts::new(filtered(), [1e2; 4], 1.0, 400);
    parts.significance = 3.0;
    let found = parts.read().estimate();
    let std = libm::sqrtf(found.covariance[3][3]);
    assert!(found.theta[3].abs() > 10.0 * std, "{std}");
    assert!(close(found.theta[3], THETA[3], 0.05), "{:?}", found.theta);
}
