//! What a model may be wrong by without being another one.

use super::*;

#[test]
fn what_friction_and_dead_zone_may_hide_is_half_of_what_they_hold_or_a_flow_that_none_is_known_to()
{
    // 40 units per s^2 on a stiffness of 625, and 0.12 and 0.03 of 1600 units per s for 1/25 s.
    let (friction, dead_zone) = (0.5 * 40.0 / 625.0, 0.5 * 0.12 * 1600.0 / 25.0);
    let narrow = 0.03 * 1600.0 / 25.0;
    let model = |friction, dead_zone| Model {
        friction,
        dead_zone,
        ..MODEL
    };
    for (model, exact) in [
        (model(0.0, 0.0), narrow),
        (model(40.0, 0.05), friction + narrow),
        (model(0.0, 0.12), dead_zone),
        (model(40.0, 0.12), friction + dead_zone),
    ] {
        let found = unknown(&model);
        assert!((found - exact).abs() < 1e-5, "{found}, not {exact}");
    }
}

#[test]
fn a_window_counts_by_its_motion_over_what_friction_and_drift_hide() -> Result<(), Error> {
    let mut supervisor = installed()?;
    supervisor.enter(State::Adapting);
    // 4 units by friction, 0.144 by the flow, one by drift.
    let used = Model {
        b0: 120.0 * MODEL.a1,
        friction: 8.0 * MODEL.a1,
        ..MODEL
    };
    supervisor.verified_model = Some(used);
    (supervisor.design.drift, supervisor.design.min_travel) = (1.0, 0.1);
    supervisor.comparison = Comparison::Begins;
    let mut motion = Motion::at(200.0);
    for k in 0..5000 {
        let seen = step(&mut motion, &used, k);
        let before = supervisor.running().cloned();
        assert_eq!(supervisor.compare(&seen), Event::None);
        if let (Some(mut window), None) = (before, supervisor.running()) {
            assert!(window.is_over());
            while !window.explain() {}
            let sums = window.sums(0.1, 5.144, 1.0).expect("it moves");
            assert!((0.2..0.8).contains(&sums.weight), "{sums:?}");
            let mut expected = Evidence::NONE;
            expected.add(&sums);
            assert_eq!(supervisor.evidence, expected);
            return Ok(());
        }
    }
    panic!("a window has an end");
}
