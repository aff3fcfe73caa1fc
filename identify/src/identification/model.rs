//! A model with what speaks for it.

use crate::estimate::Estimate;
use crate::filter_choice::far;
use crate::free_run::FreeRun;
use crate::instruments::DelayFound;
use crate::poor_input::PoorInput;
use crate::run::{PredictionErrors, Trace};

/// Standard deviations by which a delay may miss the one that the record shows.
const MISSED: f64 = 3.0;

/// How the model was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// By instruments.
    Instruments,
    /// By least squares over the sums, because the instruments were weak.
    WeakInstruments,
    /// By the output error of its motion: with a friction that is its own.
    OutputError,
    /// By the recursion of the core: with a memory, raw trends or the scheme of Goodwin, and for
    /// what is not stable.
    Recursion,
}

/// Where the sign of the friction is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Friction {
    /// From measurements; there may be none.
    Measured,
    /// From the model, which reverses where its own velocity does, but for rests that are measured.
    Held,
    /// From the model, which rests where its own friction holds it: no rest is left out.
    HeldAtRest,
}

/// A model with what speaks for it.
#[derive(Debug, Clone, PartialEq)]
pub struct Identification {
    /// How it was found.
    pub way: Way,
    /// The pole of the filter \[rad/s\]; `None` for raw trends.
    pub pole: Option<f64>,
    /// f_0 .. f_{m-1} of the filter 1/A with the poles of the model itself, where that was taken.
    pub own_filter: Option<Vec<f64>>,
    /// How far the first parameter moves behind filter poles at half and at twice the automatic
    /// one, in the standard deviations of both estimates together; `None` where the pole was given.
    ///
    /// Where that is more than chance the standard deviations of `estimate` contain the moves of
    /// all parameters.
    pub filter_shifts: Option<[f64; 2]>,
    /// Delay in samples.
    pub delay: f64,
    /// Whether the longest delay that is offered was taken.
    pub delay_at_end: bool,
    /// The shortest and the longest whole delay that simulate as well as the best one, within one
    /// standard error over parts of the record left out; `None` where the delay was given.
    pub delay_alike: Option<[usize; 2]>,
    /// The delay as an unknown: what the record would add to the one that was given, or to the one
    /// that was searched where that is at an end; of the recursion, by the sums. `None` where
    /// the sums have no model.
    pub delay_found: Option<DelayFound>,
    /// A longer delay in samples that simulates as well in the place of a zero in the right half
    /// plane, where the delay was searched: the record does not tell the two, and the standard
    /// deviations contain how far the model moves.
    pub delay_imitated: Option<f64>,
    /// What the input is where it says too little for the delay, which was searched.
    pub poor_input: Option<PoorInput>,
    /// Where the friction is from.
    pub friction: Friction,
    /// The model of the whole record.
    pub estimate: Estimate,
    /// Blocks that its standard deviations rest on; `None` for those of the recursion, which take
    /// the noise for white.
    pub effective_blocks: Option<f64>,
    /// The same by least squares behind the same filter, for comparison.
    pub least_squares: Option<Estimate>,
    /// One-step prediction errors of the recursion over the whole record.
    pub errors: PredictionErrors,
    /// Free simulation of the second half; `None` where the model runs away.
    pub free_run: Option<FreeRun>,
    /// Whether the simulated model, its filter and its delay come from the first half alone. The
    /// whole record stands in where the first half does not separate the parameters.
    pub held_out: bool,
    /// The course of the parameters in the recursion.
    pub trace: Trace,
}

fn missed(found: &DelayFound) -> bool {
    found.shift.abs() > MISSED * found.sigma
}

impl Identification {
    /// Standard deviation of the delay in samples, where it was searched.
    pub fn delay_sigma(&self) -> Option<f64> {
        let found = self.delay_found.as_ref();
        found
            .filter(|_| self.delay_alike.is_some())
            .map(|f| f.sigma)
    }

    /// What the record would add to the delay, given or searched, and its standard deviation, in
    /// samples, where that is more than chance. To first order in what is added.
    pub fn delay_missed(&self) -> Option<[f64; 2]> {
        let found = self.delay_found.as_ref();
        found
            .filter(|found| missed(found) && found.shift.abs() <= found.reach)
            .map(|found| [found.shift, found.sigma])
    }

    /// Whether the record does not tell the delay: what it would add is more than chance and beyond
    /// what the equations are linear over, or the delay was searched and its deviation is.
    pub fn delay_untold(&self) -> bool {
        let searched = self.delay_alike.is_some();
        self.delay_found.as_ref().is_some_and(|found| {
            (missed(found) && found.shift.abs() > found.reach)
                || (searched && found.sigma > found.reach)
        })
    }

    /// The larger one of `filter_shifts`, where it is more than chance: the model depends on the
    /// filter.
    pub fn filter_dependence(&self) -> Option<f64> {
        self.filter_shifts.and_then(far)
    }
}
