//! Steps, sines and rest on any positioner, and what they show.

use rand::RngExt;

use crate::servo::population::bench::Bench;
use crate::servo::population::draw::AxisDraw;
use crate::servo::population::range::{Purpose, stream};

/// What moves an axis to where it is wanted.
pub trait Positioner {
    /// Moves to a position \[mm\]; ends an oscillation.
    fn move_to(&mut self, target_mm: f64);

    /// Oscillates about the present reference; whether that is possible.
    fn oscillate(&mut self, amplitude_mm: f64, frequency_hz: f64) -> bool;

    /// One sample, with the code of the sensor.
    fn update(&mut self, code: i32) -> Sample;
}

/// One sample of a positioner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Wanted position \[mm\].
    pub reference_mm: f64,
    /// Whether the reference has come to rest at its target.
    pub resting: bool,
    /// Command of the valve.
    pub command: f64,
    /// Whether it still controls.
    pub alive: bool,
    /// Moves at rest that it has reported.
    pub moves_at_rest: u32,
}

/// Frequencies of the sines \[Hz\].
pub const FREQUENCIES: [f64; 3] = [0.5, 1.0, 2.0];

/// Steps between the small ones and 90 % of the travel, as places over the travel.
const LARGE_STEPS: [f64; 5] = [0.6, 0.2, 0.05, 0.95, 0.5];

/// Small steps \[mm\].
const SMALL_STEPS: [f64; 3] = [0.05, 0.2, 1.0];

/// Time for which a move is given after its reference has come to rest, and the part of it at the
/// end that is judged \[s\].
const SETTLE: f64 = 2.0;
const JUDGED: f64 = 0.5;

/// Time at rest that shows a cycle \[s\].
const REST: f64 = 4.0;

/// Longest time for a reference to come to rest \[s\].
const PATIENCE: f64 = 20.0;

/// Amplitude over travel of large and of small sines, where the limits of motion allow it.
pub const LARGE: f64 = 0.2;
const SMALL: f64 = 0.005;

/// What a sequence shows of an axis; `None` where it did not come to it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Largest error at the end of a large step \[mm\].
    pub steady_state_mm: Option<f64>,
    /// Largest error from the command of a step of 0.05 mm on \[mm\].
    pub excursion_mm: Option<f64>,
    /// Largest error in the large and in the small sines \[mm\].
    pub large_sines_mm: [Option<f64>; 3],
    /// The same of the small ones.
    pub small_sines_mm: [Option<f64>; 3],
    /// Range of the position at rest \[mm\].
    pub rest_range_mm: Option<f64>,
    /// Whether the positioner has reported that the axis moved in that time.
    pub rest_noticed: bool,
    /// Root mean square of the change of the command per sample.
    pub wear: f64,
    /// Whether the positioner still controlled at the end.
    pub alive: bool,
}

/// A positioner on its bench.
#[derive(Debug)]
pub struct Exercise<'a, P> {
    /// The bench.
    pub bench: &'a mut Bench,
    /// The positioner.
    pub positioner: &'a mut P,
    reference: f64,
    resting: bool,
    command: f64,
    moves_at_rest: u32,
    changes: f64,
    samples: f64,
}

impl<'a, P: Positioner> Exercise<'a, P> {
    /// The positioner controls the axis of the bench.
    pub fn new(bench: &'a mut Bench, positioner: &'a mut P) -> Self {
        Self {
            bench,
            positioner,
            reference: f64::NAN,
            resting: false,
            command: 0.0,
            moves_at_rest: 0,
            changes: 0.0,
            samples: 0.0,
        }
    }

    /// One sample: its error \[mm\], or `None` when the positioner has given up.
    fn tick(&mut self) -> Option<f64> {
        let code = self.bench.code();
        let sample = self.positioner.update(code);
        let error = sample.reference_mm - self.bench.position_mm();
        self.reference = sample.reference_mm;
        self.resting = sample.resting;
        self.moves_at_rest = sample.moves_at_rest;
        let change = sample.command - self.command;
        self.changes += change * change;
        self.samples += 1.0;
        self.command = sample.command;
        self.bench.hold(sample.command);
        sample.alive.then_some(error)
    }

