//! What a model may be wrong by without being another one.

use super::*;
use crate::servo::supervision::validation::Sums;

#[test]
fn what_a_dead_zone_may_hide_is_the_flow_of_half_of_it() {
    // Of 1600 units per s for 1/25 s.
    for dead_zone in [0.0, 0.05, 0.2] {
        let model = Model {
            dead_zone,
            friction: 40.0,
            ..MODEL
        };
        let (found, exact) = (unknown(&model), 0.5 * dead_zone * 1600.0 / 25.0);
        assert!((found - exact).abs() < 1e-5, "{found}, not {exact}");
    }
}

#[test]
#[cfg_attr(miri, ignore = "many samples")]
fn a_window_counts_by_what_its_errors_exceed_of_dead_zone_and_drift() -> Result<(), Error> {
    let mut supervisor = installed()?;
    supervisor.enter(State::Adapting);
    // 4 units by the dead zone, one by drift.
    let used = Model {
        b0: 120.0 * MODEL.a1,
        dead_zone: 8.0 * 25.0 / 120.0,
        ..MODEL
    };
    supervisor.verified_model = Some(used);
    (supervisor.design.drift, supervisor.design.min_travel) = (1.0, 0.1);
    supervisor.window_due = true;
    let mut motion = Motion {
        position: 200.0,
        ..Motion::default()
    };
    for k in 0..5000 {
        let seen = step(&mut motion, &used, k);
        let before = supervisor.window.clone();
        assert_eq!(supervisor.compare(&seen), Event::None);
        if let (Some(mut window), None) = (before, &supervisor.window) {
            assert!(window.update(seen.flow, seen.y));
            let sums = window.sums(0.1, 5.0).expect("it moves");
            let evidence = |sums: &Sums| {
                let mut evidence = Evidence::NONE;
                evidence.add(sums);
                evidence
            };
            assert_eq!(supervisor.evidence, evidence(&sums));
            let all = Sums {
                hidden: 0.0,
                ..sums
            };
            assert_ne!(supervisor.evidence, evidence(&all));
            return Ok(());
        }
    }
    panic!("a window has an end");
}
