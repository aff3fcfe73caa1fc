//! The end of a stop, and one on a wrong model.

extern crate std;

use std::format;

use super::bench::{DELAY, MODEL};
use super::*;
use crate::hardware::Valve;
use crate::servo::monitoring::{Alarm, stop::Stop};
use crate::servo::motion::Motion;

/// A loop that brakes behind a fault.
fn braking() -> Bench {
    let mut bench = failed(MODEL, Reason::FollowingError);
    let _ = bench.step();
    let (report, _) = bench.step();
    assert!(report.command < -0.1, "{report:?}");
    assert_ne!(bench.servo.guard.stop, Stop::default());
    bench.servo.guard.alarm = Some(Alarm::Brake);
    bench
}

#[test]
fn a_stop_ends_with_the_fault_that_it_answers() {
    let mut bench = braking();
    bench.servo.abort();
    assert_eq!(bench.servo.guard.stop, Stop::default());
    assert_eq!(bench.servo.guard.alarm, None);
    // The full command takes three samples to zero.
    for k in 0..2000 {
        let (report, _) = bench.step();
        assert_eq!(report.state, State::Idle);
        assert!(k < 3 || report.command == 0.0, "{k}: {}", report.command);
    }
    let mut bench = braking();
    bench.servo.install(MODEL).expect("a model");
    assert_eq!(bench.servo.guard.stop, Stop::default());
    assert_eq!(bench.servo.guard.alarm, None);
    // A commissioning that ends at once brakes for nothing before it.
    let mut bench = braking();
    bench.servo.commission();
    let begins = (0..2000).any(|_| {
        // Reported from the request on; the stages begin at rest.
        assert!(bench.step().0.state.is_commissioning());
        bench.servo.supervisor().state().is_commissioning()
    });
    assert!(begins);
    bench.servo.fail(Reason::TravelEnd);
    for k in 0..20 {
        let (report, _) = bench.step();
        assert!(k < 3 || report.command == 0.0, "{k}: {}", report.command);
    }
}

/// A stop of an axis in the middle of a move, whose drive is another one from then on; its largest
/// speed, and that a second later.
fn stopped(drive: Model, sign: f32, brakes: bool) -> [f32; 2] {
    let mut bench = Bench::new(MODEL);
    let _ = bench.worst(1500);
    bench.servo.move_to(300.0).expect("a target");
    while bench.motion.velocity < 200.0 {
        let _ = bench.worst(1);
    }
    (bench.model, bench.sign) = (drive, sign);
    if brakes {
        bench.servo.fail(Reason::FollowingError);
    } else {
        bench.servo.abort();
    }
    let mut fastest = 0.0_f32;
    for _ in 0..1000 {
        let _ = bench.step();
        fastest = fastest.max(bench.motion.velocity.abs());
    }
    [fastest, bench.motion.velocity.abs()]
}

#[test]
fn a_brake_on_a_wrong_model_ends_or_brakes() {
    let scaled = |gain: f32, quick: f32| Model {
        a1: quick * quick * MODEL.a1,
        a2: quick * MODEL.a2,
        b0: gain * quick * quick * MODEL.b0,
        ..MODEL
    };
    for gain in [0.3, 1.0, 3.0, 6.0] {
        for quick in [0.6, 1.0, 1.7] {
            for sign in [1.0, -1.0] {
                let drive = scaled(gain, quick);
                let [closed, _] = stopped(drive, sign, false);
                let [fastest, left] = stopped(drive, sign, true);
                let told = format!("{gain} {quick} {sign}: {fastest}, {closed}; {left}");
                assert!(left < 30.0, "{told}");
                if sign > 0.0 {
                    // Where the brake drives it, it does for less than half of the delay and 1/w:
                    // a quarter of the speed that a full command has given it by then.
                    let mut full = Motion::default();
                    for _ in 0..DELAY + 40 {
                        drive.advance(&mut full, 1.0, 1e-3);
                    }
                    let most = 0.25 * full.velocity;
                    assert!(fastest < closed.max(most), "{told}, {most}");
                    assert!(fastest < closed || gain * quick > 5.0, "{told}");
                }
            }
        }
    }
}

/// A valve that takes no command from the one on that is told.
struct Deaf(u32);

impl Valve for Deaf {
    type Error = ();

    fn drive(&mut self, command: f32) -> Result<f32, ()> {
        self.0 = self.0.saturating_sub(1);
        if self.0 == 0 { Err(()) } else { Ok(command) }
    }
}

