//! From nothing to control, and back again after a loss of power.

extern crate std;

use super::bench::{Bench, DELAY, MODEL};
use super::*;
use crate::servo::commissioning::Found;
use crate::servo::design::constants::REOPENED_STD;
use crate::servo::store::Record;

/// A bench whose loop has found its model by itself, after how many samples.
fn commissioned(sign: f32) -> (Bench, u32) {
    let config = Bench::untold();
    let model = Model {
        dead_zone: 0.02,
        ..MODEL
    };
    let mut bench = Bench::without_a_model(model, &config);
    bench.sign = sign;
    bench.servo.commission();
    for k in 0..12_000 {
        let (report, _) = bench.step();
        if report.state.is_controlling() {
            return (bench, k);
        }
        assert!(
            !matches!(report.state, State::Failed(_)),
            "{:?}",
            report.state
        );
    }
    panic!("no model");
}

/// Moves to several places; the largest error on the way, and at the end of one.
fn errors(bench: &mut Bench) -> [f32; 2] {
    let mut worst = [0.0_f32; 2];
    let _ = bench.worst(1500);
    for target in [300.0, 150.0, 200.0] {
        bench.servo.move_to(target).expect("a target");
        worst[0] = worst[0].max(bench.worst(2500));
        worst[1] = worst[1].max((bench.motion.position - target).abs());
    }
    worst
}

/// The loop is the one that the settings make of what was found.
fn designed(servo: &bench::Loop, record: &Record) {
    let found = Found {
        model: record.model,
        delay: record.delay,
        sign: record.sign,
        noise: record.noise,
        dead_volume: record.dead_volume,
        imbalance: record.imbalance,
    };
    let config = Bench::untold();
    let design = building::tuned(&config, &found)
        .resolve()
        .expect("settings");
    assert_eq!(servo.learning.settled, design.identification.settled);
    // A code of the sensor is what the axis says.
    let supervision = design.supervision.with_resolution(bench::SCALE);
    assert_eq!(servo.supervisor.design.drift, supervision.drift);
    assert_eq!(servo.moves.run_out_rate, design.run_out_rate);
    // Poles of the bandwidth that the margins leave.
    let (bandwidth, margins) = (servo.controller().bandwidth(), servo.margins());
    let natural = libm::sqrtf(record.model.a1);
    assert!(
        (0.5 * natural..10.0 * natural).contains(&bandwidth),
        "{bandwidth}"
    );
    assert!(margins.is_some());
}

#[test]
fn a_loop_finds_its_model_and_goes_on_from_a_record_of_it() {
    for sign in [1.0, -1.0] {
        let (mut bench, samples) = commissioned(sign);
        assert!((500..9000).contains(&samples), "{samples}");
        assert_eq!(bench.servo.sign(), sign);
        let record = bench.servo.record().expect("a model");
        let model = *bench.servo.controller().model();
        assert_eq!((record.model, record.sign), (model, sign));
        assert_eq!(record.delay, bench.servo.delay());
        assert!(
            (record.delay - 1e-3 * DELAY as f32).abs() < 1.5e-3,
            "{}",
            record.delay
        );
        assert!((model.a1 / MODEL.a1 - 1.0).abs() < 0.05, "{model:?}");
        let gain = MODEL.b0 / MODEL.a1;
        assert!((model.b0 / model.a1 / gain - 1.0).abs() < 0.03, "{model:?}");
        assert!(
            record.noise > 0.0 && record.noise < 3e-4,
            "{}",
            record.noise
        );
        designed(&bench.servo, &record);
        let worst = errors(&mut bench);
        assert!(worst[0] < 3.0 && worst[1] < 0.1, "{sign}: {worst:?}");
        // Another loop, with the settings alone, on the same drive.
        let config = Bench::untold();
        let mut other = Bench::without_a_model(bench.model, &config);
        other.sign = sign;
        other.servo.resume(&record).expect("a record");
        assert_eq!(other.servo.record().map(|record| record.model), Some(model));
        assert_eq!(
            (other.servo.sign(), other.servo.delay()),
            (sign, record.delay)
        );
        let worst = errors(&mut other);
        assert!(worst[0] < 3.0 && worst[1] < 0.1, "{sign}: {worst:?}");
    }
}

