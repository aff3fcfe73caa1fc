//! Gains for plants drawn at random, against a computation that shares nothing with the library:
//! the plant by its modes, the controllers from the gains as they are printed.

mod draws;
mod loops;

use draws::Uniform;
use loops::{Plant, margins, simulated};
use trendid_identify::tune::{Goal, Margins, TunedLoop, tune};

/// Samples of a step that are simulated at most: some slow loops take a million to arrive.
const LONGEST: usize = 10_000;

/// What does not hold of a loop.
fn objections(plant: &Plant, found: &TunedLoop, own: &[f64]) -> Vec<String> {
    let mut objections = Vec::new();
    let course = simulated(plant, found, own.len());
    let off = |k: usize| (course[k] - 1.0).abs();
    let largest = |range: std::ops::Range<usize>| range.map(off).fold(0.0, f64::max);
    let n = course.len();
    let [before, after] = [largest(0..n / 2), largest(n / 2..n)];
    // A step that is not simulated to its end may still rise.
    let whole = n as f64 * found.bandwidth * plant.dt >= 30.0;
    if whole && !(after <= 1.01 * before) {
        objections.push(format!("grows from {before} to {after}"));
    }
    let apart = own.iter().zip(&course).map(|(x, y)| (x - y).abs());
    let apart = apart.fold(0.0, f64::max);
    if !(apart < 2e-3 * before.max(1.0)) {
        objections.push(format!("{apart:.1e} beside the step of the library"));
    }
    let [said, true_] = [found.margins, margins(plant, found)];
    if !said.stable {
        objections.push("given though unstable".to_owned());
    }
    let figures = |m: Margins| [m.gain, m.phase_deg, m.delay, m.crossover];
    let each = ["gain", "phase", "delay", "crossover"].into_iter();
    let each = each.zip(figures(said).into_iter().zip(figures(true_)));
    // The distance of the open loop from -1.
    let distance = |m: &Margins| 1.0 / m.max_sensitivity;
    if !((distance(&said) - distance(&true_)).abs() < 3e-4) {
        let [said, true_] = [said.max_sensitivity, true_.max_sensitivity];
        objections.push(format!("sensitivity {said} instead of {true_}"));
    }
    for (name, (said, true_)) in each {
        if !(said == true_ || (said / true_ - 1.0).abs() < 3e-3) {
            objections.push(format!("{name} {said} instead of {true_}"));
        }
    }
    objections
}

fn check(seeds: std::ops::RangeInclusive<u64>) {
    let (mut loops, mut refused, mut wrong) = (0, 0, Vec::new());
    for seed in seeds {
        let plant = Plant::of(seed);
        let mut draw = Uniform(seed + 50_000);
        draw.next();
        let given = (draw.next() < 0.5).then(|| {
            let rate = plant.poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
            let rate = if rate > 0.0 { rate } else { 0.01 / plant.dt };
            (rate * draw.between(1e-3, 3.0)).min(0.5 / plant.dt)
        });
        let goal = Goal {
            sample_time: plant.dt,
            bandwidth: given,
        };
        let tuned = tune(&plant.model, &[], goal).expect("gains or reasons");
        refused += tuned.refused.len();
        assert!(tuned.refused.iter().all(|(_, why)| !why.is_empty()));
        for found in &tuned.loops {
            loops += 1;
            let samples = ((40.0 / (found.bandwidth * plant.dt)) as usize).clamp(400, LONGEST);
            let own = found.step(&tuned.plant, (samples - 1) as f64 * plant.dt);
            let own: Vec<f64> = own.iter().map(|sample| sample.output).collect();
            for objection in objections(&plant, found, &own) {
                let (kind, model) = (found.gains.name(), &plant.model);
                wrong.push(format!("{seed} {kind} {given:?} {model:?}: {objection}"));
            }
        }
    }
    println!("{loops} loops, {refused} refused");
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn drawn_loops_are_stable_and_have_the_margins_that_are_said() {
    // The last one has an observer a hundred times faster than its plant.
    check(1..=40);
    check(280..=280);
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn many_drawn_loops_are_stable_and_have_the_margins_that_are_said() {
    check(41..=600);
}
