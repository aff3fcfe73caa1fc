//! Readings and slots that are missing, and readings that say nothing.

use super::bench::{Bench, MODEL};
use super::*;
use crate::servo::design::constants::DELAY_MAX;

#[test]
fn a_setpoint_goes_on_through_slots_and_readings_that_are_missing() {
    let ran = |missing: u32, mute: bool| {
        let mut bench = Bench::new(MODEL);
        let _ = bench.worst(1500);
        bench.servo.move_to(300.0).expect("a target");
        for k in 0..100 {
            let gone = (60..60 + missing).contains(&k);
            bench.is_mute = gone && mute;
            if gone && !mute {
                let _ = bench.miss();
            } else {
                let _ = bench.step();
            }
        }
        bench.is_mute = false;
        let (report, y) = bench.step();
        (report, y, bench)
    };
    let (whole, ..) = ran(0, false);
    for mute in [true, false] {
        let (report, y, mut bench) = ran(2, mute);
        assert!(report.state.is_controlling(), "{:?}", report.state);
        assert_eq!(report.setpoint, whole.setpoint);
        assert!((report.setpoint.position - y).abs() < 1.0, "{mute}");
        let worst = bench.worst(2500);
        assert!(
            worst < 1.0 && (bench.motion.position - 300.0).abs() < 0.02,
            "{worst}"
        );
        // What is missing for longer is a fault.
        let (report, ..) = ran(38, mute);
        assert_eq!(report.state, State::Failed(Reason::SensorFault), "{mute}");
    }
}

#[test]
fn in_a_slot_that_is_missing_the_command_stays_in_force_and_the_supervisor_goes_on() {
    let mut bench = Bench::adaptive(MODEL);
    bench.servo.oscillate(30.0, 1.0).expect("a sine");
    let _ = bench.worst(700);
    assert_eq!(bench.servo.supervisor().state(), State::Adapting);
    let mut flow = bench.servo.controller.flow_in_force();
    assert!(flow.abs() > 0.01, "{flow}");
    // As long as what is set in the missing slots is on its way and takes effect.
    for k in 0..12 {
        if k < 2 {
            bench.servo.supervisor.peak_speed = 0.0;
            let _ = bench.miss();
            let speed = bench.servo.supervisor.peak_speed;
            assert!(speed > 10.0, "{k}: {speed}");
        } else {
            assert!(bench.step().0.state.is_controlling());
        }
        let next = bench.servo.controller.flow_in_force();
        assert!((next - flow).abs() < 0.01, "{k}: {next} behind {flow}");
        flow = next;
    }
}

#[test]
fn before_the_first_reading_no_slot_is_missing() {
    let mut config = Bench::config();
    config.adaptive = true;
    let servo = bench::Loop::try_new(&config, bench::axis(), bench::Code(0), bench::Spool(0.0));
    let mut servo = servo.expect("settings");
    servo.skip(10_000);
    assert_eq!(servo.sensed.errors, 0);
    let _ = servo.update();
    servo.skip(2);
    assert_eq!(servo.sensed.errors, 2);
    let _ = servo.update();
    assert_eq!(servo.sensed.errors, 0);
}

#[test]
fn an_axis_that_stands_shows_its_noise_and_a_sensor_that_hangs_does_not() {
    for (hangs, reason) in [(false, Reason::Blocked), (true, Reason::SensorStuck)] {
        let mut bench = Bench::new(MODEL);
        let _ = bench.worst(1500);
        bench.servo.move_to(300.0).expect("a target");
        let at = bench.motion;
        let mut state = bench.servo.supervisor().state();
        for _ in 0..3000 {
            bench.motion = at;
            bench.hangs = hangs;
            state = bench.step().0.state;
            if !state.is_controlling() {
                break;
            }
        }
        assert_eq!(state, State::Failed(reason));
    }
}

/// What was measured beyond an end is led back from there, what is only expected there is not.
#[test]
fn an_axis_that_is_only_expected_beyond_an_end_leads_no_reference_out_of_the_travel() {
    for (place, is_mute, begins) in [
        (-1.0, false, -1.0),
        (-1.0, true, 0.0),
        (401.0, false, 401.0),
        (401.0, true, 400.0),
        (399.0, true, 399.0),
    ] {
        let mut bench = Bench::new(MODEL);
        bench.motion = Motion::at(place);
        bench.servo.abort();
        for _ in 0..500 {
            let _ = bench.step();
        }
        bench.servo.install(MODEL).expect("a model");
        bench.is_mute = is_mute;
        let _ = bench.step();
        bench.servo.install(MODEL).expect("a model");
        let reference = bench.servo.moves.trajectory.setpoint().position;
        assert!(
            (reference - begins).abs() < 0.01,
            "{place} {is_mute}: {reference}"
        );
        bench.is_mute = false;
        assert!(bench.worst(2000) < 1.2, "{place} {is_mute}");
    }
}

/// Also those of samples without any position: who takes over behind them knows what is on its way.
#[test]
fn the_commands_on_their_way_are_those_that_the_valve_had_whatever_the_sensor_says() {
    let mut bench = Bench::new(MODEL);
    let _ = bench.worst(1500);
    bench.servo.move_to(300.0).expect("a target");
    let mut newest_first = [0.0; DELAY_MAX + 1];
    let mut moved = 0;
    for k in 0..300 {
        bench.is_mute = k > 100;
        let _ = match k {
            50..52 => bench.miss(),
            _ => bench.step().1,
        };
        newest_first.rotate_right(1);
        newest_first[0] = bench.servo.valve_mut().0;
        moved += u32::from(newest_first[0].abs() > 0.01);
        let known = bench.servo.commands.along(1.0);
        if k > DELAY_MAX {
            assert!(known.eq(newest_first), "{k}");
        }
    }
    assert!(moved > 60, "{moved}");
}
