//! The motion in which control begins, and the rest in which a commissioning does.

extern crate std;

mod halted;

use super::bench::{self, Bench, MODEL};
use crate::servo::design::constants::NOISE_RATIO;
use crate::servo::error::Error;
use crate::servo::model::Model;
use crate::servo::motion::Motion;
use crate::servo::supervision::state::State;

/// In a move through 100 at so many units per s, at least.
fn moving(speed: f32) -> Bench {
    let mut bench = Bench::new(MODEL);
    let _ = bench.worst(1500);
    bench.servo.move_to(380.0).expect("a target");
    while bench.motion.velocity < speed {
        let _ = bench.worst(1);
    }
    bench
}

/// Samples until a commissioning that is asked for begins; the state is reported from then on.
fn waited(bench: &mut Bench, mut move_on: impl FnMut(&mut Bench)) -> u32 {
    for k in 0..20_000 {
        move_on(bench);
        let (report, _) = bench.step();
        assert_eq!(report.state, State::Exciting, "{k}");
        assert_eq!(bench.servo.move_to(200.0), Err(Error::NotControlling));
        if bench.servo.supervisor().state().is_commissioning() {
            return k;
        }
    }
    panic!("it never begins");
}

#[test]
fn what_one_code_and_the_noise_leave_unknown_is_no_motion() {
    let mut bench = Bench::without_a_model(MODEL, &Bench::config());
    let near = |x: f32, exact: f32| assert!((x / exact - 1.0).abs() < 1e-5, "{x}, not {exact}");
    // Stated, else found, else taken for it.
    near(bench.servo.noise(), 2e-4);
    bench.servo.config.noise = None;
    bench.servo.drive.noise = 0.0;
    near(bench.servo.noise(), 400.0 * NOISE_RATIO);
    bench.servo.drive.noise = 3e-3;
    near(bench.servo.noise(), 3e-3);
    // 8.4 over the rate of the filter before it has settled.
    let rate = bench.servo.moves.tracking.rate();
    bench.servo.moves.unsettle(1e-3);
    let settled = bench.servo.moves.unsettled;
    assert!(
        settled.abs_diff((8.4e3 / rate) as u32 + 1) <= 1,
        "{settled}"
    );
    // A position that is off by one code and two deviations of the noise.
    for (part, moves) in [(0.9, false), (1.1, true)] {
        let mut bench = Bench::without_a_model(MODEL, &Bench::config());
        let rate = bench.servo.moves.tracking.rate();
        let most = 1.76 * rate * (bench::SCALE + 2.0 * 2e-4);
        for k in 0..500 {
            let y = 200.0 + part * most * 1e-3 * k as f32;
            bench.servo.moves.tracking.update(y);
            bench.servo.sensed.position = y;
        }
        let seen = bench.servo.present_motion(&MODEL, 2e-4);
        let velocity = seen.map(|motion| motion.velocity);
        assert_eq!(velocity != Some(0.0), moves, "{part}");
    }
}

#[test]
fn a_model_that_is_installed_in_motion_lets_it_run_out() {
    for controls in [true, false] {
        let mut bench = moving(100.0);
        if !controls {
            bench.servo.abort();
            let _ = bench.step();
        }
        let speed = bench.motion.velocity;
        bench.servo.install(MODEL).expect("a model");
        let (report, y) = bench.step();
        let reference = report.setpoint;
        assert!((reference.velocity / speed - 1.0).abs() < 0.1, "{controls}");
        assert!((reference.position - y).abs() < 0.5, "{controls}");
        assert!(bench.worst(2000) < 3.0, "{controls}");
        assert!(bench.motion.velocity.abs() < 0.1, "{controls}");
    }
}

