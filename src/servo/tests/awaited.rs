//! Control that waits until the readings show the motion of the axis.

use super::bench::{self, Bench, MODEL, RECORD};
use super::*;
use crate::servo::motion::Motion;

/// Where the axis is when its first reading comes, and how fast.
const BEGIN: f32 = 100.0;
const SPEED: f32 = 100.0;

/// A model is installed before the first reading.
fn awaiting() -> Bench {
    let mut bench = Bench::without_a_model(MODEL, &Bench::config());
    let code = bench::Code((BEGIN / bench::SCALE) as i32);
    let servo = bench::Loop::try_new(&Bench::config(), bench::axis(), code, bench::Spool(0.0));
    bench.servo = servo.expect("settings");
    bench.servo.install(MODEL).expect("a model");
    bench
}

/// An axis that goes on at its speed, whatever the valve does, in its sample `k`.
const fn at(k: u32) -> Motion {
    Motion {
        position: BEGIN + 1e-3 * SPEED * k as f32,
        velocity: SPEED,
        acceleration: 0.0,
    }
}

#[test]
fn readings_that_are_missing_while_the_motion_is_awaited_leave_it_as_it_is() {
    for of in [u32::MAX, 10, 5, 3] {
        for mute in [true, false] {
            let mut bench = awaiting();
            for k in 0.. {
                bench.motion = at(k);
                let gone = k > 5 && k % of == 0;
                if gone && !mute {
                    let _ = bench.miss();
                } else {
                    bench.is_mute = gone;
                    let (report, y) = bench.step();
                    assert_eq!(report.command, 0.0, "{of} {k}");
                    let off = (report.position - y).abs();
                    assert!(off < 0.05, "{of} {mute} {k}: {off}");
                }
                if !bench.servo.awaits_motion() {
                    break;
                }
                // Until then nothing takes over.
                let observed = bench.servo.controller.motion();
                assert_eq!(observed.velocity, 0.0, "{of} {k}");
                assert!(k < 100, "control never begins");
            }
            // With the newest sample.
            let motion = bench.servo.controller.motion();
            assert_eq!(motion.position, bench.servo.sensed.position);
            assert!((motion.velocity - SPEED).abs() < 5.0, "{of}: {motion:?}");
        }
    }
}

#[test]
fn another_model_begins_no_sooner_with_a_motion_that_is_awaited() {
    let samples = |bench: &mut Bench, from: u32| {
        for k in from.. {
            bench.motion = at(k);
            let (report, _) = bench.step();
            assert_eq!(report.command, 0.0, "{k}");
            if !bench.servo.awaits_motion() {
                return k - from;
            }
        }
        0
    };
    for resumes in [false, true] {
        let mut bench = awaiting();
        for k in 0..15 {
            bench.motion = at(k);
            let _ = bench.step();
        }
        let asked = if resumes {
            bench.servo.resume(&RECORD)
        } else {
            bench.servo.install(MODEL)
        };
        assert_eq!(asked, Ok(()));
        assert_eq!(bench.servo.move_to(200.0), Err(Error::NotControlling));
        let rest = samples(&mut bench, 15);
        // 8.4 over the rate of the filter, which a record changes.
        let settling = (8.4e3 / bench.servo.moves.tracking.rate()) as u32;
        let exact = if resumes { settling } else { settling - 15 };
        assert!(
            exact > 10 && rest.abs_diff(exact) <= 1,
            "{rest}, not {exact}"
        );
        let motion = bench.servo.controller.motion();
        assert!((motion.velocity - SPEED).abs() < 5.0, "{motion:?}");
        // It runs out from there.
        let (report, _) = bench.step();
        assert!(report.state.is_controlling());
        assert!(report.setpoint.velocity > 0.8 * SPEED, "{report:?}");
    }
}

