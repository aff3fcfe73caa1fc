//! The rest in which a commissioning begins, sample by sample.

use crate::servo::motion::{Motion, Travel};
use crate::servo::servo_loop::takeover::Halt;
use crate::servo::supervision::state::{Reason, State};
use crate::servo::tests::bench::{Bench, MODEL, SCALE};

/// In a move from 200 to 390, at 100 per s at least.
fn moving() -> Bench {
    let mut bench = Bench::new(MODEL);
    let _ = bench.worst(1500);
    bench.servo.move_to(390.0).expect("a target");
    while bench.motion.velocity < 100.0 {
        let _ = bench.worst(1);
    }
    bench
}

/// A loop without control, on an axis at rest that shall be commissioned.
fn idle() -> Bench {
    let mut bench = Bench::without_a_model(MODEL, &Bench::config());
    for _ in 0..200 {
        let _ = bench.step();
    }
    bench
}

#[test]
fn the_reference_is_stopped_once_and_by_the_limits_of_motion() {
    let mut bench = moving();
    bench.servo.commission();
    let mut alone = bench.servo.moves.trajectory.clone();
    let mut followed = bench.servo.moves.followed.clone();
    let middles = bench.servo.commissioning.middles();
    assert!(!alone.is_finished());
    alone.stop(&middles);
    let mut k = 0_u32;
    while !alone.is_finished() {
        let (report, _) = bench.step();
        assert_eq!(report.state, State::Exciting, "{k}");
        let newest = alone.update();
        assert_eq!(bench.servo.moves.trajectory.setpoint(), newest, "{k}");
        assert_eq!(report.setpoint, followed.pass(newest), "{k}");
        // What waits for a reference that still moves has waited for a sample.
        assert_eq!(bench.servo.takeover.halt.since, 1, "{k}");
        k += 1;
    }
    assert!(k > 20, "{k}");
    // It ends within the places that have room: at 0.72 of the travel.
    let Motion { position, .. } = alone.update().motion();
    assert!((200.0..288.1).contains(&position), "{position}");
}

#[test]
fn an_axis_stands_when_it_has_stayed_about_a_place_for_the_whole_time() {
    let mut bench = idle();
    let most = bench.servo.guard.monitors.bounds().stop.closing;
    // A swing behind the closed valve and the delay of 3 ms end within 3/w.
    let time = 3e-3 + 3.0 / bench.servo.guard.monitors.bounds().frequency;
    assert!((1e-3 * most as f32 - time).abs() < 1.1e-3, "{most} {time}");
    for (since, stood, waits) in [
        (1, most, false),
        (1, most - 1, true),
        (12 * most, 0, false),
        (12 * most - 1, 0, true),
    ] {
        bench.servo.takeover.halt = Halt {
            since,
            stood,
            place: bench.servo.sensed.position,
        };
        assert_eq!(bench.servo.comes_to_rest(), waits, "{since} {stood}");
        if !waits {
            assert_eq!(bench.servo.takeover.halt.since, 0, "the next one is new");
        }
    }
    // A way within what a creep has in that time, and three grains of the sensor, is none.
    let creep = bench.servo.config.creep();
    assert!(creep > 0.0);
    for grains in [0.0, 2e-2] {
        bench.servo.config.noise = Some(grains);
        let slip = creep * 1e-3 * most as f32 + 3.0 * (SCALE + 2.0 * grains);
        for (share, stood) in [(0.98, 6), (-0.98, 6), (1.02, 0), (-1.02, 0)] {
            bench.servo.sensed.position = 200.0 + share * slip;
            bench.servo.takeover.halt = Halt {
                since: 1,
                stood: 5,
                place: 200.0,
            };
            assert!(bench.servo.comes_to_rest());
            let halt = bench.servo.takeover.halt;
            assert_eq!((halt.since, halt.stood), (2, stood), "{grains} {share}");
            let place = if stood == 0 {
                bench.servo.sensed.position
            } else {
                200.0
            };
            assert_eq!(halt.place, place, "{grains} {share}");
        }
    }
}

#[test]
fn what_is_asked_for_no_more_is_reported_no_more() {
    let mut bench = moving();
    bench.servo.abort();
    let _ = bench.step();
    bench.servo.commission();
    assert_eq!(bench.step().0.state, State::Exciting);
    assert!(bench.servo.takeover.halt.since > 0);
    bench.servo.abort();
    assert_eq!(bench.step().0.state, State::Idle);
    // Asked for anew it begins anew; asked for again it goes on.
    bench.servo.takeover.halt.stood = 7;
    bench.servo.commission();
    assert_eq!(bench.servo.takeover.halt.since, 0);
    let _ = bench.step();
    let since = bench.servo.takeover.halt.since;
    assert!(since > 0);
    bench.servo.commission();
    assert_eq!(bench.servo.takeover.halt.since, since);
}

#[test]
fn a_place_without_room_is_left_before_a_commissioning_and_not_without_control() {
    let near_the_end = |controls: bool| {
        let mut bench = Bench::new(MODEL);
        let _ = bench.worst(1500);
        bench.servo.move_to(390.0).expect("a target");
        let _ = bench.worst(5000);
        if !controls {
            bench.servo.abort();
            let _ = bench.step();
        }
        bench.servo.commission();
        let _ = bench.step();
        bench.servo.supervisor().state().is_commissioning()
    };
    assert!(!near_the_end(true) && near_the_end(false));
    let Travel { min, max } = idle().servo.commissioning.middles();
    assert!(min > 100.0 && max < 300.0, "{min} {max}");
}

#[test]
fn a_sign_that_is_stated_or_of_a_verified_model_is_known_to_a_commissioning() {
    let ends = |reversed: Option<bool>, installs: bool| {
        let mut config = Bench::config();
        config.reversed = reversed;
        let mut bench = Bench::without_a_model(MODEL, &config);
        if installs {
            bench.servo.install(MODEL).expect("a model");
            let _ = bench.worst(1500);
        }
        bench.servo.commission();
        let _ = bench.step();
        // The valve opens the other way.
        bench.sign = -1.0;
        for _ in 0..20_000 {
            if let State::Failed(reason) = bench.step().0.state {
                return Some(reason);
            }
        }
        None
    };
    assert_eq!(ends(None, false), None);
    assert_eq!(ends(Some(false), false), Some(Reason::WrongSign));
    assert_eq!(ends(None, true), Some(Reason::WrongSign));
}

#[test]
fn a_commissioning_that_is_asked_for_again_gives_up_the_one_under_way() {
    let mut bench = idle();
    bench.servo.commission();
    let moves = (0..2000).any(|_| bench.step().0.command != 0.0 && bench.motion.velocity > 50.0);
    assert!(moves && bench.servo.supervisor().state().is_commissioning());
    bench.servo.commission();
    // The valve closes, and the next one begins at rest.
    let mut waited = 0;
    loop {
        let (report, _) = bench.step();
        assert_eq!(report.state, State::Exciting, "{waited}");
        if bench.servo.supervisor().state().is_commissioning() {
            break;
        }
        waited += 1;
        assert!(waited < 10 || report.command == 0.0, "{waited}");
    }
    assert!((50..1000).contains(&waited), "{waited}");
    let slow = bench.servo.config.min_speed();
    assert!(bench.motion.velocity.abs() < 0.5 * slow && slow < 25.0);
}
