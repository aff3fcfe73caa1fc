//! Defects of valve and drive in the core: offset, dead zone, unequal gains, Coulomb friction.

use trendid::inputs::{DeadZone, Valved, asymmetric, coulomb, dead_zone};
use trendid::trends::{FilteredTrends, Scheme};
use trendid::{Config, Identifier, Structure};
use trendid_host_tests::plants::servo::{REFERENCE, Servo};
use trendid_host_tests::plants::valve::FrictionDrive;
use trendid_host_tests::signals::excitation::Excitation;
use trendid_host_tests::signals::experiment::{Experiment, Record};
use trendid_host_tests::signals::noise::{Condition, Stream, generator};

use rand::RngExt;

const DT: f32 = 0.001;

fn trends<const M: usize>() -> FilteredTrends<M> {
    FilteredTrends::for_bandwidth(Scheme::Tustin, DT, 20.0).unwrap()
}

fn errors(theta: &[f32]) -> [f64; 3] {
    Servo::errors_of(theta, &REFERENCE)
}

fn worst(e: [f64; 3]) -> f64 {
    e.iter().fold(0.0, |w, v| w.max(v.abs()))
}

/// The servo with an offset, with and without a constant input.
fn offset(record: &Record) -> (f64, f64, f64) {
    let plain = Config::new(Structure::<3, 3, 1>::INTEGRATING, 20.0, [0.4], 50.0);
    let mut without: Identifier<_, 3, 3> = Identifier::try_new(&plain, trends()).unwrap();
    let constant = Structure::<3, 4, 1>::INTEGRATING_WITH_CONSTANT;
    let config = Config::new(constant, 20.0, [0.4], 50.0);
    let mut with: Identifier<_, 3, 4> = Identifier::try_new(&config, trends()).unwrap();
    for s in record.samples() {
        let _ = without.update(s.u as f32, s.y as f32);
        let _ = with.update(s.u as f32, s.y as f32);
    }
    let theta = with.theta();
    (
        worst(errors(&without.theta())),
        worst(errors(&theta)),
        f64::from(theta[3] / theta[2]),
    )
}

#[test]
fn offset_of_ten_percent() {
    println!("offset 0.04 under commands of 0.4: worst error of C, omega0, xi [%] over seeds");
    for eta in [0.0, 10.0] {
        let mut experiment = Experiment::reference(Condition::white(eta), 1.0);
        experiment.valve.offset = 0.04;
        let (mut without, mut with, mut found) = (0.0_f64, 0.0_f64, 0.0_f64);
        for seed in 6000..6100 {
            let (a, b, c) = offset(&experiment.record(seed));
            without = without.max(a);
            with = with.max(b);
            found = found.max((c - 0.04).abs());
        }
        println!(
            "  eta {eta} um: without constant {without:.1}, with {with:.4}; offset off by {found:.1e}"
        );
        assert!(without > 10.0 && with < 0.05 && found < 1e-4);
    }
}

/// A dead zone found on the way: errors of C, omega0, xi \[%\] and the width at the end.
fn dead_zone_found(record: &Record, start: f32) -> ([f64; 3], f32) {
    let mut config = Config::new(Structure::<3, 6, 2>::SERVO, 20.0, [0.2, 0.05], 50.0);
    config.memory = Some(0.7);
    let valve = DeadZone::new(start, 0.1, 300);
    let mut servo: Valved<_, 3, 6> = Valved::try_new(&config, trends(), valve).unwrap();
    for s in record.samples() {
        let _ = servo.update(s.u as f32, s.y as f32);
    }
    (
        errors(&servo.identifier().theta()),
        servo.dead_zone().delta(),
    )
}

#[test]
fn dead_zone_of_three_percent_in_closed_loop() {
    println!("dead zone 0.03, closed loop, 4 s, 100 seeds: rms and worst of C, omega0, xi [%]");
    for eta in [0.0, 20.0, 100.0] {
        let mut experiment = Experiment::closed_loop(Condition::white(eta), 4.0);
        experiment.valve.dead_zone = 0.03;
        for start in [0.0, 0.02, 0.045] {
            let (mut square, mut largest, mut off) = ([0.0; 3], [0.0_f64; 3], 0.0_f32);
            for seed in 6200..6300 {
                let (e, delta) = dead_zone_found(&experiment.record(seed), start);
                for i in 0..3 {
                    square[i] += e[i] * e[i] / 100.0;
                    largest[i] = largest[i].max(e[i].abs());
                }
                off = off.max((delta - 0.03).abs());
            }
            let rms = square.map(f64::sqrt);
            println!(
                "  eta {eta} um, from {start}: {rms:.3?}, {largest:.3?}; width off by {off:.5}"
            );
            // With 0.1 mm of noise single runs of the hundred, with few reversals, are worse: up to
            // some 8 %. A start above the truth hides movements that the valve lets pass; some of
            // that is left after 4 s.
            if eta <= 20.0 && start < 0.03 {
                assert!(worst(largest) <= 1.0 && off <= 0.002);
            } else {
                assert!(worst(rms) <= 1.0 && off <= 0.004);
            }
        }
    }
    // What it would be without.
    let mut experiment = Experiment::closed_loop(Condition::CLEAN, 4.0);
    experiment.valve.dead_zone = 0.03;
    let plain = Config::new(Structure::<3, 3, 1>::INTEGRATING, 20.0, [0.2], 50.0);
    let mut without: Identifier<_, 3, 3> = Identifier::try_new(&plain, trends()).unwrap();
    for s in experiment.record(6200).samples() {
        let _ = without.update(s.u as f32, s.y as f32);
    }
    let e = errors(&without.theta());
    println!("  without these inputs: {e:.1?}");
    assert!(worst(e) > 5.0);
}