#[test]
fn a_commissioning_that_nobody_can_place_yet_is_not_reported() {
    let mut bench = awaiting();
    bench.servo.abort();
    bench.servo.commission();
    bench.is_mute = true;
    for _ in 0..2 {
        assert_eq!(bench.step().0.state, State::Idle);
    }
    assert_eq!(bench.step().0.state, State::Failed(Reason::SensorFault));
}

#[test]
fn an_axis_that_leaves_its_travel_or_its_sensor_meanwhile_is_not_moved() {
    for (from, lost, reason) in [
        (403.0, false, Reason::Implausible),
        (200.0, true, Reason::SensorFault),
    ] {
        let mut bench = Bench::without_a_model(MODEL, &Bench::config());
        let sensor = bench::Code((from / bench::SCALE) as i32);
        let servo =
            bench::Loop::try_new(&Bench::config(), bench::axis(), sensor, bench::Spool(0.0));
        bench.servo = servo.expect("settings");
        bench.servo.install(MODEL).expect("a model");
        for k in 0..100 {
            bench.motion = Motion {
                position: from + at(k).position - BEGIN,
                ..at(k)
            };
            bench.is_mute = lost && k > 10;
            let (report, _) = bench.step();
            assert_eq!(report.command, 0.0, "{reason:?} {k}");
            assert_eq!(report.state.is_controlling(), bench.servo.awaits_motion());
        }
        assert_eq!(bench.servo.supervisor().state(), State::Failed(reason));
    }
}

#[test]
fn control_that_is_asked_for_soon_behind_a_first_reading_waits_as_long() {
    for outage in [false, true] {
        for seen in [1, 2, 5, 12, 20, 40] {
            let mut bench = Bench::without_a_model(MODEL, &Bench::config());
            let away = |k: u32| Motion {
                velocity: 3.0 * SPEED,
                ..Motion::at(BEGIN + 3e-3 * SPEED * k as f32)
            };
            if outage {
                // Longer than what is bridged: what the filter knew is of another time.
                bench.is_mute = true;
                for _ in 0..50 {
                    let _ = bench.step();
                }
                bench.is_mute = false;
            } else {
                let code = bench::Code((BEGIN / bench::SCALE) as i32);
                let valve = bench::Spool(0.0);
                let servo = bench::Loop::try_new(&Bench::config(), bench::axis(), code, valve);
                bench.servo = servo.expect("settings");
            }
            for k in 0..seen {
                bench.motion = away(k);
                let _ = bench.step();
            }
            bench.servo.install(MODEL).expect("a model");
            let mut worst = 0.0_f32;
            for k in seen.. {
                if bench.servo.awaits_motion() {
                    bench.motion = away(k);
                } else if k > seen + 500 {
                    break;
                }
                let (report, y) = bench.step();
                assert!(report.state.is_controlling(), "{seen}: {report:?}");
                worst = worst.max((report.setpoint.position - y).abs());
            }
            assert!(worst < 1.0, "{outage} {seen}: {worst}");
        }
    }
}

#[test]
fn a_commissioning_that_begins_with_the_first_reading_knows_the_motion_at_its_end() {
    let mut config = Bench::config();
    config.adaptive = true;
    let mut bench = Bench::without_a_model(MODEL, &config);
    bench.servo.commission();
    for k in 0..20_000 {
        let (report, _) = bench.step();
        assert!(!bench.servo.awaits_motion(), "{k}");
        if report.state.is_controlling() {
            assert!(k > 100, "{k}");
            return;
        }
        assert!(report.state.is_commissioning(), "{k}: {report:?}");
    }
    panic!("it does not end");
}

#[test]
fn readings_that_were_off_are_forgotten_when_nothing_is_left_of_them() {
    for jump in [100.0, 1.0, 0.0] {
        let mut bench = Bench::without_a_model(MODEL, &Bench::config());
        for k in 0..250 {
            bench.motion = Motion::at(if k == 150 { 200.0 + jump } else { 200.0 });
            let _ = bench.step();
        }
        bench.servo.install(MODEL).expect("a model");
        assert!(!bench.servo.awaits_motion(), "{jump}");
    }
}
