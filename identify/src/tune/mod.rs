//! Gains for the loop that a user already has, from a model and what is not known of it.
//!
//! ```text
//! model -> sampled plant (exact, delay between samples) -> controller for a bandwidth -> margins
//!                                                               ^ the largest whose sensitivity stays below 1.7,
//!                                                                 for the model and two standard deviations around it
//! ```
//!
//! | controller | its gains follow from |
//! |---|---|
//! | position P around velocity PI | bandwidth W of the position; velocity loop at 3 W with 65 degrees where the PI lag allows |
//! | PID, derivative of the output filtered | crossover at W with 60 degrees |
//! | state feedback with observer | slower poles onto a circle of radius W, observer at 3 W, a constant disturbance estimated |
//!
//! Gain and phase at the crossover: Astrom and Hagglund, Advanced PID Control (2006); sensitivity
//! as the measure of robustness, the same, section 4; delays ahead of the state: Astrom and
//! Wittenmark, Computer-Controlled Systems (1997).
//!
//! ```
//! use trendid_identify::tune::{Goal, Model, tune};
//! // 1e6 / (s (s^2 + 20 s + 400)) with half a millisecond of delay, sampled every millisecond.
//! let model = Model { a: vec![0.0, 400.0, 20.0], b: vec![1e6], delay: 0.5e-3 };
//! let tuned = tune(&model, &[], Goal { sample_time: 1e-3, bandwidth: None })?;
//! for found in &tuned.loops {
//!     assert!(found.margins.stable && found.margins.max_sensitivity <= 1.7);
//!     let step = found.step(&tuned.plant, 4.0);
//!     assert!((step.last().unwrap().output - 1.0).abs() < 0.01);
//! }
//! # Ok::<(), trendid_identify::Error>(())
//! ```

mod controller;
mod frequency_response;
mod limits;
mod margins;
mod model;
mod placement;
mod plant;
mod search;
mod shaping;
mod stability;
mod state_feedback;
mod tuned_loop;

use crate::error::Error;
use search::Search;

pub use controller::{Cascade, Controller, Pid};
pub use margins::Margins;
pub use model::Model;
pub use plant::SampledPlant;
pub use state_feedback::StateFeedback;
pub use tuned_loop::{Gains, Goal, KINDS, SENSITIVITY, Sample, TunedLoop};

/// Gains for a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Tuned {
    /// The model, sampled.
    pub plant: SampledPlant,
    /// One loop of each kind that the plant allows.
    pub loops: Vec<TunedLoop>,
    /// Kinds without a loop, with the reason.
    pub refused: Vec<(&'static str, String)>,
    /// u for r, r', r'' ..: the model inverted, its delay left out.
    pub feedforward: Vec<f64>,
}

/// Gains for a model; the margins hold for `around` too, models within what is known of it.
///
/// Gains are found for a plant whose gain is one, and are in the units of the signals by division
/// afterwards: they do not depend on these units. The search for a bandwidth goes from half a
/// radian per sample down to a thousandth of the rate of the plant, or to 1e-8 radians per sample.
///
/// Cost: some 30 bandwidths for each kind of controller, each with a frequency response of every
/// model.
///
/// # Errors
/// [`Error::SampleTime`], [`Error::Bandwidth`]; [`Error::Model`] for a model without a controller:
/// numbers that are none of a drive, and a delay that is longer than 200 samples, also one of
/// `around`, as nobody knows gains for a delay that nobody knows.
pub fn tune(model: &Model, around: &[Model], goal: Goal) -> Result<Tuned, Error> {
    let dt = goal.sample_time;
    limits::check(model, around, goal)?;
    let plant = limits::sampled(model, dt)?;
    let gain = plant.gain();
    let unit = model.divided(gain);
    let others: Vec<SampledPlant> = around
        .iter()
        .map(|model| Ok(limits::sampled(model, dt)?.divided(gain)))
        .collect::<Result<_, Error>>()?;
    let search = Search {
        model: &unit,
        plant: plant.divided(gain),
        others,
    };
    let (mut loops, mut refused) = (Vec::new(), Vec::new());
    for kind in KINDS {
        let found = match goal.bandwidth {
            Some(bandwidth) => search.at(kind, bandwidth, f64::INFINITY),
            None => search.fastest_robust(kind),
        };
        match found {
            Ok(found) => loops.push(found.for_gain(gain)),
            Err(reason) => refused.push((kind, reason)),
        }
    }
    Ok(Tuned {
        plant,
        loops,
        refused,
        feedforward: model.feedforward(),
    })
}

#[cfg(test)]
mod tests;
