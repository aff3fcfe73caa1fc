//! An axis that takes a load at one place and puts it down at another, again and again.

use crate::servo::population::adaptive::LoopPositioner;
use crate::servo::population::course::{Course, course};
use crate::servo::population::draw::AxisDraw;
use crate::servo::population::sequence::Exercise;

/// Places over the travel where it takes the load and puts it down.
const PLACES: [f64; 2] = [0.35, 0.65];

/// Rounds without a load, and with one.
const EMPTY: usize = 2;
const LOADED: usize = 10;

/// Time from one place to the other, with the stay there \[s\], and the end of it that is judged.
const STAY: f64 = 2.4;
const JUDGED: f64 = 0.5;

/// What came of it; infinite where the loop had ended before.
#[derive(Clone, Debug, PartialEq)]
pub struct Handling {
    /// How the loop came through.
    pub course: Course,
    /// Largest error on the way and at the end of a stay: before there is a load, and in the second
    /// half of the rounds with one \[mm\].
    pub errors_mm: [[f64; 2]; 2],
}

/// Handles a load that makes the moving mass so many times as large. `None` of an axis that is not
/// accepted.
pub fn handle(axis: &AxisDraw, factor: f64, adaptive: bool) -> Option<Handling> {
    let mut errors_mm = [[f64::INFINITY; 2]; 2];
    let course = course(axis, adaptive, None, |exercise| {
        errors_mm[0] = exercise.rounds(EMPTY, 1.0)?;
        let _ = exercise.rounds(LOADED / 2, factor)?;
        errors_mm[1] = exercise.rounds(LOADED / 2, factor)?;
        Some(())
    })?;
    Some(Handling { course, errors_mm })
}

impl Exercise<'_, LoopPositioner> {
    /// Moves to each place, so many times; the largest error on the way and at the end of a stay.
    fn rounds(&mut self, rounds: usize, factor: f64) -> Option<[f64; 2]> {
        let length = self.bench.axis().stroke_mm();
        let mut worst = [0.0_f64; 2];
        for _ in 0..rounds {
            for (place, factor) in PLACES.into_iter().zip([factor, 1.0 / factor]) {
                let [stays, largest] = self.step(place * length, STAY, JUDGED)?;
                worst = [worst[0].max(largest), worst[1].max(stays)];
                self.bench.multiply_mass(factor);
            }
        }
        Some(worst)
    }
}