#[test]
fn a_motion_counts_within_what_the_drive_can_have() {
    let noise = 2e-4;
    for a2 in [20.0, 200.0] {
        let model = Model { a2, ..MODEL };
        let mut bench = Bench::without_a_model(model, &Bench::config());
        let rate = bench.servo.moves.tracking.rate();
        // 1.3 times the velocity gain; b0 + a1 V + a2 V w, over the rate cubed, and three grains.
        let fastest = 1.3 * 1600.0;
        let jerk = 1e6 + 625.0 * fastest + a2 * fastest * 25.0;
        let behind = jerk / (rate * rate * rate) + 3.0 * (bench::SCALE + 2.0 * noise);
        for (speed, lag, counts) in [
            (0.99, 0.0, true),
            (-0.99, 0.0, true),
            (1.01, 0.0, false),
            (-1.01, 0.0, false),
            (0.5, 0.99, true),
            (0.5, -0.99, true),
            (0.5, 1.01, false),
            (0.5, -1.01, false),
        ] {
            let seen = Motion {
                position: 200.0,
                velocity: speed * fastest,
                acceleration: 0.0,
            };
            bench.servo.moves.tracking.begin(seen);
            let position = 200.0 + lag * behind;
            bench.servo.sensed.position = position;
            let expected = counts.then_some(Motion { position, ..seen });
            let motion = bench.servo.present_motion(&model, noise);
            assert_eq!(motion, expected, "{a2} {speed} {lag}");
        }
        // Of a coarse sensor the noise counts.
        let behind = jerk / (rate * rate * rate) + 3.0 * (bench::SCALE + 2.0);
        for (lag, counts) in [(0.99, true), (1.01, false)] {
            let seen = Motion {
                position: 200.0,
                velocity: fastest,
                acceleration: 0.0,
            };
            bench.servo.moves.tracking.begin(seen);
            bench.servo.sensed.position = 200.0 + lag * behind;
            let motion = bench.servo.present_motion(&model, 1.0);
            assert_eq!(motion.is_some(), counts, "{a2} {lag}");
        }
    }
}

/// An axis at rest, of which so many readings were off by `jump`, the last one so many samples ago.
fn misread(jump: f32, readings: u32, since: u32) -> Bench {
    let mut bench = Bench::without_a_model(MODEL, &Bench::config());
    let mut pass = |samples: u32, off: f32| {
        bench.motion.position += off;
        for _ in 0..samples {
            let _ = bench.step();
        }
        bench.motion.position -= off;
    };
    pass(100, 0.0);
    pass(readings, jump);
    pass(since, 0.0);
    bench
}

#[test]
fn a_motion_that_readings_make_which_were_off_is_none() {
    for (jump, readings) in [(100.0, 3), (100.0, 1), (-30.0, 1), (60.0, 40), (5.0, 2)] {
        for since in [0, 1, 2, 5, 8, 11, 14, 17, 20, 24, 30, 60] {
            // All that the filter knows is off, and so is the newest one.
            if (readings, since) == (40, 0) {
                continue;
            }
            let mut bench = misread(jump, readings, since);
            bench.servo.install(MODEL).expect("a model");
            let told = std::format!("{jump} {readings} {since}");
            for _ in 0..1000 {
                let (report, y) = bench.step();
                assert!(report.state.is_controlling(), "{told}: {report:?}");
                let error = (report.setpoint.position - y).abs();
                assert!(error < 0.5, "{told}: {error}");
            }
            assert_eq!(bench.servo.moves.astray, 0.0);
        }
    }
    // What is left of it in the filter, of a drive that has 1600 per s at its full command.
    let velocity = |since| {
        let bench = misread(100.0, 3, since);
        bench.servo.moves.tracking.motion().velocity.abs()
    };
    assert!(velocity(5) > 2500.0 && (200.0..1600.0).contains(&velocity(20)));
}

#[test]
fn an_axis_in_motion_goes_on_behind_a_reading_that_was_off() {
    for since in [0, 1, 5, 12, 20, 40] {
        let mut bench = Bench::without_a_model(MODEL, &Bench::config());
        let at = |k: u32| Motion {
            velocity: 300.0,
            ..Motion::at(20.0 + 0.3 * k as f32)
        };
        for k in 0..=100 + since {
            bench.motion = at(k);
            bench.motion.position += if k == 100 { 50.0 } else { 0.0 };
            let _ = bench.step();
        }
        bench.servo.install(MODEL).expect("a model");
        let mut worst = 0.0_f32;
        for k in 1..1000 {
            if k == 1 || bench.servo.awaits_motion() {
                bench.motion = at(100 + since + k);
            }
            let (report, y) = bench.step();
            assert!(report.state.is_controlling(), "{since}: {report:?}");
            worst = worst.max((report.setpoint.position - y).abs());
        }
        assert!(worst < 1.0, "{since}: {worst}");
    }
}

