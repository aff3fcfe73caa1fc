//! Drawn axes whose mass changes in motion: the loop that adapts beside the one with the gains of its commissioning.

use trendid_host_tests::servo::population::changed::{Changed, mass};
use trendid_host_tests::servo::population::draw::AxisDraw;
use trendid_host_tests::servo::population::family::Family;

/// Seeds of usual axes: none was used to tune anything.
const SEEDS: std::ops::RangeInclusive<u64> = 200_001..=200_040;

fn changed(factor: f64, adaptive: bool) -> Vec<Changed> {
    SEEDS
        .filter_map(|seed| {
            mass(
                &AxisDraw::new(Family::Pneumatic, true, seed),
                factor,
                adaptive,
            )
        })
        .collect()
}

fn median(runs: &[Changed], of: impl Fn(&Changed) -> f64) -> f64 {
    let mut values: Vec<f64> = runs.iter().map(of).collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn count(runs: &[Changed], holds: impl Fn(&Changed) -> bool) -> usize {
    runs.iter().filter(|run| holds(run)).count()
}

/// Error in the sine over that before the change.
fn ratio(run: &Changed) -> f64 {
    run.sine_mm[1] / run.sine_mm[0]
}

#[test]
fn a_loop_that_adapts_is_no_worse_than_one_that_does_not() {
    for (factor, ratio_max, stopped_max) in [(3.0, 2.0, 2), (1.0 / 3.0, 3.5, 1)] {
        let (adapts, fixed) = (changed(factor, true), changed(factor, false));
        let stopped = [&adapts, &fixed].map(|runs| count(runs, |run| run.stopped.is_some()));
        let ratios = [&adapts, &fixed].map(|runs| median(runs, ratio));
        let steady = [&adapts, &fixed].map(|runs| median(runs, |run| run.steady_state_mm));
        let calmed = [&adapts, &fixed].map(|runs| count(runs, |run| run.oscillations > 0));
        println!(
            "mass x{factor:.2}: {} axes, adaptive and fixed: sine over that before {ratios:.2?}, steady state {steady:.3?} mm, \
             stopped {stopped:?}, oscillating {calmed:?}",
            adapts.len()
        );
        assert!(adapts.len() >= 36, "accepted: {}", adapts.len());
        assert!(adapts.iter().all(|run| run.blow_mm_s < 50.0), "an end stop");
        assert!(stopped[0] <= stopped_max, "{stopped:?}");
        assert!(
            ratios[0] < ratio_max && ratios[0] <= ratios[1],
            "{ratios:?}"
        );
        assert!(steady[0] <= steady[1], "{steady:?}");
        assert!(stopped[0] + calmed[0] <= stopped[1] + calmed[1]);
    }
}
