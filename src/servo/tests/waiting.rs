//! What waits for a sample that has the time for it.

use super::*;
use crate::identifier::Outcome;
use crate::servo::commissioning::Found;
use crate::servo::design::TuningDesign;
use crate::servo::design::constants::DELAY_MAX;
use crate::servo::identification::look;
use crate::servo::motion::Setpoint;
use crate::servo::supervision::event::Spare;

/// A loop that adapts, in a motion that it does not follow.
fn astray() -> Bench {
    let mut bench = Bench::adaptive(MODEL);
    bench.servo.oscillate(30.0, 1.0).expect("a sine");
    let _ = bench.worst(700);
    assert_eq!(bench.servo.supervisor().state(), State::Adapting);
    bench.model = Model { b0: 0.3e6, ..MODEL };
    bench
}

/// A sample with a target of its own.
fn asked(bench: &mut Bench, k: u32) {
    let target = if (k / 500).is_multiple_of(2) {
        220.0
    } else {
        180.0
    };
    bench.servo.move_to(target).expect("a target");
    let _ = bench.step();
}

#[test]
fn targets_in_every_sample_leave_time_for_the_search_for_poles() {
    let mut bench = Bench::new(MODEL);
    let _ = bench.worst(100);
    bench.servo.takeover.unsearched = Some(MODEL);
    for k in 0..8000 {
        asked(&mut bench, k);
    }
    assert!(!bench.servo.takeover.is_searching());
}

#[test]
fn targets_in_every_sample_leave_time_for_candidates() {
    let mut bench = astray();
    let (mut looked, mut compared) = (false, false);
    for k in 0..2000 {
        asked(&mut bench, k);
        looked |= bench.servo.takeover.looked.is_some();
        compared |= !bench.servo.supervisor().comparison.rests();
    }
    assert!(looked && compared);
}

#[test]
fn a_look_at_what_is_no_longer_makes_no_candidate() {
    let mut bench = astray();
    bench.servo.takeover.looked = Some(look(bench.servo.identifier()));
    bench
        .servo
        .install(MODEL)
        .expect("a model that may control");
    assert_eq!(bench.servo.takeover.looked, None);
    // Behind a change of the drive, in samples without time.
    let mut bench = astray();
    bench.servo.takeover.looked = Some(look(bench.servo.identifier()));
    let outcome = Outcome::Estimated { innovation: 5.0 };
    for _ in 0..100 {
        let y = bench.motion.position;
        let _ = bench
            .servo
            .supervise(&Setpoint::at(y), y, false, 0.0, outcome, Spare::Nothing);
    }
    assert_eq!(bench.servo.takeover.looked, None);
}

#[test]
fn a_sample_in_which_other_gains_come_into_force_has_no_time_to_think() {
    let mut bench = Bench::new(MODEL);
    let _ = bench.worst(1500);
    assert_eq!(bench.servo.spare(), Spare::Thought);
    let slow = Tuning::slowest(bench.servo.controller.tuning_design(), &MODEL);
    bench.servo.controller.replace_poles(slow, None);
    assert_eq!(bench.servo.spare(), Spare::Step);
    let _ = bench.worst(2);
    assert_eq!(bench.servo.spare(), Spare::Thought);
}

#[test]
fn the_search_behind_a_commissioning_is_one_for_what_it_found_and_ends_with_poles_that_hold() {
    // In whole samples, and no more of them than a controller remembers.
    for (delay, samples) in [(0.0, 0), (2.4e-3, 2), (2.6e-3, 3), (1.0, DELAY_MAX)] {
        let mut bench = Bench::without_a_model(MODEL, &Bench::config());
        let found = Found {
            model: MODEL,
            delay,
            sign: 1.0,
            noise: 2e-4,
            dead_volume: f32::INFINITY,
            imbalance: 0.0,
        };
        let design = TuningDesign {
            sample_time: 1e-3,
            delay: 1e-3 * samples as f32,
            dead_volume: f32::INFINITY,
            noise: 2e-4,
            bandwidth_max: f32::INFINITY,
        };
        let mut alone = Tuning::new(&design, &MODEL);
        while !(alone.step() || alone.has_some()) {}
        let poles = |bench: &Bench| {
            bench
                .servo
                .takeover
                .tuning
                .as_ref()
                .map(|t| t.tuning.poles())
        };
        // The sample that finds them says so.
        let mut calls = 0;
        loop {
            bench.servo.search_poles(&found, 1);
            if bench.servo.has_poles(&found) {
                break;
            }
            assert_ne!(poles(&bench), Some(alone.poles()), "{delay}");
            calls += 1;
            assert!(calls < 20_000, "{delay}");
        }
        // What is faster is for control: nothing more of it before.
        for _ in 0..3000 {
            bench.servo.search_poles(&found, 6);
            assert!(bench.servo.has_poles(&found));
            assert_eq!(poles(&bench), Some(alone.poles()), "{delay}");
        }
        // Another model begins anew.
        let other = Found {
            model: Model { a2: 21.0, ..MODEL },
            ..found
        };
        assert!(!bench.servo.has_poles(&other));
        bench.servo.search_poles(&other, 6);
        assert!(!bench.servo.has_poles(&found) && !bench.servo.has_poles(&other));
    }
}
