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
mod margins;
mod model;
mod placement;
mod plant;
mod shaping;
mod state_feedback;

use nalgebra::DVector;

use crate::delay_choice::LONGEST_DELAY;
use crate::error::Error;
use frequency_response::FrequencyResponse;
use state_feedback::IDLE;

pub use controller::{Cascade, Controller, Pid};
pub use margins::Margins;
pub use model::Model;
pub use plant::SampledPlant;
pub use state_feedback::StateFeedback;

/// Largest sensitivity of a loop whose bandwidth is chosen: a gain margin of 2.4 and a phase margin
/// of 34 degrees at least.
pub const SENSITIVITY: f64 = 1.7;

/// Bandwidths that are tried between the slowest and the fastest, and steps that sharpen the
/// choice.
const TRIED: usize = 24;
const SHARPENED: usize = 5;

/// What the loops are for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Sample time of the controller \[s\].
    pub sample_time: f64,
    /// Bandwidth \[rad/s\]; the largest robust one without.
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
        let samples = (seconds / plant.dt).round() as usize + 1;
        let mut state = DVector::zeros(plant.order());
        let mut inner = DVector::zeros(self.controller.states());
        let mut past = vec![0.0; plant.delay + 2];
        let mut course = Vec::with_capacity(samples);
        for k in 0..samples {
            let output = (&plant.c * &state)[0];
            let command = self.controller.step(&mut inner, 1.0, output);
            past.rotate_right(1);
            past[0] = command;
            state = &plant.a * &state
                + &plant.b[0] * past[plant.delay]
                + &plant.b[1] * past[plant.delay + 1];
            course.push(Sample {
                time: k as f64 * plant.dt,
                output,
                command,
            });
        }
        course
    }

    /// The open loop, broken at the input of the plant, over the frequency \[rad/s\].
    pub fn open(&self, plant: &SampledPlant) -> impl Fn(f64) -> nalgebra::Complex<f64> {
        let controller = FrequencyResponse::new(&self.controller, plant.dt);
        move |omega| plant.response(omega) * controller.at(omega)
    }
}

/// Gains for a model; the margins hold for `around` too, models within what is known of it.
///
/// Cost: some 30 bandwidths for each kind of controller, each with a frequency response of every
/// model.
///
/// # Errors
/// [`Error::Model`] for a model without a controller, [`Error::SampleTime`], [`Error::Bandwidth`].
pub fn tune(model: &Model, around: &[Model], goal: Goal) -> Result<Tuned, Error> {
    model.check()?;
    let dt = goal.sample_time;
    if !(dt > 0.0 && dt.is_finite()) {
        return Err(Error::SampleTime(dt));
    }
    if !(model.delay <= LONGEST_DELAY as f64 * dt) {
        let what = format!(
            "its delay is longer than {LONGEST_DELAY} samples: a controller with a longer sample time does as well"
        );
        return Err(Error::Model(what));
    }
    let fastest = 0.5 / dt;
    if let Some(bandwidth) = goal.bandwidth
        && !(bandwidth > 0.0 && bandwidth <= fastest)
    {
        return Err(Error::Bandwidth { bandwidth, fastest });
    }
    let plant = SampledPlant::new(model, dt);
    let others: Vec<SampledPlant> = around
        .iter()
        .filter(|model| model.check().is_ok())
        .map(|model| SampledPlant::new(model, dt))
        .collect();
    let (mut loops, mut refused) = (Vec::new(), Vec::new());
    for kind in KINDS {
        let at =
            |bandwidth: f64, limit: f64| judged(kind, model, (&plant, &others), bandwidth, limit);
        let found = match goal.bandwidth {
            Some(bandwidth) => at(bandwidth, f64::INFINITY),
            None => fastest_robust(&plant, |bandwidth| at(bandwidth, SENSITIVITY)),
        };
        match found {
            Ok(found) => loops.push(found),
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

/// Why a bandwidth has no gains.
const UNSTABLE: &str = "the loop would be unstable at this bandwidth";

/// A loop of a kind at a bandwidth with its margins, those of a plant and of others around it; an
/// error where it is unstable, or where the sensitivity with one of them exceeds `limit`.
fn judged(
    kind: &str,
    model: &Model,
    (plant, others): (&SampledPlant, &[SampledPlant]),
    bandwidth: f64,
    limit: f64,
) -> Result<TunedLoop, String> {
    let dt = plant.dt;
    let (gains, controller) = if kind == KINDS[0] {
        if model.a[0] != 0.0 {
            return Err("the plant does not integrate: its output is no position".into());
        }
        let cascade = shaping::cascade(plant, bandwidth).ok_or("no gain at this bandwidth")?;
        (Gains::Cascade(cascade), cascade.controller(dt))
    } else if kind == KINDS[1] {
        let pid = shaping::pid(plant, bandwidth).ok_or("no gain at this bandwidth")?;
        (Gains::Pid(pid), pid.controller(dt))
    } else {
        let (gains, controller) = state_feedback::design(plant, model, bandwidth)?;
        (Gains::StateFeedback(gains), controller)
    };
    let [nominal, worst] = margins::with_others(plant, others, &controller, (bandwidth, limit))
        .ok_or_else(|| format!("no bandwidth keeps the sensitivity below {limit}"))?;
    if !nominal.stable {
        return Err(UNSTABLE.into());
    }
    Ok(TunedLoop {
        gains,
        bandwidth,
        controller,
        margins: nominal,
        worst: (!others.is_empty()).then_some(worst),
    })
}

/// The loop with the largest bandwidth that is stable, of those whose sensitivity stays below its
/// limit.
fn fastest_robust(
    plant: &SampledPlant,
    at: impl Fn(f64) -> Result<TunedLoop, String>,
) -> Result<TunedLoop, String> {
    let robust = |bandwidth: f64| -> Result<TunedLoop, String> {
        let found = at(bandwidth)?;
        let stable = found.worst.is_none_or(|worst| worst.stable);
        stable.then_some(found).ok_or_else(|| UNSTABLE.into())
    };
    let fastest = (0.5 / plant.dt).min(100.0 * plant.rate);
    let slowest = 1e-3 * plant.rate.min(fastest);
    let ratio = (fastest / slowest).powf(1.0 / (TRIED - 1) as f64);
    let mut reason = String::new();
    for k in 0..TRIED {
        let bandwidth = fastest / ratio.powi(k as i32);
        match robust(bandwidth) {
            Ok(mut best) => {
                let (mut low, mut high) = (bandwidth, bandwidth * ratio);
                for _ in 0..SHARPENED {
                    let middle = (low * high).sqrt();
                    match robust(middle) {
                        Ok(found) => (best, low) = (found, middle),
                        Err(_) => high = middle,
                    }
                }
                return Ok(best);
            }
            Err(why) if why == IDLE && !reason.is_empty() && reason != IDLE => {
                return Err(format!("{reason} and is above a pole of the plant"));
            }
            Err(why) if why == UNSTABLE => reason = "no bandwidth leaves the loop stable".into(),
            Err(why) => reason = why,
        }
    }
    Err(reason)
}

#[cfg(test)]
mod tests;
