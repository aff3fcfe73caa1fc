//! What waits for a sample that has the time for it.

use super::*;
use crate::identifier::Outcome;
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
