//! Drawn axes that take a load and put it down, every three seconds: the loop that adapts beside
//! the one with the gains of its commissioning.

use trendid_host_tests::servo::population::draw::AxisDraw;
use trendid_host_tests::servo::population::family::Family;
use trendid_host_tests::servo::population::handling::{Handling, handle};
use trendid_host_tests::servo::population::summary::quantile;

/// The first seed of the usual axes: none was used to tune anything.
const FIRST: u64 = 200_001;

fn handled(family: Family, factor: f64, axes: u64) {
    let runs = [true, false].map(|adaptive| -> Vec<Handling> {
        (FIRST..FIRST + axes)
            .filter_map(|seed| handle(&AxisDraw::new(family, true, seed), factor, adaptive))
            .collect()
    });
    let figures = |of: fn(&Handling) -> f64| {
        runs.each_ref()
            .map(|runs| quantile(&runs.iter().map(of).collect::<Vec<_>>(), 0.5))
    };
    let count = |holds: fn(&Handling) -> bool| {
        let holding = |runs: &Vec<Handling>| runs.iter().filter(|run| holds(run)).count();
        runs.each_ref().map(holding)
    };
    let empty = figures(|run| run.errors_mm[0][0]);
    let way = figures(|run| run.errors_mm[1][0]);
    let stay = figures(|run| run.errors_mm[1][1]);
    let stopped = count(|run| run.course.stopped.is_some());
    println!(
        "{family:?}, a load of x{factor:.2} that comes and goes: {} axes, adaptive and fixed: largest error on the way {way:.2?} mm, {empty:.2?} mm without it, \
         where it stays {stay:.3?} mm, oscillating {:?}, stopped {stopped:?}",
        runs[0].len(),
        count(|run| run.course.oscillations > 0)
    );
    assert!(10 * runs[0].len() >= 9 * axes as usize, "accepted");
    let struck = count(|run| run.course.blow_mm_s > 50.0);
    assert_eq!(struck[0], 0, "end stops: {struck:?}");
    assert!(stopped[0] <= stopped[1], "{stopped:?}");
    assert!(way[0] <= way[1], "{way:?}");
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn a_load_that_comes_and_goes_is_carried() {
    handled(Family::Linear, 1.732, 20);
}

#[test]
#[ignore = "long: cargo xtask statistics"]
fn a_load_that_comes_and_goes_is_carried_no_worse_than_with_fixed_gains() {
    for (family, axes) in [(Family::Pneumatic, 60), (Family::Linear, 40)] {
        for factor in [1.732, 3.0] {
            handled(family, factor, axes);
        }
    }
    handled(Family::Hydraulic, 1.732, 40);
}
