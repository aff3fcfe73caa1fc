//! Control that begins with a record, while the position is measured already.

use super::bench::{self, Bench, MODEL, RECORD};
use crate::servo::error::Error;
use crate::servo::motion::{Motion, Setpoint};
use crate::servo::supervision::state::{Reason, State};

#[test]
fn the_measured_motion_goes_on_behind_a_record() {
    for position in [20.0, 200.0, 380.0] {
        let mut bench = Bench::without_a_model(MODEL, &Bench::config());
        bench.motion = Motion::at(position);
        // Long enough for the filter to forget where the bench began.
        for _ in 0..500 {
            let _ = bench.step();
        }
        let before = bench.servo.moves.tracking.motion();
        bench.servo.resume(&RECORD).expect("a record");
        assert_eq!(bench.servo.moves.tracking.motion(), before);
        for _ in 0..500 {
            let (report, y) = bench.step();
            assert!(report.state.is_controlling(), "{:?}", report.state);
            assert!(report.command.abs() < 0.02, "{}", report.command);
            assert!((y - position).abs() < 0.05, "{y}");
        }
        assert_eq!(
            bench.servo.guard.monitors.counters().implausible_readings,
            0
        );
    }
}

#[test]
fn a_model_that_was_installed_is_resumed_from_its_own_record() {
    let mut config = Bench::config();
    config.noise = None;
    // No commissioning has found the noise; one has, finer than the identifier resolves.
    for found in [None, Some(1e-7)] {
        let mut bench = Bench::without_a_model(MODEL, &config);
        bench.servo.install(MODEL).expect("a model");
        let _ = bench.worst(500);
        let mut record = bench.servo.record().expect("a record");
        assert_eq!((record.model, record.noise), (MODEL, 0.0));
        record.noise = found.unwrap_or(record.noise);
        let mut next = Bench::without_a_model(MODEL, &config);
        next.servo.resume(&record).expect("its own record");
        for _ in 0..500 {
            let (report, _) = next.step();
            assert!(report.state.is_controlling(), "{:?}", report.state);
        }
    }
}

#[test]
fn a_record_before_the_first_reading_begins_at_that_reading() {
    let axis = bench::axis();
    let sensor = bench::Code((300.0 / bench::SCALE) as i32);
    let servo = bench::Loop::try_new(&Bench::config(), axis, sensor, bench::Spool(0.0));
    let mut servo = servo.expect("settings");
    servo.resume(&RECORD).expect("a record");
    assert_eq!(servo.move_to(100.0), Err(Error::NotControlling));
    for _ in 0..100 {
        let report = servo.update();
        assert!((report.setpoint.position - 300.0).abs() < 1e-3);
        assert!(report.command.abs() < 0.02, "{}", report.command);
    }
    assert_eq!(servo.moves.tracking.motion().velocity, 0.0);
}

#[test]
fn a_motion_that_nothing_would_come_of_is_refused() {
    let asked = |bench: &mut Bench| [bench.servo.move_to(100.0), bench.servo.oscillate(10.0, 1.0)];
    let refused = [Err(Error::NotControlling); 2];
    let mut bench = Bench::without_a_model(MODEL, &Bench::config());
    assert_eq!(asked(&mut bench), refused);
    bench.servo.commission();
    let _ = bench.step();
    assert_eq!(asked(&mut bench), refused);
    bench.servo.fail(Reason::TravelEnd);
    assert_eq!(asked(&mut bench), refused);
    bench.servo.install(MODEL).expect("a model");
    // Two readings are too few for a motion.
    assert_eq!(asked(&mut bench), refused);
    let _ = bench.worst(100);
    assert_eq!(asked(&mut bench), [Ok(()); 2]);
}

/// A loop on the travel 0 to 400 whose axis stands anywhere, and has been seen there or not.
fn standing(position: f32, seen: bool) -> Bench {
    let mut bench = Bench::without_a_model(MODEL, &Bench::config());
    if !seen {
        let code = bench::Code((position / bench::SCALE) as i32);
        let servo = bench::Loop::try_new(&Bench::config(), bench::axis(), code, bench::Spool(0.0));
        bench.servo = servo.expect("settings");
    }
    bench.motion = Motion::at(position);
    if seen {
        for _ in 0..500 {
            let _ = bench.step();
        }
    }
    bench
}

#[test]
fn an_axis_far_beyond_an_end_is_not_moved() {
    for position in [-5.0, 405.0, 600.0] {
        for asks in [0, 1] {
            let ask = |bench: &mut Bench| match asks {
                0 => bench.servo.install(MODEL),
                _ => bench.servo.resume(&RECORD),
            };
            let mut bench = standing(position, true);
            let refused = ask(&mut bench);
            assert!(matches!(refused, Err(Error::Setting(_))), "{refused:?}");
            assert_eq!(bench.servo.supervisor().state(), State::Idle);
            // Before the first reading nobody knows.
            let mut bench = standing(position, false);
            assert_eq!(ask(&mut bench), Ok(()));
            for _ in 0..300 {
                let (report, y) = bench.step();
                assert_eq!(report.state, State::Failed(Reason::Implausible));
                assert_eq!(report.command, 0.0);
                assert!((y - position).abs() < 0.01, "{y}");
            }
        }
    }
}

#[test]
fn a_commissioning_begins_beyond_an_end_as_well() {
    for position in [-5.0, 405.0] {
        let mut bench = standing(position, false);
        bench.servo.install(MODEL).expect("a model");
        bench.servo.commission();
        for k in 0..1000 {
            let (report, _) = bench.step();
            assert!(report.state.is_commissioning(), "{k}: {:?}", report.state);
            if bench.servo.supervisor().state().is_commissioning() {
                break;
            }
            assert!(k < 999, "it never begins");
        }
    }
}

#[test]
fn an_axis_a_little_beyond_an_end_is_led_back_to_it() {
    for (position, end) in [(-3.0, 0.0), (403.5, 400.0)] {
        for seen in [true, false] {
            let mut bench = standing(position, seen);
            bench.servo.resume(&RECORD).expect("a record");
            let (mut last, mut fastest) = (position, 0.0_f32);
            for k in 0..1500 {
                let (report, y) = bench.step();
                assert!(report.state.is_controlling(), "{:?}", report.state);
                fastest = fastest.max((report.setpoint.position - last).abs() / 1e-3);
                last = report.setpoint.position;
                assert!((y - last).abs() < 1.0, "{k}: {y} for {last}");
            }
            assert_eq!(last, end);
            assert!((bench.motion.position - end).abs() < 0.1);
            // D w / 2.
            assert!(fastest < 45.0, "{fastest}");
            assert_eq!(bench.servo.move_to(200.0), Ok(()));
        }
    }
}

#[test]
fn a_target_waits_until_an_axis_beyond_an_end_is_back() {
    for asks in [true, false] {
        let mut bench = standing(403.0, true);
        bench.servo.install(MODEL).expect("a model");
        for k in 0..2000 {
            if k == 20 {
                let done = if asks {
                    bench.servo.move_to(300.0)
                } else {
                    // At the end there is no room for a sine.
                    assert!(bench.servo.oscillate(1.0, 1.0).is_err());
                    bench.servo.oscillate(0.0, 1.0)
                };
                assert_eq!(done, Ok(()));
            }
            let (report, y) = bench.step();
            assert!((y - report.setpoint.position).abs() < 2.0, "{k}: {y}");
        }
        let target = if asks { 300.0 } else { 400.0 };
        let Setpoint { position, .. } = bench.step().0.setpoint;
        assert!((position - target).abs() < 1e-3, "{position}");
    }
}
