//! An axis that takes a load at one place and puts it down at another, again and again.

use trendid::servo::Reason;

use crate::servo::population::adaptive::LoopPositioner;
use crate::servo::population::bench::Bench;
use crate::servo::population::draw::AxisDraw;
use crate::servo::population::range::Purpose;
use crate::servo::population::sequence::Exercise;

/// Places over the travel where it takes the load and puts it down.
const PLACES: [f64; 2] = [0.35, 0.65];

/// Rounds without a load, and with one.
const EMPTY: usize = 2;
const LOADED: usize = 10;

/// Time from one place to the other, with the stay there \[s\], and the end of it that is judged.
const STAY: f64 = 2.4;
const JUDGED: f64 = 0.5;

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Handling {
    /// The seed of the axis.
    pub seed: u64,
    /// Largest error on the way and at the end of a stay before there is a load \[mm\].
    pub empty_mm: [f64; 2],
    /// The same in the second half of the rounds with a load \[mm\].
    pub loaded_mm: [f64; 2],
    /// Hardest blow to an end stop \[mm/s\].
    pub blow_mm_s: f64,
    /// Why the loop stopped.
    pub stopped: Option<Reason>,
    /// Oscillations that were noticed.
    pub oscillations: u32,
    /// Models that reached the controller.
    pub models: u32,
}

/// Handles a load that makes the moving mass so many times as large. `None` of an axis that is not
/// accepted.
pub fn handle(axis: &AxisDraw, factor: f64, adaptive: bool) -> Option<Handling> {
    let mut bench = Bench::new(axis, Purpose::Disturbance);
    let mut positioner = LoopPositioner::knowing(axis, adaptive, None).ok()?;
    let _ = positioner.commission(&mut bench).verified_s?;
    let mut handling = Handling {
        seed: axis.seed,
        empty_mm: [f64::INFINITY; 2],
        loaded_mm: [f64::INFINITY; 2],
        blow_mm_s: 0.0,
        stopped: None,
        oscillations: 0,
        models: 0,
    };
    let mut exercise = Exercise::new(&mut bench, &mut positioner);
    // A run that the loop ended has the figures that it came to.
    let _ = exercise.rounds(&mut handling, factor);
    handling.stopped = positioner.stopped();
    handling.oscillations = positioner.faults().map_or(0, |faults| faults.oscillations);
    handling.models = positioner.servo().supervisor().counts().0;
    handling.blow_mm_s = bench.blow_mm_s;
    Some(handling)
}

impl Exercise<'_, LoopPositioner> {
    /// A move to each place; the largest error on the way and at the end of the stay.
    fn round(&mut self, factor: f64) -> Option<[f64; 2]> {
        let length = self.bench.axis().stroke_mm();
        let mut worst = [0.0_f64; 2];
        for (place, factor) in PLACES.into_iter().zip([factor, 1.0 / factor]) {
            let [stays, largest] = self.step(place * length, STAY, JUDGED)?;
            worst = [worst[0].max(largest), worst[1].max(stays)];
            self.bench.multiply_mass(factor);
        }
        Some(worst)
    }

    fn rounds(&mut self, handling: &mut Handling, factor: f64) -> Option<()> {
        let mut many = |rounds, factor| {
            let mut worst = [0.0_f64; 2];
            for _ in 0..rounds {
                let round = self.round(factor)?;
                worst = [worst[0].max(round[0]), worst[1].max(round[1])];
            }
            Some(worst)
        };
        handling.empty_mm = many(EMPTY, 1.0)?;
        let _ = many(LOADED / 2, factor)?;
        handling.loaded_mm = many(LOADED / 2, factor)?;
        Some(())
    }
}
