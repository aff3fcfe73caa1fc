//! An axis whose moving mass changes in motion, under the loop that adapts and under the gains of
//! its commissioning.

use rand::RngExt;
use trendid::servo::Reason;

use crate::servo::population::adaptive::LoopPositioner;
use crate::servo::population::bench::Bench;
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

/// What came of a change.
#[derive(Clone, Debug, PartialEq)]
pub struct Changed {
    /// The seed of the axis.
    pub seed: u64,
    /// Largest error in the sine before the change, and in two periods after the time to learn
    /// \[mm\].
    pub sine_mm: [f64; 2],
    /// Largest error at the end of the steps after the change \[mm\].
    pub steady_state_mm: f64,
    /// Range at rest after it \[mm\].
    pub rest_range_mm: f64,
    /// Hardest blow to an end stop \[mm/s\].
    pub blow_mm_s: f64,
    /// Why the loop stopped.
    pub stopped: Option<Reason>,
    /// Oscillations that were noticed, least factor on the bandwidth, and models that reached the
    /// controller.
    pub oscillations: u32,
    /// Factor on the bandwidth at the end.
    pub derating: f32,
    /// Models that reached the controller.
    pub models: u32,
}

/// Multiplies the moving mass in a sine; the constant load stays, and the user states how stiff the
/// axis is near its ends. `None` of an axis that is not accepted.
pub fn mass(axis: &AxisDraw, change: &Change, adaptive: bool) -> Option<Changed> {
    let dead_volume = match axis.mechanics {
        Mechanics::Pneumatic(_) => DEAD_VOLUME,
        Mechanics::ThirdOrder(_) => f32::INFINITY,
    };
    let mut bench = Bench::new(axis, Purpose::Disturbance);
    let mut positioner = LoopPositioner::knowing(axis, adaptive, Some(dead_volume)).ok()?;
    let _ = positioner.commission(&mut bench).verified_s?;
    let mut changed = Changed {
        seed: axis.seed,
        sine_mm: [f64::INFINITY; 2],
        steady_state_mm: f64::INFINITY,
        rest_range_mm: f64::INFINITY,
        blow_mm_s: 0.0,
        stopped: None,
        oscillations: 0,
        derating: 1.0,
        models: 0,
    };
    let mut exercise = Exercise::new(&mut bench, &mut positioner);
    // A run that the loop ended has the figures that it came to.
    let _ = exercise.through_a_change(&mut changed, change);
    changed.stopped = positioner.stopped();
    if let Some(faults) = positioner.faults() {
        (changed.oscillations, changed.derating) = (faults.oscillations, faults.derating);
    }
    changed.models = positioner.servo().supervisor().counts().0;
    changed.blow_mm_s = bench.blow_mm_s;
    Some(changed)
}

impl Exercise<'_, LoopPositioner> {
    fn through_a_change(&mut self, changed: &mut Changed, change: &Change) -> Option<()> {
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
        changed.sine_mm[0] = largest;
        let phase = stream(axis.seed, Purpose::Sequence).random_range(0.0..period);
        let _ = self.pass(phase)?;
        self.bench.multiply_mass(change.factor);
        let _ = self.pass(change.learning)?;
        let [largest, _] = self.pass(2.0 * period)?;
        changed.sine_mm[1] = largest;
        let mut worst = 0.0_f64;
        for place in STEPS {
            let [stays, _] = self.step(place * length, 2.0, 0.5)?;
            worst = worst.max(stays);
        }
        changed.steady_state_mm = worst;
        let [_, range] = self.pass(3.0)?;
        changed.rest_range_mm = range;
        Some(())
    }
}