#[test]
fn a_valve_that_reports_an_error_is_a_fault_in_the_same_sample() {
    let code = bench::Code((200.0 / bench::SCALE) as i32);
    for commissions in [false, true] {
        let valve = Deaf(40);
        let servo = ServoLoop::try_new(&Bench::config(), bench::axis(), code.clone(), valve);
        let mut servo = servo.expect("settings");
        if commissions {
            servo.commission();
        } else {
            servo.install(MODEL).expect("a model");
        }
        for k in 1..40 {
            let report = servo.update();
            assert!(!matches!(report.state, State::Failed(_)), "{k}: {report:?}");
        }
        let report = servo.update();
        assert_eq!(report.state, State::Failed(Reason::ValveFault));
        assert_eq!((report.command, report.faults.stops), (0.0, 1));
    }
}

#[test]
fn a_brake_that_would_drive_a_growing_speed_leaves_the_valve_in_its_middle() {
    for (believed, growing) in [(-1.0, true), (-1.0, false), (1.0, true)] {
        let mut bench = braking();
        let y = bench.servo.sensed.position;
        let motion = |velocity: f32, acceleration: f32| Motion {
            position: y,
            velocity,
            acceleration,
        };
        bench.servo.controller.place(motion(300.0 * believed, 0.0));
        let acceleration = if growing { 1000.0 } else { -1000.0 };
        bench
            .servo
            .moves
            .tracking
            .begin(motion(300.0, acceleration));
        let command = bench.servo.stopping(y);
        if believed > 0.0 {
            assert!(command < -0.1, "{command}");
        } else if growing {
            assert_eq!(command, bench.servo.controller.middle());
        } else {
            assert!(command > 0.1, "{command}");
        }
    }
}

#[test]
fn what_an_alarm_asks_for_is_the_next_command() {
    for way in [1.0, -1.0_f32] {
        let moving = || {
            let mut bench = Bench::new(MODEL);
            let _ = bench.worst(1500);
            bench.servo.move_to(200.0 + 100.0 * way).expect("a target");
            while way * bench.motion.velocity < 100.0 {
                let _ = bench.worst(1);
            }
            bench
        };
        let [free, closes, brakes] = [None, Some(Alarm::Close), Some(Alarm::Brake)].map(|alarm| {
            let mut bench = moving();
            let mut command = 0.0;
            // The rate of the valve lets it close in two samples.
            for _ in 0..2 {
                bench.servo.guard.alarm = alarm;
                command = way * bench.step().0.command;
            }
            command
        });
        assert!(free > 0.1, "{free}");
        assert_eq!(closes, 0.0);
        assert!(brakes < -0.1, "{brakes}");
    }
}

#[test]
fn a_brake_next_to_the_middle_of_its_valve_is_told_from_one_next_to_zero() {
    let model = Model {
        offset: 0.2,
        ..MODEL
    };
    let mut bench = failed(model, Reason::FollowingError);
    let y = bench.servo.sensed.position;
    let motion = |velocity: f32, acceleration: f32| Motion {
        position: y,
        velocity,
        acceleration,
    };
    bench.servo.controller.place(motion(-30.0, 0.0));
    bench.servo.moves.tracking.begin(motion(30.0, 1000.0));
    let middle = bench.servo.controller.middle();
    assert!((middle + 0.2).abs() < 1e-6, "{middle}");
    assert_eq!(bench.servo.stopping(y), middle);
}

#[test]
fn an_error_that_stays_goes_back_to_the_model_of_the_commissioning_before_it_stops() {
    let stops = |knows: bool| {
        let mut bench = Bench::adaptive(MODEL);
        let other = Model {
            a2: 1.5 * MODEL.a2,
            ..MODEL
        };
        bench.servo.supervisor.install(other).expect("a model");
        bench.servo.retune(other);
        let _ = bench.worst(100);
        if !knows {
            bench.servo.fallback.known_good = None;
        }
        // Further than any lag leaves it.
        let y = bench.servo.sensed.position;
        let far = Setpoint::at(y + 150.0);
        let stops = (0..5000).position(|_| bench.servo.is_stopped(&far, y, 0.0, false));
        let state = bench.servo.supervisor().state();
        assert_eq!(state, State::Failed(Reason::FollowingError));
        assert_eq!(bench.servo.fallback.went_back, knows);
        let model = if knows { MODEL } else { other };
        assert_eq!(bench.servo.supervisor().verified_model(), Some(model));
        stops.expect("a stop")
    };
    // As late again.
    let (twice, once) = (stops(true), stops(false));
    assert!(twice.abs_diff(2 * once) < 10, "{twice}, not twice {once}");
}
