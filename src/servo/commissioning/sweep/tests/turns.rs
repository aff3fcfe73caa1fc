//! What turns an axis, and what a model changes.

use super::*;

#[test]
fn an_axis_that_leaves_the_band_turns_and_one_that_nears_an_end_by_much() {
    for side in [1.0, -1.0] {
        // Half a period of 0.1 s: 60 ms ahead for the band, 75 ms for the ends.
        for (place, v, turns, by_much) in [
            (0.2, 0.0, true, false),
            (0.14, 0.0, false, false),
            (0.14, 0.3, true, false),
            (0.44, 0.05, true, false),
            (0.44, 0.2, true, true),
        ] {
            let mut sweep = Sweep::new(0.5, 0.1, 0.03, LIMIT, 0);
            sweep.inform(0.1, 0.03, 0.01);
            (sweep.level, sweep.left) = (0.3 * side, 1.0);
            let mut tested = sweep;
            let command = side * sweep.update(0.5 + side * place, side * v, 0.0, STEP);
            assert_eq!(command < 0.0, turns, "{side} {place} {v}");
            let size = -command - 0.01 * side;
            let much = (size - 0.7 * LIMIT).abs() < 1e-6;
            assert_eq!(much, by_much, "{side} {place} {v}: {size}");
            // The way in which it is tested is kept, and so is one that leads inwards.
            tested.tests = true;
            let kept = tested.update(0.5 + side * place, side * v, 0.0, STEP);
            assert_eq!(kept, 0.3 * side);
            (tested.level, tested.tests) = (-0.3 * side, false);
            let kept = tested.update(0.5 + side * place, side * v, 0.0, STEP);
            assert_eq!(kept, -0.3 * side);
        }
    }
}

#[test]
fn a_model_sets_time_and_valve_of_the_levels() {
    let mut sweep = Sweep::new(0.5, 0.1, 0.03, LIMIT, 0);
    assert_eq!(sweep.half(), 0.1);
    sweep.inform(0.4, 0.1, 0.02);
    assert_eq!(sweep.half(), 0.4);
    for sign in [1.0, -1.0] {
        sweep.next(sign, 0.0);
        let flow = sign * (sweep.level + 0.02) - 0.1;
        assert!((0.05..=1.5 * 0.14).contains(&flow), "{flow}");
        let holds = sweep.left / 0.4;
        assert!((0.2..=0.9).contains(&holds), "{holds}");
    }
}

#[test]
fn a_level_that_proves_moves_what_stays_the_same_way_for_a_period_whatever_it_swings() {
    for side in [1.0, -1.0] {
        let mut sweep = Sweep::new(0.5, 0.1, 0.03, LIMIT, 0);
        sweep.pushes([0.3, 0.4]);
        (sweep.level, sweep.left) = (0.1 * side, 0.02);
        sweep.prove();
        let least = if side > 0.0 { 0.3 } else { 0.4 };
        let level = sweep.level;
        assert!(side * level >= least, "{level}");
        // A swing of half the travel, which is calmed otherwise.
        let w = core::f32::consts::PI / 0.1;
        let swung = 0.5 * w * w;
        let held = (0..1000).take_while(|_| {
            let command = sweep.update(0.5, 0.0, swung, STEP);
            sweep.proves() && command == level
        });
        let samples = held.count();
        assert!((198..=200).contains(&samples), "{samples}");
        assert!(sweep.update(0.5, 0.0, swung, STEP) < 0.0 && !sweep.proves());
        // What leaves the band turns all the same, and that proves nothing.
        let mut turned = sweep;
        turned.level = side * 0.1;
        turned.prove();
        assert!(side * turned.update(0.5 + side * 0.2, 0.0, 0.0, STEP) < 0.0);
        assert!(!turned.proves());
    }
}
