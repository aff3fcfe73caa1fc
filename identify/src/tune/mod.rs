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

use nalgebra::DVector;

use crate::error::Error;
use frequency_response::FrequencyResponse;
use search::Search;

pub use controller::{Cascade, Controller, Pid};
pub use margins::Margins;
pub use model::Model;
pub use plant::SampledPlant;
pub use state_feedback::StateFeedback;

/// Largest sensitivity of a loop whose bandwidth is chosen: a gain margin of 2.4 and a phase margin
/// of 34 degrees at least.
pub const SENSITIVITY: f64 = 1.7;

/// Largest and smallest bandwidth \[rad per sample\]: held commands hardly follow above, and a loop
/// is as good with fewer samples below.
const FASTEST: f64 = 0.5;
const SLOWEST: f64 = 1e-5;

/// What the loops are for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Sample time of the controller \[s\].
    pub sample_time: f64,
    /// Bandwidth \[rad/s\], 1e-5 to 0.5 radians per sample; the largest robust one of these without.
    pub bandwidth: Option<f64>,
}

/// A controller by its gains.
#[derive(Debug, Clone, PartialEq)]
pub enum Gains {
    /// Position P around velocity PI.
    Cascade(Cascade),
    /// PID, or PI where no derivative is needed.
    Pid(Pid),
    /// State feedback with observer.
    StateFeedback(StateFeedback),
}

impl Gains {
    /// Name of the kind.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Cascade(_) => KINDS[0],
            Self::Pid(_) => KINDS[1],
            Self::StateFeedback(_) => KINDS[2],
        }
    }
}

/// The kinds of controllers, in the order of [`Tuned::loops`].
pub const KINDS: [&str; 3] = ["cascade", "pid", "state feedback"];

/// A controller with its plant.
#[derive(Debug, Clone, PartialEq)]
pub struct TunedLoop {
    /// Its gains.
    pub gains: Gains,
    /// Bandwidth that they are for \[rad/s\].
    pub bandwidth: f64,
    /// The same as state equations.
    pub controller: Controller,
    /// With the model.
    pub margins: Margins,
    /// The worst within two standard deviations; `None` where no standard deviations were given.
    pub worst: Option<Margins>,
}

/// A sample of a simulated loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// \[s\]
    pub time: f64,
    /// y.
    pub output: f64,
    /// u.
    pub command: f64,
}

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

impl TunedLoop {
    /// The answer of the loop to a step of the reference by 1, over so many seconds.
    pub fn step(&self, plant: &SampledPlant, seconds: f64) -> Vec<Sample> {
        let mut course = Vec::new();
        self.step_while(plant, |sample| {
            course.push(sample);
            sample.time < seconds - 0.5 * plant.dt
        });
        course
    }

    /// The same, sample by sample for as long as `next` says.
    pub fn step_while(&self, plant: &SampledPlant, mut next: impl FnMut(Sample) -> bool) {
        let mut state = DVector::zeros(plant.order());
        let mut inner = DVector::zeros(self.controller.states());
        let mut past = vec![0.0; plant.delay + 2];
        for k in 0u64.. {
            let output = (&plant.c * &state)[0];
            let command = self.controller.step(&mut inner, 1.0, output);
            past.rotate_right(1);
            past[0] = command;
            state = &plant.a * &state
                + &plant.b[0] * past[plant.delay]
                + &plant.b[1] * past[plant.delay + 1];
            let time = k as f64 * plant.dt;
            let sample = Sample {
                time,
                output,
                command,
            };
            if !next(sample) {
                return;
            }
        }
    }

    /// For a plant whose gain is `gain` times that of the one that it is for.
    fn for_gain(self, gain: f64) -> Self {
        let gains = match self.gains {
            Gains::Cascade(gains) => Gains::Cascade(Cascade {
                kp: gains.kp / gain,
                ..gains
            }),
            Gains::Pid(gains) => Gains::Pid(Pid {
                kp: gains.kp / gain,
                ..gains
            }),
            Gains::StateFeedback(gains) => Gains::StateFeedback(gains.for_gain(gain)),
        };
        Self {
            gains,
            controller: self.controller.for_gain(gain),
            ..self
        }
    }

    /// The open loop, broken at the input of the plant, over the frequency \[rad/s\].
    pub fn open(&self, plant: &SampledPlant) -> impl Fn(f64) -> nalgebra::Complex<f64> {
        let controller = FrequencyResponse::new(&self.controller, plant.dt);
        move |omega| plant.response(omega) * controller.at(omega)
    }
}

/// Gains for a model; the margins hold for `around` too, models within what is known of it.
///
/// Gains are found for a plant whose gain is one, and are in the units of the signals by division
/// afterwards: they do not depend on these units. The search for a bandwidth goes from half a
/// radian per sample down to a thousandth of the rate of the plant, or to 1e-5 radians per sample.
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
