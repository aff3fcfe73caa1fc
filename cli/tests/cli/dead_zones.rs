//! Records of an axis behind a valve with a dead zone, as the monitor writes them: a commissioning
//! and six moves.

use std::fmt::Write;

use trendid_host_tests::servo::population::adaptive::LoopPositioner;
use trendid_host_tests::servo::population::bench::Bench;
use trendid_host_tests::servo::population::draw::AxisDraw;
use trendid_host_tests::servo::population::family::Family;
use trendid_host_tests::servo::population::range::Purpose;
use trendid_host_tests::servo::population::sequence::Positioner;

use crate::common::{Scratch, json};

/// Places of the moves over the travel, and the time for each \[s\].
const PLACES: [f64; 6] = [0.3, 0.7, 0.45, 0.6, 0.35, 0.5];
const EACH: f64 = 3.0;

/// The CSV of an axis, velocity gain \[mm/s\] and natural frequency of the axis itself in the middle
/// of its travel, the gain of the model of its loop, and half of the dead zone.
fn record(seed: u64) -> (String, [f64; 4]) {
    let axis = AxisDraw::new(Family::Pneumatic, true, seed);
    let mut bench = Bench::new(&axis, Purpose::Disturbance);
    let mut positioner = LoopPositioner::new(&axis, true).expect("settings");
    positioner.remember();
    let done = positioner.commission(&mut bench);
    assert!(done.verified_s.is_some(), "seed {seed}: {done:?}");
    for place in PLACES {
        positioner.move_to(place * axis.stroke_mm());
        let end = bench.time() + EACH;
        while bench.time() < end {
            let sample = positioner.update(bench.code());
            bench.hold(sample.command);
        }
    }
    let samples = positioner.remembered();
    let [learned, ..] = samples.last().and_then(|s| s.used).expect("a model");
    let [gain, omega0, _] = axis.truth(0.5 * axis.stroke_mm());
    let [zone, _] = axis.valve_null();
    let mut csv = String::from("t,u,y\n");
    for (k, seen) in samples.iter().enumerate() {
        let t = k as f64 * axis.sample_time;
        let (u, y) = (seen.report.command, seen.position_mm);
        writeln!(csv, "{t},{u},{y}").expect("text");
    }
    (csv, [gain, omega0, learned, zone])
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

/// Errors of the gain against the axis itself, of usual pneumatic ones: without a dead zone, told
/// it, with one that is found with its middle, and by the loop.
fn errors_of_the_gain(seeds: std::ops::Range<u64>) -> [Vec<f64>; 4] {
    let scratch = Scratch::new(&format!("valve-records-{seeds:?}"));
    let mut errors: [Vec<f64>; 4] = Default::default();
    for seed in seeds {
        let (csv, [gain, omega0, learned, zone]) = record(seed);
        let file = scratch.file(&format!("{seed}.csv"), &csv);
        let zone = format!("{zone:.4}");
        let ratios = |more: &[&str]| {
            let structure = [
                "--order",
                "3",
                "--integrator",
                "--constant",
                "--delay",
                "auto",
            ];
            let found = json(&[&["identify", &file, "--json"], &structure[..], more].concat());
            let number = |name: &str| found["physical"][name].as_f64().expect("a number");
            [number("gain").abs() / gain, number("omega0") / omega0]
        };
        let all = [
            ratios(&[]),
            ratios(&["--dead-zone", &zone]),
            ratios(&["--dead-zone", "auto"]),
            [learned.abs() / gain, f64::NAN],
        ];
        println!(
            "{seed}: gain and frequency over those of the axis, without, told and found dead zone, by the loop {all:.2?}"
        );
        for (errors, [gain, _]) in errors.iter_mut().zip(all) {
            errors.push((gain - 1.0).abs());
        }
    }
    errors
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn the_dead_zone_of_a_valve_gives_its_record_the_gain() {
    let [without, told, found, _] = errors_of_the_gain(200_017..200_019);
    for ((without, told), found) in without.into_iter().zip(told).zip(found) {
        assert!(told < without && found < without && found < 0.3);
    }
}

#[test]
#[ignore = "long: cargo xtask statistics"]
fn the_dead_zone_of_the_valve_gives_its_records_their_gain() {
    let errors = errors_of_the_gain(200_017..200_025);
    let worst = |errors: &[f64]| errors.iter().copied().fold(0.0, f64::max);
    for (name, errors) in ["without", "told", "found", "by the loop"]
        .iter()
        .zip(&errors)
    {
        println!(
            "gain, {name}: error {:.3} in the median, {:.3} at most",
            median(errors),
            worst(errors)
        );
    }
    let [without, told, found, _] = &errors;
    for one in [told, found] {
        assert!(median(one) < 0.5 * median(without), "{errors:?}");
        assert!(worst(one) < worst(without), "{errors:?}");
    }
    assert!(worst(found) < 0.3, "{errors:?}");
}
