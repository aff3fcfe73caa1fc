//! An axis whose moving mass changes in motion, under the loop that adapts and under the gains of
//! its commissioning.

use rand::RngExt;

use crate::servo::population::adaptive::LoopPositioner;
use crate::servo::population::course::{Course, course};
use crate::servo::population::draw::{AxisDraw, Mechanics};
use crate::servo::population::range::{Purpose, Range, stream};
use crate::servo::population::sequence::{Exercise, LARGE, Positioner, amplitude};
use crate::servo::rig::DEAD_VOLUME;

/// A change of the moving mass in a sine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// The mass after it over that before.
    pub factor: f64,
    /// Amplitude of the sine over the travel, as far as the limits of motion allow it.
    pub part: f64,
    /// Its frequency \[Hz\].
    pub frequency: f64,
    /// Time that is left to learn \[s\].
    pub learning: f64,
}

/// Amplitudes over the travel, and frequencies \[Hz\], of sines that are drawn.
const PARTS: Range = Range::ratio(0.02, 0.06, LARGE);
const FREQUENCIES: Range = Range::ratio(0.3, 0.8, 2.0);

impl Change {
    /// In a large, slow sine, with 3 s to learn.
    pub const fn large(factor: f64) -> Self {
        Self {
            factor,
            part: LARGE,
            frequency: 0.5,
            learning: 3.0,
        }
    }

    /// In a sine of 2 to 20 % of the travel and 0.3 to 2 Hz, with 10 s to learn.
    pub fn drawn(factor: f64, seed: u64) -> Self {
        let mut random = stream(seed, Purpose::Sequence);
        Self {
            factor,
            part: PARTS.draw(false, &mut random),
            frequency: FREQUENCIES.draw(false, &mut random),
            learning: 10.0,
        }
    }
}

/// Places over the travel of the steps at the end.
const STEPS: [f64; 3] = [0.35, 0.65, 0.5];

/// What came of a change; infinite where the loop had ended before.
#[derive(Clone, Debug, PartialEq)]
pub struct Changed {
    /// How the loop came through.
    pub course: Course,
    /// The errors.
    pub errors: Errors,
}

/// Errors about a change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Largest error in the sine before the change, and in two periods after the time to learn
    /// \[mm\].
    pub sine_mm: [f64; 2],
    /// Largest error at the end of the steps after the change \[mm\].
    pub steady_state_mm: f64,
    /// Range at rest after it \[mm\].
    pub rest_range_mm: f64,
}

/// Multiplies the moving mass in a sine; the constant load stays, and the user states how stiff the
/// axis is near its ends. `None` of an axis that is not accepted.
pub fn mass(axis: &AxisDraw, change: &Change, adaptive: bool) -> Option<Changed> {
    let dead_volume = match axis.mechanics {
        Mechanics::Pneumatic(_) => DEAD_VOLUME,
        Mechanics::ThirdOrder(_) => f32::INFINITY,
    };
    let mut errors = Errors {
        sine_mm: [f64::INFINITY; 2],
        steady_state_mm: f64::INFINITY,
        rest_range_mm: f64::INFINITY,
    };
    let course = course(axis, adaptive, Some(dead_volume), |exercise| {
        exercise.through_a_change(&mut errors, change)
    })?;
    Some(Changed { course, errors })
}

impl Exercise<'_, LoopPositioner> {
    fn through_a_change(&mut self, errors: &mut Errors, change: &Change) -> Option<()> {
        let axis = *self.bench.axis();
        let length = axis.stroke_mm();
        let _ = self.step(0.5 * length, 1.0, 0.5)?;
        let size = amplitude(&axis, change.part, change.frequency);
        if !self.positioner.oscillate(size, change.frequency) {
            return None;
        }
        let period = 1.0 / change.frequency;
        let _ = self.pass(period)?;
        let [largest, _] = self.pass(period)?;
        errors.sine_mm[0] = largest;
        let phase = stream(axis.seed, Purpose::Sequence).random_range(0.0..period);
        let _ = self.pass(phase)?;
        self.bench.multiply_mass(change.factor);
        let _ = self.pass(change.learning)?;
        let [largest, _] = self.pass(2.0 * period)?;
        errors.sine_mm[1] = largest;
        let mut worst = 0.0_f64;
        for place in STEPS {
            let [stays, _] = self.step(place * length, 2.0, 0.5)?;
            worst = worst.max(stays);
        }
        errors.steady_state_mm = worst;
        let [_, range] = self.pass(3.0)?;
        errors.rest_range_mm = range;
        Some(())
    }
}
