//! What a loop is for, and what one is: a controller with its gains and its margins.

use nalgebra::DVector;

use super::controller::{Cascade, Controller, Pid};
use super::frequency_response::FrequencyResponse;
use super::margins::Margins;
use super::plant::SampledPlant;
use super::state_feedback::StateFeedback;

/// Largest sensitivity of a loop whose bandwidth is chosen: a gain margin of 2.4 and a phase margin
/// of 34 degrees at least.
pub const SENSITIVITY: f64 = 1.7;

/// Largest and smallest bandwidth \[rad per sample\]: held commands hardly follow above, and
/// a loop is as good with fewer samples below, where its poles are hardly told from 1.
pub(super) const FASTEST: f64 = 0.5;
pub(super) const SLOWEST: f64 = 1e-8;

/// What the loops are for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// Sample time of the controller \[s\].
    pub sample_time: f64,
    /// Bandwidth \[rad/s\], 1e-8 to 0.5 radians per sample; without, the largest robust one.
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

/// The kinds of controllers, in the order of [`Tuned::loops`](super::Tuned::loops).
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
    pub(super) fn for_gain(self, gain: f64) -> Self {
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
