//! Passes of the core over the signals of a problem.

use trendid::Outcome;
use trendid::estimation::Terms;

use crate::dynamic::{Setup, settings};
use crate::error::Error;
use crate::estimate::Estimate;
use crate::problem::Problem;
use crate::tuning::{FASTEST, Tuning};

/// Settling of the trends before the first estimate, in time constants of the filter.
const SETTLING: f64 = 6.0;

/// And at most this share of the record.
const SETTLING_SHARE: f64 = 0.2;

/// Expected noise of the output over its spread.
const NOISE: f32 = 1e-4;

/// Numerators that differ by less than this from those without a hold are not worth another pass.
const NEGLIGIBLE: f64 = 1e-5;

/// Passes at most until the numerators are those of the estimate.
const PASSES: usize = 8;

/// Movement of a parameter between two passes, in standard deviations, that ends them.
const SETTLED: f64 = 1e-3;

/// One-step prediction errors of a run, summed in f64: over a long record f32 would lose the later,
/// smaller errors.
#[doc(alias = "Index")]
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PredictionErrors {
    /// Sum of their squares, in the unit of y squared.
    #[doc(alias = "iq")]
    pub ise: f64,
    /// Sum of their magnitudes, in the unit of y.
    #[doc(alias = "iv")]
    pub iae: f64,
    /// Number of errors.
    pub samples: usize,
}

/// One pass over the record.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// The estimate before the second half.
    pub half: Estimate,
    /// The estimate after the last sample.
    pub end: Estimate,
    /// One-step prediction errors: of the second half where the parameters were held there, else of
    /// all samples that were predicted.
    pub errors: PredictionErrors,
}

/// The course of the parameters over a run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Trace {
    /// Sample number, parameters, standard deviations.
    pub rows: Vec<(usize, Vec<f64>, Vec<f64>)>,
}

/// What a pass does beside estimating.
struct Pass<'t> {
    /// Whether the parameters are held over the second half.
    held: bool,
    /// Where every so-many-th state goes.
    trace: Option<(&'t mut Trace, usize)>,
}

impl Problem<'_> {
    /// Runs the core over all samples. With a trace, every so-many-th state is kept in it.
    ///
    /// # Errors
    /// A configuration or a sample that the core refuses.
    pub fn run(
        &self,
        tuning: Tuning,
        mut trace: Option<(&mut Trace, usize)>,
    ) -> Result<Run, Error> {
        let end = |run: &Run| run.end.clone();
        self.settle(tuning, end, |denominator| {
            let trace = trace.as_mut().map(|(trace, every)| (&mut **trace, *every));
            self.pass(tuning, denominator, Pass { held: false, trace })
        })
    }

    /// Estimates with the first half and predicts the second with the parameters held.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn run_held(&self, tuning: Tuning) -> Result<Run, Error> {
        let half = |run: &Run| run.half.clone();
        self.settle(tuning, half, |denominator| {
            let pass = Pass {
                held: true,
                trace: None,
            };
            self.pass(tuning, denominator, pass)
        })
    }

    /// Passes until the numerators of the inputs are those of the estimate.
    ///
    /// At fast sampling they are so from the first.
    fn settle(
        &self,
        tuning: Tuning,
        of: impl Fn(&Run) -> Estimate,
        mut pass: impl FnMut(Option<&[f64]>) -> Result<Run, Error>,
    ) -> Result<Run, Error> {
        let mut run = pass(None)?;
        for _ in 1..PASSES {
            let now = of(&run);
            let fastest = now.fastest().max(tuning.fastest().unwrap_or(0.0)) * self.signals.dt;
            if !(fastest * fastest / 12.0 > NEGLIGIBLE) || fastest > FASTEST {
                break;
            }
            run = pass(Some(&now.a))?;
            if !(now.distance(&of(&run)) > SETTLED) {
                break;
            }
        }
        Ok(run)
    }

    fn pass(
        &self,
        tuning: Tuning,
        denominator: Option<&[f64]>,
        Pass { held, mut trace }: Pass,
    ) -> Result<Run, Error> {
        if let Some((trace, _)) = &mut trace {
            trace.rows.clear();
        }
        let mut core = self.setup(tuning, denominator).build()?;
        let y = self.signals.output;
        // Positions are large against their increments: the reference goes before f32 (integrator
        // only).
        let reference = match self.structure.integrator {
            true => y[0],
            false => 0.0,
        };
        let mut u = vec![0.0_f32; self.signals.inputs.len()];
        let middle = y.len() / 2;
        let mut half = None;
        let mut errors = PredictionErrors::default();
        for (k, y) in y.iter().enumerate() {
            if k == middle {
                half = Some(core.estimate());
                core.adapt(!held);
            }
            for (u, input) in u.iter_mut().zip(&self.signals.inputs) {
                *u = self.signals.acting(k, input.samples[k]) as f32;
            }
            let outcome = core.update(&u, (y - reference) as f32);
            if let Outcome::Refused(_) = outcome {
                return Err(Error::Disproportionate(k));
            }
            if let Some(error) = outcome.innovation()
                && (k >= middle || !held)
            {
                errors.add(f64::from(error));
            }
            if let Some((trace, every)) = &mut trace
                && k % *every == 0
                && matches!(outcome, Outcome::Estimated { .. })
            {
                let now = core.estimate();
                trace.rows.push((k, now.theta, now.sigma));
            }
        }
        let end = core.estimate();
        Ok(Run {
            half: half.unwrap_or_else(|| end.clone()),
            end,
            errors,
        })
    }

    fn setup(&self, tuning: Tuning, denominator: Option<&[f64]>) -> Setup {
        let (signals, structure) = (self.signals, self.structure);
        // Raw trends have no filter; their normalisation takes a decade below the sampling rate.
        let bandwidth = tuning.fastest().unwrap_or(0.1 / signals.dt) as f32;
        let inputs = &signals.inputs;
        let ranges: Vec<f32> = inputs.iter().map(|i| spread(i.samples) as f32).collect();
        let output_range = spread(signals.output) as f32;
        let mut settings = settings(bandwidth, &ranges, output_range);
        settings.output_noise = NOISE * output_range;
        settings.memory = self.options.memory.map(|m| m as f32);
        let settling = tuning.slowest().map_or(0.0, |rate| SETTLING / rate);
        settings.settling =
            settling.min(SETTLING_SHARE * self.samples() as f64 * signals.dt) as f32;
        for (c, input) in inputs.iter().enumerate() {
            settings.holds[c] = input.hold;
            if input.delayed {
                settings.set_delay(c, tuning.delay as f32);
            }
            if !structure.integrator {
                settings.initial_input[c] = input.samples[0] as f32;
            }
        }
        let scheme = self.options.scheme;
        Setup {
            order: structure.order,
            output: Terms::between(usize::from(structure.integrator), structure.order),
            inputs: inputs.iter().map(|i| Terms::up_to(self.terms(i))).collect(),
            constant: structure.constant,
            initial_state: false,
            sample_time: signals.dt as f32,
            scheme,
            filter: tuning.filter(scheme, structure.order, signals.dt, denominator),
            settings,
        }
    }
}

impl PredictionErrors {
    fn add(&mut self, error: f64) {
        self.ise += error * error;
        self.iae += error.abs();
        self.samples += 1;
    }
}

/// Root mean square about the mean; for signals that move.
fn spread(x: &[f64]) -> f64 {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / x.len() as f64).sqrt()
}
