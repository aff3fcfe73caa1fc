//! Accuracy of the core in the rows of Table 1, against its limits, the bound and the extended
//! Kalman filter.
//!
//! `trendid paper table1` prints the whole table; these rows hold the figures it must not lose.
//! Seeds differ from those that chose the filter (below 60000) and from the table's own (100000).

use trendid::trends::Scheme;
use trendid_host_tests::paper::statistics::{Line, summary};
use trendid_host_tests::paper::trial::{Filter, Method, Setting, trial};
use trendid_host_tests::signals::noise::Reading;

const FIRST: u64 = 200_000;

fn core(filter: Filter) -> Method {
    Method::Core {
        scheme: Scheme::Tustin,
        filter,
        compensated: !matches!(filter, Filter::None | Filter::Span),
    }
}

fn lines(setting: &Setting, duration_s: f64, seeds: u64, methods: &[Method]) -> Vec<Line> {
    let trials: Vec<_> = (FIRST..FIRST + seeds)
        .map(|seed| trial(setting, duration_s, seed, methods))
        .collect();
    let lines = summary(setting, duration_s, methods, &trials);
    for line in &lines {
        println!("{}", line.csv());
    }
    lines
}

fn rows(reading: Reading, vary: &str) -> Vec<Setting> {
    let mut rows = Setting::all(reading);
    rows.retain(|s| s.vary == vary);
    rows
}

#[test]
#[ignore = "long: cargo xtask statistics"]
fn absolute_noise_rows_within_their_limits_and_settled_in_time_by_default() {
    for (setting, settled_ms) in
        rows(Reading::Absolute, "noise")
            .iter()
            .zip([100.0, 180.0, f64::INFINITY, 350.0])
    {
        let line = lines(setting, 0.5, 100, &[Method::DEFAULT])[0];
        assert_eq!(line.beyond(), Some([false; 3]), "{line:?}");
        assert!(line.settled_p95_ms <= Some(settled_ms), "{line:?}");
        assert_eq!(line.diverged, 0);
    }
}

#[test]
#[ignore = "long: cargo xtask statistics"]
fn absolute_white_noise_within_the_limits_by_default() {
    for setting in rows(Reading::Absolute, "white") {
        let line = lines(&setting, 0.5, 100, &[Method::DEFAULT])[0];
        assert_eq!(line.beyond(), Some([false; 3]), "{line:?}");
    }
}

#[test]
#[ignore = "long: cargo xtask statistics"]
fn absolute_resolution_and_sampling_within_a_tenth_of_the_paper_by_default() {
    for vary in ["resolution", "sampling"] {
        for setting in rows(Reading::Absolute, vary) {
            let line = lines(&setting, 0.5, 100, &[Method::DEFAULT])[0];
            assert_eq!(line.beyond(), Some([false; 3]), "{line:?}");
        }
    }
}

#[test]
#[ignore = "long: cargo xtask statistics"]
fn absolute_drift_within_a_tenth_of_the_paper_with_the_drift_in_the_model() {
    for setting in rows(Reading::Absolute, "drift") {
        let line = lines(&setting, 0.5, 100, &[core(Filter::Ramp)])[0];
        assert_eq!(line.beyond(), Some([false; 3]), "{line:?}");
    }
}

#[test]
#[ignore = "long: cargo xtask statistics"]
fn relative_white_noise_near_the_bound() {
    for setting in rows(Reading::Relative, "white") {
        let line = lines(&setting, 3.0, 100, &[Method::DEFAULT])[0];
        assert_eq!(line.diverged, 0);
        for i in 0..3 {
            assert!(line.of_bound()[i] <= 1.5, "{line:?}");
            assert!(line.median_pct[i] <= line.bound_pct[i], "{line:?}");
        }
    }
}

#[test]
#[ignore = "long: cargo xtask statistics"]
fn relative_white_noise_better_than_a_kalman_filter_that_knows_its_level() {
    for setting in rows(Reading::Relative, "white") {
        let lines = lines(&setting, 1.0, 300, &[Method::DEFAULT, Method::Kalman]);
        assert_eq!(lines[0].diverged, 0);
        for i in 0..3 {
            assert!(lines[0].rms_pct[i] < lines[1].rms_pct[i], "{lines:?}");
        }
    }
}

#[test]
#[ignore = "long: cargo xtask statistics"]
fn raw_trends_fail_under_noise_and_the_table_says_so() {
    let setting = rows(Reading::Absolute, "white")[1];
    let lines = lines(&setting, 0.5, 100, &[core(Filter::None), Method::DEFAULT]);
    for i in 0..3 {
        assert!(lines[0].median_pct[i] > 100.0 * lines[1].median_pct[i]);
    }
}