#[test]
fn before_the_first_reading_the_valve_waits_for_the_motion() {
    for commissions in [false, true] {
        let mut bench = moving(100.0);
        let code = bench::Code((bench.motion.position / bench::SCALE) as i32);
        let servo = bench::Loop::try_new(&Bench::config(), bench::axis(), code, bench::Spool(0.0));
        bench.servo = servo.expect("settings");
        bench.servo.install(MODEL).expect("a model");
        if commissions {
            bench.servo.commission();
            // One that does not yet know its motion may stand for all that is known.
            let waits = bench.servo.moves.tracking.rate();
            let samples = waited(&mut bench, |_| {});
            assert!(samples as f32 > 8.4e3 / waits, "{samples}");
            continue;
        }
        let mut k = 0_u32;
        while bench.servo.move_to(200.0) == Err(Error::NotControlling) {
            let (report, _) = bench.step();
            assert_eq!(report.command, 0.0, "{k}");
            k += 1;
        }
        let exact = (8.4e3 / bench.servo.moves.tracking.rate()) as u32 + 1;
        assert!(k.abs_diff(exact) <= 1, "{k}, not {exact}");
        // It goes on with that motion, whatever became of it.
        let (speed, (report, y)) = (bench.motion.velocity, bench.step());
        assert!(speed.abs() > 20.0 && speed * report.setpoint.velocity > 0.5 * speed * speed);
        assert!((report.setpoint.position - y).abs() < 1.0);
        assert_eq!(bench.servo.move_to(100.0), Ok(()));
        let _ = bench.worst(3000);
        assert!((bench.motion.position - 100.0).abs() < 0.1);
    }
}

#[test]
fn a_commissioning_begins_where_the_axis_stands_and_where_there_is_room() {
    // At rest in the middle: with the next sample.
    let mut bench = Bench::new(MODEL);
    let _ = bench.worst(1500);
    bench.servo.commission();
    assert_eq!(waited(&mut bench, |_| {}), 0);
    // At rest near an end, and in motion: the model leads it to the nearest place with room.
    for (target, passed) in [(390.0, 5000), (390.0, 600)] {
        let mut bench = Bench::new(MODEL);
        let _ = bench.worst(1500);
        bench.servo.move_to(target).expect("a target");
        let _ = bench.worst(passed);
        bench.servo.commission();
        let samples = waited(&mut bench, |_| {});
        let closing = bench.servo.guard.monitors.bounds().stop.closing;
        assert!(samples >= closing, "{samples}");
        // 0.72 of the travel.
        let Motion {
            position, velocity, ..
        } = bench.motion;
        assert!(position < 288.1, "{passed}: {position}");
        let creep = bench.servo.config.creep();
        assert!(velocity.abs() < creep, "{passed}: {velocity} {creep}");
    }
}

#[test]
fn an_axis_that_does_not_come_to_rest_is_waited_for_twelve_times_and_no_longer() {
    for drifts in [false, true] {
        let mut bench = moving(100.0);
        bench.servo.abort();
        let _ = bench.step();
        bench.servo.commission();
        let closing = bench.servo.guard.monitors.bounds().stop.closing;
        let samples = waited(&mut bench, |bench| {
            if drifts {
                // Whatever the valve does; away from its ends.
                bench.motion = Motion {
                    velocity: 40.0,
                    ..Motion::at(bench.motion.position)
                };
                if bench.motion.position > 350.0 {
                    bench.motion.position = 100.0;
                }
            }
        });
        if drifts {
            assert_eq!(samples, 12 * closing);
        } else {
            assert!((closing..6 * closing).contains(&samples), "{samples}");
        }
    }
}
