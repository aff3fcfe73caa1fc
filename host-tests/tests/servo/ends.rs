//! Drawn axes at the ends of their travel: what a commissioning that begins there does.

use trendid_host_tests::random::Random;
use trendid_host_tests::servo::population::adaptive::LoopPositioner;
use trendid_host_tests::servo::population::bench::Bench;
use trendid_host_tests::servo::population::draw::AxisDraw;
use trendid_host_tests::servo::population::family::Family;
use trendid_host_tests::servo::population::range::Purpose;

use rand::{RngExt, SeedableRng};

/// The first seed of the usual axes: none was used to tune anything.
const FIRST: u64 = 200_001;

/// Largest distance from an end over the travel: beyond it the population begins.
const NEAR: f64 = 0.08;

/// Blow to an end that counts \[mm/s\].
const BLOW: f64 = 50.0;

/// What came of the commissionings of so many axes.
#[derive(Debug, Default)]
struct Commissionings {
    accepted: usize,
    wrong_sign: usize,
    struck: usize,
    hardest: f64,
}

/// Commissions axes from the places that `share` gives for their seeds.
fn commissioned(family: Family, axes: u64, share: impl Fn(u64) -> f64) -> Commissionings {
    let mut seen = Commissionings::default();
    for seed in FIRST..FIRST + axes {
        let axis = AxisDraw::new(family, true, seed).starting_at(share(seed));
        let mut bench = Bench::new(&axis, Purpose::Disturbance);
        let mut positioner = LoopPositioner::new(&axis, true).expect("settings");
        let found = positioner.commission(&mut bench);
        seen.accepted += usize::from(found.verified_s.is_some());
        seen.wrong_sign += usize::from(found.wrong_sign);
        seen.struck += usize::from(bench.blow_mm_s > BLOW);
        if bench.blow_mm_s > BLOW {
            println!("{family:?}, seed {seed}: {:.0} mm/s", bench.blow_mm_s);
        }
        seen.hardest = seen.hardest.max(bench.blow_mm_s);
    }
    seen
}

/// One end or the other.
fn end(seed: u64) -> f64 {
    (seed % 2) as f64
}

/// A place near one of the ends.
fn near(seed: u64) -> f64 {
    let away = NEAR * Random::seed_from_u64(seed).random::<f64>();
    if seed.is_multiple_of(2) {
        away
    } else {
        1.0 - away
    }
}

fn from_the_stops(family: Family, axes: u64) {
    let seen = commissioned(family, axes, end);
    println!("{family:?}, {axes} axes on a stop: {seen:?}");
    assert_eq!(seen.wrong_sign, 0, "{seen:?}");
    assert!(seen.struck <= axes as usize / 12, "{seen:?}");
    let refused = axes as usize - seen.accepted;
    assert!(refused <= 1 + axes as usize / 6, "{seen:?}");
}

#[test]
fn an_axis_on_a_stop_commissions_itself_without_a_blow() {
    for family in Family::ALL {
        from_the_stops(family, 4);
    }
}

#[test]
#[ignore = "long: cargo xtask statistics"]
fn axes_at_their_ends_commission_themselves() {
    for family in Family::ALL {
        from_the_stops(family, 60);
        let seen = commissioned(family, 60, near);
        println!("{family:?}, 60 axes within {NEAR} of an end: {seen:?}");
        assert!(seen.struck <= 5 && seen.wrong_sign == 0, "{seen:?}");
        assert!(seen.accepted >= 53, "{seen:?}");
    }
}
