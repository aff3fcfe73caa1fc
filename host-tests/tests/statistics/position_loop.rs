//! The adaptive position loop over many seeds: faults, changes in motion, readings that fail.

use trendid_host_tests::servo::bridging::{SINE_MAX_MM, error_with_failing_readings};
use trendid_host_tests::servo::population::summary::quantile;
use trendid_host_tests::servo::run::{Options, run};
use trendid_host_tests::servo::scenario::Scenario;

#[test]
#[ignore = "long: cargo xtask statistics"]
fn faults_are_refused_for_the_right_reason_and_the_gains_are_kept() {
    for scenario in Scenario::ALL.into_iter().filter(|s| s.expected().is_some()) {
        for seed in 4001..=4100 {
            let figures = run(scenario, &Options::adaptive(seed), &mut |_, _| {});
            assert!(
                figures.refused_rightly(),
                "{} seed {seed}: {}",
                scenario.name(),
                figures.state
            );
            assert_eq!(figures.gains_kept, Some(true), "{} {seed}", scenario.name());
        }
    }
}

/// Four changes, 25 seeds of each. Wanted after a change is what `Figures::outside` lists: one and
/// a half times the figures of the nominal axis, within 2 s. Forty-seven of these 100 runs reach
/// all of it, so that it is printed and not demanded; demanded is that no run is given up, and that
/// each stands where it should in the end, and follows.
#[test]
#[ignore = "long: cargo xtask statistics"]
fn changes_in_motion_are_survived_in_every_run() {
    let mut outside = Vec::new();
    let (mut steady, mut sine) = (0.0_f64, 0.0_f64);
    for scenario in Scenario::ALL.into_iter().filter(|s| s.is_change()) {
        for seed in 3001..=3025 {
            let f = run(scenario, &Options::adaptive(seed), &mut |_, _| {});
            let missed = f.outside();
            if !missed.is_empty() {
                outside.push(format!("{} seed {seed}: {missed:?}", scenario.name()));
            }
            assert!(f.state.is_controlling(), "{} {seed}", scenario.name());
            steady = steady.max(f.steady_state_mm.unwrap_or(f64::INFINITY));
            sine = sine.max(f.tracking_1hz_mm.unwrap_or(f64::INFINITY));
        }
    }
    println!("seeds 3001 to 3025, outside: {outside:#?}");
    println!(
        "{} of 100 outside; worst steady state {steady:.3} mm, worst at 1 Hz {sine:.2} mm",
        outside.len()
    );
    assert!(steady < 1.0 && sine < 5.0, "{steady} mm, {sine} mm");
}

/// Median, 90 % and 99 % of the sine of 0.5 Hz in mm: within the limits of a sensor that never
/// fails (`nominal` of the tests of the servo). The worst of some draws says more of how many they
/// are: of 400 draws 2 % are beyond 1.05 mm.
#[test]
#[ignore = "long: cargo xtask statistics"]
fn readings_that_fail_now_and_then_are_bridged() {
    let sines: Vec<f64> = (2001..=2200).map(error_with_failing_readings).collect();
    let found = [0.5, 0.9, 0.99].map(|part| quantile(&sines, part));
    println!("0.5 Hz {found:.3?} mm");
    let within = found.iter().zip(SINE_MAX_MM).all(|(x, most)| *x <= most);
    assert!(within, "{found:?} mm");
}