    /// Passes a time; the largest error and the range of the position \[mm\].
    pub fn pass(&mut self, seconds: f64) -> Option<[f64; 2]> {
        let end = self.bench.time() + seconds;
        let (mut largest, mut low, mut high) = (0.0_f64, f64::INFINITY, f64::NEG_INFINITY);
        while self.bench.time() < end {
            let position = self.bench.position_mm();
            (low, high) = (low.min(position), high.max(position));
            largest = largest.max(self.tick()?.abs());
        }
        Some([largest, high - low])
    }

    /// Moves, and waits until the reference rests.
    fn arrive(&mut self, target_mm: f64) -> Option<f64> {
        self.positioner.move_to(target_mm);
        let end = self.bench.time() + PATIENCE;
        let mut largest = self.tick()?.abs();
        while !self.resting && self.bench.time() < end {
            largest = largest.max(self.tick()?.abs());
        }
        Some(largest)
    }

    /// A step: the error that stays after `settle` seconds, and the largest one on the way \[mm\].
    pub fn step(&mut self, target_mm: f64, settle: f64, judged: f64) -> Option<[f64; 2]> {
        let moving = self.arrive(target_mm)?;
        let [settling, _] = self.pass(settle - judged)?;
        let [stays, _] = self.pass(judged)?;
        Some([stays, moving.max(settling).max(stays)])
    }

    /// A sine: the largest error over whole `periods` after the two in which it may grow \[mm\].
    pub fn sine(&mut self, amplitude: f64, frequency: f64, periods: f64) -> Option<f64> {
        let centre = self.reference;
        if !self.positioner.oscillate(amplitude, frequency) {
            return None;
        }
        self.pass(2.0 / frequency)?;
        let [largest, _] = self.pass(periods / frequency)?;
        self.arrive(centre)?;
        self.pass(0.3)?;
        Some(largest)
    }

    fn whole(&mut self, axis: &AxisDraw, motion: &mut Motion) -> Option<()> {
        let length = axis.stroke_mm();
        let mut random = stream(axis.seed, Purpose::Sequence);
        let mut place = |low: f64, high: f64| length * random.random_range(low..high);
        let (steps_at, small_at, rest_at) = (place(0.2, 0.8), place(0.1, 0.9), place(0.1, 0.9));
        self.step(steps_at, SETTLE, JUDGED)?;
        for size in SMALL_STEPS {
            let [_, largest] = self.step(steps_at + size, SETTLE, JUDGED)?;
            motion.excursion_mm.get_or_insert(largest);
        }
        let mut worst = 0.0_f64;
        for place in LARGE_STEPS {
            let [stays, _] = self.step(place * length, SETTLE, JUDGED)?;
            worst = worst.max(stays);
        }
        motion.steady_state_mm = Some(worst);
        // The last step led to the middle: the large sines are about it.
        for (frequency, error) in FREQUENCIES.iter().zip(&mut motion.large_sines_mm) {
            let amplitude = amplitude(axis, LARGE, *frequency);
            *error = self.sine(amplitude, *frequency, 2.0);
        }
        self.step(small_at, 1.0, JUDGED)?;
        for (frequency, error) in FREQUENCIES.iter().zip(&mut motion.small_sines_mm) {
            let amplitude = amplitude(axis, SMALL, *frequency);
            *error = self.sine(amplitude, *frequency, 2.0);
        }
        self.step(rest_at, SETTLE, JUDGED)?;
        let before = self.moves_at_rest;
        let [_, range] = self.pass(REST)?;
        motion.rest_noticed = self.moves_at_rest > before;
        motion.rest_range_mm = Some(range);
        Some(())
    }

    /// The whole sequence.
    pub fn run(mut self) -> Motion {
        let axis = *self.bench.axis();
        let mut motion = Motion::default();
        motion.alive = self.whole(&axis, &mut motion).is_some();
        if !motion.alive {
            // How the axis stops belongs to it.
            let end = self.bench.time() + 1.0;
            while self.bench.time() < end {
                let _ = self.tick();
            }
        }
        motion.wear = (self.changes / self.samples).sqrt();
        motion
    }
}

/// Amplitude of a sine of a part of the travel, as far as the limits of motion allow it \[mm\].
pub fn amplitude(axis: &AxisDraw, part: f64, frequency: f64) -> f64 {
    let limits = axis.limits();
    let w = std::f64::consts::TAU * frequency;
    let room = (limits.velocity / w)
        .min(limits.acceleration / (w * w))
        .min(limits.jerk / (w * w * w));
    (part * axis.stroke_mm()).min(0.8 * room)
}