#[test]
fn a_record_that_cannot_be_true_is_refused_and_nothing_is_changed() {
    let record = Record {
        model: MODEL,
        std: [1.0; 6],
        delay: 3e-3,
        sign: 1.0,
        noise: 2e-4,
        dead_volume: f32::INFINITY,
        imbalance: 0.1,
    };
    let resumed = |reversed: Option<bool>, record: Record| {
        let mut config = Bench::config();
        config.reversed = reversed;
        let mut bench = Bench::without_a_model(MODEL, &config);
        let found = bench.servo.resume(&record);
        assert_eq!(
            bench.servo.supervisor().state().is_controlling(),
            found.is_ok()
        );
        found
    };
    let refused = |reason| Err(Error::Model(reason));
    assert_eq!(resumed(None, record.clone()), Ok(()));
    assert_eq!(resumed(Some(false), record.clone()), Ok(()));
    assert_eq!(
        resumed(Some(true), record.clone()),
        refused(Reason::WrongSign)
    );
    for sign in [0.0, 0.5, f32::NAN] {
        let record = Record { sign, ..record };
        assert_eq!(resumed(None, record), refused(Reason::WrongSign));
    }
    for delay in [-1e-3, f32::NAN, f32::INFINITY] {
        let noise = delay;
        for record in [Record { delay, ..record }, Record { noise, ..record }] {
            assert_eq!(resumed(None, record), refused(Reason::NotFinite));
        }
    }
    for imbalance in [-0.6, 0.6, f32::NAN] {
        let found = resumed(
            None,
            Record {
                imbalance,
                ..record
            },
        );
        let text = found.map_err(|error| std::format!("{error}"));
        assert!(
            matches!(&text, Err(text) if text.contains("imbalance")),
            "{text:?}"
        );
    }
    for (a1, reason) in [(0.0, Reason::Unstable), (f32::NAN, Reason::NotFinite)] {
        let model = Model { a1, ..MODEL };
        assert_eq!(resumed(None, Record { model, ..record }), refused(reason));
    }
}

#[test]
fn a_loop_that_adapts_finds_another_mass_in_motion() {
    let mut bench = Bench::adaptive(MODEL);
    // Twice the mass.
    let Model { a1, a2, b0, .. } = MODEL;
    bench.model = Model::linear(0.5 * a1, 0.5 * a2, 0.5 * b0);
    let mut retuned = 0;
    for k in 0..12_000 {
        if k % 500 == 0 {
            let target = if k % 1000 == 0 { 280.0 } else { 120.0 };
            bench.servo.move_to(target).expect("a target");
        }
        let (report, _) = bench.step();
        assert!(report.state.is_controlling(), "{:?}", report.state);
        retuned += u32::from(report.retuned);
    }
    let found = *bench.servo.controller().model();
    assert!(retuned > 0, "{found:?}");
    assert!((found.a1 / (0.5 * a1) - 1.0).abs() < 0.05, "{found:?}");
    assert!((found.b0 / (0.5 * b0) - 1.0).abs() < 0.05, "{found:?}");
    // Without a motion nothing is learnt.
    let theta = bench.servo.identifier().theta();
    bench.servo.move_to(200.0).expect("a target");
    let _ = bench.worst(3000);
    let rest = bench.servo.identifier().theta();
    let _ = bench.worst(1000);
    assert_eq!(bench.servo.identifier().theta()[..3], rest[..3]);
    assert_ne!(theta, [0.0; 6]);
}