#[test]
fn unequal_gains_of_the_two_directions() {
    let mut experiment = Experiment::reference(Condition::white(20.0), 1.0);
    experiment.valve.gain_negative = 0.7;
    let config = Config::new(Structure::<3, 4, 2>::INTEGRATING, 20.0, [0.4, 0.4], 50.0);
    let (mut largest, mut ratio) = ([0.0_f64; 3], 0.0_f64);
    for seed in 6400..6500 {
        let mut identifier: Identifier<_, 3, 4, 2> =
            Identifier::try_new(&config, trends()).unwrap();
        for s in experiment.record(seed).samples() {
            let _ = identifier.update_inputs(asymmetric(s.u as f32), s.y as f32);
        }
        let theta = identifier.theta();
        let e = errors(&theta);
        for i in 0..3 {
            largest[i] = largest[i].max(e[i].abs());
        }
        ratio = ratio.max(f64::from((theta[3] / theta[2] - 0.7).abs()));
    }
    println!(
        "gains 1 and 0.7, eta 20 um, 1 s, 100 seeds: worst {largest:.3?} %, ratio off {ratio:.1e}"
    );
    assert!(worst(largest) < 0.2 && ratio < 1e-3);
}

#[test]
fn coulomb_friction_is_an_input() {
    // s (s + a) y = b u - c sgn(v) + d with the figures of a ball-screw drive; the velocity is that
    // of the drive, which is never held by friction here: at rest friction is what balances the
    // drive and no sign gives it.
    let (a, b, c, d) = (2.14, 0.37, 0.21, 0.033);
    let structure = Structure::<2, 4, 2>::INTEGRATING_WITH_CONSTANT;
    let config = Config::new(structure, 10.0, [1.0, 1.0], 0.1);
    let trends = FilteredTrends::<2>::for_bandwidth(Scheme::Tustin, DT, 10.0).unwrap();
    let plain_structure = Structure::<2, 3, 1>::INTEGRATING_WITH_CONSTANT;
    let plain_config = Config::new(plain_structure, 10.0, [1.0], 0.1);
    let (mut largest, mut ignored) = ([0.0_f64; 4], 0.0_f64);
    for seed in 6600..6620 {
        let binary = Excitation::Prbs {
            amplitude: 2.0,
            hold_s: 0.25,
            bits: 7,
        };
        let u = binary.sequence(10_000, 1e-3, seed);
        let mut random = generator(seed, Stream::White);
        let mut drive = FrictionDrive::new(a, b, c, d);
        let mut with: Identifier<_, 2, 4, 2> =
            Identifier::try_new(&config, trends.clone()).unwrap();
        let mut without: Identifier<_, 2, 3> =
            Identifier::try_new(&plain_config, trends.clone()).unwrap();
        for u in u {
            let y = (drive.output() + 2e-6 * (random.random::<f64>() - 0.5)) as f32;
            let sign = coulomb(drive.velocity() as f32, 1e-6);
            let _ = with.update_inputs([u as f32, sign], y);
            let _ = without.update(u as f32, y);
            drive.step(u, 1e-3);
        }
        let found = with.theta().map(f64::from);
        for (i, truth) in [a, b, -c, d].into_iter().enumerate() {
            largest[i] = largest[i].max(100.0 * (found[i] / truth - 1.0).abs());
        }
        ignored = ignored.max(100.0 * (f64::from(without.theta()[0]) / a - 1.0).abs());
    }
    println!(
        "worst errors of a, b, c, d [%]: {largest:.2?}; a without the friction input {ignored:.0} %"
    );
    assert!(largest[0] < 2.0 && largest[1] < 1.0 && largest[2] < 2.0 && largest[3] < 5.0);
    assert!(ignored > 10.0);
}

#[test]
fn inputs_of_the_dead_zone_reproduce_the_valve() {
    // Linear in the two inputs: flow = u - delta sgn(u) outside, 0 inside.
    for k in -100..=100 {
        let u = 0.01 * k as f32;
        let [linear, sign] = dead_zone(u, 0.03);
        let flow = if u.abs() > 0.03 {
            u - 0.03 * u.signum()
        } else {
            0.0
        };
        assert!((linear - 0.03 * sign - flow).abs() < 1e-7);
    }
}
