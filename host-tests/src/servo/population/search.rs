//! Gains of the practitioner, searched on the axis itself.
//!
//! A coordinate search: four starts, then three rounds in which each of six numbers is tried larger
//! and, where that is no better, smaller, by factors 2, 1.5 and 1.2: at most [`TRIALS_MAX`] trials
//! of some 6 s on the axis, all with the same noise.

use crate::servo::population::bench::Bench;
use crate::servo::population::draw::AxisDraw;
use crate::servo::population::practitioner::{Gains, Practitioner};
use crate::servo::population::range::Purpose;
use crate::servo::population::sequence::{Exercise, amplitude};

/// Largest number of trials of a search.
pub const TRIALS_MAX: u32 = 4 + 3 * 2 * 6;

/// Factors of the rounds.
const FACTORS: [f64; 3] = [2.0, 1.5, 1.2];

/// Starts, from gentle to stiff.
const STARTS: [[f64; 6]; 4] = [
    [0.04, 0.05, 0.1, 6.0, 0.9, 0.02],
    [0.1, 0.3, 0.3, 8.0, 0.9, 0.02],
    [0.3, 0.3, 0.3, 8.0, 0.9, 0.02],
    [0.8, 0.3, 0.3, 8.0, 0.9, 0.02],
];

impl Gains {
    fn from_array([position, velocity, acceleration, filter, dead_zone, blend]: [f64; 6]) -> Self {
        Self {
            position,
            velocity,
            acceleration,
            filter,
            dead_zone,
            blend,
        }
    }
}

/// Searches the gains of an axis.
pub fn tuned(axis: &AxisDraw) -> Gains {
    let mut best = STARTS[0];
    let mut least = cost(axis, best);
    for start in &STARTS[1..] {
        keep_better(axis, *start, &mut best, &mut least);
    }
    for factor in FACTORS {
        for i in 0..best.len() {
            let mut larger = best;
            larger[i] *= factor;
            if !keep_better(axis, larger, &mut best, &mut least) {
                let mut smaller = best;
                smaller[i] /= factor;
                keep_better(axis, smaller, &mut best, &mut least);
            }
        }
    }
    Gains::from_array(best)
}

fn keep_better(axis: &AxisDraw, tried: [f64; 6], best: &mut [f64; 6], least: &mut f64) -> bool {
    let found = cost(axis, tried);
    let better = found < *least;
    if better {
        (*best, *least) = (tried, found);
    }
    better
}

/// What a practitioner minds: sines not followed, steps that end beside their target, cycles at
/// rest, blows to the ends.
fn cost(axis: &AxisDraw, gains: [f64; 6]) -> f64 {
    // More of the dead zone than there is, or a filter faster than the samples, is no gain that
    // anyone sets.
    let [_, omega0, _] = axis.truth(0.5 * axis.stroke_mm());
    if gains[4] > 1.1 || gains[3] * omega0 * axis.sample_time > 1.5 {
        return f64::INFINITY;
    }
    let mut bench = Bench::new(axis, Purpose::Tuning);
    bench.reversed = false;
    let mut controller = Practitioner::new(axis, &Gains::from_array(gains), bench.measure_mm());
    let mut exercise = Exercise::new(&mut bench, &mut controller);
    let cost = minded(axis, &mut exercise);
    let blow = if bench.blow_mm_s > 50.0 { 10.0 } else { 0.0 };
    cost.unwrap_or(f64::INFINITY) + blow
}

fn minded(axis: &AxisDraw, exercise: &mut Exercise<'_, Practitioner>) -> Option<f64> {
    let length = axis.stroke_mm();
    exercise.step(0.4 * length, 0.5, 0.1)?;
    let [stays, _] = exercise.step(0.5 * length, 1.0, 0.3)?;
    let [large, small] = [0.2, 0.005].map(|part| amplitude(axis, part, 1.0));
    let large_error = exercise.sine(large, 1.0, 1.0)?;
    let small_error = exercise.sine(small, 1.0, 1.0)?;
    let [_, range] = exercise.pass(1.0)?;
    let limit = axis.cycle_mm();
    let rest = libm::log1p(stays / limit) + libm::log1p(range / limit);
    Some(large_error / large + 0.5 * small_error / small + 0.2 * rest)
}