#[test]
fn commands_are_told_from_the_newest_to_the_oldest_with_their_sign() {
    let mut commands = servo_loop::commands::Commands::new();
    let length = commands.along(1.0).count();
    for k in 1..=3 * length {
        commands.push(k as f32);
        for (age, command) in commands.along(-1.0).enumerate() {
            let wanted = if k > age { -((k - age) as f32) } else { 0.0 };
            assert_eq!(command, wanted, "{k} {age}");
        }
    }
}

#[test]
fn what_was_found_takes_the_place_of_settings_that_were_guessed() {
    let found = Found {
        model: MODEL,
        delay: 1.0,
        sign: -1.0,
        noise: 7e-3,
        dead_volume: 0.1,
        imbalance: -0.1,
    };
    let mut config = Bench::config();
    for noise in [None, Some(2e-4)] {
        config.noise = noise;
        let tuned = building::tuned(&config, &found);
        assert_eq!(tuned.noise, Some(noise.unwrap_or(7e-3)));
        assert_eq!(tuned.controller.dead_volume, Some(0.1));
        assert_eq!(tuned.controller.imbalance, -0.1);
        // As much delay as is remembered.
        let most = servo_loop::commands::Commands::new().along(1.0).count() - 1;
        assert!((tuned.delay / (1e-3 * most as f32) - 1.0).abs() < 1e-5);
        let bandwidth = tuned.bandwidth.expect("a bandwidth");
        assert!(
            (0.5..2.0).contains(&(bandwidth / libm::sqrtf(MODEL.a1))),
            "{bandwidth}"
        );
    }
}

#[test]
fn before_there_is_a_model_it_is_a_guess_by_bandwidth_and_travel() {
    let bench = Bench::without_a_model(MODEL, &Bench::config());
    // 25 rad/s, a damping of a half, and a travel in a time constant.
    let guess = Model::linear(625.0, 25.0, 625.0 * 400.0);
    assert_eq!(*bench.servo.controller().model(), guess);
    assert_eq!(bench.servo.record(), None);
}

#[test]
fn an_axis_that_does_not_follow_goes_on_once_on_the_model_of_the_commissioning() {
    let mut bench = Bench::adaptive(MODEL);
    assert!(!bench.servo.goes_back(), "there is no other model");
    let other = Model {
        b0: 0.5 * MODEL.b0,
        ..MODEL
    };
    bench.servo.supervisor.install(other).expect("a model");
    bench.servo.retune(other);
    let _ = bench.worst(500);
    assert_eq!(*bench.servo.controller().model(), other);
    bench.servo.identify_from(&other, REOPENED_STD);
    assert!(bench.servo.goes_back());
    // So does the identifier, which would else offer the other one again.
    let [.., b0, _, _, _] = bench.servo.identifier().theta();
    assert!((b0 / MODEL.b0 - 1.0).abs() < 1e-3, "{b0}");
    let (report, _) = bench.step();
    assert!(report.retuned, "the user learns of it");
    assert_eq!(report.state, State::Rejected(Reason::FollowingError));
    let _ = bench.worst(500);
    assert_eq!(*bench.servo.controller().model(), MODEL);
    assert_eq!(bench.servo.supervisor().verified_model(), Some(MODEL));
    assert_eq!(bench.servo.supervisor().verified_std(), [f32::INFINITY; 3]);
    assert!(!bench.servo.goes_back(), "and stops on that one");
    assert!(!bench.step().0.retuned);
}

#[test]
fn an_axis_that_does_not_follow_stops_where_there_is_no_other_model() {
    let mut bench = Bench::adaptive(MODEL);
    // A closed valve and a sensor whose code changes: nothing is wrong but the place.
    let there = Setpoint::at(300.0);
    let stopped = (0..3000).any(|_| bench.servo.is_stopped(&there, 200.0, 0.0, false));
    assert!(stopped);
    let state = bench.servo.supervisor().state();
    assert_eq!(state, State::Failed(Reason::FollowingError));
}
