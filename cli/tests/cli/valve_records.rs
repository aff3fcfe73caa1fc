//! Records of an axis behind a valve with a dead zone, as the monitor writes them: a commissioning and six moves.

use std::fmt::Write;

use trendid_host_tests::servo::population::adaptive::LoopPositioner;
use trendid_host_tests::servo::population::bench::Bench;
use trendid_host_tests::servo::population::draw::AxisDraw;
use trendid_host_tests::servo::population::family::Family;
use trendid_host_tests::servo::population::range::Purpose;
use trendid_host_tests::servo::population::sequence::Positioner;

use crate::common::{Scratch, json};

/// Seeds of usual pneumatic axes.
const SEEDS: std::ops::RangeInclusive<u64> = 200_017..=200_024;
/// Places of the moves over the travel, and the time for each \[s\].
const PLACES: [f64; 6] = [0.3, 0.7, 0.45, 0.6, 0.35, 0.5];
const EACH: f64 = 3.0;

/// The CSV of an axis, velocity gain \[mm/s\] and natural frequency of the model of its loop, and the dead zone.
fn record(seed: u64) -> (String, [f64; 3]) {
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
    let model = positioner.servo().supervisor().verified_model();
    let zone = f64::from(model.expect("a model").dead_zone);
    let samples = positioner.remembered();
    let [gain, omega0, _] = samples.last().and_then(|s| s.used).expect("a model");
    let mut csv = String::from("t,u,y\n");
    for (k, seen) in samples.iter().enumerate() {
        let t = k as f64 * axis.sample_time;
        let (u, y) = (seen.report.command, seen.position_mm);
        writeln!(csv, "{t},{u},{y}").expect("text");
    }
    (csv, [gain, omega0, zone])
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

#[test]
fn the_dead_zone_of_the_valve_gives_its_records_their_gain() {
    let scratch = Scratch::new("valve-records");
    let (mut plain, mut valve) = (Vec::new(), Vec::new());
    for seed in SEEDS {
        let (csv, [gain, omega0, zone]) = record(seed);
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
            [number("gain").abs() / gain.abs(), number("omega0") / omega0]
        };
        let (without, with) = (ratios(&[]), ratios(&["--dead-zone", &zone]));
        println!(
            "{seed}: gain and frequency over those of the loop, without {without:.2?}, with {with:.2?}"
        );
        plain.push((without[0] - 1.0).abs());
        valve.push((with[0] - 1.0).abs());
    }
    let worst = valve.iter().copied().fold(0.0, f64::max);
    let medians = [&plain, &valve].map(|errors| median(errors));
    println!(
        "median error of the gain without and with the dead zone {medians:.3?}, worst with it {worst:.3}"
    );
    assert!(
        medians[1] < 0.15 && 2.0 * medians[1] < medians[0],
        "{medians:?}"
    );
    assert!(worst < 0.3, "{worst}");
}
